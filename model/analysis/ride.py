"""What an engineer reads off a run: loads, ride figures, travel. Pure functions."""

from __future__ import annotations

from contextlib import suppress
from functools import cached_property

import numpy as np

from model.analysis.comfort import Comfort, ride_comfort
from model.analysis.signals import Window, seat, window
from model.dynamics.equilibrium import NoEquilibriumError, rest_pose
from model.dynamics.vehicle import System
from model.simulation.trajectory import Motion, wheel_names


class Summary:
    """Figures of a run of at least one sample, each computed when it is first asked for. W wheels in the order of
    `names`, road wheels 1…n first; SI, radians.

    What is smallest, largest or counted is so in the whole run; all else is taken from its window.
    """

    def __init__(self, run: Motion) -> None:
        self._run = run

    @cached_property
    def names(self) -> list[str]:
        return wheel_names(self._run.system)

    @cached_property
    def window(self) -> Window:
        return window(self._run)

    @property
    def duration(self) -> float:
        """s, of the whole run."""
        return float(self._run.t[-1] - self._run.t[0])

    @cached_property
    def _samples(self) -> slice:
        """Those in the window."""
        return self.window.samples(self._run.t)

    @cached_property
    def _load(self) -> np.ndarray:
        """(N, W) N, laid out so that sums over time run along rows."""
        return np.ascontiguousarray(self._run.normal_load.T).T

    @cached_property
    def _counted(self) -> np.ndarray:
        """The same in the window."""
        return self._load[self._samples]

    @property
    def load_min(self) -> np.ndarray:
        """(W,) N."""
        return self._load.min(axis=0)

    @cached_property
    def load_mean(self) -> np.ndarray:
        """(W,) N."""
        return self._counted.mean(axis=0)

    @property
    def load_max(self) -> np.ndarray:
        """(W,) N."""
        return peak_load(self._run)

    @cached_property
    def load_rms(self) -> np.ndarray:
        """(W,) N."""
        return np.sqrt(np.mean(self._counted**2, axis=0))

    @cached_property
    def load_coefficient(self) -> np.ndarray:
        """(W,) dynamic load coefficient, 0…; see there."""
        return dynamic_load_coefficient(self._counted, self._run.static_load)

    @property
    def air_time(self) -> np.ndarray:
        """(W,) s without load."""
        return air_time(self._run)

    @property
    def lift_offs(self) -> np.ndarray:
        """(W,) how often a wheel lost its load."""
        return lift_offs(self._load)

    @cached_property
    def _travel(self) -> np.ndarray:
        return suspension_travel(self._run)

    @property
    def travel_down(self) -> np.ndarray:
        """(n,) m, lowest wheel centre relative to the hull, from the static pose; ≤ 0."""
        return self._travel.min(axis=0)

    @property
    def travel_up(self) -> np.ndarray:
        """(n,) m, highest; ≥ 0."""
        return self._travel.max(axis=0)

    @property
    def acceleration_rms(self) -> float:
        """m/s², vertical, of the hull's centre of mass."""
        return float(np.sqrt(np.mean(self._run.a[self._samples, self._run.system.chassis, 1] ** 2)))

    @property
    def acceleration_peak(self) -> float:
        """m/s², the largest in either direction."""
        return peak_acceleration(self._run)

    @property
    def pitch_low(self) -> float:
        """rad; the nose is up where it is positive."""
        return float(self._run.q[:, self._run.system.chassis, 2].min())

    @property
    def pitch_high(self) -> float:
        """rad."""
        return float(self._run.q[:, self._run.system.chassis, 2].max())

    @cached_property
    def seat(self) -> Comfort | None:
        """Of the driver; None where there are too few samples a second."""
        return ride_comfort(self._run, seat(self._run.config), self.window)

    @property
    def imaginary_share(self) -> float:
        """Mean over time of Σ load of imaginary wheels / Σ load of all."""
        return imaginary_share(self._counted, self._run.system.n)

    @property
    def drift(self) -> float:
        """m, by which joints were apart at worst."""
        return float(self._run.constraint_residual.max())

    @property
    def energy_error(self) -> float | None:
        """Energy not accounted for, as a share of what was turned over; None: not known."""
        return self._run.energy_error

    @property
    def real_time_factor(self) -> float:
        """Simulated time / computing time."""
        return float(self._run.t[-1]) / self._run.statistics.seconds


def peak_load(motion: Motion) -> np.ndarray:
    """(W,) N: the largest load of each wheel."""
    return motion.peaks.load


def air_time(motion: Motion) -> np.ndarray:
    """(W,) s for which each wheel has no load."""
    return motion.peaks.air_time


def lift_offs(load: np.ndarray) -> np.ndarray:
    """(W,) how often each wheel's load (N, W) was gone at a sample after it was there at the one before."""
    return np.count_nonzero((load[1:] <= 0) & (load[:-1] > 0), axis=0)


def peak_acceleration(motion: Motion) -> float:
    """The largest vertical acceleration of the hull's centre of mass in either direction, m/s²."""
    return float(motion.peaks.acceleration)


def suspension_travel(motion: Motion) -> np.ndarray:
    """(N, n) m: rise of each road wheel's centre in the hull's frame, from the static pose: that at t = 0."""
    system, q = motion.system, motion.q
    if motion.t[0] > 0:  # a stretch of a drive, whose parameters may have changed since its start
        static = system.q_design
        with suppress(NoEquilibriumError):
            static = rest_pose(system)[0]
        q = np.concatenate([static[None], q])
    height = wheel_heights(system, q)
    return height[-len(motion.t) :] - height[0]


def wheel_heights(system: System, q: np.ndarray) -> np.ndarray:
    """(N, n) m: of each road wheel's centre over the hull's centre of mass, in its frame, in poses q (N, B, 3)."""
    hull_x, hull_y, pitch = np.ascontiguousarray(q[:, system.chassis].T)
    x, y = np.ascontiguousarray(q[:, system.road_wheels, :2].transpose(2, 1, 0))  # (n, N): fewer and longer rows
    return (np.cos(pitch) * (y - hull_y) - np.sin(pitch) * (x - hull_x)).T


def imaginary_share(load: np.ndarray, road_wheels: int) -> float:
    """Mean over time of Σ load of imaginary wheels / Σ load of all, while any wheel is on the ground; 0…1.

    load: (N, W) N, of so many road wheels and then of imaginary ones.
    """
    total, share = _shares(load, road_wheels)
    grounded = total > 0
    return float(np.mean(share[grounded])) if grounded.any() else 0.0


def imaginary_shares(load: np.ndarray, road_wheels: int) -> np.ndarray:
    """(N,) the same at each sample; 0 with all wheels in the air."""
    return _shares(load, road_wheels)[1]


def _shares(load: np.ndarray, road_wheels: int) -> tuple[np.ndarray, np.ndarray]:
    """(N,) N, the load of all wheels; and the share of it that imaginary ones carry."""
    total, imaginary = load.sum(axis=1), load[:, road_wheels:].sum(axis=1)
    return total, imaginary / np.where(total > 0, total, 1.0)


def dynamic_load_coefficient(load: np.ndarray, static_load: np.ndarray) -> np.ndarray:
    """(W,) standard deviation of each wheel's load (N, W) / its load at rest (W,) (Sweatman 1983).

    0 where the load does not change; NaN for a wheel without load at rest.
    """
    return load.std(axis=0) / np.where(static_load > 0, static_load, np.nan)
