"""The table of figures in the tab of the runs."""

from __future__ import annotations

import re

from app.tabs.comparison import Other, comparison_table
from model.analysis.figures import FIGURE, LOAD_COEFFICIENT, WHEEL_FIGURES, comparison
from model.config.config_files import load_config
from tests.app.conftest import make_run

PAPER = load_config("paper")


def bodies(table: str) -> dict[str, tuple[str, str]]:
    """By figure: the change that it is sorted by, and its lines."""
    found = re.findall(r'<tbody data-figure="([^"]*)" data-change="([^"]*)">(.*?)</tbody>', table)
    return {figure: (change, lines) for figure, change, lines in found}


def test_each_figure_has_one_line_and_its_wheels_below() -> None:
    run, other = make_run(), make_run(PAPER.replace({"drive.speed_kmh": 30, "vehicle.road_wheels.count": 4}))
    found = bodies(comparison_table(comparison(run, other), compared=True))
    peak = found["Peak load"][1]
    assert "worst" not in peak
    assert "I5, before I3" in peak
    assert peak.count('<tr class="wheel">') == 11  # the baseline has fewer
    assert found["Pitch, peak to peak"][1].count("<tr") == 1
    assert "road wheels together" in found["Time in the air"][1]
    assert {figure.label for figure in WHEEL_FIGURES if figure is not LOAD_COEFFICIENT} <= set(found)
    rows = re.findall("<tr.*?</tr>", "".join(lines for _, lines in found.values()))
    assert all(row.count("<td") == 5 for row in rows)


def test_a_bar_leads_from_the_baseline_to_now() -> None:
    run, other = make_run(), make_run(PAPER.replace({"drive.speed_kmh": 12}))
    found = bodies(comparison_table(comparison(run, other), compared=True))
    change, lines = found["Vertical acceleration, rms"]
    assert float(change) == 25
    assert 'class="more" style="left:50%;width:25%"' in lines
    back = bodies(comparison_table(comparison(other, run), compared=True))
    assert 'class="less" style="left:30%;width:20%"' in back["Vertical acceleration, rms"][1]
    half = bodies(comparison_table(comparison(run, make_run(PAPER.replace({"drive.speed_kmh": 5}))), compared=True))
    assert 'class="more beyond" style="left:50%;width:50%"' in half["Vertical acceleration, rms"][1]


def test_what_a_figure_does_not_resolve_is_grey_and_sorted_last() -> None:
    finer = FIGURE["acceleration_rms"].share / 2
    run, other = make_run(), make_run(PAPER.replace({"drive.speed_kmh": 15 * (1 + finer)}))
    change, lines = bodies(comparison_table(comparison(run, other), compared=True))["Vertical acceleration, rms"]
    assert float(change) == 0
    assert 'class="same"' in lines
    assert "<i" not in lines


def test_without_a_baseline_there_is_only_now() -> None:
    table = comparison_table(comparison(make_run(), None), compared=False)
    assert "baseline" not in table
    assert all(
        row.count("<td") == 2 for row in re.findall("<tr.*?</tr>", "".join(b for _, b in bodies(table).values()))
    )


def test_each_run_beside_has_a_column() -> None:
    run, other = make_run(), make_run(PAPER.replace({"drive.speed_kmh": 30, "vehicle.road_wheels.count": 4}))
    beside = Other("Speed 15 → 30 km/h", "#1c6cb2", comparison(run, other))
    table = comparison_table(comparison(run, None), False, [beside])
    assert 'style="color:#1c6cb2" title="Speed 15 → 30 km/h"' in table
    peak = bodies(table)["Peak load"][1]
    cells = [re.findall("<td[^>]*>(.*?)</td>", row) for row in re.findall("<tr.*?</tr>", peak)]
    assert cells[0][1:] == ["16.1", "30.7"]
    assert cells[5][0] == "R5"
    assert cells[5][2] == "–"  # it has four road wheels
