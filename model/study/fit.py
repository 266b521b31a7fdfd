"""Values of keys with which a run comes nearest to a measured vertical acceleration, and how sure they are.

The record may begin at any time and its sensor may be off by a constant: measured(t) = simulated(t − lag) + offset.
Both are compared in the same band. Points spread over the ranges are tried first; least squares go on from a few.
Intervals come from the slopes there and from what is left; where that is no noise but follows from one sample to the
next, fewer samples count.

The lag is where a run, made larger or smaller, explains most of the record's energy. The least difference would not do:
of a run that is not right yet, its quiet end lies nearer to the record than its obstacle.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from model.analysis.signals import CENTRE_OF_MASS, Point, point_acceleration
from model.config.config import Config, ConfigError
from model.config.parameters import Value
from model.config.validation import shorten
from model.dynamics.equilibrium import NoEquilibriumError
from model.simulation.batch import in_order
from model.simulation.simulate import simulate_motion, warm_up
from model.study.design import DesignError, Range, design

if TYPE_CHECKING:
    from scipy.optimize import OptimizeResult

G = 9.80665  # m/s²
TIMES = {"s": 1.0, "sec": 1.0, "ms": 1e-3}
ACCELERATIONS = {"m/s^2": 1.0, "m/s2": 1.0, "m/s²": 1.0, "g": G, "mm/s^2": 1e-3, "ft/s^2": 0.3048}
HEADING = re.compile(r"\s*(.*?)\s*(?:[\[(]\s*([^\])]*?)\s*[\])])?\s*")
FEWEST = 20  # samples of a record
SPREAD = 16  # points tried first, for each key
STARTS = 3  # of them that least squares go on from
NUDGE = 4e-3  # of a range: over which slopes are taken
EDGE = 5e-3  # of a range: so near to its end a value lies at the end
SLACK = 0.2  # s by which the lag may still move after a guess
MOVES = 4  # as often the guess is made anew where the lag would move further
OVERLAP = 0.5  # of the record or the run that must be compared
LARGER = 2.0  # times as large as it is a run may be made to find its lag
ALIKE = 0.5  # of the best run's explained energy that a run must reach to be a start
BAND = 0.4  # of the slower sample rate: what both can hold
CONFIDENCE = 0.95

Signal = tuple[np.ndarray, np.ndarray]  # t (N,), s, and a (N,), m/s²
Runs = Callable[[Sequence[Mapping[str, Value]]], list[Signal | None]]  # what each run measures; None: it has no end


@dataclass(frozen=True)
class Estimate:
    """A value and the ends of its interval at CONFIDENCE."""

    value: float
    low: float
    high: float


@dataclass(frozen=True)
class Fit:
    """What was found."""

    keys: tuple[str, ...]
    estimates: tuple[Estimate, ...]  # of the keys, in the unit of the file
    lag: Estimate  # s
    offset: Estimate  # m/s²
    at_end: tuple[bool, ...]  # which values lie at an end of their range
    t: np.ndarray  # (N,) s, of the record, where both are known
    measured: np.ndarray  # (N,) m/s²
    fitted: np.ndarray  # (N,) m/s², with offset
    before: np.ndarray | None  # (N,) of the base, laid over the record as well as may be
    rms: float  # m/s², of what is left
    rms_before: float | None
    low_pass: float | None  # Hz, above which nothing was compared
    samples: float  # as many independent ones what is left is worth
    runs: int

    @property
    def explained(self) -> float:
        """Part of the record's energy that the fitted run explains, 1 at best; negative: it is worse than no motion."""
        energy = float(np.var(self.measured))
        return 1 - self.rms**2 / energy if energy > 0 else 0.0

    @property
    def changes(self) -> dict[str, Value]:
        """The values found."""
        return {key: estimate.value for key, estimate in zip(self.keys, self.estimates, strict=True)}


