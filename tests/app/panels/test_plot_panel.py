"""The tabs of plots as a browser tab is sent them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from app.panels import plot_panel
from tests.app.conftest import Tab, wait_for


def test_the_tabs_that_cost_more_follow_once_the_run_stays(explore: Any, open_tab: Any) -> None:
    tab: Tab = open_tab(explore())
    wait_for(lambda: tab.shows_run(1))
    wait_for(lambda: "Energy unaccounted for" in tab.html("Does the run obey"), "the Trust tab")
    assert len(tab.charts()) == 3 + 4 + 1
    assert tab.charts()[-1]["title"] == "Vertical acceleration: amplitude"
    assert "v/λ" in tab.html("trackride-modes")
    assert "uncomfortable" in tab.html("trackride-comfort")
    before = tab.html("trackride-map")
    tab.use("Speed, km/h", 30)
    wait_for(lambda: tab.shows_run(2))
    wait_for(lambda: tab.html("trackride-map") != before, "another load map")
    wait_for(lambda: "1.19 Hz" in tab.html("trackride-modes"), "30 km/h on waves of 7 m")


def test_only_what_is_in_front_keeps_up_with_a_drag(
    explore: Any, open_tab: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    tab: Tab = open_tab(explore())
    wait_for(lambda: "Energy unaccounted for" in tab.html("Does the run obey"), "all tabs")
    monkeypatch.setattr(plot_panel, "CALM", 1e9)
    acceleration, page = tab.charts()[3]["data"][1], tab.html("Does the run obey")
    tab.use("Speed, km/h", 30)
    wait_for(lambda: tab.shows_run(2) and np.isclose(tab.charts()[0]["data"][1][0], 30), "its loads")
    assert np.array_equal(tab.charts()[3]["data"][1], acceleration)
    tab.use("Tabs in front", "Ride,Trust")
    wait_for(lambda: np.isclose(tab.charts()[3]["data"][1].max(), 30), "its acceleration")
    wait_for(lambda: tab.html("Does the run obey") != page, "what it obeys")
    tab.use("Speed, km/h", 20)
    wait_for(lambda: tab.shows_run(3) and np.isclose(tab.charts()[3]["data"][1].max(), 20), "the next run's")
    assert np.isclose(tab.charts()[0]["data"][1][0], 30)  # behind now


def test_a_wheel_singled_out_recolours_the_curves_and_keeps_the_charts(explore: Any, open_tab: Any) -> None:
    explorer = explore()
    tab: Tab = open_tab(explorer)
    wait_for(lambda: tab.shows_run(1) and len(tab.charts()) == 8)
    charts = {uuid for uuid, widget in tab.widgets.items() if widget["type"] == "GuiUplotMessage"}
    clear = [series["stroke"] for series in tab.charts()[0]["series"][1:]]
    plots = explorer.sessions[0]._window._plots
    plots.single_out(1)
    wait_for(lambda: tab.charts()[0]["series"][1]["stroke"] != clear[0], "faded curves")
    assert tab.charts()[0]["series"][2]["stroke"] == clear[1]
    plots.single_out(None)
    wait_for(lambda: [series["stroke"] for series in tab.charts()[0]["series"][1:]] == clear, "clear curves")
    assert charts == {uuid for uuid, widget in tab.widgets.items() if widget["type"] == "GuiUplotMessage"}
