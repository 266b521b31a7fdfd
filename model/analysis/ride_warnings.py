"""What the reader of a run should be wary of: where the model is doubtful, and where figures tell too little."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.ndimage import maximum_filter1d

from model.analysis.comfort import LEAST_RATE, MOST_CREST, Comfort, ride_comfort
from model.analysis.modes import vehicle_modes
from model.analysis.signals import Window, seat, window
from model.analysis.wheel_contact import penetration
from model.config.config import Config, Drive, FlatRoad, RandomRoad, Simulation, SineRoad, SumRoad
from model.config.parameters import PARAMETER
from model.dynamics.equilibrium import NoEquilibriumError
from model.road.random_road import longest
from model.road.road import Road, profile_end, profile_start
from model.simulation.accuracy import APART_NOTED, ENERGY_NOTED, advice, energy_missing, joints_apart
from model.simulation.trajectory import Trajectory, wheel_names

ARM_LIMIT = np.radians(45)  # turn of a road arm beyond which the model is doubtful
LEAN_LIMIT = 10.0  # °, of the hull at rest, beyond which a reader is warned
SINKING_LIMIT = 0.1  # penetration, as a share of the wheel's radius
FLOOR_STEP = 0.01  # m between points at which the hull's floor is held against the road
FEW_WAVES = 0.65  # times the hull's slowest mode at which the longest waves are met: from there on pitch is too small …
ENOUGH_WAVES = 0.3  # … and where enough of them are there
WAVE_STEP = 5.0  # m, to which the length that is enough is rounded up
STANDING = {"road": FlatRoad(), "drive": Drive(), "simulation": Simulation()}  # what does not change the hull's modes
IN_PHASE = 0.02  # how close to a whole number of waves the wheel gaps must come


@dataclass(frozen=True)
class RideWarning:
    """Something about a run that its reader should know."""

    what: str
    meaning: str

    def __str__(self) -> str:
        return f"{self.what}. {self.meaning}"


def warnings(trajectory: Trajectory, road: Road | None = None) -> list[RideWarning]:
    """What the reader of this run should know, each with what it means. road: another than the run's own."""
    taken = window(trajectory)
    felt = ride_comfort(trajectory, seat(trajectory.config), taken)
    of_profile = _profile_missed(trajectory, taken) if road is None else ()
    return [
        *motion_warnings(trajectory),
        *of_profile,
        *_wheels_sunk_deep(trajectory, road),
        *_belly_grounded(trajectory, road or trajectory.road),
        *figure_warnings(trajectory.config, taken, felt, driving=road is not None),
    ]


def motion_warnings(trajectory: Trajectory) -> list[RideWarning]:
    """Those of the warnings that need no road."""
    return [
        *_inexact(trajectory),
        *_leaning(trajectory),
        *_arms_turned_far(trajectory),
        *_vehicle_in_the_air(trajectory),
        *_wheels_in_phase(trajectory),
        *_long_waves_missing(trajectory),
    ]


def figure_warnings(
    config: Config, taken: Window, felt: Comfort | None, driving: bool = False
) -> Iterator[RideWarning]:
    """Of a run whose figures are taken from a window, and whose comfort at the driver's seat is this.

    driving: it is a stretch of an endless drive.
    """
    if taken.shortfall and driving:
        yield RideWarning("The drive has just begun", "Means, comfort and absorbed power are still settling: drive on.")
    elif not taken.reached:
        yield RideWarning(
            taken.shortfall,
            "Nothing here is of it: put it nearer (road.start of a profile, road.position of an obstacle), or let the "
            "run last longer.",
        )
    elif taken.shortfall:
        yield RideWarning(taken.shortfall, "Means, comfort and absorbed power would be others in a longer run.")
    if felt is None:
        yield RideWarning(
            f"Comfort cannot be told from {config.simulation.output_rate:g} samples a second",
            f"It needs the motion up to 100 Hz: set the output rate to {LEAST_RATE:g} 1/s or more.",
        )
    elif felt.crest_factor is not None and felt.crest_factor > MOST_CREST:
        yield RideWarning(
            f"The crest factor at the driver's seat is {felt.crest_factor:.1f}",
            f"Above {MOST_CREST:g} the weighted acceleration tells too little (ISO 2631-1). Use MTVV, "
            f"{felt.transient:.3g} m/s², or VDV, {felt.dose:.3g} m/s¹·⁷⁵, which tell jolts.",
        )


