"""One tab over viser's own protocol: no old run hides a newer one, no bad value gets in, nothing outlives the tab."""

from __future__ import annotations

import logging
import re
import time
from typing import Any

import numpy as np
import pytest

import app.session.session
from app.runs.tab_place import Place, place_text
from app.server import Explorer
from app.session.session import VIEW_RATE
from model.config.config import Config
from model.config.config_files import load_config
from model.simulation.trajectory import Trajectory
from tests.app.conftest import FakeView, Tab, make_run, pass_frames, trackride_threads, wait_for
from tests.app.runs.test_runner import Bench

PAPER = load_config("paper")
SPEED = "drive.speed_kmh"


def test_a_slider_leads_to_a_new_run_in_the_plots(explore: Any, open_tab: Any) -> None:
    tab: Tab = open_tab(explore())
    wait_for(lambda: tab.shows_run(1), "run 1")
    charts = wait_for(lambda: len(tab.charts()) >= 7 and tab.charts(), "the plots of Loads and Ride")
    assert np.isclose(charts[0]["data"][1][0], 15)
    tab.use("Speed, km/h", 22)
    wait_for(lambda: tab.shows_run(2), "run 2")
    road, imaginary, share, hull = tab.charts()[:4]
    assert np.isclose(road["data"][1][0], 22)
    assert len(road["series"]) == 1 + 6 + 1
    assert len(imaginary["series"]) == 1 + 5 + 1
    assert len(share["series"]) == 1 + 1
    assert "m/s²" in hull["axes"][1]["label"]
    assert all(np.isfinite(column).all() for chart in tab.charts() for column in chart["data"])


def series_of_loads(tab: Tab) -> list[int]:
    """How many series the charts of the loads have; others are made when there is time for them."""
    return [len(chart["series"]) for chart in tab.charts() if "load" in chart["title"].lower()]


def test_charts_are_kept_so_that_zoom_survives(explore: Any, open_tab: Any) -> None:
    tab: Tab = open_tab(explore())
    wait_for(lambda: tab.shows_run(1))
    before = {uuid for uuid, widget in tab.widgets.items() if widget["type"] == "GuiUplotMessage"}
    assert before
    tab.use("Speed, km/h", 30)
    wait_for(lambda: tab.shows_run(2))
    assert before <= {uuid for uuid, widget in tab.widgets.items() if widget["type"] == "GuiUplotMessage"}
    tab.use("Road wheels", 4)  # other curves: other charts
    wait_for(lambda: tab.shows_run(3))
    wait_for(lambda: [6, 5, 2] == series_of_loads(tab), "charts for four wheels")


def test_during_a_drag_run_numbers_only_rise_and_the_last_value_stands(explore: Any, open_tab: Any) -> None:
    tab: Tab = open_tab(explore())
    wait_for(lambda: tab.shows_run(1))
    first = len(tab.messages)
    slider = tab.find("Speed, km/h")
    for step in range(40):
        tab.send("GuiUpdateMessage", uuid=slider, updates={"value": 20 + step / 2})
        if step % 10 == 9:
            wait_for(lambda step=step: tab.shows_run(step + 2), "the run of the last value so far")
    road = tab.charts()[0]
    assert np.isclose(road["data"][1][0], 39.5)
    chart = next(uuid for uuid, widget in tab.widgets.items() if widget["props"] is road)
    loads = [
        message["updates"]["data"][1][0]
        for message in tab.messages[first:]
        if message["type"] == "GuiUpdateMessage" and message["uuid"] == chart and "data" in message["updates"]
    ]
    assert loads == sorted(loads)
    # The page says where the slider is; nobody moves it back
    assert not [
        message
        for message in tab.messages[first:]
        if message["type"] == "GuiUpdateMessage" and message["uuid"] == slider
    ]


@pytest.mark.parametrize("value", [1e9, -5.0, float("nan"), 101])
def test_a_bad_value_is_refused_with_range_and_unit(
    explore: Any, open_tab: Any, monkeypatch: pytest.MonkeyPatch, value: float
) -> None:
    monkeypatch.setattr(app.session.session, "REFUSAL_DELAY", 0.1)
    tab: Tab = open_tab(explore())
    wait_for(lambda: tab.shows_run(1))
    tab.use("Speed, km/h", 22)
    wait_for(lambda: tab.shows_run(2))
    tab.use("Speed, km/h", value)
    notice = wait_for(lambda: tab.notifications, "a notification")[-1]
    assert "Speed" in notice["body"]
    assert "0.5 to 100 km/h" in notice["body"]
    wait_for(lambda: tab.widget("Speed, km/h")["value"] == 22, "the slider's old value")
    assert tab.shows_run(2)
    assert np.isclose(tab.charts()[0]["data"][1][0], 22)
    tab.use("Speed, km/h", 23)
    wait_for(lambda: tab.shows_run(4))


