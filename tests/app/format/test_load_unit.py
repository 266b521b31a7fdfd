"""Loads are told in a unit in which they can be read, in the same one everywhere."""

from __future__ import annotations

import re

import pytest
from matplotlib.text import Text

from app.format.colours import wheel_palette
from app.format.load_unit import KILONEWTON, NEWTON, comparison_rows, heading, load_unit
from app.panels.view_panel import load_scale
from app.panels.wheel_card import card
from app.plots.curves import load_plots
from app.reports.run_report import report_page
from app.reports.sheet import compose
from app.tabs.comparison import comparison_table
from app.tabs.load_map import load_map
from app.tabs.trust import trust_html
from app.view3d.labels import load_text
from model import load_config, simulate
from model.analysis.figures import LOAD_PEAK, comparison
from model.analysis.wheel_contact import wheel_state
from model.dynamics.vehicle import build_system
from model.simulation.trajectory import Trajectory


@pytest.fixture(scope="module")
def robot() -> Trajectory:
    return simulate(load_config("robot").replace({"simulation.duration": 2}))


@pytest.mark.parametrize("preset", ["paper", "m113", "marder"])
def test_the_loads_of_heavy_vehicles_are_told_in_kilonewtons(preset: str) -> None:
    assert load_unit(build_system(load_config(preset))) is KILONEWTON


def test_the_loads_of_a_robot_are_told_in_newtons_wherever_they_stand(robot: Trajectory) -> None:
    unit = load_unit(robot.system)
    assert unit is NEWTON
    road, imaginary, _ = load_plots(robot, wheel_palette(robot.system.n, robot.system.m))
    assert road.unit == imaginary.unit == "N"
    assert road.values[:, 0].max() == pytest.approx(robot.normal_load[:, 0].max(), abs=0.05)
    assert "Normal load of road wheels, N<" in load_map(robot)
    assert re.search(r"weight 2\d\d\.\d N;", trust_html(robot))
    load = robot.normal_load[-1, 0]
    assert f"<b>{load:.1f} N</b>" in card(wheel_state(robot, 0, robot.t[-1]), "#123456", unit)
    assert load_text(load, unit).strip() == f"{load:.1f}"
    assert re.findall(r">(\d+)</span>", load_scale(65.0, unit)) == ["0", "10", "20", "30", "40", "50", "60"]
    words = [text.get_text() for text in compose(robot, None, None, "A robot").figure.findobj(Text)]
    assert {"Normal load of road wheels, N", "Peak load, N"} <= set(words)
    assert "Peak load, N<" in report_page(robot, "robot")
    table = comparison_table(comparison_rows(robot, None), compared=False)
    for page in (table, load_map(robot), trust_html(robot), load_scale(65.0, unit)):
        assert " kN" not in page


def test_a_baseline_is_told_in_the_unit_of_the_run_beside_it(robot: Trajectory) -> None:
    paper = simulate(load_config("paper").replace({"simulation.duration": 2}))
    rows = {(row.figure, row.wheel): row for row in comparison_rows(paper, robot)}
    peak = rows[LOAD_PEAK.label, "R1"]
    assert peak.unit == "kN"
    assert peak.baseline == pytest.approx(robot.peaks.load[0] / 1e3)
    other = next(row for row in comparison_rows(robot, paper) if (row.figure, row.wheel) == (LOAD_PEAK.label, "R1"))
    assert (other.unit, other.baseline) == ("N", pytest.approx(paper.peaks.load[0]))
    before = {(row.figure, row.wheel): row.change for row in comparison(robot, paper)}
    assert other.change == before[LOAD_PEAK.label, "R1"]
    assert heading(LOAD_PEAK.label, [other]) == "Peak load, N"


def test_a_load_with_its_unit_has_no_minus_before_zero() -> None:
    assert NEWTON.text(-0.01) == "0.0 N"
    assert KILONEWTON.text(-1234.0) == "−1.23 kN"
