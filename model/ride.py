"""What an engineer reads off a run: loads, ride figures, travel, and what to be wary of. Pure functions."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from model.config import SineRoad
from model.road import build_road
from model.trajectory import Trajectory, wheel_names

ARM_LIMIT = np.radians(45)  # turn of a road arm beyond which the model is doubtful
SINKING_LIMIT = 0.1  # penetration, as a share of the wheel's radius
IN_PHASE = 0.02  # how close to a whole number of waves the wheel gaps must come


@dataclass(frozen=True)
class Summary:
    """Figures of a run. W wheels in the order of `names`, road wheels 1…n first; SI, radians."""

    names: list[str]
    load_min: np.ndarray  # (W,) N
    load_mean: np.ndarray  # (W,) N
    load_max: np.ndarray  # (W,) N
    air_time: np.ndarray  # (W,) s without load
    travel_down: np.ndarray  # (n,) m, lowest wheel centre relative to the hull, from the static pose; ≤ 0
    travel_up: np.ndarray  # (n,) m, highest; ≥ 0
    acceleration_rms: float  # m/s², vertical, of the hull's centre of mass, over the whole run
    acceleration_peak: float  # m/s², the largest in either direction
    pitch_low: float  # rad; the nose is up where it is positive
    pitch_high: float  # rad
    imaginary_share: float  # mean over time of Σ load of imaginary wheels / Σ load of all
    drift: float  # m, by which joints were apart at worst
    real_time_factor: float  # simulated time / computing time


@dataclass(frozen=True)
class RideWarning:
    """Something about a run that its reader should know."""

    what: str
    meaning: str

    def __str__(self) -> str:
        return f"{self.what}. {self.meaning}"


def summary(trajectory: Trajectory) -> Summary:
    """The figures of a run of at least one sample."""
    system, load = trajectory.system, trajectory.normal_load
    travel = suspension_travel(trajectory)
    acceleration = trajectory.a[:, system.chassis, 1]
    pitch = trajectory.q[:, system.chassis, 2]
    return Summary(
        names=wheel_names(system),
        load_min=load.min(axis=0),
        load_mean=load.mean(axis=0),
        load_max=load.max(axis=0),
        air_time=(load <= 0).sum(axis=0) / trajectory.config.simulation.output_rate,
        travel_down=travel.min(axis=0),
        travel_up=travel.max(axis=0),
        acceleration_rms=float(np.sqrt(np.mean(acceleration**2))),
        acceleration_peak=float(np.abs(acceleration).max()),
        pitch_low=float(pitch.min()),
        pitch_high=float(pitch.max()),
        imaginary_share=imaginary_share(trajectory),
        drift=float(trajectory.constraint_residual.max()),
        real_time_factor=float(trajectory.t[-1]) / trajectory.statistics.seconds,
    )


def suspension_travel(trajectory: Trajectory) -> np.ndarray:
    """(N, n) m: rise of each road wheel's centre in the hull's frame, from the static pose at t = 0."""
    system = trajectory.system
    chassis = trajectory.q[:, system.chassis, None]
    x, y = np.moveaxis(trajectory.q[:, system.road_wheels, :2] - chassis[..., :2], 2, 0)
    height = np.cos(chassis[..., 2]) * y - np.sin(chassis[..., 2]) * x
    return height - height[0]


def imaginary_share(trajectory: Trajectory) -> float:
    """Mean over time of Σ load of imaginary wheels / Σ load of all, while any wheel is on the ground; 0…1."""
    total = trajectory.normal_load.sum(axis=1)
    imaginary = trajectory.normal_load[:, trajectory.system.n :].sum(axis=1)
    grounded = total > 0
    return float(np.mean(imaginary[grounded] / total[grounded])) if grounded.any() else 0.0


def penetration(trajectory: Trajectory) -> np.ndarray:
    """(N, W) m: how deep each wheel is in the ground; negative, and −∞ high up, in the air."""
    centres = trajectory.q[:, trajectory.system.wheel, :2]
    distances = build_road(trajectory.config).nearest(centres.reshape(-1, 2))[2]
    return trajectory.system.r - distances.reshape(centres.shape[:2])


def warnings(trajectory: Trajectory) -> list[RideWarning]:
    """What the reader of this run should know, each with what it means."""
    return [
        *_arms_turned_far(trajectory),
        *_wheels_sunk_deep(trajectory),
        *_vehicle_in_the_air(trajectory),
        *_wheels_in_phase(trajectory),
    ]


def _arms_turned_far(trajectory: Trajectory) -> Iterator[RideWarning]:
    q, system = trajectory.q, trajectory.system
    turn = q[:, system.road_arms, 2] - q[:, [system.chassis], 2]
    sample, arm = np.unravel_index(np.abs(turn).argmax(), turn.shape)
    if abs(turn[sample, arm]) > ARM_LIMIT:
        angle = np.degrees(turn[sample, arm])
        yield RideWarning(
            f"Road arm {arm + 1} turned by {angle:+.3g}° (t = {trajectory.t[sample]:.2f} s)",
            "The paper's suspension has no bump stops: a real one would have hit them before 45°.",
        )


def _wheels_sunk_deep(trajectory: Trajectory) -> Iterator[RideWarning]:
    depth = penetration(trajectory)
    sample, wheel = np.unravel_index(depth.argmax(), depth.shape)
    if depth[sample, wheel] > SINKING_LIMIT * trajectory.system.r:
        name = wheel_names(trajectory.system)[wheel]
        yield RideWarning(
            f"Wheel {name} sank {1000 * depth[sample, wheel]:.3g} mm into the ground "
            f"(t = {trajectory.t[sample]:.2f} s)",
            "The contact law is meant for less than a tenth of the radius: take this load with care, "
            "or stiffen the ground.",
        )


def _vehicle_in_the_air(trajectory: Trajectory) -> Iterator[RideWarning]:
    flying = (trajectory.normal_load <= 0).all(axis=1)
    if flying.any():
        seconds = flying.sum() / trajectory.config.simulation.output_rate
        yield RideWarning(
            f"All wheels were in the air for {seconds:.2f} s (t = {trajectory.t[flying.argmax()]:.2f} s)",
            "The vehicle jumps: nothing drives it up there, and it lands harder than the model was made for.",
        )


def _wheels_in_phase(trajectory: Trajectory) -> Iterator[RideWarning]:
    road = trajectory.config.road
    if not isinstance(road, SineRoad) or road.amplitude == 0:
        return
    waves = -np.diff(trajectory.config.vehicle.road_wheels.x) / road.wavelength
    if (np.round(waves) >= 1).all() and (np.abs(waves - np.round(waves)) < IN_PHASE).all():
        yield RideWarning(
            f"The wavelength, {road.wavelength:g} m, fits the wheel spacing",
            "All road wheels rise and fall together: the hull bounces without pitching, more than on waves a "
            "little shorter or longer.",
        )
