"""In which units the loads of a vehicle, and the figures of its runs, are told.

One rule for plots, maps, tables, labels and the card.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from app.format.units import METRIC, POUND_FORCE, Unit, Units
from model.analysis.figures import LOAD_PEAK, Row, comparison
from model.dynamics.vehicle import System
from model.simulation.trajectory import Trajectory

SMALL = 500.0  # N on a wheel at rest, on average: in kN the loads of such a vehicle would be mostly zeros


class LoadUnit(NamedTuple):
    """A unit of force, and with how many decimals loads are told in it."""

    name: str
    newtons: float
    decimals: int

    def of(self, newtons: np.ndarray) -> np.ndarray:
        """Forces in this unit."""
        return newtons / self.newtons

    def text(self, newtons: float) -> str:
        """A force with its unit: "8.82 kN"."""
        number = round(newtons / self.newtons, self.decimals) + 0.0  # no minus before zero
        return f"{number:.{self.decimals}f} {self.name}".replace("-", "−")


KILONEWTON, NEWTON = LoadUnit("kN", 1e3, 2), LoadUnit("N", 1.0, 1)
POUNDS, FEW_POUNDS = LoadUnit("lbf", POUND_FORCE, 0), LoadUnit("lbf", POUND_FORCE, 2)


def load_unit(system: System, units: Units = METRIC) -> LoadUnit:
    """The unit for all loads of this vehicle."""
    large, small = (KILONEWTON, NEWTON) if units.force == METRIC.force else (POUNDS, FEW_POUNDS)
    return large if float(system.weight.sum()) > SMALL * (system.n + system.m) else small


def comparison_rows(now: Trajectory, baseline: Trajectory | None, units: Units = METRIC) -> list[Row]:
    """The ride figures of a run beside those of another, as `comparison` gives them, loads in the run's own unit."""
    unit = load_unit(now.system, units)
    return [told_row(row, unit, units) for row in comparison(now, baseline)]


def heading(label: str, rows: Sequence[Row]) -> str:
    """ "Peak load, kN": a figure with the unit that it has in these rows."""
    unit = next((row.unit for row in rows if row.figure == label), "")
    return f"{label}, {unit}" if unit else label


def figure_unit(unit: str, loads: LoadUnit, units: Units) -> Unit:
    """What the unit of a figure is told in."""
    return Unit(loads.name, KILONEWTON.newtons / loads.newtons) if unit == LOAD_PEAK.unit else units.of(unit)


def told_row(row: Row, loads: LoadUnit, units: Units) -> Row:
    """A figure in the units in which it is told."""
    unit = figure_unit(row.unit, loads, units)
    now, baseline = (None if value is None else value * unit.factor for value in (row.now, row.baseline))
    return replace(row, unit=unit.name, now=now, baseline=baseline, resolution=row.resolution * unit.factor)
