"""A drive without end in real time: how far to go at each frame, and what is then seen. Thread: app/runs/runner.py."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from time import perf_counter
from typing import Any

import numpy as np

from model.config.config import Config
from model.road.road import Road
from model.simulation.drive import LiveDrive
from model.simulation.integrate import Status
from model.simulation.trajectory import Trajectory

FRAME = 1 / 30  # s of real time from one frame to the next
LONGEST_FRAME = 0.1  # s of real time that is caught up after a hitch; the rest is dropped
BUDGET = 0.7 * FRAME  # s of computing in a frame; a drive that needs more goes slower than the user asked for
FIRST = 1e-6  # s simulated at once, so that there is something to see
SLICE = 0.05  # s simulated between two looks at the clock
PLOTTED = 10.0  # s simulated that the plots show
PLOT_EVERY = 0.1  # s of real time between two updates of the plots
ALIGNED = 40  # samples: the plotted past begins at a multiple of these, so that thinned curves do not flicker
AT_HAND = 0.1  # s simulated that the 3-D view gets
MEASURED = 1.0  # s of real time over which the real-time factor is measured


class Pace:
    """Turns real time into the simulated time to reach, and measures the real-time factor. All times in s."""

    def __init__(self, time: float = 0.0) -> None:
        """time: simulated so far."""
        self.target = time
        self._marks: deque[tuple[float, float]] = deque()  # real time and simulated time at the last frames

    def move_on(self, elapsed: float, speed: float) -> float:
        """The time to reach after `elapsed` more of real time at `speed` times real time."""
        self.target += min(elapsed, LONGEST_FRAME) * speed
        return self.target

    def reached(self, now: float, time: float) -> None:
        """At real time `now` the drive has come to `time`. What is missing to the target is dropped."""
        self.target = min(self.target, time)
        self._marks.append((now, self.target))
        while len(self._marks) > 2 and self._marks[1][0] <= now - MEASURED:
            self._marks.popleft()

    def rest(self) -> None:
        """Forget what was measured, because of a pause or another speed."""
        self._marks.clear()

    @property
    def factor(self) -> float | None:
        """Simulated over real time in the last moments; None: it is too early to say."""
        if not self._marks:
            return None
        (began, first), (now, last) = self._marks[0], self._marks[-1]
        return (last - first) / (now - began) if now - began >= MEASURED / 2 else None


@dataclass(frozen=True)
class DriveState:
    """What is seen of a drive at one instant."""

    config: Config
    time: float  # driven, s
    distance: float  # driven, m
    factor: float | None  # times real time that was reached
    ended: str  # why it came to an end, in words; empty while it goes on
    advice: str  # what to try then
    recent: Trajectory  # the last moments, up to `time` at least; of a drive that stands, `past`
    past: Trajectory  # the last PLOTTED seconds, the same object until there is a newer one
    road: Road  # under `recent` and about it, in its frame
    origin: float  # m from where the drive started to x = 0 of that frame
    stands: bool  # it is paused, and the user can look back

    @property
    def past_from_start(self) -> Trajectory:
        """`past`, its x measured from where the drive started."""
        return replace(self.past, q=self.past.q + np.array([self.origin, 0.0, 0.0]))


class Driver:
    """One endless drive, frame by frame. Raises NoEquilibriumError where the vehicle has no rest pose to start from."""

    def __init__(self, config: Config, clock: Callable[[], float] = perf_counter) -> None:
        """clock: real time, s."""
        self._clock = clock
        self._drive = LiveDrive(config, PLOTTED + ALIGNED / config.simulation.output_rate)
        self._asked = config
        self._start()

    def _start(self) -> None:
        self._drive.advance(FIRST)
        self._pace = Pace()
        self._before: float | None = None  # real time of the last frame; None: standing
        self._speed = 0.0
        self._distance_from: float | None = None
        self._past: Trajectory | None = None
        self._plotted_at = -np.inf

    def change(self, config: Config) -> None:
        """Drive on with another configuration from the next frame on."""
        self._asked = config

    def stand(self) -> DriveState:
        """Pause: real time passes without driving until the next frame."""
        self._take_over()
        self._before = None
        self._pace.rest()
        self._past, self._plotted_at = aligned(self._drive.recent()), -np.inf
        return self._state(self._past, self._drive.road_under(self._past), stands=True)

    def frame(self, speed: float) -> DriveState:
        """Drive on by the real time that has passed, times `speed`, or as far as BUDGET allows."""
        began = self._clock()
        self._take_over()
        drive, pace = self._drive, self._pace
        if speed != self._speed:
            pace.rest()
        self._speed = speed
        elapsed = FRAME if self._before is None else began - self._before
        self._before = began
        target = pace.move_on(elapsed, speed)
        while drive.time < target and drive.status is Status.RUNNING:
            drive.advance(min(target, drive.time + SLICE))
            if self._clock() - began > BUDGET:
                break
        now = self._clock()
        pace.reached(now, drive.time)
        if self._past is None or now - self._plotted_at >= PLOT_EVERY or drive.status is not Status.RUNNING:
            self._past, self._plotted_at = aligned(drive.recent()), now
        return self._state(drive.recent(AT_HAND), drive.road())

    def _state(self, recent: Trajectory, road: Road, *, stands: bool = False) -> DriveState:
        drive = self._drive
        assert self._past is not None
        x = drive.distance + float(recent.q[-1, recent.system.chassis, 0])
        if self._distance_from is None:
            self._distance_from = x
        return DriveState(
            config=drive.config,
            time=self._pace.target,
            distance=x - self._distance_from,
            factor=self._pace.factor,
            ended="" if drive.status is Status.RUNNING else recent.status,
            advice=recent.advice,
            recent=recent,
            past=self._past,
            road=road,
            origin=drive.distance,
            stands=stands,
        )

    def _take_over(self) -> None:
        """Give the drive the configuration that was asked for."""
        if self._asked != self._drive.config and not self._drive.change(self._asked):
            self._start()


def aligned(run: Trajectory) -> Trajectory:
    """The run without its first samples: it begins at a multiple of ALIGNED samples from the start of the drive."""
    if len(run.t) <= ALIGNED:
        return run
    number = round(float(run.t[0]) * run.config.simulation.output_rate)
    skipped = -number % ALIGNED
    parts = {field.name: getattr(run, field.name) for field in fields(run) if field.name != "static_load"}
    shorter: dict[str, Any] = {name: part[skipped:] for name, part in parts.items() if isinstance(part, np.ndarray)}
    return replace(run, **shorter)
