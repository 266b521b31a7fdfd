"""What the page draws of studies, as data for assets/study.js: names, units and numbers as they are shown. Pure.

`metric` beside them is the unit of the tables, and the factor that leads from it to what is shown: downloads are in it.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from app.format.command_line import Source
from app.format.load_unit import figure_unit, load_unit
from app.format.parameters import shown_number, slider_numbers
from app.format.units import METRIC, Units
from app.plots.thinning import thin
from model.analysis.comfort import POWER_LIMIT
from model.analysis.figures import ACCELERATION_RMS, FIGURE, POWER, SHOCK
from model.config.config import Config
from model.dynamics.vehicle import System, build_system
from model.study.design import Range
from model.study.figure_map import FigureMap
from model.study.fit import Fit, Overlay
from model.study.limits import NEVER, SHOCK_BOUND, SPEEDS, Limit
from model.study.profiler import LEVELS, Curve, Profile, decisive, effects, range_text

Data = dict[str, Any]
BOUNDS = {POWER.name: POWER_LIMIT, SHOCK.name: SHOCK_BOUND}  # of practice, which the page marks
SHARE = 4  # spectra are means over stretches of a fourth of a record …
HIGHEST = 30.0  # Hz … and go so far
DIGITS = 6  # of numbers that are drawn


class FigureUnit:
    """A figure with the unit and the factor in which it is shown; loads in the vehicle's unit."""

    def __init__(self, name: str, system: System, units: Units) -> None:
        of, _, self.wheel = name.partition(".")
        figure = FIGURE[of]
        self.name, self.label = name, f"{figure.label}, {self.wheel}" if self.wheel else figure.label
        told, metric = (figure_unit(figure.unit, load_unit(system, of_page), of_page) for of_page in (units, METRIC))
        self.unit, self.factor = told.name, told.factor
        self._metric = [metric.name, told.factor / metric.factor]

    @property
    def data(self) -> Data:
        bound = BOUNDS.get(self.name)
        return {"name": self.name, "label": self.label, "unit": self.unit, "metric": self._metric, "bound": bound}


def profile_data(
    profile: Profile, baseline: Profile | None, rows: Sequence[str], columns: Sequence[str], units: Units = METRIC
) -> Data:
    """A profile, and that of the baseline over the same ranges.

    rows, columns: figures and keys that the profiler shows; others are there for the strips on sliders only.
    """
    system = build_system(profile.base)
    shown = [FigureUnit(name, system, units) for name in profile.figures]
    told = []
    for k, figure in enumerate(shown):
        found = effects(profile, figure.name)
        told.append(
            figure.data
            | {
                "now": _number(profile.present[k] * figure.factor),
                "before": None if baseline is None else _number(baseline.present[k] * figure.factor),
                "shown": figure.name in rows,
                "effects": [[effect.key, _number(effect.reach * figure.factor), effect.way] for effect in found],
                "decisive": len(decisive(found)),
            }
        )
    factors = np.array([figure.factor for figure in shown])
    others = {} if baseline is None else {curve.axis.key: curve for curve in baseline.curves}
    return {
        "level": profile.level,
        "done": profile.level == LEVELS[-1],
        "figures": told,
        "columns": [
            axis_data(profile.base, curve.axis, units)
            | _curve_data(profile.base, curve, factors, units)
            | {
                "shown": curve.axis.key in columns,
                "baseline": None
                if curve.axis.key not in others
                else _curve_data(profile.base, others[curve.axis.key], factors, units)
                | {"now": _shown(baseline.base, curve.axis.key, units) if baseline is not None else None},
            }
            for curve in profile.curves
        ],
    }


def map_data(of: FigureMap, units: Units = METRIC) -> Data:
    """A map; a list of numbers for each row."""
    figure = FigureUnit(of.figure, build_system(of.base), units)
    x, y = axis_data(of.base, of.x, units), axis_data(of.base, of.y, units)
    return {
        "done": of.done,
        "figure": figure.data,
        "x": x | {"at": _numbers(of.columns * units.told(of.base.parameter(of.x.key)).shown_factor)},
        "y": y | {"at": _numbers(of.rows * units.told(of.base.parameter(of.y.key)).shown_factor)},
        "values": [_numbers(row * figure.factor) for row in of.values],
    }


def map_command(of: FigureMap, source: Source) -> str:
    """The command line that repeats it."""
    vary = [option for axis in (of.x, of.y) for option in ("--vary", range_text(axis, of.level))]
    return source.command("sweep", *vary, "--figures", of.figure, "--out", "map.csv")


def limits_data(own: Sequence[Limit], baseline: Sequence[Limit], part: float, units: Units = METRIC) -> Data:
    """Fastest speeds over rough ground and half-rounds; part: of the grounds that are done, 0…1."""
    return {
        "done": part >= 1,
        "part": _number(part),
        "fastest": _number(SPEEDS[-1] * units.of("km/h").factor),
        "speed": _unit_data("km/h", units),
        "size": _unit_data("mm", units),
        "own": {name: _limits_of(own, shock, units) for name, shock in (("ride", False), ("shock", True))},
        "baseline": {name: _limits_of(baseline, shock, units) for name, shock in (("ride", False), ("shock", True))},
    }


def _unit_data(metric: str, units: Units) -> Data:
    unit = units.of(metric)
    return {"unit": unit.name, "metric": [metric, unit.factor]}


