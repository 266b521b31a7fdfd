"""What an engineer reads off a run: loads, ride figures, travel, and what to be wary of. Pure functions."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from model.analysis.comfort import Comfort, ride_comfort
from model.analysis.signals import seat, steady
from model.config.config import SineRoad
from model.dynamics.equilibrium import NoEquilibriumError, rest_pose
from model.dynamics.vehicle import System
from model.road.road import Road, profile_end, profile_start
from model.simulation.trajectory import Trajectory, wheel_names

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
    load_coefficient: np.ndarray  # (W,) dynamic load coefficient, 0…; see there
    air_time: np.ndarray  # (W,) s without load
    travel_down: np.ndarray  # (n,) m, lowest wheel centre relative to the hull, from the static pose; ≤ 0
    travel_up: np.ndarray  # (n,) m, highest; ≥ 0
    acceleration_rms: float  # m/s², vertical, of the hull's centre of mass, over the whole run
    acceleration_peak: float  # m/s², the largest in either direction
    pitch_low: float  # rad; the nose is up where it is positive
    pitch_high: float  # rad
    seat: Comfort  # of the driver
    imaginary_share: float  # mean over time of Σ load of imaginary wheels / Σ load of all
    drift: float  # m, by which joints were apart at worst
    real_time_factor: float  # simulated time / computing time


class _Figure(NamedTuple):
    """One figure of a comparison."""

    label: str
    unit: str
    least: float  # a baseline smaller than this is as good as nothing: no change in percent


ACCELERATION_RMS = _Figure("Vertical acceleration, rms", "m/s²", 1e-3)
ACCELERATION_PEAK = _Figure("Vertical acceleration, peak", "m/s²", 1e-3)
WEIGHTED = _Figure("Weighted acceleration at the seat", "m/s²", 1e-3)
POWER = _Figure("Absorbed power at the seat", "W", 1e-3)
PITCH = _Figure("Pitch, peak to peak", "°", 1e-3)
IMAGINARY_SHARE = _Figure("Load on imaginary wheels", "%", 1e-2)
LOAD_PEAK = _Figure("Peak load", "kN", 1e-3)
LOAD_RMS = _Figure("Load, rms", "kN", 1e-3)
LOAD_COEFFICIENT = _Figure("Dynamic load coefficient", "%", 1e-2)
TRAVEL = _Figure("Suspension travel", "mm", 1e-2)
AIR_TIME = _Figure("Time in the air", "s", 1e-9)
HULL_FIGURES = (ACCELERATION_RMS, ACCELERATION_PEAK, WEIGHTED, POWER, PITCH, IMAGINARY_SHARE)
WHEEL_FIGURES = (LOAD_PEAK, LOAD_RMS, LOAD_COEFFICIENT, TRAVEL, AIR_TIME)


@dataclass(frozen=True)
class Row:
    """One figure of a run beside that of its baseline; a figure that a run does not have is None."""

    figure: str
    wheel: str  # R1…, I1…; empty for a figure of the whole vehicle
    unit: str
    now: float | None
    baseline: float | None
    change: float | None  # %, of the baseline; None where it means nothing
    resolution: float = 0.0  # in the unit: finer differences mean nothing

    @property
    def label(self) -> str:
        return f"{self.figure}, {self.wheel}" if self.wheel else self.figure


@dataclass(frozen=True)
class WheelState:
    """One wheel at one time: what its card shows. None where the word does not apply."""

    name: str
    time: float  # s
    normal_load: float  # N
    static_load: float  # N, at rest on flat ground
    load_share: float | None  # of all wheels' load, 0…1; None with all wheels in the air
    traction: float  # N, along the road, forward
    penetration: float | None  # m; None in the air
    slip_velocity: float | None  # m/s, ṗ of the rim over the ground, forward; None in the air
    arm_angle: float  # °, of its arm in the hull, from the design pose; counter-clockwise
    torque_share: float | None  # of the driving torque, 0…1; None where no torque drives (prescribed, all in the air)
    drive_torque: float | None  # N m, of the drive on this wheel, positive drives forward


class ContactMotion(NamedTuple):
    """Where wheels meet the road and how they move there; leading dimensions as given."""

    normal: np.ndarray  # (..., W, 2) n, unit vector from the ground to the wheel's centre; upright in the air
    depth: np.ndarray  # (..., W) z, m; negative, and −∞ high up, in the air
    sinking: np.ndarray  # (..., W) ż, m/s
    slip: np.ndarray  # (..., W) ṗ of the rim along the road, m/s


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
        load_coefficient=dynamic_load_coefficient(trajectory),
        air_time=(load <= 0).sum(axis=0) / trajectory.config.simulation.output_rate,
        travel_down=travel.min(axis=0),
        travel_up=travel.max(axis=0),
        acceleration_rms=float(np.sqrt(np.mean(acceleration**2))),
        acceleration_peak=float(np.abs(acceleration).max()),
        pitch_low=float(pitch.min()),
        pitch_high=float(pitch.max()),
        seat=ride_comfort(trajectory, seat(trajectory.config)),
        imaginary_share=imaginary_share(trajectory),
        drift=float(trajectory.constraint_residual.max()),
        real_time_factor=float(trajectory.t[-1]) / trajectory.statistics.seconds,
    )


def suspension_travel(trajectory: Trajectory) -> np.ndarray:
    """(N, n) m: rise of each road wheel's centre in the hull's frame, from the static pose: that at t = 0."""
    system, q = trajectory.system, trajectory.q
    if trajectory.t[0] > 0:  # a stretch of a drive, whose parameters may have changed since its start
        static = system.q_design
        with suppress(NoEquilibriumError):
            static = rest_pose(system)[0]
        q = np.concatenate([static[None], q])
    chassis = q[:, system.chassis, None]
    x, y = np.moveaxis(q[:, system.road_wheels, :2] - chassis[..., :2], 2, 0)
    height = np.cos(chassis[..., 2]) * y - np.sin(chassis[..., 2]) * x
    return height[-len(trajectory.t) :] - height[0]


def imaginary_share(trajectory: Trajectory) -> float:
    """Mean over time of Σ load of imaginary wheels / Σ load of all, while any wheel is on the ground; 0…1."""
    total = trajectory.normal_load.sum(axis=1)
    imaginary = trajectory.normal_load[:, trajectory.system.n :].sum(axis=1)
    grounded = total > 0
    return float(np.mean(imaginary[grounded] / total[grounded])) if grounded.any() else 0.0


def dynamic_load_coefficient(trajectory: Trajectory) -> np.ndarray:
    """(W,) standard deviation of each wheel's load over the steady part of a run / its load at rest (Sweatman 1983).

    0 where the load does not change; NaN for a wheel without load at rest.
    """
    static = np.where(trajectory.static_load > 0, trajectory.static_load, np.nan)
    return trajectory.normal_load[steady(trajectory)].std(axis=0) / static


def comparison(now: Trajectory, baseline: Trajectory | None) -> list[Row]:
    """The ride figures of a run, and of another beside them: the hull's first, then each wheel's, front first.

    A change of the time in the air is None when the runs last differently long; it is counted in samples.
    """
    runs = [now] if baseline is None else [now, baseline]
    sampling = max(1 / run.config.simulation.output_rate for run in runs)
    present = _figures(now)
    other = {} if baseline is None else _figures(baseline)
    same_length = baseline is not None and now.t[-1] == baseline.t[-1]
    rows = []
    for figure, wheel in sorted({**present, **other}, key=_reading_order):
        value, reference = present.get((figure, wheel)), other.get((figure, wheel))
        change = None
        if value is not None and reference is not None and reference >= figure.least:
            change = 100 * (value / reference - 1)
        if figure is AIR_TIME and not same_length:
            change = None
        resolution = sampling if figure is AIR_TIME else 0.0
        rows.append(Row(figure.label, wheel, figure.unit, value, reference, change, resolution))
    return rows


def _reading_order(key: tuple[_Figure, str]) -> tuple[int, bool, int]:
    figure, wheel = key
    number = int(wheel[1:]) if wheel else 0
    return (*HULL_FIGURES, *WHEEL_FIGURES).index(figure), wheel.startswith("I"), number


def _figures(trajectory: Trajectory) -> dict[tuple[_Figure, str], float]:
    """By figure and wheel, in the figures' units."""
    of, n = summary(trajectory), trajectory.system.n
    figures = {
        (ACCELERATION_RMS, ""): of.acceleration_rms,
        (ACCELERATION_PEAK, ""): of.acceleration_peak,
        (WEIGHTED, ""): of.seat.total,
        (POWER, ""): of.seat.absorbed_power,
        (PITCH, ""): float(np.degrees(of.pitch_high - of.pitch_low)),
        (IMAGINARY_SHARE, ""): 100 * of.imaginary_share,
    }
    for figure, names, values in (
        (LOAD_PEAK, of.names, of.load_max / 1e3),
        (LOAD_RMS, of.names, np.sqrt(np.mean(trajectory.normal_load**2, axis=0)) / 1e3),
        (LOAD_COEFFICIENT, of.names, 100 * of.load_coefficient),
        (TRAVEL, of.names[:n], 1e3 * (of.travel_up - of.travel_down)),
        (AIR_TIME, of.names, of.air_time),
    ):
        known = ((name, float(value)) for name, value in zip(names, values, strict=True) if np.isfinite(value))
        figures |= {(figure, name): value for name, value in known}
    return figures


