"""What a study is: a base configuration, the keys that vary, their values in each run, and the figures that are asked
for. Data only: running.py runs it.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from math import prod
from typing import Literal, overload

import numpy as np

from model.analysis.figures import FIGURE, FIGURES, Figure
from model.config.config import Config, ConfigError
from model.config.config_files import parse_value
from model.config.parameters import PARAMETER, Parameter, Value, number_text
from model.config.validation import convert, shorten, unknown_fault

VARIED = ("number", "integer", "choice", "flag", "list")  # kinds of parameters that a study may vary
MOST_RUNS = 10_000_000
MOST_AT_ONCE = 1_000_000  # of an analysis, which holds all of them
NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
RANGE = re.compile(rf"({NUMBER}):({NUMBER})(?::(\S+))?")

Point = tuple[Value, ...]  # a value for each key of a study


class DesignError(ValueError):
    """A study that cannot be made; the message says what is wrong and what to do."""


@dataclass(frozen=True)
class Values:
    """A key and the values that it takes, in their order."""

    key: str
    values: tuple[Value, ...]

    @property
    def listed(self) -> bool:
        """Whether lists are among them."""
        return any(isinstance(value, tuple) for value in self.values)

    def at(self, part: float) -> Value:
        """The value that lies at a part, 0…1, of the row."""
        return self.values[min(int(part * len(self.values)), len(self.values) - 1)]

    @property
    def steps(self) -> tuple[Value, ...]:
        return self.values


@dataclass(frozen=True)
class Range:
    """A key and the range that its value is taken from, both ends included, in the unit of the file."""

    key: str
    low: float
    high: float
    count: int | None = None  # values on a grid
    listed = False

    @property
    def whole(self) -> bool:
        """Whether only whole numbers are allowed."""
        return PARAMETER[self.key].kind == "integer"

    def at(self, part: float) -> Value:
        """The value at a part, 0…1, of the range; each whole number gets an equal share of it."""
        if self.whole:
            return min(int(self.low + part * (self.high - self.low + 1)), int(self.high))
        return self.low + part * (self.high - self.low)

    @property
    def steps(self) -> tuple[Value, ...]:
        """The values on a grid."""
        values = np.linspace(self.low, self.high, self.count or 0)
        return tuple(int(value) if self.whole else float(value) for value in values)


Varied = Values | Range


class Grid(Sequence[Point]):
    """All combinations of given values; the last key changes fastest."""

    def __init__(self, axes: Sequence[tuple[Value, ...]]) -> None:
        self.axes = tuple(axes)

    def __len__(self) -> int:
        return prod(len(axis) for axis in self.axes)

    @overload
    def __getitem__(self, number: int) -> Point: ...
    @overload
    def __getitem__(self, number: slice) -> Sequence[Point]: ...
    def __getitem__(self, number: int | slice) -> Point | Sequence[Point]:
        if isinstance(number, slice):
            return [self[k] for k in range(*number.indices(len(self)))]
        if not 0 <= number < len(self):
            raise IndexError(number)
        point: list[Value] = []
        for axis in reversed(self.axes):
            number, place = divmod(number, len(axis))
            point.insert(0, axis[place])
        return tuple(point)


class Sample(Sequence[Point]):
    """Points that a design (N, K) of numbers from 0 to 1 spreads over what K keys may be."""

    def __init__(self, varied: Sequence[Varied], parts: np.ndarray) -> None:
        self.varied, self.parts = tuple(varied), parts

    def __len__(self) -> int:
        return len(self.parts)

    @overload
    def __getitem__(self, number: int) -> Point: ...
    @overload
    def __getitem__(self, number: slice) -> Sequence[Point]: ...
    def __getitem__(self, number: int | slice) -> Point | Sequence[Point]:
        if isinstance(number, slice):
            return Sample(self.varied, self.parts[number])
        return tuple(of.at(float(part)) for of, part in zip(self.varied, self.parts[number], strict=True))


@dataclass(frozen=True)
class Study:
    """One run for each point: the base with the point's values in place of its own."""

    base: Config
    varied: tuple[Varied, ...]
    points: Sequence[Point]
    figures: tuple[str, ...]  # names of model/analysis/figures.py; "peak_load.R1": of a wheel
    sample: str = "given"  # how the points were chosen
    seed: int = 0  # of a sample

    @property
    def keys(self) -> tuple[str, ...]:
        """Those that vary."""
        return tuple(of.key for of in self.varied)


