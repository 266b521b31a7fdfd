"""The table of figures in the tab of the runs."""

from __future__ import annotations

import re

from app.tabs.comparison import comparison_table
from model.analysis.figures import comparison
from model.config.config import load_config
from tests.app.conftest import make_run

PAPER = load_config("paper")


def test_the_table_of_figures() -> None:
    run, other = make_run(), make_run(PAPER.replace({"drive.speed_kmh": 30, "vehicle.road_wheels.count": 4}))
    table = comparison_table(comparison(run, other), compared=True)
    words = re.sub("<[^>]*>", " ", table).split()
    assert words.count("baseline") == 1 + 2 + 2 + 1
    assert "Whole" in words
    rows = re.findall("<tr>(.*?)</tr>", table)
    assert all(len(re.findall("<t[dh]", row)) in (2, 3, 4, 7) for row in rows)
    assert sum(row.startswith("<td>R5") for row in rows) == 3  # the baseline has no such wheel
    assert "baseline" not in comparison_table(comparison(run, None), compared=False)