@pytest.fixture
def _patient_refusal(monkeypatch: pytest.MonkeyPatch) -> None:
    """A bad value is not refused while the test lasts."""
    monkeypatch.setattr(app.session.session, "REFUSAL_DELAY", 1e9)


@pytest.mark.usefixtures("_patient_refusal")
def test_a_value_that_is_corrected_in_time_is_not_refused(explore: Any, open_tab: Any) -> None:
    """A drag can pass a bad value."""
    explorer: Explorer = explore()
    tab: Tab = open_tab(explorer)
    wait_for(lambda: tab.shows_run(1))
    tab.use("Wheel radius, m", 0.0)
    wait_for(lambda: explorer.sessions[0]._refused, "the bad value to be seen")
    tab.use("Wheel radius, m", 0.25)
    wait_for(lambda: tab.shows_run(3))
    assert explorer.sessions[0]._refused is None
    assert tab.notifications == []


def test_a_value_beyond_the_slider_but_allowed_stands(explore: Any, open_tab: Any) -> None:
    tab: Tab = open_tab(explore())
    wait_for(lambda: tab.shows_run(1))
    tab.use("Speed, km/h", 90.0)
    wait_for(lambda: tab.shows_run(2))
    wait_for(lambda: tab.widget("Speed, km/h")["props"]["max"] == 90)


def test_a_preset_and_a_reset_move_all_controls_and_run_once(explore: Any, open_tab: Any) -> None:
    tab: Tab = open_tab(explore())
    wait_for(lambda: tab.shows_run(1))
    tab.use("Preset", "Half-round obstacle")
    wait_for(lambda: tab.shows_run(2))
    wait_for(lambda: tab.widget("Road type")["value"] == "half round")
    assert tab.widget("Amplitude, mm")["props"]["disabled"]
    assert tab.widget("Obstacle height, mm")["value"] == 100
    tab.use("Obstacle height, mm", 150)
    wait_for(lambda: tab.shows_run(3))
    tab.use("Changes", "Reset")
    wait_for(lambda: tab.shows_run(4))
    wait_for(lambda: tab.widget("Obstacle height, mm")["value"] == 100)
    tab.use("Obstacle height, mm", 160)
    wait_for(lambda: tab.shows_run(5), "the next run: the controls that moved asked for none")


def test_a_diverged_run_shows_its_good_part_and_advice(explore: Any, open_tab: Any) -> None:
    def run(config: Config, **_: Any) -> Trajectory:
        if config.drive.speed_kmh == 15:
            return make_run(config)
        return make_run(config, 51, "diverged at t = 0.5 s: the step became too small", "Loosen rtol.")

    tab: Tab = open_tab(explore(run=run))
    wait_for(lambda: tab.shows_run(1))
    tab.use("Speed, km/h", 60)
    wait_for(lambda: "not complete" in tab.status)
    assert "0.5 s in" in tab.status
    notice = wait_for(lambda: tab.notifications, "a notification")[-1]
    assert "t = 0.5 s" in notice["body"]
    assert "Loosen rtol." in notice["body"]
    assert tab.charts()[0]["data"][0][-1] == pytest.approx(0.5)
    tab.use("Speed, km/h", 15)
    wait_for(lambda: tab.shows_run(3))
    wait_for(lambda: any(m["type"] == "RemoveNotificationMessage" for m in tab.messages), "the notice to go")


def test_errors_are_shown_and_logged_and_do_not_end_the_session(
    explore: Any, open_tab: Any, caplog: pytest.LogCaptureFixture
) -> None:
    class Breaking(FakeView):
        def show(self, trajectory: Trajectory) -> None:
            if trajectory.config.drive.speed_kmh == 20:
                raise RuntimeError("the view broke")
            super().show(trajectory)

    def run(config: Config, **_: Any) -> Trajectory:
        if config.drive.speed_kmh == 25:
            raise ValueError("the run broke")
        return make_run(config)

    tab: Tab = open_tab(explore(run=run, make_view=Breaking))
    wait_for(lambda: tab.shows_run(1))
    with caplog.at_level(logging.ERROR, "trackride"):
        for speed, text in ((20, "the view broke"), (25, "the run broke")):
            tab.use("Speed, km/h", speed)
            wait_for(lambda text=text: any(text in notice["body"] for notice in tab.notifications), text)
            assert text in caplog.text
        tab.use("Preset", "no such preset")
        wait_for(lambda: any("no such preset" in notice["body"] for notice in tab.notifications))
    tab.use("Speed, km/h", 30)
    wait_for(lambda: tab.shows_run(4))


