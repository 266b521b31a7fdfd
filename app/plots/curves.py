"""The curves that the plots show: a run (and a baseline) -> named curves, thinned to what pixels show. Pure."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Literal

import numpy as np

from app.format.colours import Palette
from app.format.load_unit import LoadUnit, load_unit
from app.format.units import FINER, METRIC, Unit, Units
from app.plots.thinning import thin
from model.analysis.ride import imaginary_shares
from model.simulation.trajectory import Trajectory

DECIMALS = 2  # of the values that are plotted, and FINER; the page shows no more (plots.js)
OTHER_SIZE = 10.0  # times the weight on a wheel, from which on loads of two vehicles share no axis
TIME = "Time, s"


@dataclass(frozen=True)
class Curve:
    """One line of a plot."""

    label: str
    colour: str  # CSS
    kind: Literal["run", "baseline", "static", "beside"] = "run"  # of this run, its baseline, at rest, a run beside it
    wheel: int | None = None  # in the model's order; None: of the whole vehicle
    faded: bool = False  # another wheel is singled out


@dataclass(frozen=True, eq=False)
class Beside:
    """A kept run that is shown beside the present one."""

    name: str
    colour: str  # CSS
    run: Trajectory


@dataclass(frozen=True)
class Peak:
    """The largest value of a curve of the run, which may lie between its samples."""

    curve: int  # its number in the plot
    time: float  # s
    value: float  # in the plot's unit


@dataclass(frozen=True)
class Plot:
    """Curves over one axis."""

    title: str
    unit: str
    curves: tuple[Curve, ...]
    least: tuple[float, float] | None  # range of the unit that is always in view
    x: np.ndarray = field(compare=False)  # (K,) rising, in the axis's unit
    values: np.ndarray = field(compare=False)  # (K, curves), in the unit; NaN where a baseline has ended
    axis: str = TIME
    peaks: tuple[Peak, ...] = field(default=(), compare=False)
    note: str = ""  # said beside the title
    logarithmic: bool = False  # its x, which has no 0 then

    @property
    def data(self) -> tuple[np.ndarray, ...]:
        """For uPlot: x and one array for each curve; at least one point."""
        if not len(self.x):
            return tuple(np.zeros((1 + len(self.curves), 1)))
        return (self.x, *np.ascontiguousarray(self.values.T))


def load_plots(
    run: Trajectory,
    palette: Palette,
    baseline: Trajectory | None = None,
    wheel: int | None = None,
    beside: Sequence[Beside] = (),
    units: Units = METRIC,
) -> tuple[Plot, ...]:
    """Normal load of road wheels and of imaginary wheels, in the vehicle's unit, and the imaginary ones' share, %.

    A baseline adds its curves, one for each wheel that the run has too; a note says where it is of another size (see
    `beside_loads`). A wheel that is singled out leaves the others faded. A dotted line marks the load at rest: of that
    wheel, or the wheels' mean. A vehicle without imaginary wheels has no plots of theirs. Each wheel's largest load
    during the motion is a peak of its curve. Of each run beside there is one curve: of the wheel that is singled
    out, or of the largest load of the family.
    """
    n, m = run.system.n, run.system.m
    unit = load_unit(run.system, units)
    compared = beside_loads(run, baseline)
    others = [other for other in beside if beside_loads(run, other.run) is not None]
    note = "" if compared is baseline else "baseline: other size"
    families = [("Normal load of road wheels", wheel_curves("R", palette.road, 0, wheel), partial(_road_loads, unit))]
    if m:
        imaginary = wheel_curves("I", palette.imaginary, n, wheel)
        families += [("Normal load of imaginary wheels", imaginary, partial(_other_loads, unit))]
    plots = [
        time_plot(
            title,
            Unit(unit.name),
            (0.0, _wheel_weight(run) / unit.newtons),
            curves,
            values,
            run,
            compared,
            others,
            at_rest=_at_rest(run, unit, curves, palette.hull),
            peaks=_load_peaks(unit, run, curves),
            note=note,
        )
        for title, curves, values in families
    ]
    if m:
        share = [Curve("Share", palette.hull)]
        plots += [
            time_plot("Load carried by imaginary wheels", Unit("%"), (0.0, 1.0), share, _share, run, baseline, beside)
        ]
    return tuple(plots)


def beside_loads(run: Trajectory, baseline: Trajectory | None) -> Trajectory | None:
    """The baseline, unless its vehicle is so much heavier or lighter that loads of one of both would lie flat."""
    if baseline is None or not 1 / OTHER_SIZE < _wheel_weight(baseline) / _wheel_weight(run) < OTHER_SIZE:
        return None
    return baseline


def _wheel_weight(run: Trajectory) -> float:
    """N, of an even share of the weight on each wheel."""
    return float(run.system.weight.sum()) / (run.system.n + run.system.m)


def wheel_curves(letter: str, colours: Sequence[str], first: int, single: int | None) -> list[Curve]:
    """A curve for each wheel of a family whose first is number `first`; faded when another wheel is singled out."""
    return [
        Curve(f"{letter}{i + 1}", colour, wheel=first + i, faded=single not in (None, first + i))
        for i, colour in enumerate(colours)
    ]


def time_plot(
    title: str,
    unit: Unit,
    least: tuple[float, float] | None,
    curves: list[Curve],
    values: Callable[[Trajectory], np.ndarray],
    run: Trajectory,
    baseline: Trajectory | None = None,
    beside: Sequence[Beside] = (),
    at_rest: tuple[float, Curve] | None = None,
    peaks: Sequence[tuple[float, float]] = (),
    note: str = "",
) -> Plot:
    """A plot over time. values: run -> (N, C), a column for each curve; at_rest: a dotted line and its height.

    unit: in which values, heights and peaks are told. peaks: time and value of each curve's peak, in the curves'
    order; those outside of the run's samples are left out.
    """
    shown = values(run)
    columns, finite, own = [shown], np.isfinite(shown), curves
    if baseline is not None and len(baseline.t):
        others = values(baseline)[:, : len(curves)]
        curves = curves + [
            Curve(curve.label, curve.colour, "baseline", curve.wheel, curve.faded)
            for curve in curves[: others.shape[1]]
        ]
        columns += [at_times(run.t, baseline.t, others)]
    for other in beside:
        if len(other.run.t) and (single := _largest(values(other.run), own)) is not None:
            curves = [*curves, Curve(other.name, other.colour, "beside")]
            columns += [at_times(run.t, other.run.t, single)]
    time, thinned = run.t, np.hstack(columns) if len(columns) > 1 else shown
    if not finite.all():
        samples = finite.all(axis=1)
        time, thinned = time[samples], thinned[samples]
    time, thinned = thin(time, thinned)
    if at_rest is not None:
        height, line = at_rest
        curves = [*curves, line]
        thinned = np.vstack([thinned.T, np.full(len(time), height)]).T
    decimals = DECIMALS + FINER.get(unit.name, 0)
    marked = tuple(
        Peak(k, float(at), round(float(value) * unit.factor, decimals))
        for k, (at, value) in enumerate(peaks)
        if len(time) and time[0] <= at <= time[-1]
    )
    shown = np.round(thinned * unit.factor, decimals)
    in_view = None if least is None else (least[0] * unit.factor, least[1] * unit.factor)
    return Plot(title, unit.name, tuple(curves), in_view, time, shown, peaks=marked, note=note)


def _largest(values: np.ndarray, curves: Sequence[Curve]) -> np.ndarray | None:
    """(N, 1) the curve that is singled out, or the largest of all; None where another vehicle has no such wheel."""
    clear = [k for k, curve in enumerate(curves) if not curve.faded]
    if len(clear) == 1 < len(curves):
        return values[:, clear] if clear[0] < values.shape[1] else None
    return values.max(axis=1, keepdims=True) if values.shape[1] else None


def at_times(t: np.ndarray, own: np.ndarray, values: np.ndarray) -> np.ndarray:
    """(N, C) values of another run, sampled at `own` times, at times t; NaN after its end."""
    if np.array_equal(t, own):
        return values
    columns = np.column_stack([np.interp(t, own, column) for column in values.T])
    columns[t > own[-1]] = np.nan
    return columns


def _at_rest(run: Trajectory, unit: LoadUnit, curves: list[Curve], colour: str) -> tuple[float, Curve]:
    """Load at rest of the family's wheel that is singled out, in its colour, or the wheels' mean in `colour`."""
    clear = [curve for curve in curves if not curve.faded]
    loads = [run.static_load[curve.wheel] for curve in clear or curves if curve.wheel is not None]
    shade = clear[0].colour if len(clear) == 1 else colour
    return float(np.mean(loads)) / unit.newtons, Curve("at rest", shade, "static", faded=not clear)


def _road_loads(unit: LoadUnit, run: Trajectory) -> np.ndarray:
    """(N, n)."""
    return unit.of(run.normal_load[:, : run.system.n])


def _other_loads(unit: LoadUnit, run: Trajectory) -> np.ndarray:
    """(N, m)."""
    return unit.of(run.normal_load[:, run.system.n :])


def _load_peaks(unit: LoadUnit, run: Trajectory, curves: Sequence[Curve]) -> list[tuple[float, float]]:
    """Time and value of each wheel's largest load."""
    if not len(run.t):
        return []
    wheels = [curve.wheel for curve in curves if curve.wheel is not None]
    return list(zip(run.peaks.load_time[wheels], unit.of(run.peaks.load[wheels]), strict=True))


def _share(run: Trajectory) -> np.ndarray:
    """(N, 1), % of all wheels' load; 0 with all in the air."""
    return 100 * imaginary_shares(run.normal_load, run.system.n)[:, None]
