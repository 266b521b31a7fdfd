"""Imaginary wheels against a track of links: our runs beside records of another engine, and which springs come nearest.

The records are of half an M113 with rigid shoes on pins over half-rounds (assets/links). Runs and records are laid over
each other at the time at which the first wheel has climbed a little, and compared from just before that on.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import NamedTuple

import numpy as np
from scipy.signal import butter, sosfiltfilt

from model.analysis.ride import suspension_travel
from model.config.config import Config
from model.config.config_files import load_config
from model.dynamics.equilibrium import NoEquilibriumError
from model.paper.study import PRELOAD_FORCE, STIFFNESS, StudyError
from model.simulation.batch import simulate_many
from model.simulation.trajectory import Trajectory

RECORDS = ("half_round_100_15", "half_round_100_30", "half_round_200_15")  # .csv: height, mm, and speed, km/h
RATE = 200.0  # 1/s, of records and runs
CUT_OFF = 20.0  # Hz: accelerations above it are not compared
BEFORE, AFTER = 0.5, 1.9  # s before and after the first wheel has climbed: what is compared
CLIMBED = 0.03  # m that the first wheel has risen in the hull
CLIMBING = 0.1  # s before that in which it has met the obstacle already
AHEAD = 6.0  # m to the obstacle at the start
ARM_LENGTH, ASSEMBLY = 0.3176, np.radians(24.95)  # m, rad: of the records' arms at the assembly pose

# The M113 at the pose of the records, all that is sprung and the track as in the preset
AT_ASSEMBLY: Mapping[str, object] = {
    "vehicle.chassis.cg_height": 0.909,
    "vehicle.road_wheels.positions": (1.355, 0.688, 0.021, -0.646, -1.312),
    "vehicle.road_arms.angle_deg": 24.95,
    "vehicle.road_suspension.damping": (506.3, 506.3, 500, 500, 506.3),
}
WITHOUT: Mapping[str, object] = {"vehicle.imaginary_wheels.enabled": False}

DAMPING = "vehicle.imaginary_suspension.damping"
# What is tried first: N/m, N s/m and N at the imaginary wheel; then ever closer about the best
TRIED: Mapping[str, tuple[float, ...]] = {
    STIFFNESS: (1e3, 4e3, 1.6e4, 6.4e4, 2.56e5),
    DAMPING: (60.0, 400.0, 2.5e3, 1.6e4),
    PRELOAD_FORCE: (250.0, 1e3, 4e3, 1.6e4),
}
CLOSER = (2.0, 1.4, 1.2)  # factors from the best value to its neighbours, round by round
AS_GOOD = 1.02  # times the least error: what cannot be told from the best
UNFINISHED = "Runs of the M113 over the half-rounds of the records did not reach their end."


class Motion(NamedTuple):
    """How the hull moves from BEFORE ahead of the time at which the first wheel has climbed, to AFTER behind it.

    Pitch and rise are counted from their means before that time.
    """

    t: np.ndarray  # (N,) s, 0 where the first wheel has climbed
    acceleration: np.ndarray  # (N,) m/s², vertical, below CUT_OFF
    pitch: np.ndarray  # (N,) rad, nose up
    rise: np.ndarray  # (N,) m


class Record(NamedTuple):
    """One run of a track of links over a half-round."""

    height: float  # m
    radius: float  # m
    speed_kmh: float  # while wheels climb the obstacle
    motion: Motion


class Errors(NamedTuple):
    """How far a run's motion is from a record's. Each: acceleration, pitch, rise."""

    rms: tuple[float, float, float]  # root mean square difference / the record's root mean square
    peak: tuple[float, float, float]  # largest in either direction / the record's, − 1


@dataclass(frozen=True)
class Compared:
    """One vehicle beside all records."""

    config: Config  # without the records' roads
    motions: tuple[Motion, ...]
    errors: tuple[Errors, ...]

    @property
    def error(self) -> float:
        """One figure: root mean square of all rms errors. 1 is that of a hull that does not move."""
        return float(np.sqrt(np.mean(np.square([errors.rms for errors in self.errors]))))


@dataclass(frozen=True)
class LinksStudy:
    """All that is told about imaginary wheels and links."""

    records: tuple[Record, ...]
    preset: Compared  # m113
    assembly: Compared  # the same with its arms at the records' pose
    without: Compared  # that without imaginary wheels
    nearest: Compared  # that with the imaginary wheels that come nearest
    values: Mapping[str, float]  # of these: stiffness, damping, preload by key
    as_good: Mapping[str, tuple[float, float]]  # lowest and highest value that was tried and is as good
    tried: int  # how many sets of values


def study_links(texts: Iterable[str], on_progress: Callable[[float], None] | None = None) -> LinksStudy:
    """Compare, and seek the imaginary wheels that come nearest. texts: of the records' files.

    on_progress: gets the part done, 0…1, and may raise to end the study. Raises StudyError.
    """
    records = tuple(read_record(text) for text in texts)
    preset = load_config("m113")
    assembly = preset.replace(AT_ASSEMBLY)
    fixed = [preset, assembly, assembly.replace(WITHOUT)]
    first = [dict(zip(TRIED, values, strict=True)) for values in product(*TRIED.values())]
    count = len(fixed) + len(first) + len(CLOSER) * 3 ** len(TRIED)
    done = 0

    def compare(configs: Sequence[Config]) -> Iterator[Compared | None]:
        nonlocal done
        for found in compare_all(configs, records):
            done += 1
            if on_progress is not None:
                on_progress(done / count)
            yield found

    preset_run, assembly_run, bare_run = compare(fixed)
    if preset_run is None or assembly_run is None or bare_run is None:
        raise StudyError(UNFINISHED)
    tried: list[tuple[dict[str, float], Compared]] = []

    def best_of(values: Sequence[dict[str, float]]) -> tuple[dict[str, float], Compared]:
        compared = compare([assembly.replace(each) for each in values])
        tried.extend((each, found) for each, found in zip(values, compared, strict=True) if found is not None)
        if not tried:
            raise StudyError(UNFINISHED)
        return min(tried, key=lambda each: each[1].error)

    values, nearest = best_of(first)
    for factor in CLOSER:
        around = product((1 / factor, 1.0, factor), repeat=len(TRIED))
        values, nearest = best_of(
            [{key: values[key] * by for key, by in zip(TRIED, each, strict=True)} for each in around]
        )
    good = [each for each, found in tried if found.error <= AS_GOOD * nearest.error]
    return LinksStudy(
        records,
        preset=preset_run,
        assembly=assembly_run,
        without=bare_run,
        nearest=nearest,
        values=values,
        as_good={key: (min(each[key] for each in good), max(each[key] for each in good)) for key in TRIED},
        tried=len(tried),
    )


def read_record(text: str) -> Record:
    """The record in a file of assets/links. Raises ValueError for what is none."""
    found = re.search(r"height ([\d.]+) m, radius ([\d.]+) m, speed ([\d.]+) km/h", text)
    if found is None:
        raise ValueError("The head of a record must say height, radius and speed.")
    lines = [line for line in text.splitlines() if not line.startswith("#")]
    t, acceleration, pitch_deg, rise_mm, arm_deg = np.loadtxt(lines, delimiter=",", skiprows=1).T[:5]
    climbed = ARM_LENGTH * (np.sin(ASSEMBLY) - np.sin(ASSEMBLY - np.radians(arm_deg)))
    motion = motion_about(t, acceleration, np.radians(pitch_deg), rise_mm / 1000, climbed)
    height, radius, speed = map(float, found.groups())
    return Record(height, radius, speed, motion)


def motion_about(
    t: np.ndarray, acceleration: np.ndarray, pitch: np.ndarray, rise: np.ndarray, climbed: np.ndarray
) -> Motion:
    """The part of a motion, sampled at t, that is compared. climbed: how high the first wheel is in the hull, m.

    Raises ValueError where the first wheel never climbs, or too close to the ends.
    """
    low_pass = butter(4, CUT_OFF, fs=1 / np.mean(np.diff(t)), output="sos")
    up = climbed - climbed[: int(BEFORE * RATE)].mean() > CLIMBED
    at = int(up.argmax())
    grid = np.arange(-round(BEFORE * RATE), round(AFTER * RATE)) / RATE
    if not up.any() or t[at] + grid[0] < t[0] or t[at] + grid[-1] > t[-1]:
        raise ValueError("The first wheel does not climb, or too close to the start or the end.")
    before = grid < -CLIMBING

    def laid(values: np.ndarray) -> np.ndarray:
        return np.interp(t[at] + grid, t, values)

    pitch, rise = laid(pitch), laid(rise)
    return Motion(
        grid,
        laid(sosfiltfilt(low_pass, acceleration)),
        pitch - pitch[before].mean(),
        rise - rise[before].mean(),
    )


def compare_all(configs: Sequence[Config], records: Sequence[Record]) -> Iterator[Compared | None]:
    """Each configuration beside the records, in their order; None for one that cannot rest or does not come through."""
    runs = simulate_many((on_obstacle(config, record) for config in configs for record in records), _motion)
    for config in configs:
        motions = [next(runs) for _ in records]
        if any(motion is None or isinstance(motion, NoEquilibriumError) for motion in motions):
            yield None
            continue
        whole = tuple(motion for motion in motions if isinstance(motion, Motion))
        errors = tuple(errors_of(motion, record.motion) for motion, record in zip(whole, records, strict=True))
        yield Compared(config, whole, errors)


def on_obstacle(config: Config, record: Record) -> Config:
    """A configuration on a record's half-round, at its speed, for long enough."""
    return config.replace({
        "road.type": "half_round",
        "road.position": AHEAD,
        "road.height": record.height,
        "road.radius": record.radius,
        "drive.speed_kmh": record.speed_kmh,
        "simulation.duration": AHEAD / (record.speed_kmh / 3.6) + AFTER + BEFORE,
        "simulation.output_rate": RATE,
    })  # fmt: skip


def errors_of(motion: Motion, record: Motion) -> Errors:
    """How far a motion is from a record's."""
    pairs = list(zip(motion[1:], record[1:], strict=True))
    rms = [float(np.sqrt(np.mean((ours - theirs) ** 2) / np.mean(theirs**2))) for ours, theirs in pairs]
    peak = [float(np.abs(ours).max() / np.abs(theirs).max() - 1) for ours, theirs in pairs]
    return Errors((rms[0], rms[1], rms[2]), (peak[0], peak[1], peak[2]))


def _motion(run: Trajectory) -> Motion | None:
    """A run's motion; None where it came to an end too early."""
    if not run.complete:
        return None
    hull = run.system.chassis
    _, y, pitch = run.q[:, hull].T
    try:
        return motion_about(run.t, run.a[:, hull, 1], pitch, y, suspension_travel(run)[:, 0])
    except ValueError:
        return None