def test_an_error_in_every_frame_is_told_once(explore: Any, open_tab: Any, caplog: pytest.LogCaptureFixture) -> None:
    class Breaking(FakeView):
        def draw(self, time: float) -> None:
            self.times.append(time)
            raise RuntimeError(f"cannot draw {len(self.times)}")  # another text each time

    explorer: Explorer = explore(make_view=Breaking)
    tab: Tab = open_tab(explorer)
    view: Any = wait_for(lambda: explorer.sessions, "a session")[0]._window.view
    with caplog.at_level(logging.ERROR, "trackride"):
        wait_for(lambda: len(view.times) > 5, "frames")
        wait_for(lambda: tab.notifications, "a notification")
        frames, began = len(view.times), time.monotonic()
        wait_for(lambda: len(view.times) > frames + 12, "more frames")
        assert time.monotonic() - began > 10 / VIEW_RATE  # not as fast as it can
    assert len(tab.notifications) == 1
    assert caplog.text.count("RuntimeError: cannot draw") == 1


def test_two_tabs_are_independent(explore: Any, open_tab: Any) -> None:
    explorer: Explorer = explore()
    one, other = open_tab(explorer), open_tab(explorer)
    wait_for(lambda: one.shows_run(1) and other.shows_run(1))
    one.use("Speed, km/h", 33)
    wait_for(lambda: one.shows_run(2))
    one.close()
    wait_for(lambda: len(explorer.sessions) == 1)
    assert other.widget("Speed, km/h")["value"] == 15
    assert np.isclose(other.charts()[0]["data"][1][0], 15)
    other.use("Speed, km/h", 44)
    wait_for(lambda: other.shows_run(2), "the second run of this tab")


def test_closing_the_tab_ends_its_threads_even_in_the_middle_of_a_run(explore: Any, open_tab: Any) -> None:
    bench = Bench()
    tab: Tab = open_tab(explore(run=bench))
    wait_for(lambda: bench.begun, "a run")
    wait_for(lambda: trackride_threads() == {"trackride-runner", "trackride-view"}, "both threads")
    tab.close()
    wait_for(lambda: not trackride_threads(), "the threads to end")
    assert bench.stopped == [15]


def test_playback_moves_on_and_obeys(explore: Any, open_tab: Any) -> None:
    explorer: Explorer = explore()
    tab: Tab = open_tab(explorer)
    wait_for(lambda: tab.shows_run(1))
    view = explorer.sessions[0]._window.view
    wait_for(lambda: len(view.times) > 5)
    assert len(set(view.times)) > 3
    assert view.threads == {"trackride-view"}
    tab.use("Time, s", 1.25)
    wait_for(lambda: view.times[-1] == 1.25)
    count = len(view.times)
    pass_frames(explorer)
    assert len(view.times) == count  # paused: nothing to draw
    tab.press("Ten steps on")
    wait_for(lambda: view.times[-1] == pytest.approx(1.35))
    wait_for(lambda: tab.widget("Time, s")["value"] == pytest.approx(1.35))
    tab.use("Speed, km/h", 20)  # a new run goes on at the same time
    wait_for(lambda: tab.shows_run(2))
    wait_for(lambda: view.times[-1] == pytest.approx(1.35))
    tab.press("Play or pause")
    wait_for(lambda: len(set(view.times[-3:])) == 3)
    wait_for(lambda: float(re.search(r'trackride-time" at="\[\[([\d.]+)', tab.html("trackride-time"))[1]) > 1.35)


