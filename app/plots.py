"""What the plots show, without a plot: a run (and a baseline) -> named curves, thinned to what pixels show."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from model.trajectory import Trajectory

BUCKETS = 500  # stretches of time, each drawn by its smallest and its largest value: more than a plot is wide
DECIMALS = 2  # of the values that are plotted and read
BEYOND = 1.0  # how far outside its 0…1 scale the time cursor starts and ends, so that only its upright shows


@dataclass(frozen=True)
class Curve:
    """One line of a plot."""

    label: str
    colour: str  # CSS
    baseline: bool = False  # of the run compared with: drawn pale and dashed


@dataclass(frozen=True)
class Plot:
    """Curves over one time axis."""

    title: str
    unit: str
    curves: tuple[Curve, ...]
    least: tuple[float, float]  # range of the unit that is always in view
    time: np.ndarray  # (K,) s, rising
    values: np.ndarray  # (K, curves), in the unit

    @property
    def layout(self) -> tuple[str, str, tuple[Curve, ...]]:
        """All that is not data: plots with the same layout differ in their data only."""
        return self.title, self.unit, self.curves


def load_plots(
    run: Trajectory, colours: Sequence[str], hull_colour: str, baseline: Trajectory | None = None
) -> tuple[Plot, ...]:
    """Normal load of road wheels and of imaginary wheels, kN, and vertical acceleration of the hull, m/s².

    colours: one for each wheel of the run, road wheels first. A vehicle without imaginary wheels has no plot of
    theirs. A baseline adds its curves, one for each wheel that the run has too.
    """
    n, m = run.system.n, run.system.m
    plots = []
    for title, unit, least, names, shades, values in (
        ("Normal load of road wheels", "kN", (0.0, 1.0), _names("R", n), colours[:n], _road_loads),
        ("Normal load of imaginary wheels", "kN", (0.0, 1.0), _names("I", m), colours[n:], _imaginary_loads),
        ("Vertical acceleration of the hull", "m/s²", (-0.5, 0.5), ["Hull"], [hull_colour], _acceleration),
    ):
        if names:
            curves = [Curve(name, shade) for name, shade in zip(names, shades, strict=True)]
            columns = values(run)
            if baseline is not None:
                other = values(baseline)[:, : len(names)].T
                curves += [Curve(curve.label, curve.colour, baseline=True) for curve in curves[: len(other)]]
                columns = np.column_stack([columns, *(np.interp(run.t, baseline.t, column) for column in other)])
            time, columns = thin(run.t, columns)
            plots.append(Plot(title, unit, tuple(curves), least, time, np.round(columns, DECIMALS)))
    return tuple(plots)


def _names(letter: str, count: int) -> list[str]:
    return [f"{letter}{i + 1}" for i in range(count)]


def _road_loads(run: Trajectory) -> np.ndarray:
    """(N, n), kN."""
    return run.normal_load[:, : run.system.n] / 1e3


def _imaginary_loads(run: Trajectory) -> np.ndarray:
    """(N, m), kN."""
    return run.normal_load[:, run.system.n :] / 1e3


def _acceleration(run: Trajectory) -> np.ndarray:
    """(N, 1), m/s²."""
    return run.a[:, run.system.chassis, 1:2]


def thin(time: np.ndarray, values: np.ndarray, buckets: int = BUCKETS) -> tuple[np.ndarray, np.ndarray]:
    """(K,) times and (K, C) values with K ≤ 2·buckets that look like the (N,) and (N, C) given.

    Each bucket of samples leaves two: of every column the smallest and the largest value, in the order in which they
    came, so that no peak is lost. They stand at the bucket's first and last time. Samples that are not finite are
    left out.
    """
    finite = np.isfinite(values).all(axis=1)
    time, values = time[finite], values[finite]
    count = len(time)
    if count <= 2 * buckets:
        return time, values
    size = -(-count // buckets)
    full = -(-count // size)
    # The last bucket is filled up with the last sample.
    index = np.minimum(np.arange(full * size), count - 1).reshape(full, size)
    bucketed = values[index]  # (full, size, C)
    first_is_low = bucketed.argmin(axis=1) <= bucketed.argmax(axis=1)
    low, high = bucketed.min(axis=1), bucketed.max(axis=1)
    pairs = np.stack([np.where(first_is_low, low, high), np.where(first_is_low, high, low)], axis=1)
    return time[index[:, [0, -1]]].ravel(), pairs.reshape(2 * full, -1)


def with_cursor(plot: Plot, time: float) -> tuple[np.ndarray, ...]:
    """Data for uPlot: times, one array for each curve, and the time cursor's.

    The cursor is a curve on a scale of its own, 0…1: below it everywhere but at `time`, where it runs upright through
    the whole plot. The other curves are interpolated there.
    """
    if not len(plot.time):
        empty = np.zeros(1)
        return (empty, *(empty for _ in plot.curves), empty - BEYOND)
    time = float(np.clip(time, plot.time[0], plot.time[-1]))
    at = int(np.searchsorted(plot.time, time))
    before = max(at - 1, 0)
    step = plot.time[min(at, len(plot.time) - 1)] - plot.time[before]
    part = (time - plot.time[before]) / step if step > 0 else 0.0
    here = (1 - part) * plot.values[before] + part * plot.values[min(at, len(plot.time) - 1)]
    columns = np.insert(plot.values, [at] * 3, here, axis=0).T
    cursor = np.full(columns.shape[1], -BEYOND)
    cursor[at + 1] = 1 + BEYOND
    return (np.insert(plot.time, [at] * 3, time), *np.ascontiguousarray(columns), cursor)