def make_study(
    base: Config,
    varied: Sequence[Varied],
    figures: Iterable[str] = (),
    sample: str = "grid",
    seed: int = 0,
) -> Study:
    """A study of the base with these keys varied, and these figures, or all, those of each wheel too.

    sample: "grid", "latin-hypercube:N" or "sobol:N"; seed: of the latter two, whose designs it determines.
    Raises DesignError.
    """
    if not varied:
        raise DesignError("nothing varies: give a key and its values")
    keys = [of.key for of in varied]
    twice = {key for key in keys if keys.count(key) > 1}
    if twice:
        raise DesignError(f"{', '.join(sorted(twice))}: is varied twice; give all its values at once")
    points, wanted = _points(varied, sample, seed), checked_figures(figures, base)
    return Study(base, tuple(varied), points, wanted, sample, seed)


def _points(varied: Sequence[Varied], sample: str, seed: int) -> Sequence[Point]:
    method, _, count = sample.partition(":")
    if method == "grid" and not count:
        for of in varied:
            if isinstance(of, Range) and of.count is None:
                shown = f"{of.key}={number_text(of.low)}:{number_text(of.high)}"
                raise DesignError(f"{shown}: says no number of values; give {shown}:5, or a sample")
        grid = Grid([of.steps for of in varied])
        if len(grid) > MOST_RUNS:
            raise DesignError(f"{len(grid)} runs are more than {MOST_RUNS}: give fewer values, or a sample")
        return grid
    if method not in ("latin-hypercube", "sobol"):
        raise DesignError(f"sample {sample}: give latin-hypercube:N, sobol:N or grid")
    if not (count.isascii() and count.isdigit() and 1 <= int(count) <= MOST_RUNS):
        raise DesignError(f"sample {sample}: give the number of runs, from 1 to {MOST_RUNS}: {method}:256")
    for of in varied:
        if isinstance(of, Range) and of.count is not None:
            raise DesignError(f"{of.key}: a sample takes its own values, not {of.count}; give FROM:TO")
    return Sample(varied, design(method, int(count), len(varied), seed))


def design(method: Literal["latin-hypercube", "sobol"] | str, runs: int, keys: int, seed: int) -> np.ndarray:
    """(N, K) numbers from 0 to 1 that fill a cube evenly; the same for the same seed. Raises DesignError."""
    from scipy.stats import qmc  # a second to load

    random = np.random.Generator(np.random.PCG64(seed))
    if method == "latin-hypercube":
        return qmc.LatinHypercube(keys, rng=random).random(runs)
    power = round(np.log2(runs))
    if 2**power != runs:
        raise DesignError(f"sobol:{runs}: such a sample is even only with a power of 2; give sobol:{2**power}")
    return qmc.Sobol(keys, rng=random).random_base2(power)


def check_analysis(over: Sequence[Range], runs: int, least: int = 1) -> None:
    """Raises DesignError for an analysis over too few ranges, or of too many runs."""
    if len(over) < least:
        raise DesignError("give two keys or more: there is nothing to compare one with")
    if runs > MOST_AT_ONCE:
        raise DesignError(f"{runs} runs are more than {MOST_AT_ONCE}: give fewer keys, samples or rounds")


