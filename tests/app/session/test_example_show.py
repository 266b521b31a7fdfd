"""An example runs in the page and is undone by one click: over viser's own protocol."""

from __future__ import annotations

import json
import re
from html import unescape
from typing import Any

import pytest

import app.session.example_show
from model.config.config_files import load_config
from tests.app.conftest import Tab, wait_for

PAPER = load_config("paper")
SPEED, DAMPING = "Speed, km/h", "Suspension damping, kN s/m"


@pytest.fixture(autouse=True)
def at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(app.session.example_show, "LEAD", 0.0)
    monkeypatch.setattr(app.session.example_show, "PACE", 0.0)


def ask(tab: Tab, kind: str, name: str = "") -> None:
    """As a button on the page does."""
    tab.use("Asked", json.dumps({"kind": kind, "content": name, "count": 1}))


def card(tab: Tab) -> str:
    """What the card of the example says at its end; empty: it is not at its end, or there is none."""
    found = re.search(r'<trackride-example name="[^"]*" says="([^"]*)" ended', tab.html("<trackride-example"))
    return unescape(found[1]) if found else ""


def opened(tab: Tab) -> str:
    """The tab that was brought to the front last."""
    return (re.findall(r'<trackride-front of="([^"]*)"', tab.html("<trackride-front")) or [""])[-1]


def test_half_the_damping_is_compared_with_the_run_before_and_undone(explore: Any, open_tab: Any) -> None:
    explorer = explore()
    tab: Tab = open_tab(explorer)
    tab.use(SPEED, 22)
    wait_for(lambda: tab.shows_run(2))
    ask(tab, "example", "Halve the damping")
    said = wait_for(lambda: card(tab), "the end of the example")
    session = explorer.sessions[0]
    assert said.startswith("The damping is half of what it was. Pitch, peak to peak: ")
    assert tab.widget(DAMPING)["value"] == pytest.approx(4.732 / 2, abs=0.001)
    assert session.shown.config == PAPER.replace(
        {"drive.speed_kmh": 22, "vehicle.road_suspension.damping": PAPER.vehicle.road_suspension.damping / 2}
    )
    assert session._workspace.baseline.config == PAPER.replace({"drive.speed_kmh": 22})
    assert opened(tab) == "Runs"
    ask(tab, "undo example")
    wait_for(lambda: session.shown.config == PAPER.replace({"drive.speed_kmh": 22}), "the run before")
    assert session._workspace.baseline is None
    wait_for(lambda: opened(tab) == "Loads", "the tab of before")
    wait_for(lambda: tab.widget(DAMPING)["value"] == 4.732, "the slider's value of before")
    assert not card(tab)
    tab.press("Undo the last change")  # the example was one step, and so is its end
    wait_for(lambda: tab.widget(DAMPING)["value"] == pytest.approx(4.732 / 2, abs=0.001), "undo of undo")


def test_the_worst_speed_is_the_one_with_the_largest_figure(explore: Any, open_tab: Any) -> None:
    explorer = explore()  # whose loads are as large as the speed
    tab: Tab = open_tab(explorer)
    wait_for(lambda: tab.shows_run(1))
    ask(tab, "example", "Find the worst speed")
    assert "Of 18 speeds, 70 km/h loads a wheel most. Peak load: " in wait_for(lambda: card(tab), "its end")
    assert explorer.sessions[0].shown.config == PAPER.replace({"drive.speed_kmh": 70})
    assert opened(tab) == "Study"


def test_an_example_leaves_the_drive_and_the_next_one_undoes_it(explore: Any, open_tab: Any) -> None:
    explorer = explore()
    tab: Tab = open_tab(explorer)
    wait_for(lambda: tab.shows_run(1))
    tab.press("Drive on and on, or back to the run")
    wait_for(lambda: "<b>Drive</b>" in tab.status)
    tab.press("Cross a half-round")
    wait_for(lambda: "climbs the half-round" in card(tab), "its end")
    session = explorer.sessions[0]
    assert session.shown.config.road.type == "half_round"
    assert tab.widget("Time scale")["value"] == "1/4×"
    tab.press("Find the worst speed")
    wait_for(lambda: "70 km/h" in card(tab), "the end of the next one")
    assert session.shown.config == PAPER.replace({"drive.speed_kmh": 70})
    assert tab.widget("Time scale")["value"] == "1×"


def test_who_takes_over_ends_it_and_can_still_undo_it(
    explore: Any, open_tab: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    explorer = explore()
    tab: Tab = open_tab(explorer)
    wait_for(lambda: tab.shows_run(1))
    monkeypatch.setattr(app.session.example_show, "LEAD", 60.0)
    ask(tab, "example", "Halve the damping")
    wait_for(lambda: "This run is now the baseline" in unescape(tab.html("<trackride-example")))
    tab.use(SPEED, 30)
    wait_for(lambda: card(tab).startswith("You have taken over"), "its end")
    ask(tab, "keep example")
    wait_for(lambda: "name=" not in tab.html("<trackride-example"), "no card")
    session = explorer.sessions[0]
    assert session.shown.config.drive.speed_kmh == 30
    assert session._workspace.baseline is not None


def test_the_tour_starts_from_the_palette(explore: Any, open_tab: Any) -> None:
    tab: Tab = open_tab(explore())
    assert 'starts="0"' in wait_for(lambda: tab.html("<trackride-tour"), "the tour")
    tab.press("Tour of the page")
    wait_for(lambda: 'starts="1"' in tab.html("<trackride-tour"), "its start")
