"""The figures of a run, by name: one table for comparisons, tabs, reports, the command line and studies.

To add a figure, add a line to FIGURES.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import isfinite
from typing import Literal

import numpy as np

from model.analysis.comfort import Comfort
from model.analysis.ride import Summary
from model.analysis.signals import same_window
from model.simulation.trajectory import Trajectory

Reading = float | np.ndarray | None  # of the whole vehicle, of each wheel (W,), or what cannot be told


@dataclass(frozen=True, eq=False)
class Figure:
    """One figure that a run comes to."""

    name: str  # in files and on the command line
    label: str
    unit: str
    meaning: str
    of: Callable[[Summary], Reading]  # in the unit; of each wheel where it is per wheel, road wheels first
    per_wheel: bool = False
    road_wheels_only: bool = False  # where it is per wheel
    better: Literal["smaller", "larger"] | None = "smaller"  # None: neither, as such
    least: float = 1e-3  # in the unit: a baseline smaller than this is as good as nothing
    share: float = 0.005  # of the figure: a finer difference is not resolved, …
    resolution: float | Literal["sample"] = 0.0  # … nor one finer than this, in the unit, or than the sampling
    together: bool = False  # of all wheels counts what the road wheels come to together; else the worst wheel
    grows: Literal["window", "run"] | None = None  # with what it grows
    compared: bool = True  # among the figures of the ride; else it tells about the computation


PEAK_SHARE = 0.01  # what is largest for an instant: against a fine solution, loads come within 0.62 % (README)


def _felt(value: Callable[[Comfort], float]) -> Callable[[Summary], float | None]:
    """A figure of the comfort at the driver's seat."""
    return lambda of: None if of.seat is None else value(of.seat)


ACCELERATION_RMS = Figure(
    "acceleration_rms",
    "Vertical acceleration, rms",
    "m/s²",
    "of the hull's centre of mass, over the window",
    lambda of: of.acceleration_rms,
)
ACCELERATION_PEAK = Figure(
    "acceleration_peak",
    "Vertical acceleration, peak",
    "m/s²",
    "of the hull's centre of mass, the largest in either direction in the whole run",
    lambda of: of.acceleration_peak,
    share=PEAK_SHARE,
)
SHOCK = Figure(
    "shock",
    "Shock at the seat",
    "g",
    "largest vertical acceleration at the driver's seat in either direction over the window, behind a low-pass of "
    "30 Hz (Butterworth, 2nd order); 2.5 g is held to be the limit",
    _felt(lambda felt: felt.shock),
    share=PEAK_SHARE,
)
WEIGHTED = Figure(
    "weighted_acceleration",
    "Weighted acceleration at the seat",
    "m/s²",
    "rms over the window at the driver's seat, up and down (W_k) and fore and aft (W_d) together, by ISO 2631-1",
    _felt(lambda felt: felt.total),
)
DOSE = Figure(
    "vibration_dose",
    "Vibration dose (VDV) at the seat",
    "m/s¹·⁷⁵",
    "(∫ a⁴ dt)^¼ of the vertical weighted acceleration over the window: it tells jolts, and grows with time",
    _felt(lambda felt: felt.dose),
    grows="window",
)
TRANSIENT = Figure(
    "transient",
    "Worst second (MTVV) at the seat",
    "m/s²",
    "largest rms over a second of the vertical weighted acceleration, in the window",
    _felt(lambda felt: felt.transient),
)
POWER = Figure(
    "absorbed_power",
    "Absorbed power at the seat",
    "W",
    "by a sitting person, of the vertical acceleration, mean over the window (Pradko and Lee)",
    _felt(lambda felt: felt.absorbed_power),
)
PITCH = Figure(
    "pitch",
    "Pitch, peak to peak",
    "°",
    "of the hull, from its lowest to its highest angle in the whole run",
    lambda of: float(np.degrees(of.pitch_high - of.pitch_low)),
)
IMAGINARY_SHARE = Figure(
    "imaginary_share",
    "Load on imaginary wheels",
    "%",
    "of the load on all wheels, mean over the window",
    lambda of: 100 * of.imaginary_share,
    better=None,
    least=1e-2,
)
LOAD_PEAK = Figure(
    "peak_load",
    "Peak load",
    "kN",
    "largest normal load in the whole run",
    lambda of: of.load_max / 1e3,
    per_wheel=True,
    share=PEAK_SHARE,
)
LOAD_RMS = Figure(
    "rms_load", "Load, rms", "kN", "of the normal load, over the window", lambda of: of.load_rms / 1e3, per_wheel=True
)
LOAD_COEFFICIENT = Figure(
    "load_coefficient",
    "Dynamic load coefficient",
    "%",
    "standard deviation of the normal load over the window / the load at rest",
    lambda of: 100 * of.load_coefficient,
    per_wheel=True,
    least=1e-2,
)
TRAVEL = Figure(
    "travel",
    "Suspension travel",
    "mm",
    "of each road wheel in the hull, from its lowest to its highest place in the whole run",
    lambda of: 1e3 * (of.travel_up - of.travel_down),
    per_wheel=True,
    road_wheels_only=True,
    better=None,
    least=1e-2,
)
AIR_TIME = Figure(
    "air_time",
    "Time in the air",
    "s",
    "without load, in the whole run",
    lambda of: of.air_time,
    per_wheel=True,
    least=1e-9,
    resolution="sample",
    together=True,
    grows="run",
)
LIFT_OFFS = Figure(
    "lift_offs",
    "Lift-offs",
    "",
    "how often a wheel left the ground in the whole run, counted from sample to sample: a hop between two is not seen",
    lambda of: of.lift_offs.astype(float),
    per_wheel=True,
    least=0.5,
    share=0.0,
    resolution=1.0,
    together=True,
    grows="run",
)
DRIFT = Figure(
    "drift", "Constraint drift, largest", "µm", "by which joints were apart", lambda of: 1e6 * of.drift, compared=False
)
ENERGY_ERROR = Figure(
    "energy_error",
    "Energy unaccounted for",
    "%",
    "of the energy turned over, at worst in the whole run",
    lambda of: None if of.energy_error is None else 100 * of.energy_error,
    compared=False,
)
FIGURES = (
    ACCELERATION_RMS, ACCELERATION_PEAK, SHOCK, WEIGHTED, DOSE, TRANSIENT, POWER, PITCH, IMAGINARY_SHARE,
    LOAD_PEAK, LOAD_RMS, LOAD_COEFFICIENT, TRAVEL, AIR_TIME, LIFT_OFFS,
    DRIFT, ENERGY_ERROR,
)  # fmt: skip
FIGURE = {figure.name: figure for figure in FIGURES}
LABELLED = {figure.label: figure for figure in FIGURES}
RIDE_FIGURES = tuple(figure for figure in FIGURES if figure.compared)
HULL_FIGURES = tuple(figure for figure in RIDE_FIGURES if not figure.per_wheel)
WHEEL_FIGURES = tuple(figure for figure in RIDE_FIGURES if figure.per_wheel)