def wheel_state(trajectory: Trajectory, wheel: int, time: float, road: Road | None = None) -> WheelState:
    """A wheel, counted from 0 with road wheels first, at a time, s; between samples in proportion.

    A time outside the run gives its start or its end. road: where it is at hand, or another than the run's own.
    """
    system = trajectory.system
    t = trajectory.t
    before = min(max(int(np.searchsorted(t, time, side="right")) - 1, 0), len(t) - 1)
    after = min(before + 1, len(t) - 1)
    part = np.clip((time - t[before]) / (t[after] - t[before]), 0, 1) if after > before else 0.0

    def at_time(samples: np.ndarray) -> np.ndarray:
        return (1 - part) * samples[before] + part * samples[after]

    q, load = at_time(trajectory.q), at_time(trajectory.normal_load)
    touch = contact_motion(system, road or trajectory.road, q, at_time(trajectory.v))
    touching = touch.depth[wheel] > 0
    total = float(load.sum())
    share = float(load[wheel]) / total if total > 0 else None
    torque_share = None if system.prescribed else share
    force = float(at_time(trajectory.drive_force))
    return WheelState(
        name=wheel_names(system)[wheel],
        time=float(np.clip(time, t[0], t[-1])),
        normal_load=float(load[wheel]),
        static_load=float(trajectory.static_load[wheel]),
        load_share=share,
        traction=float(at_time(trajectory.traction)[wheel]),
        penetration=float(touch.depth[wheel]) if touching else None,
        slip_velocity=float(touch.slip[wheel]) if touching else None,
        arm_angle=float(np.degrees(q[system.spring_j[wheel], 2] - q[system.chassis, 2])),
        torque_share=torque_share,
        drive_torque=None if torque_share is None else torque_share * system.r * force,
    )