def read_record(text: str, columns: Sequence[str] = ()) -> Signal:
    """Time and vertical acceleration of a CSV file, with names and units in its heading: "t [s], a [m/s^2]".

    columns: names of both; left out, the first column and the first whose name holds "acc" or is "a". Lines that begin
    with # are left out. Raises DesignError.
    """
    lines = [line for line in text.lstrip("\ufeff").splitlines() if line.strip() and not line.startswith("#")]
    if not lines:
        raise DesignError("holds no lines")
    separator = ";" if ";" in lines[0] else "\t" if "\t" in lines[0] else ","
    headings = [HEADING.fullmatch(cell) for cell in lines[0].split(separator)]
    names = [found[1] if found else "" for found in headings]
    units = [(found[2] or "") if found else "" for found in headings]
    if all(re.fullmatch(r"[-+.\deE]+", name) for name in names):
        raise DesignError("begins with numbers; give a heading with units, such as: t [s],a [m/s^2]")
    time, acceleration = _columns(names, columns)
    scale = []
    for column, known in ((time, TIMES), (acceleration, ACCELERATIONS)):
        unit = units[column].replace("**", "^")
        if unit not in known:
            said = f"has the unit {unit!r}" if unit else "has no unit"
            allowed = ", ".join(known)
            raise DesignError(f"column {shorten(names[column])} {said}; give one of {allowed}: t [s],a [m/s^2]")
        scale.append(known[unit])
    rows = []
    for number, line in enumerate(lines[1:], 2):
        cells = line.split(separator)
        try:
            rows.append((float(cells[time]), float(cells[acceleration])))
        except (ValueError, IndexError):
            raise DesignError(
                f"line {number} below the comments: {line[:60]!r} has no number in both columns"
            ) from None
    t, a = np.array(rows, dtype=float).reshape(-1, 2).T * np.array(scale)[:, None]
    if len(t) < FEWEST:
        raise DesignError(f"has {len(t)} samples; {FEWEST} or more are needed")
    if not np.isfinite(a).all() or not (np.diff(t) > 0).all():
        raise DesignError("time must grow from line to line, and all numbers must be finite")
    return t, a


def _columns(names: Sequence[str], wanted: Sequence[str]) -> tuple[int, int]:
    """Where time and acceleration stand."""
    if wanted:
        if len(wanted) != 2 or not set(wanted) <= set(names):
            raise DesignError(f"has the columns {', '.join(names)}; name that of time and that of acceleration")
        return names.index(wanted[0]), names.index(wanted[1])
    found = next((k for k, name in enumerate(names) if k and (name.lower() == "a" or "acc" in name.lower())), None)
    if found is None:
        raise DesignError(f"has the columns {', '.join(names)}; none is named a or acceleration: name both")
    return 0, found


def fit(
    base: Config,
    record: Signal,
    over: Sequence[Range],
    low_pass: float | None = None,
    at: Point = CENTRE_OF_MASS,
    seed: int = 0,
    spread: Callable[[Callable[..., object], Iterable[object]], Iterable[object]] = in_order,
) -> Fit:
    """Fit keys to a record; low_pass: Hz, above which nothing is compared; at: the sensor's place in the hull.

    The base's road and speed must be those of the record. Where run and record have different sample rates, nothing
    above what both can hold is compared.
    Raises DesignError where run and record hardly overlap, or nothing can be run.
    """

    def runs(changes: Sequence[Mapping[str, Value]]) -> list[Signal | None]:
        warm_up(base.simulation.integrator)
        return list(spread(partial(_measured, base, at), changes))  # type: ignore[arg-type]

    return fit_runs(runs, record, over, low_pass, seed)


@dataclass(frozen=True, eq=False)
class Overlay:
    """A run laid over a record as well as may be: simulated(t − lag) + offset beside measured(t)."""

    t: np.ndarray  # (N,) s, of the record, where both are known
    measured: np.ndarray  # (N,) m/s²
    simulated: np.ndarray  # (N,) m/s², with offset
    lag: float  # s
    offset: float  # m/s²

    @property
    def rms(self) -> float:
        """m/s², of what is left."""
        return float(np.sqrt(np.mean((self.simulated - self.measured) ** 2)))


