"""One tab: the newest request wins, no old run hides a newer one, no bad value gets in, nothing outlives the tab."""

from __future__ import annotations

import logging
import re
import threading
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import app.session.session
from app.runs.request import Failed, Finished, Outcome, Refused, Request, first_request
from app.runs.runner import Runner
from app.server import Explorer
from model.config.config import Config, load_config
from model.dynamics.equilibrium import NoEquilibriumError
from model.simulation.trajectory import Trajectory
from tests.app.conftest import FakeView, Tab, make_run, simulate_at_once, trackride_threads, wait_for

PAPER = load_config("paper")
SPEED = "drive.speed_kmh"


class Bench:
    """Runs that end when they are told to."""

    def __init__(self, part_done: float = 0.0) -> None:
        self.begun: list[float] = []  # speeds
        self.stopped: list[float] = []
        self.part_done = part_done
        self.go_on = threading.Event()

    def __call__(
        self, config: Config, *, on_progress: Callable[[float], None], should_stop: Callable[[], bool]
    ) -> Trajectory:
        self.begun.append(config.drive.speed_kmh)
        on_progress(self.part_done)
        while not self.go_on.wait(0.002):
            if should_stop():
                self.stopped.append(config.drive.speed_kmh)
                return make_run(config, status="cancelled")
        return make_run(config)


def start(run: Any, first: Config = PAPER) -> tuple[Runner, list[Exception]]:
    errors: list[Exception] = []
    return Runner(Request(first), run, lambda: None, errors.append), errors


def faster(speed: Any) -> Callable[[Request], Request]:
    return lambda request: request.changed(SPEED, speed)


def outcome_of(runner: Runner) -> Outcome:
    return wait_for(lambda: runner.take(), "an outcome")[0]


def test_requests_that_nobody_has_begun_are_replaced() -> None:
    bench = Bench(part_done=0.9)
    runner, _ = start(bench)
    wait_for(lambda: bench.begun, "the first run")
    for speed in range(20, 30):
        runner.change(faster(speed))
    bench.go_on.set()
    finished = wait_for(
        lambda: [o for o in runner.take() if isinstance(o, Finished) and o.request.number == 11], "the last request"
    )[0]
    runner.close()
    assert bench.begun == [15, 29]
    assert bench.stopped == []  # nearly done, so it was let finish
    assert finished.trajectory.config.drive.speed_kmh == 29


def test_a_newer_request_stops_a_run_that_has_far_to_go_and_hides_it() -> None:
    bench = Bench()
    bench.go_on.set()
    runner, _ = start(bench)
    outcome_of(runner)
    bench.go_on.clear()
    runner.change(faster(20))
    wait_for(lambda: 20 in bench.begun, "the second run")
    runner.change(faster(30))
    wait_for(lambda: 30 in bench.begun, "the third run")
    assert bench.stopped == [20]
    bench.go_on.set()
    assert outcome_of(runner).request.changes == {SPEED: 30}
    runner.close()


def test_a_long_drag_still_shows_something() -> None:
    """Requests that come faster than runs end do not stop every run."""

    def slow(config: Config, *, on_progress: Any, should_stop: Any) -> Trajectory:
        for part in range(1, 13):
            time.sleep(0.01)
            on_progress(part / 12)
            if should_stop():
                return make_run(config, status="cancelled")
        return make_run(config)

    runner, _ = start(slow)
    shown = []
    end = time.monotonic() + 1.5
    while time.monotonic() < end:
        runner.change(faster(10 + len(shown)))
        shown += [outcome.request.number for outcome in runner.take()]
        time.sleep(0.03)
    runner.close()
    assert len(shown) >= 3
    assert shown == sorted(shown)


def test_a_refusal_does_not_hide_the_run_before_it() -> None:
    runner, _ = start(simulate_at_once)
    wait_for(lambda: runner.under_way() is None and runner._outcomes)
    runner.change(faster(-3))
    outcomes: list[Outcome] = []
    wait_for(lambda: len(outcomes) == 2 or outcomes.extend(runner.take() if len(runner._outcomes) == 2 else []))
    runner.close()
    assert [type(outcome) for outcome in outcomes] == [Finished, Refused]


