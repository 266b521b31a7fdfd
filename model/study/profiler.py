"""What each parameter would do to the figures of a run: true runs along one parameter at a time, coarse to fine.

A curve of a parameter does not depend on the present value of that parameter. So the curves are kept by what else the
vehicle and the road are: when one slider has moved, its own curve is there already, and after an undo all of them are.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from model.config.config import Config, ConfigError
from model.config.parameters import PARAMETER, Value, number_text
from model.study.design import Range
from model.study.running import Evaluate, Job, Outcome

LEVELS = (7, 13, 25)  # values along a range, each time those of the level before and the ones between
SEEDS = 4  # more random roads, for the band
CURVES = 300  # that are remembered
DECISIVE = 0.5  # of the largest effect: what has less does not matter most

SEED = "road.seed"


@dataclass(frozen=True, eq=False)
class Band:
    """From the smallest to the largest figure on several random roads."""

    values: np.ndarray  # (M,) of the parameter
    low: np.ndarray  # (M, F); NaN where no run came to its end
    high: np.ndarray  # (M, F)


@dataclass(frozen=True, eq=False)
class Curve:
    """Figures along the range of one parameter."""

    axis: Range
    values: np.ndarray  # (N,) of the parameter, rising, in the unit of the file; the present one is among them
    figures: np.ndarray  # (N, F) in their units; NaN, a gap, where a run did not come to its end
    band: Band | None = None


@dataclass(frozen=True, eq=False)
class Profile:
    """Figures of a configuration, and how each parameter would change them."""

    base: Config
    figures: tuple[str, ...]
    present: np.ndarray  # (F,) of the configuration itself
    curves: tuple[Curve, ...]
    level: int  # values along each range, of LEVELS


@dataclass(frozen=True)
class Effect:
    """What a parameter can do to a figure."""

    key: str
    reach: float  # the figure's largest value over the range less its smallest
    way: int  # 1: the figure grows with the parameter, -1: it falls, 0: both


class Found:
    """Outcomes of runs along a parameter, by what else is the same. The curves used longest ago are forgotten."""

    def __init__(self, most: int = CURVES) -> None:
        self._most = most
        self._curves: OrderedDict[object, dict[Value, Outcome]] = OrderedDict()

    def curve(self, base: Config, axis: Range, figures: tuple[str, ...], seed: int | None) -> dict[Value, Outcome]:
        """Outcomes by the parameter's value, to be filled."""
        try:
            other = base.replace({axis.key: axis.at(0.0)})
        except ConfigError:  # the low end is not allowed beside the rest
            other = base
        key = (other, axis.key, figures, seed)
        found = self._curves.setdefault(key, {})
        self._curves.move_to_end(key)
        while len(self._curves) > self._most:
            self._curves.popitem(last=False)
        return found


def axis_of(base: Config, key: str) -> Range | None:
    """The range that a slider of a parameter has; None where it takes no single number, or the road has no such key."""
    parameter = PARAMETER[key]
    if parameter.kind not in ("number", "integer") or not parameter.applies_to(base.road.type):
        return None
    value = base.value(key)
    if isinstance(value, tuple) or parameter.slider_low == parameter.slider_high:
        return None
    low, high, _ = parameter.slider(float(value or 0.0))
    if isinstance(value, int | float):
        low, high = min(low, value), max(high, value)
    return Range(key, low, high)