def laid_over(base: Config, record: Signal, low_pass: float | None = None, at: Point = CENTRE_OF_MASS) -> Overlay:
    """A configuration's run over a record; low_pass and at as for `fit`. Raises DesignError where that cannot be."""
    signal = _measured(base, at, {})
    if signal is None:
        raise DesignError("the run did not come to its end")
    problem = _Problem(lambda _: [], record, (), low_pass)
    signal = problem.in_band(signal)
    guess = problem.guess(signal)
    if guess is None:
        raise DesignError("run and record last too differently; let the run last about as long")
    t, a, lag = *problem.record, guess.lag
    within = (t - lag >= signal[0][0]) & (t - lag <= signal[0][-1])
    t, a = t[within], a[within]
    simulated = np.interp(t - lag, *signal)
    offset = float(np.mean(a - simulated))
    return Overlay(t, a, simulated + offset, lag, offset)


def _measured(base: Config, at: Point, changes: Mapping[str, Value]) -> Signal | None:
    """What a sensor in the hull measures in a run."""
    try:
        run = simulate_motion(base.replace(changes))
    except (ConfigError, NoEquilibriumError):
        return None
    return (run.t, point_acceleration(run, at)[:, 1]) if run.complete else None


def fit_runs(runs: Runs, record: Signal, over: Sequence[Range], low_pass: float | None = None, seed: int = 0) -> Fit:
    """The same with anything that makes signals of values."""
    from scipy.stats import t as student

    problem = _Problem(runs, record, over, low_pass)
    found = problem.best(design("latin-hypercube", SPREAD * len(over), len(over), seed))
    left, slopes = found.fun, problem.slopes(found.x)
    samples = max(len(left) / _repetition(left), len(found.x) + 1.0)
    freedom = samples - len(found.x) if samples - len(found.x) >= 1 else 1.0
    variance = float(left @ left) / len(left) * samples / freedom
    covariance = np.linalg.pinv(slopes.T @ slopes * samples / len(left)) * variance
    reach = float(student.ppf((1 + CONFIDENCE) / 2, freedom)) * np.sqrt(np.diag(covariance))
    estimates = [
        _estimate(of.low + value * (of.high - of.low), within * (of.high - of.low))
        for of, value, within in zip(over, found.x, reach, strict=False)
    ]
    ends = [bool(value < EDGE or value > 1 - EDGE) for value in found.x[: len(over)]]
    before = problem.before()
    return Fit(
        keys=tuple(of.key for of in over),
        estimates=tuple(estimates),
        lag=_estimate(found.x[-2], reach[-2]),
        offset=_estimate(found.x[-1], reach[-1]),
        at_end=tuple(ends),
        t=problem.t,
        measured=problem.a,
        fitted=problem.a + left,
        before=before,
        rms=float(np.sqrt(np.mean(left**2))),
        rms_before=None if before is None else float(np.sqrt(np.mean((before - problem.a) ** 2))),
        low_pass=problem.low_pass,
        samples=samples,
        runs=problem.count,
    )


def _estimate(value: float, reach: float) -> Estimate:
    return Estimate(float(value), float(value - reach), float(value + reach))


class _Guess(NamedTuple):
    """How a run may lie over the record."""

    explained: float  # of the record's sum of squares, by the run made larger or smaller
    left: float  # of that sum, by the run as it is
    lag: float  # s