def _inexact(trajectory: Trajectory) -> Iterator[RideWarning]:
    """Of joints that came apart and energy that is not accounted for."""
    apart = trajectory.constraint_residual
    found = []
    if len(apart) and apart.max() > APART_NOTED:
        found.append(f"{joints_apart(apart.max())} (t = {trajectory.t[apart.argmax()]:.2f} s)")
    missing = trajectory.energy_error or 0.0
    if missing > ENERGY_NOTED:
        found.append(energy_missing(missing))
    if found:
        words = " and ".join(found)
        yield RideWarning(f"The run is not exact: {words}", advice(trajectory.config.simulation))


def _leaning(trajectory: Trajectory) -> Iterator[RideWarning]:
    """Of the rest pose, where the run begins."""
    lean = np.degrees(trajectory.q[0, trajectory.system.chassis, 2]) if trajectory.t[0] == 0 else 0.0
    if abs(lean) > LEAN_LIMIT:
        yield RideWarning(
            f"The hull leans {'back' if lean > 0 else 'for'}wards by {abs(lean):.3g}° at rest",
            "Its springs hardly hold it, or the centre of mass is far from the wheels' middle: stiffen the suspension, "
            "or move the wheels (vehicle.road_wheels.offset).",
        )


def _arms_turned_far(trajectory: Trajectory) -> Iterator[RideWarning]:
    peaks = trajectory.peaks
    turn, time = np.stack([peaks.arm_low, peaks.arm_high]), np.stack([peaks.arm_low_time, peaks.arm_high_time])
    way, arm = np.unravel_index(np.abs(turn).argmax(), turn.shape)
    if abs(turn[way, arm]) > ARM_LIMIT:
        angle = np.degrees(turn[way, arm])
        yield RideWarning(
            f"Road arm {arm + 1} turned by {angle:+.3g}° (t = {time[way, arm]:.2f} s)",
            "A real arm would have hit a stop before 45°; the paper's has none. Give bump and rebound stops.",
        )


def _wheels_sunk_deep(trajectory: Trajectory, road: Road | None) -> Iterator[RideWarning]:
    depth, time = trajectory.peaks.depth, trajectory.peaks.depth_time
    if trajectory.tracked is None:
        sampled = penetration(trajectory, road)
        depth, time = sampled.max(axis=0), trajectory.t[sampled.argmax(axis=0)]
    wheel = int(depth.argmax())
    if depth[wheel] > SINKING_LIMIT * trajectory.system.r:
        name = wheel_names(trajectory.system)[wheel]
        yield RideWarning(
            f"Wheel {name} sank {1000 * depth[wheel]:.3g} mm into the ground (t = {time[wheel]:.2f} s)",
            "The contact law is meant for less than a tenth of the radius: take this load with care, "
            "or stiffen the ground.",
        )