def test_a_tab_that_nobody_looks_at_rests_until_something_happens(
    explore: Any, open_tab: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(app.session.session, "STAYS_AWAKE", 0.1)
    monkeypatch.setattr(app.session.session, "IDLE_RATE", 1e-3)  # Hz: what does not wake it comes too late
    explorer: Explorer = explore()
    tab: Tab = open_tab(explorer)
    wait_for(lambda: tab.shows_run(1))
    session = explorer.sessions[0]
    view: Any = session._window.view
    assert not session._rests  # it plays
    tab.use("In view", False)
    wait_for(lambda: session._rests, "rest")
    tab.use("Speed, km/h", 30)
    wait_for(lambda: tab.shows_run(2))
    wait_for(lambda: session._rests, "rest again")
    before = view.times[-1]
    tab.use("In view", True)
    wait_for(lambda: view.times[-1] > before, "the run to play on")
    assert view.times[-1] < before + 1  # not as if it had played all the time
    tab.press("Play or pause")
    wait_for(lambda: session._rests, "rest while it stands")
    tab.press("Play or pause")
    wait_for(lambda: not session._rests)


def test_view_switches_reach_the_scene_on_the_view_thread(explore: Any, open_tab: Any) -> None:
    explorer: Explorer = explore()
    tab: Tab = open_tab(explorer)
    wait_for(lambda: tab.shows_run(1))
    view = explorer.sessions[0]._window.view
    tab.use("Load arrows", False)
    tab.use("Look from", "Front")
    tab.press("Follow the vehicle, or not")
    wait_for(lambda: view.switches == {"arrows": False, "follow": False} and view.views == ["front"])
    wait_for(lambda: tab.widget("Follow vehicle")["value"] is False)
    light = tab.charts()[0]["series"][1]["stroke"]
    tab.use("Dark", True)
    wait_for(lambda: view.dark and tab.charts()[0]["series"][1]["stroke"] != light)


def test_a_tab_that_is_loaded_anew_stands_where_it_was_and_stores_where_it_goes(explore: Any, open_tab: Any) -> None:
    place = Place(1.25, False, (0.5, -9.0, 1.0), (0.0, 0.0, 0.75))
    explorer = explore()
    tab = open_tab(explorer, place=place_text(place))
    wait_for(lambda: tab.widget("Time, s")["value"] == 1.25, "the time")
    assert "▶ Play" in tab.widget("Playback")["props"]["options"]
    moves = {m["type"]: m for m in tab.messages if m["type"] in ("SetCameraPositionMessage", "SetCameraLookAtMessage")}
    assert tuple(moves["SetCameraPositionMessage"]["position"]) == place.position
    assert tuple(moves["SetCameraLookAtMessage"]["look_at"]) == place.look_at
    tab.use("Time, s", 1.5)
    wait_for(lambda: "&quot;time&quot;: 1.5," in tab.html("trackride-place").replace('"', "&quot;"), "the new place")


def drive_past(config: Config, **how: Any) -> Trajectory:
    run = make_run(config, samples=401)
    run.q[:, :, 0] += config.drive.speed_kmh / 3.6 * run.t[:, None]
    return run


def test_an_obstacle_that_the_user_is_led_back_to_is_marked_until_the_run_plays(explore: Any, open_tab: Any) -> None:
    explorer = explore(load_config("half_round"), "half_round", run=drive_past)
    tab: Tab = open_tab(explorer)
    wait_for(lambda: tab.shows_run(1))
    view: FakeView = explorer.sessions[0]._window.view
    tab.use("Time, s", 3.9)
    wait_for(lambda: view.times[-1] == 3.9)
    assert not view.marks_obstacle
    tab.use("Road type", "step")
    wait_for(lambda: view.marks_obstacle, "the mark")
    wait_for(lambda: view.times[-1] < 3.0, "the moment before it")
    tab.press("Play or pause")
    wait_for(lambda: not view.marks_obstacle, "the mark to go")


def test_who_changes_an_obstacle_behind_the_vehicle_is_led_back_once_it_rests(
    explore: Any, open_tab: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("app.session.session.REST", 1e9)  # nothing rests yet
    explorer = explore(load_config("half_round"), "half_round", run=drive_past)
    tab: Tab = open_tab(explorer)
    wait_for(lambda: tab.shows_run(1))
    view: FakeView = explorer.sessions[0]._window.view
    tab.use("Time, s", 3.9)
    wait_for(lambda: view.times[-1] == 3.9)
    tab.use("Speed, km/h", 22)  # the road is the same
    wait_for(lambda: tab.shows_run(2))
    for number, height in enumerate((120, 140, 160), 3):
        tab.use("Obstacle height, mm", height)
        wait_for(lambda number=number: tab.shows_run(number))
        assert not view.marks_obstacle
        assert view.times[-1] == 3.9
    monkeypatch.setattr("app.session.session.REST", 0.0)
    wait_for(lambda: view.marks_obstacle, "the mark")
    wait_for(lambda: view.times[-1] < 3.0, "the moment before it")
    wait_for(lambda: "Another obstacle" in [n["title"] for n in tab.notifications], "a word")
