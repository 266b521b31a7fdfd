"""In which unit the loads of a vehicle are told: one rule for plots, maps, tables, labels and the card."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

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


def load_unit(system: System) -> LoadUnit:
    """The unit for all loads of this vehicle."""
    return KILONEWTON if float(system.weight.sum()) > SMALL * (system.n + system.m) else NEWTON


def comparison_rows(now: Trajectory, baseline: Trajectory | None) -> list[Row]:
    """The ride figures of a run beside those of another, as `comparison` gives them, loads in the run's own unit."""
    unit = load_unit(now.system)
    return [_told_in(unit, row) for row in comparison(now, baseline)]


def heading(label: str, rows: Sequence[Row]) -> str:
    """ "Peak load, kN": a figure with the unit that it has in these rows."""
    unit = next((row.unit for row in rows if row.figure == label), "")
    return f"{label}, {unit}" if unit else label


def _told_in(unit: LoadUnit, row: Row) -> Row:
    if row.unit != LOAD_PEAK.unit:
        return row
    now, baseline = (
        None if load is None else load * KILONEWTON.newtons / unit.newtons for load in (row.now, row.baseline)
    )
    return replace(row, unit=unit.name, now=now, baseline=baseline)