def contact_motion(system: System, road: Road, q: np.ndarray, v: np.ndarray) -> ContactMotion:
    """Contact of all wheels in poses q and velocities v (..., B, 3)."""
    centres, velocity = q[..., system.wheel, :2], v[..., system.wheel, :]
    _, normal, distance = road.nearest(centres.reshape(-1, 2))
    normal, distance = normal.reshape(centres.shape), distance.reshape(centres.shape[:-1])
    n_x, n_y = normal[..., 0], normal[..., 1]
    return ContactMotion(
        normal=normal,
        depth=system.r - distance,
        sinking=-(velocity[..., 0] * n_x + velocity[..., 1] * n_y),
        slip=velocity[..., 0] * n_y - velocity[..., 1] * n_x + system.r * velocity[..., 2],
    )


def penetration(trajectory: Trajectory, road: Road | None = None) -> np.ndarray:
    """(N, W) m: how deep each wheel is in the ground; negative, and −∞ high up, in the air.

    road: another than the run's own.
    """
    return contact_motion(trajectory.system, road or trajectory.road, trajectory.q, trajectory.v).depth


def warnings(trajectory: Trajectory, road: Road | None = None) -> list[RideWarning]:
    """What the reader of this run should know, each with what it means. road: another than the run's own."""
    of_profile = _profile_missed(trajectory) if road is None else ()
    return [*motion_warnings(trajectory), *of_profile, *_wheels_sunk_deep(trajectory, road)]


def motion_warnings(trajectory: Trajectory) -> list[RideWarning]:
    """Those of the warnings that need no road."""
    return [
        *_arms_turned_far(trajectory),
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
            "A real arm would have hit a stop before 45°; the paper's has none. Give bump and rebound stops.",
        )


def _wheels_sunk_deep(trajectory: Trajectory, road: Road | None) -> Iterator[RideWarning]:
    depth = penetration(trajectory, road)
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


def _profile_missed(trajectory: Trajectory) -> Iterator[RideWarning]:
    """Of a measured profile that is not reached, or that ends under way."""
    system, config = trajectory.system, trajectory.config
    start, end = profile_start(config), profile_end(config)
    if start is None:
        return
    wheels = trajectory.q[:, system.road_wheels, 0]
    if wheels.max() < start:
        yield RideWarning(
            f"The profile was not reached: it begins at x = {start:.6g} m, the wheels came to {wheels.max():.4g} m",
            "Nothing here is of the measured road: give road.start, where its first point is to lie, or a longer run.",
        )
    elif end is not None and wheels[-1].min() > end:
        left = trajectory.t[(wheels.min(axis=1) > end).argmax()]
        yield RideWarning(
            f"The points of the profile end at x = {end:.4g} m; all wheels were past that at t = {left:.2f} s",
            "From there on the road is level. Figures that count this stretch too are too small: end the run there.",
        )
