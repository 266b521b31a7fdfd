"""What a peer engine is given to compute: our vehicle, our start, and the same road in straight pieces."""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np

from model.dynamics.vehicle import System
from model.road.road import build_road
from model.simulation.trajectory import Trajectory

PIECE = 0.2  # m: neither engine takes the sine itself; pieces of 0.35 m tear at the loads


class Task(NamedTuple):
    """One run for a peer, of a vehicle with the paper's suspension: linear springs, imaginary arms on road arms.

    B bodies, W wheels, N samples; SI, radians, the frame of `System`.
    """

    system: System
    q: np.ndarray  # (B, 3) poses at the start
    v: np.ndarray  # (B, 3) and their rates
    static_load: np.ndarray  # (W,) N
    t: np.ndarray  # (N,) s, at which the loads are wanted
    x: np.ndarray  # (K,) corners of the road, as far as the wheels come
    h: np.ndarray  # (K,) their heights
    step: float  # s, of the peer

    @property
    def steps(self) -> int:
        return round(float(self.t[-1]) / self.step)

    @property
    def sinking(self) -> np.ndarray:
        """How deep the wheels stand in level ground at rest, (W,), m: there a peer's contact is made like ours."""
        return np.sqrt(self.static_load / self.system.ground.k_n)


class Peer(Protocol):
    """A peer that is set up for a task and can run it any number of times."""

    def run(self) -> None:
        """From start to end, nothing recorded: this is what is timed."""

    def loads(self) -> np.ndarray:
        """The normal loads of one more run, (N, W), N."""


def task_of(run: Trajectory, step: float) -> Task:
    """The task that one of our runs has done."""
    wheels, r = run.q[:, run.system.wheel, 0], run.system.r
    x = np.arange(wheels.min() - 2 * r, wheels.max() + 2 * r + PIECE, PIECE)
    return Task(run.system, run.q[0], run.v[0], run.static_load, run.t, x, build_road(run.config).height(x), step)