def test_what_cannot_stand_at_rest_fails_with_its_message_and_the_next_request_runs() -> None:
    def run(config: Config, **_: Any) -> Trajectory:
        if config.drive.speed_kmh == 20:
            raise NoEquilibriumError("springs too soft")
        if config.drive.speed_kmh == 25:
            raise ZeroDivisionError("a mistake of ours")
        return make_run(config)

    runner, errors = start(run)
    outcome_of(runner)
    runner.change(faster(20))
    assert outcome_of(runner) == Failed(runner.latest, "springs too soft")
    runner.change(faster(25))
    wait_for(lambda: errors, "the error")
    runner.change(faster(30))
    assert isinstance(outcome_of(runner), Finished)
    runner.close()
    assert [type(error) for error in errors] == [ZeroDivisionError]


def test_a_request_is_not_withdrawn_when_there_is_a_newer_one() -> None:
    runner, _ = start(simulate_at_once)
    good = outcome_of(runner).request
    runner.change(faster(-1))
    refused = outcome_of(runner).request
    runner.change(faster(40))
    assert not runner.withdraw(refused, good)
    assert runner.latest.changes == {SPEED: 40}
    runner.close()


def test_contradicting_changes_drop_out() -> None:
    suspension = "vehicle.imaginary_suspension"
    request = Request(PAPER).changed(f"{suspension}.preload_deflection", 0.2)
    request = request.changed(f"{suspension}.preload_force", 500.0)
    assert request.config().vehicle.imaginary_suspension.preload_force == 500
    request = request.changed(f"{suspension}.preload_deflection", 0.15)
    assert request.config().vehicle.imaginary_suspension.preload_force is None
    request = Request(PAPER).changed("road.amplitude", 0.2).changed("road.type", "flat")
    assert request.config().road.type == "flat"
    assert request.changed("road.type", "sine").config().road == PAPER.road


def test_a_configuration_is_a_preset_with_changes() -> None:
    config = PAPER.replace({SPEED: 22})
    assert first_request(PAPER, config).changes == {SPEED: 22}
    other = load_config("half_round")
    assert first_request(PAPER, other).config() == other


# With a tab, over viser's own protocol


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
    wait_for(lambda: [len(chart["series"]) for chart in tab.charts()[:3]] == [6, 5, 2], "charts for four wheels")


def test_during_a_drag_run_numbers_only_rise_and_the_last_value_stands(explore: Any, open_tab: Any) -> None:
    tab: Tab = open_tab(explore())
    wait_for(lambda: tab.shows_run(1))
    first = len(tab.messages)
    slider = tab.find("Speed, km/h")
    for step in range(40):
        tab.send("GuiUpdateMessage", uuid=slider, updates={"value": 20 + step / 2})
        time.sleep(0.005)
    wait_for(lambda: tab.shows_run(41), "the last run")
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


def test_a_value_that_is_corrected_in_time_is_not_refused(explore: Any, open_tab: Any) -> None:
    """Typing 0.25 passes 0."""
    tab: Tab = open_tab(explore())
    wait_for(lambda: tab.shows_run(1))
    tab.use("Wheel radius, m", 0.0)
    time.sleep(0.1)
    tab.use("Wheel radius, m", 0.25)
    wait_for(lambda: tab.shows_run(3))
    assert tab.notifications == []


def test_what_the_page_moves_to_the_sliders_end_is_not_a_request(explore: Any, open_tab: Any) -> None:
    """The page puts a typed 500 to the slider's end, 70, when the box loses the focus."""
    tab: Tab = open_tab(explore())
    wait_for(lambda: tab.shows_run(1))
    tab.use("Speed, km/h", 500.0)
    time.sleep(0.1)
    tab.use("Speed, km/h", 70.0)
    wait_for(lambda: tab.notifications, "a notification at once")
    wait_for(lambda: tab.widget("Speed, km/h")["value"] == 15)
    assert tab.shows_run(1)


def test_an_allowed_value_stays_when_the_page_moves_the_slider_to_its_end(explore: Any, open_tab: Any) -> None:
    bench = Bench(part_done=1.0)
    bench.go_on.set()
    tab: Tab = open_tab(explore(run=bench))
    wait_for(lambda: tab.shows_run(1))
    bench.go_on.clear()
    tab.use("Speed, km/h", 90.0)
    tab.use("Speed, km/h", 70.0)
    wait_for(lambda: bench.begun[-1] == 90)
    bench.go_on.set()
    wait_for(lambda: tab.shows_run(2))
    wait_for(lambda: tab.widget("Speed, km/h")["value"] == 90)
    assert bench.begun == [15, 90]
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
    tab.use("Parameters", "Reset")
    wait_for(lambda: tab.shows_run(4))
    wait_for(lambda: tab.widget("Obstacle height, mm")["value"] == 100)
    time.sleep(0.2)
    assert tab.shows_run(4)


