"""Where in the run we are: a clock that plays, pauses, steps and starts again at the end."""

from __future__ import annotations

from dataclasses import dataclass

SPEEDS = {f"1/{n}×": 1 / n for n in (8, 4, 2)} | {f"{n}×": float(n) for n in (1, 2, 4, 8)}
NORMAL_SPEED = "1×"
STEP = 0.01  # s


@dataclass
class Playback:
    """Time in a run of `duration`, both in s; `speed` 1 is real time."""

    duration: float = 0.0
    time: float = 0.0
    speed: float = SPEEDS[NORMAL_SPEED]
    playing: bool = True

    def advance(self, elapsed: float) -> None:
        """Let `elapsed` seconds of real time pass; the end of the run leads back to its start."""
        if self.playing and self.duration > 0:
            self.time = (self.time + elapsed * self.speed) % self.duration

    def scrub(self, time: float) -> None:
        """Go to a time and stay there. Times outside the run, or no number, lead to its nearest end."""
        self.playing = False
        self.time = min(max(time, 0.0), self.duration) if time == time else 0.0

    def step(self, steps: int) -> None:
        """Go some steps on, or back when negative, and stay there."""
        self.scrub(self.time + steps * STEP)

    def toggle(self) -> None:
        """Play, or pause. At the very end, play starts again from the beginning."""
        self.playing = not self.playing
        if self.playing and self.time >= self.duration:
            self.time = 0.0

    def fit(self, duration: float) -> None:
        """A new run of this duration: go on at the same time as far as it has one."""
        self.duration = duration
        self.time = min(self.time, duration)