def parse_varied(text: str, base: Config, road_varies: bool = False) -> Varied:
    """KEY=FROM:TO, KEY=FROM:TO:N or KEY=a,b,c. Raises DesignError.

    road_varies: the type of the road varies too, so that keys of other roads make sense.
    """
    key, equals, given = (part.strip() for part in text.partition("="))
    if not (key and equals and given):
        raise DesignError(f"{text}: give KEY=FROM:TO:N or KEY=a,b,c, such as drive.speed_kmh=10:30:5")
    parameter = _parameter(key, base, road_varies)
    found = RANGE.fullmatch(given)
    if found is None:
        if ":" in given and parameter.kind in ("number", "integer"):
            end = next((end for end in given.split(":")[:2] if not re.fullmatch(NUMBER, end)), given)
            raise DesignError(f"{text}: {end!r} is no number; give KEY=FROM:TO:N, each {parameter.allowed}")
        return Values(key, _values(given, parameter))
    if parameter.kind not in ("number", "integer"):
        raise DesignError(f"{text}: {key} has no range; give {parameter.allowed}, several with commas between them")
    low, high = (_value(number, parameter) for number in found.groups()[:2])
    assert isinstance(low, float | int)
    assert isinstance(high, float | int)
    if not low < high:
        raise DesignError(f"{text}: the range is empty; give the smaller end first, and another one behind it")
    if found[3] is None:
        return Range(key, low, high)
    if not (found[3].isascii() and found[3].isdigit() and 2 <= int(found[3]) <= MOST_RUNS):
        raise DesignError(f"{text}: {found[3]!r} is no number of values; give a whole number from 2 to {MOST_RUNS}")
    varied = Range(key, low, high, int(found[3]))
    if varied.whole and len(set(varied.steps)) < len(varied.steps):
        raise DesignError(f"{text}: there are only {int(high - low + 1)} whole numbers in the range")
    return varied


def _parameter(key: str, base: Config, road_varies: bool) -> Parameter:
    """The row of a key that may vary."""
    if key not in PARAMETER:
        raise DesignError(str(unknown_fault(key, None)))
    parameter = PARAMETER[key]
    if parameter.kind not in VARIED:
        raise DesignError(f"{key}: cannot be varied; a study varies numbers, choices and lists of numbers")
    if not road_varies:
        check_key(key, base)
    return parameter


def check_key(key: str, base: Config) -> None:
    """Raises DesignError for a key that the base's road does not have."""
    parameter = PARAMETER[key]
    if not parameter.applies_to(base.road.type):
        roads = " and ".join(parameter.roads)
        raise DesignError(f"{key}: a road of type {base.road.type} has no such key; it belongs to {roads}")


def _values(given: str, parameter: Parameter) -> tuple[Value, ...]:
    try:
        listed = parse_value(f"[{given}]")
    except ConfigError as error:
        raise DesignError(f"{parameter.key}={given}: {error}") from None
    values = tuple(_value(value, parameter) for value in listed)
    if len(set(values)) < len(values):
        raise DesignError(f"{parameter.key}={given}: a value stands there twice")
    return values


def _value(value: object, parameter: Parameter) -> Value:
    if value is None and parameter.optional:
        return None
    try:
        return convert(parameter, value)
    except (ValueError, OverflowError):
        allowed = parameter.allowed
        raise DesignError(f"{parameter.key}: {shorten(value)} is not allowed; give {allowed}") from None


def checked_figures(names: Iterable[str], base: Config) -> tuple[str, ...]:
    """The names of figures, each once; of none, all: those of the whole vehicle, then those of each wheel.

    Raises DesignError for unknown ones.
    """
    chosen = tuple(dict.fromkeys(name.strip() for name in names))
    if not chosen:
        whole = tuple(figure.name for figure in FIGURES)
        return whole + tuple(f"{figure.name}.{wheel}" for figure in FIGURES for wheel in _wheels(figure, base))
    for name in chosen:
        of, dot, wheel = name.partition(".")
        if of not in FIGURE:
            near = get_close_matches(of, FIGURE, n=1, cutoff=0.0)[0]
            raise DesignError(f"{name}: there is no such figure; the nearest one is {near}")
        wheels = _wheels(FIGURE[of], base)
        if dot and wheel not in wheels:
            of_wheels = f"give {of}.R1 … {of}.{wheels[-1]}" if wheels else f"give {of}"
            raise DesignError(f"{name}: there is no such figure; {of_wheels}")
    return chosen


def _wheels(figure: Figure, base: Config) -> list[str]:
    """The wheels that have a figure of their own."""
    if not figure.per_wheel:
        return []
    road = [f"R{k + 1}" for k in range(len(base.vehicle.road_wheels.x))]
    if figure.road_wheels_only or not base.vehicle.imaginary_wheels.enabled:
        return road
    return road + [f"I{k + 1}" for k in range(len(road) - 1)]
