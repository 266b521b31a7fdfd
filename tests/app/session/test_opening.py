"""A tab from its first message until all of it is there."""

from __future__ import annotations

import json
import threading
from typing import Any

import pytest

import app.session.window
from model.config.config import Config
from model.simulation.trajectory import Trajectory
from tests.app.conftest import PATIENCE, FakeView, Tab, as_typed, make_run, wait_for


def test_what_is_not_seen_at_first_waits_until_the_page_stands(
    explore: Any, open_tab: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(app.session.window, "LAID_OUT_WITHIN", 1e9)
    explorer = explore()
    tab: Tab = open_tab(explorer, stands=False)
    wait_for(lambda: tab.shows_run(1) and tab.charts(), "the curves")
    view: FakeView = explorer.sessions[0]._window.view

    def labels() -> set[str]:
        return {as_typed(widget["props"].get("label") or "") for widget in tuple(tab.widgets.values())}

    assert {"Speed, km/h", "Preset", "Export", "Vehicle"} <= labels()
    assert "Hull mass, kg" not in labels()
    assert not view.runs
    tab.use("Tabs in front", "Loads")
    wait_for(lambda: view.runs and view.times, "the vehicle")
    tab.find("Hull mass, kg")
    tab.press("Play or pause")


def test_a_page_that_does_not_say_that_it_stands_is_taken_to(
    explore: Any, open_tab: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(app.session.window, "LAID_OUT_WITHIN", 0.2)
    explorer = explore()
    tab: Tab = open_tab(explorer, stands=False)
    wait_for(lambda: explorer.sessions and explorer.sessions[0]._window.view.times, "the vehicle")
    tab.find("Hull mass, kg")


def test_a_slider_moved_before_the_page_stands_is_not_put_back(
    explore: Any, open_tab: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(app.session.window, "LAID_OUT_WITHIN", 1e9)
    filled = threading.Event()

    def run(config: Config, **_: Any) -> Trajectory:
        if config.drive.speed_kmh == 60:
            filled.wait(PATIENCE)
        return make_run(config)

    tab: Tab = open_tab(explore(run=run), stands=False)
    wait_for(lambda: tab.shows_run(1))
    tab.use("Speed, km/h", 60)
    tab.use("Tabs in front", "Loads")
    tab.find("Hull mass, kg")
    filled.set()
    wait_for(lambda: tab.shows_run(2))
    tab.use("Speed, km/h", 15)  # which would be nothing new, had it been put back
    wait_for(lambda: tab.shows_run(3))


def test_what_is_asked_for_while_the_window_is_being_built_is_kept(explore: Any, open_tab: Any) -> None:
    asked = threading.Event()

    def make_view(client: Any, dark: bool) -> FakeView:
        assert asked.wait(PATIENCE)
        return FakeView(client, dark)

    def run(config: Config, **_: Any) -> Trajectory:
        if (config.drive.speed_kmh, config.value("road.amplitude")) == (60, 0.12):
            asked.set()
        return make_run(config)

    tab: Tab = open_tab(explore(preset="half_round", run=run, make_view=make_view))
    tab.use("Preset", "Paper vehicle")
    tab.use("Speed, km/h", 60)
    tab.use("Typed", json.dumps([tab.find("Amplitude, mm"), "120", 1]))
    wait_for(lambda: tab.shows_run(4))
    wait_for(lambda: tab.widget("Amplitude, mm")["value"] == 120)
    assert tab.notifications == []