def _belly_grounded(trajectory: Trajectory, road: Road) -> Iterator[RideWarning]:
    """Of the hull's floor from the first wheel to the last, at samples: where it is deepest in the road."""
    system = trajectory.system
    front, rear = system.q_design[system.road_wheels, 0][[0, -1]] - system.q_design[system.chassis, 0]
    down = system.q_design[system.chassis, 1] - system.belly
    x, y, turn = trajectory.q[:, system.chassis].T
    behind = x + np.cos(turn) * rear + np.sin(turn) * down  # (N,) m, of the floor under the last wheel
    before = x + np.cos(turn) * front + np.sin(turn) * down
    lowest = y - np.cos(turn) * down + np.minimum(np.sin(turn) * rear, np.sin(turn) * front)
    points = np.arange(min(behind.min(), before.min()), max(behind.max(), before.max()) + FLOOR_STEP, FLOOR_STEP)
    height = road.height(points)
    # Only where the road under the floor is anywhere as high as its lowest end can they meet
    highest = maximum_filter1d(height, 2 * int(np.ceil((front - rear) / 2 / FLOOR_STEP)) + 3)
    near = np.flatnonzero(np.interp((behind + before) / 2, points, highest) > lowest)
    if len(near) == 0:
        return
    part = np.linspace(0, 1, int(np.ceil((front - rear) / FLOOR_STEP)) + 1)
    at = behind[near, None] + (before - behind)[near, None] * part
    floor = (y + np.sin(turn) * rear - np.cos(turn) * down)[near, None] + (np.sin(turn) * (front - rear))[
        near, None
    ] * part
    deep = np.interp(at, points, height) - floor
    worst, place = np.unravel_index(deep.argmax(), deep.shape)
    if deep[worst, place] > 0:
        yield RideWarning(
            f"The hull's floor would be {1000 * deep[worst, place]:.3g} mm in the ground at "
            f"x = {at[worst, place]:.2f} m (t = {trajectory.t[near[worst]]:.2f} s)",
            "Nothing touches the ground here but wheels. A real hull would have been lifted, jolted or stopped there: "
            "the ride is rougher than this run says.",
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


def _long_waves_missing(trajectory: Trajectory) -> Iterator[RideWarning]:
    """Of a random road that begins to excite the hull only where it swings by itself."""
    config = trajectory.config
    roads = config.road.parts if isinstance(config.road, SumRoad) else (config.road,)
    wave = max((longest(road) for road in roads if isinstance(road, RandomRoad)), default=None)
    swing = None if wave is None else _slowest_swing(config.model_copy(update=STANDING))
    if wave is None or swing is None:
        return
    speed = float(trajectory.system.v_ref)
    enough = np.ceil(speed / (ENOUGH_WAVES * swing) / WAVE_STEP) * WAVE_STEP
    enough = min(float(enough), PARAMETER["road.longest_wave"].high)
    shortest = min(road.length for road in roads if isinstance(road, RandomRoad))
    if speed / wave > FEW_WAVES * swing and wave < enough:
        yield RideWarning(
            f"At {3.6 * speed:.3g} km/h the random road's longest waves, {wave:g} m, are too short for the pitch",
            f"They are met {speed / wave:.2f} times a second; by itself the hull swings at {swing:.2f} Hz, and slower "
            f"waves would pitch it, too. Set longest_wave to {enough:g} m"
            + (f", and the road's length, {shortest:g} m, to no less." if shortest < enough else "."),
        )


@lru_cache(maxsize=4)
def _slowest_swing(config: Config) -> float | None:
    """Frequency of the hull's slower mode, Hz; None where it neither bounces nor pitches by itself."""
    with suppress(NoEquilibriumError):
        modes = vehicle_modes(config)
        return min((mode.frequency for mode in (modes.bounce, modes.pitch) if mode is not None), default=None)
    return None


def _profile_missed(trajectory: Trajectory, taken: Window) -> Iterator[RideWarning]:
    """Of a measured profile that ends under way, or is not reached while the run's window is on something else."""
    system, config = trajectory.system, trajectory.config
    start, end = profile_start(config), profile_end(config)
    if start is None:
        return
    wheels = trajectory.q[:, system.road_wheels, 0]
    if wheels.max() < start and taken.reached:
        yield RideWarning(
            f"The profile was not reached: it begins at x = {start:.6g} m, the wheels came to {wheels.max():.4g} m",
            "Nothing here is of the measured road: give road.start, where its first point is to lie, or a longer run.",
        )
    elif end is not None and wheels[-1].min() > end:
        left = trajectory.t[(wheels.min(axis=1) > end).argmax()]
        yield RideWarning(
            f"The points of the profile end at x = {end:.4g} m; all wheels were past that at t = {left:.2f} s",
            "From there on the road is level. Means, comfort and absorbed power leave this stretch out.",
        )
