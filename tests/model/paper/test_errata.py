"""The numbers in the errata are what the model gives."""

from __future__ import annotations

from model.analysis.modes import vehicle_modes
from model.paper.errata import ERRATA
from tests.model.support import IMAGINARY, PAPER, ROAD_SPRING


def test_bounce_with_table_1_read_in_each_way():
    as_torsion = [{}, {f"{ROAD_SPRING}.basis": "torsion"}]
    as_torsion.append({**as_torsion[1], f"{IMAGINARY}.basis": "torsion"})
    at_wheel, road, both = (vehicle_modes(PAPER.replace(change)).bounce.frequency for change in as_torsion)
    reading = next(erratum.reading for erratum in ERRATA if erratum.where == "Table 1, torsion bars")
    assert f"bounces at {at_wheel:.2f} Hz" in reading
    assert f"would bounce at {road:.2f} Hz, or at {both:.2f} Hz" in reading
