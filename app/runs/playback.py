"""Where in a run, or in the past of a drive, we are: a clock that plays, pauses, steps, starts again at the end."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from model.config.config import ProfileRoad, SumRoad
from model.simulation.trajectory import Trajectory

SPEEDS = {f"1/{n}×": 1 / n for n in (8, 4, 2)} | {f"{n}×": float(n) for n in (1, 2, 4, 8)}
NORMAL_SPEED = "1×"
STEP = 0.01  # s
AHEAD = 0.3  # m that the first wheel is before an obstacle when the user is brought there


@dataclass
class Playback:
    """Time in a run from `start` to `end`, all in s; `speed` 1 is real time."""

    end: float = 0.0
    time: float = 0.0
    start: float = 0.0
    speed: float = SPEEDS[NORMAL_SPEED]
    playing: bool = True

    def advance(self, elapsed: float) -> None:
        """Let `elapsed` seconds of real time pass; the end of the run leads back to its start."""
        if self.playing and self.end > self.start:
            self.time = self.start + (self.time - self.start + elapsed * self.speed) % (self.end - self.start)

    def scrub(self, time: float) -> None:
        """Go to a time and stay there. Times outside the run, or no number, lead to its nearest end."""
        self.playing = False
        self.time = min(max(time, self.start), self.end) if time == time else self.start

    def step(self, steps: int) -> None:
        """Go some steps on, or back when negative, and stay there."""
        self.scrub(self.time + steps * STEP)

    def toggle(self) -> None:
        """Play, or pause. At the very end, play starts again from the beginning."""
        self.playing = not self.playing
        if self.playing and self.time >= self.end:
            self.time = self.start

    def fit(self, duration: float) -> None:
        """A new run of this duration: go on at the same time as far as it has one."""
        self.start, self.end = 0.0, duration
        self.time = min(self.time, duration)

    def look_back(self, start: float, end: float) -> None:
        """Take the past of a drive: go to its end, or stay where the user went back to, if that is still in it."""
        at_present = self.playing or self.time >= self.end
        self.start, self.end = start, end
        self.time = end if at_present else min(max(self.time, start), end)


def of_another_kind(run: Trajectory, before: Trajectory) -> bool:
    """Whether the road has other obstacles or waves, not only others of the same kind."""
    return _shapes(run) != _shapes(before)


def time_to_look(run: Trajectory, time: float) -> float:
    """When to look at a run whose road is another than that of the run that was looked at until now, at `time`, s.

    That time again, unless the vehicle has left all that is uneven behind by then: it would stand on level road. Then
    just before the first wheel comes to it.
    """
    uneven = run.road.uneven if len(run.t) else None
    if uneven is None or run.road.profile.period > 0.0:  # waves never end
        return time
    wheels, radius = run.q[:, run.system.wheel, 0], run.system.r
    now = min(int(np.searchsorted(run.t, time)), len(run.t) - 1)
    return time if wheels[now].min() - radius <= uneven[1] else time_before_obstacle(run)


def time_before_obstacle(run: Trajectory) -> float:
    """When the first wheel of a run of at least one sample comes to the first obstacle, s; 0 on a road without any."""
    if run.road.uneven is None:
        return 0.0
    foremost = run.q[:, run.system.wheel, 0].max(axis=1) + run.system.r
    return float(run.t[(foremost >= run.road.uneven[0] - AHEAD).argmax()])


def _shapes(run: Trajectory) -> list[tuple[str, str]]:
    """What the road is made of: types, and files of profiles."""
    road = run.config.road
    parts = road.parts if isinstance(road, SumRoad) else (road,)
    return [(part.type, part.file if isinstance(part, ProfileRoad) else "") for part in parts]
