"""Values of keys with which a run comes nearest to a measured vertical acceleration, and how sure they are.

The record may begin at any time and its sensor may be off by a constant: measured(t) = simulated(t − lag) + offset.
Points spread over the ranges are tried first; least squares go on from the best. Intervals come from the slopes there
and from what is left; where that is no noise but follows from one sample to the next, fewer samples count.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from model.analysis.signals import CENTRE_OF_MASS, Point, point_acceleration
from model.config.config import Config, ConfigError
from model.config.parameters import Value
from model.dynamics.equilibrium import NoEquilibriumError
from model.simulation.batch import in_order
from model.simulation.simulate import simulate_motion, warm_up
from model.study.design import DesignError, Range, design

G = 9.80665  # m/s²
TIMES = {"s": 1.0, "sec": 1.0, "ms": 1e-3}
ACCELERATIONS = {"m/s^2": 1.0, "m/s2": 1.0, "m/s²": 1.0, "g": G, "mm/s^2": 1e-3, "ft/s^2": 0.3048}
HEADING = re.compile(r"\s*(.*?)\s*(?:[\[(]\s*([^\])]*?)\s*[\])])?\s*")
FEWEST = 20  # samples of a record
SPREAD = 16  # points tried first, for each key
NUDGE = 1e-3  # of a range: over which slopes are taken
SLACK = 0.2  # s by which the lag may still move after the first guess
OVERLAP = 0.5  # of the record or the run that must be compared
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
    samples: float  # as many independent ones what is left is worth
    runs: int

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
            raise DesignError(
                f"column {names[column]!r} {said}; give one of {allowed}: {names[column]} [{next(iter(known))}]"
            )
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

    Raises DesignError where run and record hardly overlap, or nothing can be run.
    """

    def runs(changes: Sequence[Mapping[str, Value]]) -> list[Signal | None]:
        warm_up(base.simulation.integrator)
        return list(spread(partial(_measured, base, at), changes))  # type: ignore[arg-type]

    return fit_runs(runs, record, over, low_pass, seed)


def _measured(base: Config, at: Point, changes: Mapping[str, Value]) -> Signal | None:
    """What a sensor in the hull measures in a run."""
    try:
        run = simulate_motion(base.replace(changes))
    except (ConfigError, NoEquilibriumError):
        return None
    return (run.t, point_acceleration(run, at)[:, 1]) if run.complete else None


def fit_runs(runs: Runs, record: Signal, over: Sequence[Range], low_pass: float | None = None, seed: int = 0) -> Fit:
    """The same with anything that makes signals of values."""
    from scipy.optimize import least_squares
    from scipy.stats import t as student

    problem = _Problem(runs, _filtered(record, low_pass), over, low_pass)
    start = design("latin-hypercube", SPREAD * len(over), len(over), seed)
    guesses = [problem.guess(signal) for signal in problem.signals(start)]
    known = [(error, k, lag) for k, guess in enumerate(guesses) if guess is not None for error, lag in (guess,)]
    if not known:
        raise DesignError("no run lies over the record: none came to its end, or run and record last too differently")
    _, best, lag = min(known)
    problem.choose(lag)
    x = np.array([*start[best], lag, problem.offset(start[best], lag)])
    low = np.array([*np.zeros(len(over)), lag - SLACK, -np.inf])
    high = np.array([*np.ones(len(over)), lag + SLACK, np.inf])
    found = least_squares(problem.left, np.clip(x, low, high), problem.slopes, (low, high), x_scale="jac", xtol=1e-6)
    left, slopes = found.fun, problem.slopes(found.x)
    samples = max(len(left) / _repetition(left), len(x) + 1.0)
    freedom = samples - len(x) if samples - len(x) >= 1 else 1.0
    variance = float(left @ left) / len(left) * samples / freedom
    covariance = np.linalg.pinv(slopes.T @ slopes * samples / len(left)) * variance
    reach = float(student.ppf((1 + CONFIDENCE) / 2, freedom)) * np.sqrt(np.diag(covariance))
    estimates = [
        _estimate(of.low + value * (of.high - of.low), within * (of.high - of.low))
        for of, value, within in zip(over, found.x, reach, strict=False)
    ]
    ends = [bool(value < NUDGE or value > 1 - NUDGE) for value in found.x[: len(over)]]
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
        samples=samples,
        runs=problem.count,
    )


def _estimate(value: float, reach: float) -> Estimate:
    return Estimate(float(value), float(value - reach), float(value + reach))


class _Problem:
    """What is left of the record at points x: a value of each key, 0…1 of its range, the lag, s, the offset, m/s²."""

    def __init__(self, runs: Runs, record: Signal, over: Sequence[Range], low_pass: float | None) -> None:
        self.runs, self.record, self.over, self.low_pass = runs, record, over, low_pass
        self.t, self.a = record
        self.count = 0
        self._known: dict[tuple[float, ...], Signal | None] = {}

    def signals(self, points: np.ndarray) -> list[Signal | None]:
        """What is measured at points (N, K), low-passed."""
        keys = [tuple(map(float, point)) for point in points]
        new = [key for key in dict.fromkeys(keys) if key not in self._known]
        changes = [{of.key: of.at(part) for of, part in zip(self.over, key, strict=True)} for key in new]
        for key, signal in zip(new, self.runs(changes), strict=True):
            self._known[key] = None if signal is None else _filtered(signal, self.low_pass)
        self.count += len(new)
        return [self._known[key] for key in keys]

    def before(self) -> np.ndarray | None:
        """What the base measures where the record is compared, with the best lag and offset for it."""
        signal = self.runs([{}])[0]
        self.count += 1
        if signal is None:
            return None
        signal = _filtered(signal, self.low_pass)
        guess = self.guess(signal)
        if guess is None:
            return None
        value = np.interp(self.t - guess[1], *signal)
        return value + np.mean(self.a - value)

    def guess(self, signal: Signal | None) -> tuple[float, float] | None:
        """Mean square of what is left at the best lag, and that lag; None where too little overlaps.

        Of the record's part without a run all is left: or quiet parts of both would fit best.
        """
        if signal is None:
            return None
        step = min(np.diff(signal[0]).mean(), np.diff(self.record[0]).mean())
        run = np.interp(np.arange(signal[0][0], signal[0][-1], step), *signal)
        record = np.interp(np.arange(self.record[0][0], self.record[0][-1], step), *self.record)
        # For each shift, sums over the samples that overlap
        ones_run, ones = np.ones_like(run), np.ones_like(record)
        count = np.rint(_correlated(ones, ones_run))
        enough = count >= OVERLAP * min(len(run), len(record))
        if not enough.any():
            return None
        count = np.maximum(count, 1)
        difference = (_correlated(record, ones_run) - _correlated(ones, run)) / count
        square = _correlated(record**2, ones_run) + _correlated(ones, run**2) - 2 * _correlated(record, run)
        aside = (record - record.mean()) ** 2
        aside = aside.sum() - _correlated(aside, ones_run)
        error = np.where(enough, square - difference**2 * count + aside, np.inf) / len(record)
        shift = int(error.argmin()) - (len(run) - 1)
        return float(error.min()), float(self.record[0][0] - signal[0][0] + shift * step)

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


def _filtered(signal: Signal, low_pass: float | None) -> Signal:
    """Without what is above that many Hz, and without a shift in time."""
    if low_pass is None:
        return signal
    from scipy.signal import butter, sosfiltfilt

    t, a = signal
    even = np.linspace(t[0], t[-1], len(t))
    rate = (len(t) - 1) / (t[-1] - t[0])
    if low_pass >= 0.45 * rate:
        return signal
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
