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
    curves = _Curves(base, axes, figures, found)
    known = curves.known()
    if known is not None:
        yield known
    for level in levels:
        if known is not None and level <= known.level and base.road.type != "random":
            continue
        curves.fill(level, evaluate)
        yield curves.profile(level)
        if not curves.bands and base.road.type == "random":
            curves.fill_bands(evaluate)
            yield curves.profile(level)


def known_profile(base: Config, axes: Sequence[Range], figures: tuple[str, ...], found: Found) -> Profile | None:
    """The finest profile that takes no run; None: there is none."""
    return _Curves(base, axes, figures, found).known()


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


_Point = tuple[dict[Value, Outcome], Range, Value, dict[str, Value]]  # a curve, its axis and value, what else changes


class _Curves:
    """The curves of a configuration along axes, as far as they are known."""

    def __init__(self, base: Config, axes: Sequence[Range], figures: tuple[str, ...], found: Found) -> None:
        self.base, self.axes, self.figures, self.found = base, axes, figures, found
        self.own = {axis.key: found.curve(base, axis, figures, None) for axis in axes}
        self.bands: dict[str, Band] = {}
        self.itself: Outcome | None = next((own for own in map(self._present, axes) if own is not None), None)

    def _present(self, axis: Range) -> Outcome | None:
        """The configuration itself, which is a point of each curve."""
        return self.own[axis.key].get(self.base.value(axis.key))

    def _wanted(self, axis: Range, level: int) -> list[Value]:
        """The values of a curve, the present one among them."""
        present = self.base.value(axis.key)
        values = steps(axis, level)
        return values if present is None or present in values else [*values, present]

    def known(self) -> Profile | None:
        """The finest profile that takes no run; None: there is none."""
        done = [
            level
            for level in LEVELS
            if all(value in self.own[axis.key] for axis in self.axes for value in self._wanted(axis, level))
        ]
        return self.profile(done[-1]) if self.axes and done else None

    def fill(self, level: int, evaluate: Evaluate) -> None:
        """Run what a level lacks."""
        if self.itself is None:
            (self.itself,) = evaluate([Job(self.base, {}, self.figures)])
        for axis in self.axes:
            if self.base.value(axis.key) is not None:
                self.own[axis.key][self.base.value(axis.key)] = self.itself
        self._run(
            [(self.own[axis.key], axis, value, {}) for axis in self.axes for value in self._wanted(axis, level)],
            evaluate,
        )

    def fill_bands(self, evaluate: Evaluate) -> None:
        """Bands of all parameters but the seed itself, over SEEDS more roads, on the values of the first level."""
        first, most = int(self.base.value(SEED)), int(PARAMETER[SEED].high)  # type: ignore[arg-type]
        seeds = [first + k if first + k <= most else first - k for k in range(1, SEEDS + 1)]
        axes = [axis for axis in self.axes if axis.key != SEED]
        others = {(a.key, seed): self.found.curve(self.base, a, self.figures, seed) for a in axes for seed in seeds}
        self._run(
            [
                (others[axis.key, seed], axis, value, {SEED: seed})
                for seed in seeds
                for axis in axes
                for value in steps(axis, LEVELS[0])
            ],
            evaluate,
        )
        for axis in axes:
            values = steps(axis, LEVELS[0])
            curves = [self.own[axis.key], *(others[axis.key, seed] for seed in seeds)]
            rows = np.array([[self._row(curve[value]) for value in values] for curve in curves])
            low, high = np.fmin.reduce(rows), np.fmax.reduce(rows)  # those that are no number left out
            self.bands[axis.key] = Band(np.array(values, dtype=float), low, high)

    def _run(self, wanted: Sequence[_Point], evaluate: Evaluate) -> None:
        """Fill curves where they lack a value of their axis, with other changes besides."""
        missing = [(curve, axis.key, value, also) for curve, axis, value, also in wanted if value not in curve]
        outcomes = evaluate([Job(self.base, also | {key: value}, self.figures) for _, key, value, also in missing])
        for (curve, _, value, _), outcome in zip(missing, outcomes, strict=True):
            curve[value] = outcome

    def profile(self, level: int) -> Profile:
        """All that a level has."""
        curves = []
        for axis in self.axes:
            values = sorted(self._wanted(axis, level))  # type: ignore[type-var]
            rows = np.array([self._row(self.own[axis.key][value]) for value in values])
            curves.append(Curve(axis, np.array(values, dtype=float), rows, self.bands.get(axis.key)))
        return Profile(self.base, self.figures, self._row(self.itself), tuple(curves), level)

    def _row(self, outcome: Outcome | None) -> np.ndarray:
        """(F,) figures as numbers."""
        figures = (None,) * len(self.figures) if outcome is None else outcome.figures
        return np.array([np.nan if value is None else value for value in figures], dtype=float)
