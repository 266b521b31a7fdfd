"""What ride figures are read off: the acceleration at a point of the hull, and the stretch of a run that counts."""

from __future__ import annotations

import numpy as np

from model.config.config import Config, RandomRoad, SineRoad, SumRoad
from model.road.road import profile_of
from model.simulation.trajectory import Trajectory

SETTLING = 2.0  # s after the last wheel has come to the full waves, in which the start dies away

Point = tuple[float, float]  # forward and up from the hull's centre of mass, in the hull's frame, m
CENTRE_OF_MASS: Point = (0.0, 0.0)


def seat(config: Config) -> Point:
    """Where the driver sits."""
    return config.vehicle.seat.x, config.vehicle.seat.y


def point_acceleration(trajectory: Trajectory, point: Point = CENTRE_OF_MASS) -> np.ndarray:
    """(N, 2) m/s²: acceleration of a point fixed to the hull, forward and up along the world's axes.

    The point goes with the hull as a rigid body: a + θ̈ × r − θ̇² r, r the way to it from the centre of mass.
    """
    hull = trajectory.system.chassis
    pitch = trajectory.q[:, hull, 2]
    rate, growth = trajectory.v[:, hull, 2], trajectory.a[:, hull, 2]
    x, y = point
    r_x, r_y = np.cos(pitch) * x - np.sin(pitch) * y, np.sin(pitch) * x + np.cos(pitch) * y
    turning = np.column_stack([-growth * r_y - rate**2 * r_x, growth * r_x - rate**2 * r_y])
    return trajectory.a[:, hull, :2] + turning


def steady_from(trajectory: Trajectory) -> float:
    """When the last road wheel is on the full waves and the start has died away, s; at most half the run.

    Waves are those of a sine or random road, in a sum too. 0 on a road without them, where all there is to see is what
    the start or an obstacle leaves behind.
    """
    config, system = trajectory.config, trajectory.system
    wheels, parts = config.vehicle.road_wheels, [config.road]
    if isinstance(config.road, SumRoad):
        parts = list(config.road.parts)
    waves = [part for part in parts if isinstance(part, SineRoad | RandomRoad)]
    if not waves:
        return 0.0
    full = max(profile_of(wave, wheels.x[0], wheels.radius, 0.0).pieces[-1].nodes[0] for wave in waves)
    arrival = (full - wheels.x[-1]) / system.v_ref + SETTLING
    return float(min(arrival, trajectory.t[-1] / 2))


def steady(trajectory: Trajectory) -> np.ndarray:
    """(N,) whether a sample belongs to the stretch that ride figures are taken from."""
    return trajectory.t >= steady_from(trajectory)