class _Problem:
    """What is left of the record at points x: a value of each key, 0…1 of its range, the lag, s, the offset, m/s²."""

    def __init__(self, runs: Runs, record: Signal, over: Sequence[Range], low_pass: float | None) -> None:
        self.runs, self.record, self.over, self.low_pass = runs, record, over, low_pass
        self.t, self.a = record
        self.count = 0
        self._band_known = False
        self._known: dict[tuple[float, ...], Signal | None] = {}

    def signals(self, points: np.ndarray) -> list[Signal | None]:
        """What is measured at points (N, K), low-passed."""
        keys = [tuple(map(float, point)) for point in points]
        new = [key for key in dict.fromkeys(keys) if key not in self._known]
        changes = [{of.key: of.at(part) for of, part in zip(self.over, key, strict=True)} for key in new]
        for key, signal in zip(new, self.runs(changes), strict=True):
            self._known[key] = None if signal is None else self.in_band(signal)
        self.count += len(new)
        return [self._known[key] for key in keys]

    def before(self) -> np.ndarray | None:
        """What the base measures where the record is compared, with the best lag and offset for it."""
        signal = self.runs([{}])[0]
        self.count += 1
        if signal is None:
            return None
        signal = self.in_band(signal)
        guess = self.guess(signal)
        if guess is None:
            return None
        value = np.interp(self.t - guess.lag, *signal)
        return value + np.mean(self.a - value)

    def in_band(self, signal: Signal) -> Signal:
        """A run's signal in the band in which it is compared; the first one settles the band."""
        if not self._band_known:
            self._band_known = True
            self.low_pass = _band(self.low_pass, signal, self.record)
            self.t, self.a = self.record = _filtered(self.record, self.low_pass)
        return _filtered(signal, self.low_pass)

    def guess(self, signal: Signal | None) -> _Guess | None:
        """The lag at which a run explains most of the record; None where too little overlaps.

        The part of the record without a run is not explained: or quiet parts of both would fit best.
        """
        if signal is None:
            return None
        step = min(np.diff(signal[0]).mean(), np.diff(self.record[0]).mean())
        run = np.interp(np.arange(signal[0][0], signal[0][-1], step), *signal)
        record = np.interp(np.arange(self.record[0][0], self.record[0][-1], step), *self.record)
        record -= record.mean()
        # For each shift, sums over the samples that overlap
        ones_run, ones = np.ones_like(run), np.ones_like(record)
        count = np.rint(_correlated(ones, ones_run))
        enough = count >= OVERLAP * min(len(run), len(record))
        if not enough.any():
            return None
        count = np.maximum(count, 1)
        sum_run, sum_record = _correlated(ones, run), _correlated(record, ones_run)
        product = _correlated(record, run) - sum_record * sum_run / count
        square = np.maximum(_correlated(ones, run**2) - sum_run**2 / count, 0)
        times = np.clip(product / np.maximum(square, 1e-9), 0, LARGER)
        explained = np.where(enough, 2 * times * product - times**2 * square, -np.inf)
        best = int(explained.argmax())
        left = record @ record - 2 * product[best] + square[best] - sum_record[best] ** 2 / count[best]
        lag = self.record[0][0] - signal[0][0] + (best - (len(run) - 1)) * step
        return _Guess(float(explained[best]), float(left), float(lag))

    def best(self, points: np.ndarray) -> OptimizeResult:
        """The least squares from the best few of points (N, K), each 0…1 of its range. Raises DesignError."""
        guesses = [(guess, k) for k, signal in enumerate(self.signals(points)) if (guess := self.guess(signal))]
        if not guesses:
            raise DesignError(
                "no run lies over the record: none came to its end, or run and record last too differently"
            )
        most = max(guess.explained for guess, _ in guesses)
        if most <= 0:
            raise DesignError(
                "no run resembles the record: give its road and speed, and see that up is positive in the record"
            )
        alike = [(guess.left, k, guess.lag) for guess, k in guesses if guess.explained >= ALIKE * most]
        found = [self._solved(points[k], lag) for _, k, lag in sorted(alike)[:STARTS]]
        least = min(found, key=lambda each: self._all_left(*each))
        self.choose(least[1])
        return least[0]

    def _solved(self, point: np.ndarray, lag: float) -> tuple[OptimizeResult, float]:
        """Least squares from a point, and the lag about which its own may move."""
        from scipy.optimize import least_squares

        keys = len(point)
        for _ in range(MOVES):
            self.choose(lag)
            x = np.array([*point, lag, self.offset(point, lag)])
            low = np.array([*np.zeros(keys), lag - SLACK, -np.inf])
            high = np.array([*np.ones(keys), lag + SLACK, np.inf])
            found = least_squares(self.left, np.clip(x, low, high), self.slopes, (low, high), x_scale="jac", xtol=1e-6)
            about, point, lag = lag, found.x[:keys], float(found.x[keys])
            if abs(lag - about) < 0.9 * SLACK:
                break
        return found, about

    def _all_left(self, found: OptimizeResult, about: float) -> float:
        """What is left of the whole record, with the part that was not compared."""
        self.choose(about)
        t, a = self.record
        aside = (t < self.t[0]) | (t > self.t[-1])
        return float(found.fun @ found.fun + np.sum((a[aside] - a.mean()) ** 2))

    def choose(self, lag: float) -> None:
        """Compare only where run and record overlap, whatever the lag may become."""
        signal = next(signal for signal in self._known.values() if signal is not None)
        t, a = self.record
        within = (t - lag - SLACK >= signal[0][0]) & (t - lag + SLACK <= signal[0][-1])
        if within.sum() < FEWEST:
            raise DesignError("run and record hardly overlap; let the run last longer")
        self.t, self.a = t[within], a[within]

    def offset(self, point: np.ndarray, lag: float) -> float:
        """The best offset at a point."""
        return float(-np.mean(self.left(np.array([*point, lag, 0.0]))))

    def left(self, x: np.ndarray) -> np.ndarray:
        """(N,) m/s²; of a run without an end, as much as if nothing moved, and more."""
        return self._at(self.signals(x[None, :-2])[0], x[-2], x[-1])

    def slopes(self, x: np.ndarray) -> np.ndarray:
        """(N, K + 2) how it changes with x: all runs at once."""
        keys = len(x) - 2
        steps = np.where(x[:keys] > 0.5, -NUDGE, NUDGE)
        signals = self.signals(np.concatenate([x[None, :keys], x[:keys] + np.diag(steps)]))
        here = self._at(signals[0], x[-2], x[-1])
        columns = [(self._at(signals[k + 1], x[-2], x[-1]) - here) / steps[k] for k in range(keys)]
        tick = 1e-4
        later, sooner = (self._at(signals[0], x[-2] + way, x[-1]) for way in (tick, -tick))
        return np.column_stack([*columns, (later - sooner) / (2 * tick), np.ones(len(here))])

    def _at(self, signal: Signal | None, lag: float, offset: float) -> np.ndarray:
        from scipy.interpolate import CubicSpline

        if signal is None:
            return 3 * np.abs(self.a) + 1.0
        return CubicSpline(*signal)(self.t - lag) + offset - self.a


