"""A mode of the vehicle, shown instead of its run: swinging again and again, with the vehicle at rest as a ghost."""

from __future__ import annotations

from model.analysis.modes import Mode, mode_trajectory
from model.config.config import Config

PERIOD = 1.0  # s that a swing takes in the view, whatever its real frequency
EXCURSION = 0.35  # of a wheel's radius: how far the point goes that moves farthest


class ModeShow:
    """One mode being shown."""

    def __init__(self, config: Config, mode: Mode, x: float) -> None:
        """config: the one the mode is of; x: where the hull's centre of mass is along the road, m."""
        self.mode = mode
        self.swing = mode_trajectory(config, mode, EXCURSION * config.vehicle.road_wheels.radius, PERIOD, x)
        self.rest = mode_trajectory(config, mode, 0.0, PERIOD, x)
        self.since: float | None = None  # time of the run at which it began, s
        self._time = 0.0

    def move_on(self, elapsed: float) -> float:
        """The time in `swing`, s, after `elapsed` more of real time."""
        self._time = (self._time + elapsed) % PERIOD
        return self._time
