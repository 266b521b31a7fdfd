"""How the hull rides and the suspension moves: a run (and a baseline) -> plots. Pure."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from app.format.colours import Palette
from app.format.units import METRIC, Unit, Units
from app.plots.curves import Beside, Curve, Plot, time_plot, wheel_curves
from model.analysis.ride import suspension_travel
from model.simulation.trajectory import Trajectory


def ride_plots(
    run: Trajectory,
    palette: Palette,
    baseline: Trajectory | None = None,
    wheel: int | None = None,
    beside: Sequence[Beside] = (),
    units: Units = METRIC,
) -> tuple[Plot, ...]:
    """Vertical acceleration of the hull, its pitch, °, its speed, and each road wheel's travel.

    units: metric m/s², km/h and mm, or what becomes of them.
    Baseline, wheel and runs beside as in `load_plots`.
    """
    hull = [Curve("Hull", palette.hull)]
    road = wheel_curves("R", palette.road, 0, wheel if wheel is not None and wheel < run.system.n else None)
    return (
        time_plot(
            "Vertical acceleration of the hull",
            units.of("m/s²"),
            (-0.5, 0.5),
            hull,
            _acceleration,
            run,
            baseline,
            beside,
            peaks=_acceleration_peak(run),
        ),
        time_plot(
            "Pitch of the hull, nose up positive", Unit("degrees"), (-0.5, 0.5), hull, _pitch, run, baseline, beside
        ),
        time_plot("Speed", units.of("km/h"), None, hull, _speed, run, baseline, beside),
        time_plot("Suspension travel, up positive", units.of("mm"), (-5.0, 5.0), road, _travel, run, baseline, beside),
    )


def _acceleration(run: Trajectory) -> np.ndarray:
    """(N, 1), m/s²."""
    return run.a[:, run.system.chassis, 1:2]


def _acceleration_peak(run: Trajectory) -> list[tuple[float, float]]:
    """Time and value of the largest acceleration; it has the sign of the larger of the samples on both sides of it."""
    if not len(run.t):
        return []
    time, size = float(run.peaks.acceleration_time), float(run.peaks.acceleration)
    after = int(np.searchsorted(run.t, time))
    beside = _acceleration(run)[max(after - 1, 0) : after + 1, 0]
    larger = beside[np.abs(beside).argmax()] if len(beside) else 1.0
    return [(time, float(np.copysign(size, larger)))]


def _pitch(run: Trajectory) -> np.ndarray:
    """(N, 1), °."""
    return np.degrees(run.q[:, run.system.chassis, 2:3])


def _speed(run: Trajectory) -> np.ndarray:
    """(N, 1), km/h, forward."""
    return 3.6 * run.v[:, run.system.chassis, 0:1]


def _travel(run: Trajectory) -> np.ndarray:
    """(N, n), mm."""
    return 1e3 * suspension_travel(run) if len(run.t) else np.zeros((0, run.system.n))