@dataclass(frozen=True)
class Row:
    """One figure of a run beside that of its baseline; a figure that a run does not have is None."""

    figure: str
    wheel: str  # R1…, I1…; empty for a figure of the whole vehicle
    unit: str
    now: float | None
    baseline: float | None
    change: float | None  # %, of the baseline; None where it means nothing
    resolution: float = 0.0  # in the unit: a figure is told no finer than this, …
    share: float = 0.005  # … and differs only by more than this share of it (see Figure)

    @property
    def label(self) -> str:
        return f"{self.figure}, {self.wheel}" if self.wheel else self.figure

    @property
    def resolved(self) -> bool:
        """Whether now and baseline differ by what the figure resolves, or more; False without both."""
        if self.now is None or self.baseline is None:
            return False
        share = self.share * max(abs(self.now), abs(self.baseline))
        difference = abs(self.now - self.baseline)
        return difference > 0 and difference >= max(share, self.resolution)


def figure_named(name: str, of: Summary) -> float | None:
    """A figure by its name: of each wheel "peak_load.R1", and as "peak_load" the worst wheel's.

    Of time in the air and lift-offs the worst is what all road wheels come to together. None: it cannot be told, or
    there is no such wheel.
    """
    name, _, wheel = name.partition(".")
    figure = FIGURE[name]
    reading = figure.of(of)
    if not isinstance(reading, np.ndarray):
        return reading
    wheels = _of_wheels(of, reading)
    return wheels.get(wheel) if wheel else _worst(figure, wheels)


def figures_by_name(of: Summary) -> dict[str, float | None]:
    """All figures, of those per wheel each wheel's and the worst wheel's: see figure_named."""
    named: dict[str, float | None] = {}
    worst: dict[str, float | None] = {}
    for figure in FIGURES:
        reading = figure.of(of)
        if isinstance(reading, np.ndarray):
            wheels = _of_wheels(of, reading)
            named |= {f"{figure.name}.{wheel}": value for wheel, value in wheels.items()}
            worst[figure.name] = _worst(figure, wheels)
        else:
            named[figure.name] = reading
    return named | worst