def _correlated(fixed: np.ndarray, moved: np.ndarray) -> np.ndarray:
    """Σ fixed[n + shift] moved[n] for all shifts, from −(len(moved) − 1) on."""
    from scipy.signal import correlate

    return correlate(fixed, moved, mode="full", method="fft")


def _band(low_pass: float | None, signal: Signal, record: Signal) -> float | None:
    """Hz up to which both are compared: as asked for, but no more than both can hold. None: both have one rate."""
    rates = [(len(t) - 1) / (t[-1] - t[0]) for t, _ in (signal, record)]
    highest = BAND * min(rates)
    if low_pass is not None:
        return min(low_pass, highest)
    return None if max(rates) < 1.01 * min(rates) else highest


def _filtered(signal: Signal, low_pass: float | None) -> Signal:
    """Without what is above that many Hz, and without a shift in time."""
    if low_pass is None:
        return signal
    from scipy.signal import butter, sosfiltfilt

    t, a = signal
    even = np.linspace(t[0], t[-1], len(t))
    rate = (len(t) - 1) / (t[-1] - t[0])
    return even, sosfiltfilt(butter(4, low_pass, fs=rate, output="sos"), np.interp(even, t, a))


def _repetition(left: np.ndarray) -> float:
    """How many samples of what is left are worth one: 1 of white noise, more where it follows from one to the next."""
    left = left - left.mean()
    total = float(left @ left)
    if total == 0:
        return 1.0
    correlation = _correlated(left, left)[len(left) - 1 :] / total
    significant = 2 / np.sqrt(len(left))
    below = np.flatnonzero(correlation < significant)
    return float(1 + 2 * correlation[1 : below[0]].sum()) if len(below) else float(len(left))