def measured_data(base: Config, name: str, over: Overlay, found: Fit | None, units: Units = METRIC) -> Data:
    """A run over a record, in time and as spectra, and what a fit has found."""
    factor = units.of(ACCELERATION_RMS.unit).factor
    columns = [over.measured, over.simulated]
    spectra = [_spectrum(over.t, column) for column in columns]
    if found is not None:
        columns += [np.interp(over.t, found.t, found.fitted, left=np.nan, right=np.nan)]
        spectra += [_spectrum(found.t, found.fitted)]
    t, curves = thin(over.t, np.column_stack(columns))
    return {
        "name": name,
        "acceleration": _unit_data(ACCELERATION_RMS.unit, units),
        "rms": _number(over.rms * factor),
        "lag": _number(over.lag),
        "offset": _number(over.offset * factor),
        "t": _numbers(t),
        "curves": _table(curves * factor),
        "spectra": [
            {"x": _numbers(frequency[frequency <= HIGHEST]), "y": _numbers(amplitude[frequency <= HIGHEST] * factor)}
            for frequency, amplitude in spectra
        ],
        "fit": None if found is None else _fit_data(base, found, units),
    }


def _fit_data(base: Config, found: Fit, units: Units) -> Data:
    rows, factor = [], units.of(ACCELERATION_RMS.unit).factor
    for key, estimate, at_end in zip(found.keys, found.estimates, found.at_end, strict=True):
        parameter = units.told(base.parameter(key))
        value, low, high = (
            _number(number * parameter.shown_factor) for number in (estimate.value, estimate.low, estimate.high)
        )
        rows.append(
            {
                "key": key,
                "label": parameter.label,
                "unit": parameter.shown_unit,
                "value": value,
                "low": low,
                "high": high,
                "end": at_end,
            }
        )
    before = found.rms_before
    return {
        "rows": rows,
        "rms": _number(found.rms * factor),
        "before": None if before is None else _number(before * factor),
    }


def _spectrum(t: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies, Hz, and amplitudes, m/s² rms in each band."""
    from scipy.signal import welch

    rate = (len(t) - 1) / (t[-1] - t[0])
    frequency, power = welch(values, rate, nperseg=min(max(len(t) // SHARE, 16), len(t)), scaling="spectrum")
    return frequency, np.sqrt(power)


def _limits_of(found: Sequence[Limit], shock: bool, units: Units) -> list[Data]:
    """By size of the ground, rising: median of all seeds, slowest and fastest, and what is to be said of them."""
    speed, size = units.of("km/h").factor, units.of("mm").factor
    by_name: dict[str, list[Limit]] = {}
    for limit in found:
        if (limit.figure == SHOCK.name) is shock:
            by_name.setdefault(limit.ground.name, []).append(limit)
    told = []
    for name, group in by_name.items():
        speeds = [limit.drawn * speed for limit in group if limit.drawn is not None]
        told.append(
            {
                "name": units.reword(name),
                "size": _number(1e3 * size * float(np.median([limit.ground.size for limit in group]))),
                "speed": _number(float(np.median(speeds))) if speeds else None,
                "low": _number(min(speeds)) if speeds else None,
                "high": _number(max(speeds)) if speeds else None,
                "never": all(limit.why == NEVER for limit in group),
                "again": any(limit.down_again is not None for limit in group),
                "why": "" if speeds else units.reword(group[0].why),
            }
        )
    return sorted(told, key=lambda one: one["size"])


def axis_data(config: Config, axis: Range, units: Units = METRIC) -> Data:
    """A parameter: names, range, step of its slider, a number on its steps, and present value, as shown."""
    metric = config.parameter(axis.key)
    parameter, value = units.told(metric), config.value(axis.key)
    first, _, step = slider_numbers(parameter, float(value) if isinstance(value, int | float) else 0.0)
    low, high = (shown_number(parameter, number) for number in (axis.low, axis.high))
    return {
        "key": axis.key,
        "label": parameter.label,
        "unit": parameter.shown_unit,
        "metric": [metric.shown_unit, units.of_parameter(metric).factor],
        "low": low,
        "high": high,
        "step": step,
        "first": low if units == METRIC else first,
        "now": _shown(config, axis.key, units),
    }


def _shown(config: Config, key: str, units: Units) -> float | None:
    value = config.value(key)
    return shown_number(units.told(config.parameter(key)), value) if isinstance(value, int | float) else None


def _curve_data(config: Config, curve: Curve, factors: np.ndarray, units: Units) -> Data:
    """Shown values of the parameter, and a list of shown numbers for each figure."""
    scale = units.told(config.parameter(curve.axis.key)).shown_factor
    band = curve.band
    return {
        "x": _numbers(curve.values * scale),
        "y": _table(curve.figures * factors),
        "band": None
        if band is None
        else {
            "x": _numbers(band.values * scale),
            "low": _table(band.low * factors),
            "high": _table(band.high * factors),
        },
    }


def profile_commands(profile: Profile, source: Source, rows: Sequence[str], columns: Sequence[str]) -> list[str]:
    """Command lines that repeat the curves, one for each parameter."""
    return [
        source.command(
            "sweep",
            "--vary",
            range_text(curve.axis, profile.level),
            "--figures",
            ",".join(rows),
            "--out",
            f"{curve.axis.key.rpartition('.')[2]}.csv",
        )
        for curve in profile.curves
        if curve.axis.key in columns
    ]


def _number(value: float) -> float | None:
    """A number that JSON has, free of digits that nobody sees."""
    return float(f"{value:.{DIGITS}g}") if np.isfinite(value) else None


def _numbers(values: Iterable[float]) -> list[float | None]:
    return [_number(value) for value in values]


def _table(values: np.ndarray) -> list[list[float | None]]:
    """A list for each figure of (N, F)."""
    return [_numbers(column) for column in values.T]
