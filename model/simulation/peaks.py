"""What was largest in a motion, and when."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace

import numpy as np

from model.dynamics.ground import depth
from model.dynamics.vehicle import System

FOUND = 0.002  # share of a peak to which it is sought


@dataclass(frozen=True)
class Peaks:
    """What was largest during a motion, between samples too, and when; W wheels, n road arms."""

    load: np.ndarray  # (W,) N
    load_time: np.ndarray  # (W,) s
    depth: np.ndarray  # (W,) m in the ground; negative for a wheel that never touched it, −∞ high up
    depth_time: np.ndarray  # (W,) s
    air_time: np.ndarray  # (W,) s without load
    arm_high: np.ndarray  # (n,) θ_arm − θ_chassis, rad
    arm_high_time: np.ndarray  # (n,) s
    arm_low: np.ndarray  # (n,) rad
    arm_low_time: np.ndarray  # (n,) s
    acceleration: np.ndarray  # () of the hull's centre of mass, up or down, m/s²
    acceleration_time: np.ndarray  # () s

    @staticmethod
    def over(parts: Sequence[Peaks]) -> Peaks:
        """Of a motion in parts that follow each other."""
        found = {name: np.array([getattr(part, name) for part in parts]) for name in PEAK_NAMES}
        largest = {"air_time": found["air_time"].sum(axis=0)}
        for name in LARGEST:
            values = found[name]
            best = values.argmin(axis=0) if name == "arm_low" else values.argmax(axis=0)
            for key in (name, f"{name}_time"):
                largest[key] = np.take_along_axis(found[key], best[None], axis=0)[0]
        return Peaks(**largest)

    def beside(self, t: np.ndarray, load: np.ndarray, acceleration: np.ndarray) -> Peaks:
        """Where a sample shows more than was found, that: in long steps at loose tolerances a spike may hide.

        Times t (N,), s, loads (N, W), N, and the hull's vertical acceleration (N,), m/s².
        """
        found = {}
        for name, samples in (("load", load), ("acceleration", np.abs(acceleration))):
            at = np.asarray(samples.argmax(axis=0))
            top = np.take_along_axis(samples, at[None], axis=0)[0]
            more = top > getattr(self, name) * (1.0 + FOUND)
            found[name] = np.where(more, top, getattr(self, name))
            found[f"{name}_time"] = np.where(more, t[at], getattr(self, f"{name}_time"))
        return replace(self, **found)

    def since(self, start: float, sampled: Peaks) -> Peaks:
        """Of the motion from `start`, s, on: what was largest before gives way to what the samples since then say."""
        after = {"air_time": sampled.air_time}
        for name in LARGEST:
            mine = getattr(self, f"{name}_time") >= start
            for key in (name, f"{name}_time"):
                after[key] = np.where(mine, getattr(self, key), getattr(sampled, key))
        return Peaks(**after)


LARGEST = ("load", "depth", "arm_high", "arm_low", "acceleration")  # each with its time
PEAK_NAMES = tuple(field.name for field in fields(Peaks))


def sampled_peaks(system: System, t: np.ndarray, q: np.ndarray, a: np.ndarray, load: np.ndarray) -> Peaks:
    """The same at samples only, for what was not followed between them: times t (N,), s, poses q and accelerations a
    (N, B, 3), loads (N, W), N. Depths are those of wheels that press slowly.
    """
    turn = q[:, system.road_arms, 2] - q[:, [system.chassis], 2]
    spacing = np.diff(t).mean() if len(t) > 1 else 0.0
    values = {
        "load": load,
        "depth": depth(system.ground, load),
        "arm_high": turn,
        "arm_low": -turn,
        "acceleration": np.abs(a[:, system.chassis, 1]),
    }
    found = {"air_time": (load <= 0).sum(axis=0) * spacing}
    for name, samples in values.items():
        at = samples.argmax(axis=0)
        found[f"{name}_time"] = t[at]
        found[name] = np.take_along_axis(samples, np.asarray(at)[None], axis=0)[0]
    found["arm_low"] = -found["arm_low"]
    return Peaks(**found)