def steps(axis: Range, level: int) -> list[Value]:
    """The values at a level, one of LEVELS."""
    fine = np.linspace(axis.low, axis.high, LEVELS[-1])[:: (LEVELS[-1] - 1) // (level - 1)]
    if axis.whole:
        return list(dict.fromkeys(round(float(value)) for value in fine))
    return [float(f"{value:.10g}") for value in fine]


def profiles(
    base: Config,
    axes: Sequence[Range],
    figures: tuple[str, ...],
    evaluate: Evaluate,
    found: Found,
    levels: Sequence[int] = LEVELS,
) -> Iterator[Profile]:
    """The profile of a configuration, each time finer; on a random road with a band, once the first curves are there.

    `evaluate` may raise to give it up. What it takes no run for comes first, and at once.
    """
    own = {axis.key: found.curve(base, axis, figures, None) for axis in axes}
    bands: dict[str, Band] = {}
    known = known_profile(base, axes, figures, found)
    if known is not None:
        yield known
    for level in levels:
        if known is not None and level <= known.level and base.road.type != "random":
            continue
        present = _fill(base, axes, figures, own, level, evaluate)
        yield _profile(base, axes, figures, own, bands, present, level)
        if not bands and base.road.type == "random":
            bands = _bands(base, axes, figures, own, evaluate, found)
            yield _profile(base, axes, figures, own, bands, present, level)


def known_profile(base: Config, axes: Sequence[Range], figures: tuple[str, ...], found: Found) -> Profile | None:
    """The finest profile that takes no run; None: there is none."""
    own = {axis.key: found.curve(base, axis, figures, None) for axis in axes}
    done = [
        level
        for level in LEVELS
        if all(value in own[axis.key] for axis in axes for value in _wanted(base, axis, level))
    ]
    if not axes or not done:
        return None
    return _profile(base, axes, figures, own, {}, _present(base, axes[0], own), done[-1])


def effects(profile: Profile, figure: str) -> tuple[Effect, ...]:
    """What each parameter can do to a figure over its range, the strongest first."""
    place = profile.figures.index(figure)
    found = []
    for curve in profile.curves:
        column = curve.figures[:, place]
        known = column[np.isfinite(column)]
        if not len(known):
            continue
        reach, change = float(np.ptp(known)), float(known[-1] - known[0])
        way = 0 if reach == 0 or abs(change) < reach / 2 else int(np.sign(change))
        found.append(Effect(curve.axis.key, reach, way))
    return tuple(sorted(found, key=lambda effect: -effect.reach))


def decisive(found: Sequence[Effect]) -> tuple[Effect, ...]:
    """Of effects, the strongest first, those that matter most: the first, and others at least half as strong."""
    return tuple(effect for effect in found if effect.reach > 0 and effect.reach >= DECISIVE * found[0].reach)


def range_text(axis: Range, count: int) -> str:
    """A range as commands take it: "drive.speed_kmh=2:70:25"; fewer values where only whole ones are allowed."""
    return f"{span_text(axis)}:{len(steps(axis, count))}"


def span_text(axis: Range) -> str:
    """Its ends only: "drive.speed_kmh=2:70"."""
    return f"{axis.key}={number_text(axis.low)}:{number_text(axis.high)}"


def _wanted(base: Config, axis: Range, level: int) -> list[Value]:
    """The values of a curve, the present one among them."""
    present = base.value(axis.key)
    values = steps(axis, level)
    return values if present is None or present in values else [*values, present]


def _present(base: Config, axis: Range, own: dict[str, dict[Value, Outcome]]) -> np.ndarray:
    """(F,) figures of the base, which is a point of each curve."""
    return _row(own[axis.key].get(base.value(axis.key)))


def _fill(
    base: Config,
    axes: Sequence[Range],
    figures: tuple[str, ...],
    own: dict[str, dict[Value, Outcome]],
    level: int,
    evaluate: Evaluate,
) -> np.ndarray:
    """Run what a level lacks. (F,) figures of the base itself."""
    itself = next((own[a.key][base.value(a.key)] for a in axes if base.value(a.key) in own[a.key]), None)
    if itself is None:
        (itself,) = evaluate([Job(base, {}, figures)])
    for axis in axes:
        if base.value(axis.key) is not None:
            own[axis.key][base.value(axis.key)] = itself
    missing = [(axis.key, value) for axis in axes for value in _wanted(base, axis, level) if value not in own[axis.key]]
    outcomes = evaluate([Job(base, {key: value}, figures) for key, value in missing])
    for (key, value), outcome in zip(missing, outcomes, strict=True):
        own[key][value] = outcome
    return _row(itself)


def _bands(
    base: Config,
    axes: Sequence[Range],
    figures: tuple[str, ...],
    own: dict[str, dict[Value, Outcome]],
    evaluate: Evaluate,
    found: Found,
) -> dict[str, Band]:
    """Bands of all parameters but the seed itself, over SEEDS more roads, on the values of the first level."""
    first, most = int(base.value(SEED)), int(PARAMETER[SEED].high)  # type: ignore[arg-type]
    seeds = [first + k if first + k <= most else first - k for k in range(1, SEEDS + 1)]
    axes = [axis for axis in axes if axis.key != SEED]
    others = {(axis.key, seed): found.curve(base, axis, figures, seed) for axis in axes for seed in seeds}
    missing = [
        (axis.key, seed, value)
        for seed in seeds
        for axis in axes
        for value in steps(axis, LEVELS[0])
        if value not in others[axis.key, seed]
    ]
    outcomes = evaluate([Job(base, {SEED: seed, key: value}, figures) for key, seed, value in missing])
    for (key, seed, value), outcome in zip(missing, outcomes, strict=True):
        others[key, seed][value] = outcome
    bands = {}
    for axis in axes:
        values = steps(axis, LEVELS[0])
        curves = [own[axis.key], *(others[axis.key, seed] for seed in seeds)]
        all_ = np.array([[_row(curve[value], len(figures)) for value in values] for curve in curves])
        bands[axis.key] = Band(np.array(values, dtype=float), _extreme(all_, np.fmin), _extreme(all_, np.fmax))
    return bands


def _extreme(all_: np.ndarray, of: np.ufunc) -> np.ndarray:
    """(M, F) of (S, M, F), those that are no number left out."""
    return of.reduce(all_, axis=0)


def _profile(
    base: Config,
    axes: Sequence[Range],
    figures: tuple[str, ...],
    own: dict[str, dict[Value, Outcome]],
    bands: dict[str, Band],
    present: np.ndarray,
    level: int,
) -> Profile:
    curves = []
    for axis in axes:
        values = sorted(_wanted(base, axis, level))  # type: ignore[type-var]
        rows = np.array([_row(own[axis.key][value], len(figures)) for value in values])
        curves.append(Curve(axis, np.array(values, dtype=float), rows, bands.get(axis.key)))
    return Profile(base, figures, present, tuple(curves), level)


def _row(outcome: Outcome | None, count: int = 0) -> np.ndarray:
    """(F,) figures as numbers."""
    figures = (None,) * count if outcome is None else outcome.figures
    return np.array([np.nan if value is None else value for value in figures], dtype=float)