@dataclass(frozen=True)
class Overall:
    """A figure of each wheel for all of them."""

    row: Row  # of the worst wheel now, which it names; of what the road wheels come to together, where it names none
    baseline_wheel: str  # the worst in the baseline, which may be another


def overall(rows: Sequence[Row]) -> list[Overall]:
    """The rows of figures of each wheel (see `comparison`), one for each figure."""
    found = []
    for label in dict.fromkeys(row.figure for row in rows if row.wheel):
        mine, figure = [row for row in rows if row.figure == label and row.wheel], LABELLED[label]
        now, wheel = _overall(figure, {row.wheel: row.now for row in mine})
        baseline, before = _overall(figure, {row.wheel: row.baseline for row in mine})
        compared = any(row.baseline is not None for row in mine)
        reference = baseline if compared else None
        comparable = any(row.change is not None for row in mine)  # the runs are as long, where that matters
        change = percent(now, reference, figure.least) if comparable else None
        found.append(Overall(replace(mine[0], wheel=wheel, now=now, baseline=reference, change=change), before))
    return found


def comparison(now: Trajectory, baseline: Trajectory | None) -> list[Row]:
    """The ride figures of a run, and of another beside them: the hull's first, then each wheel's, front first.

    A figure that grows with time changes in percent only where both have had the same time.
    """
    runs = [now] if baseline is None else [now, baseline]
    sampling = max(1 / run.config.simulation.output_rate for run in runs)
    summaries = [Summary(run) for run in runs]
    present, *others = (_values(of, RIDE_FIGURES) for of in summaries)
    other: Mapping[tuple[Figure, str], float | None] = others[0] if others else {}
    rows = []
    for figure, wheel in sorted({**present, **other}, key=_reading_order):
        value, reference = present.get((figure, wheel)), other.get((figure, wheel))
        change = None
        if same_time(figure.grows, *summaries):
            change = percent(value, reference, figure.least)
        resolution = sampling if figure.resolution == "sample" else figure.resolution
        rows.append(Row(figure.label, wheel, figure.unit, value, reference, change, resolution, figure.share))
    return rows


def figure_table() -> str:
    """The README's table of figures, in Markdown."""
    rows = ["| Name | Figure | Unit | What it is | Better |", "| --- | --- | --- | --- | --- |"]
    for figure in FIGURES:
        name = f"`{figure.name}`" + (", each wheel" if figure.per_wheel else "")
        rows.append(f"| {name} | {figure.label} | {figure.unit} | {figure.meaning} | {figure.better or '–'} |")
    return "\n".join(rows)


def percent(value: float | None, reference: float | None, least: float) -> float | None:
    """By how much a value differs from its reference, %; None without both, or where that is smaller than `least`."""
    return None if value is None or reference is None or reference < least else 100 * (value / reference - 1)


def same_time(grows: str | None, *summaries: Summary) -> bool:
    """Whether figures that grow with that (see Figure) may be compared between runs."""
    if grows == "run":
        return len({of.duration for of in summaries}) == 1
    if grows == "window":
        return same_window(*(of.window for of in summaries))
    return True


def _reading_order(key: tuple[Figure, str]) -> tuple[int, bool, int]:
    figure, wheel = key
    number = int(wheel[1:]) if wheel else 0
    return FIGURES.index(figure), wheel.startswith("I"), number


def _values(of: Summary, figures: tuple[Figure, ...]) -> dict[tuple[Figure, str], float | None]:
    """By figure and wheel."""
    found: dict[tuple[Figure, str], float | None] = {}
    for figure in figures:
        reading = figure.of(of)
        if isinstance(reading, np.ndarray):
            found |= {(figure, name): value for name, value in _of_wheels(of, reading).items()}
        else:
            found[figure, ""] = reading
    return found


def _of_wheels(of: Summary, reading: np.ndarray) -> dict[str, float]:
    """A reading of each wheel by the wheel's name, where it can be told."""
    return {name: value for name, value in zip(of.names, reading.tolist(), strict=False) if isfinite(value)}


def _worst(figure: Figure, wheels: Mapping[str, float]) -> float | None:
    """Of all wheels; None where it can be told of none."""
    if figure.together:
        return float(np.sum([value for wheel, value in wheels.items() if wheel.startswith("R")]))
    return max(wheels.values(), default=None)


def _overall(figure: Figure, values: Mapping[str, float | None]) -> tuple[float | None, str]:
    """Of all wheels, and the worst of them where it is that wheel's."""
    told = {wheel: value for wheel, value in values.items() if value is not None}
    worst = "" if figure.together else max(told, key=lambda wheel: told[wheel], default="")
    return _worst(figure, told), worst