def test_a_diverged_run_shows_its_good_part_and_advice(explore: Any, open_tab: Any) -> None:
    def run(config: Config, **_: Any) -> Trajectory:
        if config.drive.speed_kmh == 15:
            return make_run(config)
        return make_run(config, 51, "diverged at t = 0.5 s: the step became too small", "Loosen rtol.")

    tab: Tab = open_tab(explore(run=run))
    wait_for(lambda: tab.shows_run(1))
    tab.use("Speed, km/h", 60)
    wait_for(lambda: "stopped early" in tab.status)
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
                raise RuntimeError("the scene broke")
            super().show(trajectory)

    def run(config: Config, **_: Any) -> Trajectory:
        if config.drive.speed_kmh == 25:
            raise ValueError("the run broke")
        return make_run(config)

    tab: Tab = open_tab(explore(run=run, make_view=Breaking))
    wait_for(lambda: tab.shows_run(1))
    with caplog.at_level(logging.ERROR, "trackride"):
        for speed, text in ((20, "the scene broke"), (25, "the run broke")):
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
            raise RuntimeError("cannot draw")

    explorer: Explorer = explore(make_view=Breaking)
    tab: Tab = open_tab(explorer)
    scene: Any = wait_for(lambda: explorer.sessions, "a session")[0]._window.view
    with caplog.at_level(logging.ERROR, "trackride"):
        wait_for(lambda: len(scene.times) > 5, "frames")
        wait_for(lambda: tab.notifications, "a notification")
    frames = len(scene.times)
    time.sleep(0.5)
    assert len(scene.times) - frames < 25  # at the view's rate, not as fast as it can
    assert len(tab.notifications) == 1
    assert caplog.text.count("RuntimeError: cannot draw") == 1


def test_two_tabs_are_independent(explore: Any, open_tab: Any) -> None:
    explorer: Explorer = explore()
    one, other = open_tab(explorer), open_tab(explorer)
    wait_for(lambda: one.shows_run(1) and other.shows_run(1))
    one.use("Speed, km/h", 33)
    wait_for(lambda: one.shows_run(2))
    time.sleep(0.2)
    assert other.shows_run(1)
    assert other.widget("Speed, km/h")["value"] == 15
    assert np.isclose(other.charts()[0]["data"][1][0], 15)
    one.close()
    wait_for(lambda: len(explorer.sessions) == 1)
    other.use("Speed, km/h", 44)
    wait_for(lambda: other.shows_run(2))


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
    scene = explorer.sessions[0]._window.view
    wait_for(lambda: len(scene.times) > 5)
    assert len(set(scene.times)) > 3
    assert scene.threads == {"trackride-view"}
    tab.use("Time, s", 1.25)
    wait_for(lambda: scene.times[-1] == 1.25)
    count = len(scene.times)
    time.sleep(0.15)
    assert len(scene.times) == count  # paused: nothing to draw
    tab.press("Ten steps on")
    wait_for(lambda: scene.times[-1] == pytest.approx(1.35))
    wait_for(lambda: tab.widget("Time, s")["value"] == pytest.approx(1.35))
    tab.use("Speed, km/h", 20)  # a new run goes on at the same time
    wait_for(lambda: tab.shows_run(2))
    wait_for(lambda: scene.times[-1] == pytest.approx(1.35))
    tab.press("Play or pause")
    wait_for(lambda: len(set(scene.times[-3:])) == 3)
    wait_for(lambda: float(re.search(r"trackride-time' at='\[\[([\d.]+)", tab.html("trackride-time"))[1]) > 1.35)


def test_view_switches_reach_the_scene_on_the_view_thread(explore: Any, open_tab: Any) -> None:
    explorer: Explorer = explore()
    tab: Tab = open_tab(explorer)
    wait_for(lambda: tab.shows_run(1))
    scene = explorer.sessions[0]._window.view
    tab.use("Load arrows", False)
    tab.use("Look from", "Front")
    tab.press("Follow the vehicle, or not")
    wait_for(lambda: not scene.show_arrows and not scene.follow and scene.views == ["front"])
    wait_for(lambda: tab.widget("Follow vehicle")["value"] is False)
    light = tab.charts()[0]["series"][1]["stroke"]
    tab.use("Dark", True)
    wait_for(lambda: scene.dark and tab.charts()[0]["series"][1]["stroke"] != light)
