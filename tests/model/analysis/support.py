"""Hand-made runs that several tests of the figures share."""

from __future__ import annotations

import numpy as np

from model.analysis.ride_warnings import warnings
from model.config.config import Config
from model.dynamics.vehicle import build_system
from model.simulation.trajectory import RunStatistics, Trajectory

RATE = 200.0


FLAT = Config().replace({"road.type": "flat", "simulation.output_rate": RATE})


def standing(config: Config = FLAT, samples: int = 5, load: float = 5000.0) -> Trajectory:
    """A run in which nothing moves: the design pose, every wheel under the same load. Its arrays may be written to."""
    system = build_system(config)
    bodies, wheels = len(system.mass), len(system.wheel)
    still = np.zeros((samples, bodies, 3))
    return Trajectory(
        t=np.arange(samples) / config.simulation.output_rate,
        q=np.tile(system.q_design, (samples, 1, 1)),
        v=still.copy(),
        a=still.copy(),
        normal_load=np.full((samples, wheels), load),
        traction=np.zeros((samples, wheels)),
        tangential_displacement=np.zeros((samples, wheels)),
        drive_force=np.zeros(samples),
        multipliers=np.zeros((samples, 2 * len(system.joint_i))),
        constraint_residual=np.zeros(samples),
        static_load=np.full(wheels, load),
        config=config,
        status="complete",
        advice="",
        statistics=RunStatistics(10, 1, 70, 1e-3, seconds=0.02),
    )


def whats(run: Trajectory) -> list[str]:
    found = warnings(run)
    assert all(warning.meaning.endswith(".") and warning.what in str(warning) for warning in found)
    return [warning.what for warning in found]
