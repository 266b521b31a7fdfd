"""The endless drive: in step with real time however long it lasts, slower rather than behind, following each change."""

from __future__ import annotations

import gc
import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import app.runs.runner
from app.panels.playback_panel import driven_text
from app.runs.drive import ALIGNED, FRAME, LONGEST_FRAME, PLOTTED, Driver, Pace, aligned
from app.runs.playback import Playback
from app.runs.request import Driven, Failed, Finished, Refused, Request
from app.runs.runner import Runner
from model.analysis.wheel_contact import penetration
from model.config.config import Config
from model.config.config_files import load_config
from model.dynamics.equilibrium import NoEquilibriumError
from model.road.road import Road
from model.simulation.drive import LiveDrive
from model.simulation.integrate import Status
from model.simulation.trajectory import Trajectory
from tests.app.conftest import FakeView, Tab, make_run, pass_frames, simulate_at_once, trackride_threads, wait_for

PAPER = load_config("paper")
SPEED = "drive.speed_kmh"


class Clock:
    """Real time that passes as it is told to, and `each` s whenever somebody looks."""

    def __init__(self, each: float = 0.0) -> None:
        self.now, self.each = 0.0, each

    def __call__(self) -> float:
        self.now += self.each
        return self.now


# Pace


def test_time_passes_as_fast_as_asked_for() -> None:
    pace = Pace()
    for k in range(1, 61):
        target = pace.move_on(FRAME, 4.0)
        pace.reached(k * FRAME, target + 0.003)  # steps of the integration end a little later
    assert target == pytest.approx(60 * FRAME * 4)
    assert pace.factor == pytest.approx(4.0)


def test_what_was_not_reached_is_let_go_and_shows_in_the_factor() -> None:
    pace, time = Pace(), 0.0
    for k in range(1, 61):
        target = pace.move_on(FRAME, 8.0)
        time = min(target, time + FRAME * 2)  # a machine that manages twice real time
        pace.reached(k * FRAME, time)
    assert pace.target == time
    assert pace.factor == pytest.approx(2.0)


def test_a_hitch_is_not_made_up_for() -> None:
    pace = Pace()
    assert pace.move_on(20.0, 1.0) == LONGEST_FRAME


# Driver


def test_an_hour_at_eight_times_real_time_neither_drifts_nor_grows() -> None:
    """Almost three minutes of it here; the whole hour is measured by `python -m tests.benchmarks.drive`."""
    clock = Clock()
    driver = Driver(PAPER.replace({SPEED: 30}), clock)
    sizes, objects = [], []
    frames = 210
    for k in range(frames):
        clock.now += 0.1
        state = driver.frame(8.0)
        if k % 70 == 69:
            gc.collect()
            sizes.append(len(state.past.t))
            objects.append(len(gc.get_objects()))
    assert state.time == pytest.approx(0.8 * (frames - 1) + 8 * FRAME, abs=0.01)
    assert state.factor == pytest.approx(8.0, rel=0.01)
    assert state.distance == pytest.approx(30 / 3.6 * state.time, rel=0.02)
    assert abs(state.recent.q[-1, 0, 0]) < 1100  # the origin moves along
    assert max(sizes) <= (PLOTTED + 2) * 200
    assert objects[-1] - objects[0] < 500
    assert state.past.constraint_residual.max() < 1e-5
    assert state.ended == ""


def test_a_machine_that_cannot_keep_up_drives_slower_with_frames_that_stay_short() -> None:
    clock = Clock(each=0.01)
    driver = Driver(PAPER, clock)
    durations = []
    for _ in range(100):
        before = clock.now
        state = driver.frame(8.0)
        durations.append(clock.now - before)
    assert max(durations) < 0.08
    assert 0 < state.time < 0.5 * clock.now * 8
    assert state.factor == pytest.approx(state.time / clock.now, rel=0.2)


def test_the_past_to_plot_is_made_ten_times_a_second_and_begins_on_the_grid() -> None:
    clock = Clock()
    driver = Driver(PAPER, clock)
    pasts: list[Trajectory] = []
    for _ in range(int(14 / FRAME)):
        clock.now += FRAME
        state = driver.frame(1.0)
        if not pasts or state.past is not pasts[-1]:
            pasts.append(state.past)
    assert len(pasts) == pytest.approx(14 / 0.1, rel=0.3)
    last = pasts[-1]
    assert round(last.t[0] * 200) % ALIGNED == 0
    assert last.t[-1] - last.t[0] == pytest.approx(PLOTTED, abs=0.25)
    assert len(last.normal_load) == len(last.t) == len(last.q)
    assert state.recent.t[-1] >= state.time - 0.005
    assert len(state.recent.t) < 60


def test_a_short_run_is_left_whole() -> None:
    run = make_run(samples=12)
    assert aligned(run) is run


def test_each_road_shape_of_a_drag_is_taken_over_at_once() -> None:
    clock = Clock()
    driver = Driver(PAPER, clock)
    for k in range(30):
        clock.now += FRAME
        driver.change(PAPER.replace({"road.amplitude": 0.1 + 0.001 * k}))
        assert driver.frame(1.0).config.road.amplitude == 0.1 + 0.001 * k


def test_a_drive_that_stands_shows_its_whole_past_on_the_road_it_drove_on() -> None:
    clock = Clock()
    driver = Driver(PAPER.replace({SPEED: 60}), clock)
    for _ in range(70):
        clock.now += 0.1
        driver.frame(8.0)
    driver.change(PAPER.replace({SPEED: 60, "road.amplitude": 0.02}))
    clock.now += 0.1
    driver.frame(8.0)
    state = driver.stand()
    assert state.stands
    assert state.recent is state.past
    assert state.past.t[-1] == pytest.approx(state.time, abs=0.02)
    assert state.past.t[-1] - state.past.t[0] == pytest.approx(PLOTTED, abs=0.25)
    depth = penetration(state.past, state.road)
    loaded = state.past.normal_load > 1000.0
    assert (depth[loaded] > 0.0).all()  # wheels that carry are in that ground, all along
    assert depth.max() < 0.1
    np.testing.assert_allclose(np.diff(state.past_from_start.q[:, 0, 0]), np.diff(state.past.q[:, 0, 0]), atol=1e-9)
    assert state.past_from_start.q[-1, 0, 0] == pytest.approx(60 / 3.6 * state.time, rel=0.05)


# Runner: the thread that drives


def start(first: Config = PAPER, run: Any = simulate_at_once) -> tuple[Runner, list[Exception]]:
    errors: list[Exception] = []
    return Runner(Request(first), run, lambda: None, errors.append), errors


def next_of(runner: Runner, kind: type, condition: Any = lambda outcome: True) -> Any:
    found = wait_for(lambda: [o for o in runner.take() if isinstance(o, kind) and condition(o)], kind.__name__)
    return found[0]


def test_a_request_acts_on_the_moving_vehicle() -> None:
    runner, errors = start()
    runner.drive(1.0)
    before = next_of(runner, Driven, lambda outcome: outcome.state.time > 0.2)
    runner.change(lambda request: request.changed(SPEED, 25))
    after = next_of(runner, Driven, lambda outcome: outcome.state.config.drive.speed_kmh == 25)
    runner.close()
    assert after.request.number == before.request.number + 1
    assert after.state.time > before.state.time
    assert errors == []


def test_a_pause_is_not_made_up_for() -> None:
    clock = Clock()
    driver = Driver(PAPER, clock)
    driver.frame(1.0)
    stood = driver.stand().time
    clock.now += 20.0
    assert driver.frame(1.0).time - stood == pytest.approx(FRAME)


def test_standing_resuming_and_starting_anew(monkeypatch: pytest.MonkeyPatch) -> None:
    waits: list[bool] = []

    def noted(runner: Runner) -> bool:
        waits.append(has_to_drive(runner))
        return waits[-1]

    has_to_drive = Runner._has_to_drive
    monkeypatch.setattr(Runner, "_has_to_drive", noted)
    runner, _ = start()
    runner.drive(1.0)
    next_of(runner, Driven, lambda outcome: outcome.state.time > 0.3)
    runner.drive(0.0)
    stood = next_of(runner, Driven, lambda outcome: outcome.state.stands).state.time
    wait_for(lambda: waits[-1:] == [False], "the thread to wait")
    assert runner.take() == []
    runner.drive(0.02)  # so slow that nobody can look too late
    resumed = next_of(runner, Driven)
    assert 0 <= resumed.state.time - stood < 0.3
    assert not resumed.state.stands
    runner.drive(0.02, anew=True)
    assert next_of(runner, Driven, lambda outcome: outcome.state.time < 0.2)
    runner.close()


def test_back_to_runs_shows_the_run_of_the_present_parameters() -> None:
    runner, _ = start()
    next_of(runner, Finished)
    runner.drive(1.0)
    runner.change(lambda request: request.changed(SPEED, 40))
    next_of(runner, Driven, lambda outcome: outcome.state.config.drive.speed_kmh == 40)
    runner.drive(None)
    assert next_of(runner, Finished).trajectory.config.drive.speed_kmh == 40
    runner.close()


def test_a_run_under_way_is_given_up_for_the_drive() -> None:
    def endless(config: Config, *, on_progress: Any, should_stop: Any) -> Trajectory:
        wait_for(should_stop)
        return make_run(config, status="cancelled")

    runner, _ = start(run=endless)
    runner.drive(1.0)
    assert next_of(runner, Driven)
    runner.close()


def test_a_bad_request_is_refused_and_the_drive_goes_on_with_the_good_one() -> None:
    runner, _ = start()
    runner.drive(1.0)
    good = next_of(runner, Driven)
    runner.change(lambda request: request.changed(SPEED, -1))
    refused = next_of(runner, Refused)
    assert runner.withdraw(refused.request, good.request)
    later = next_of(runner, Driven, lambda outcome: outcome.state.time > good.state.time + 0.1)
    runner.close()
    assert later.state.config == PAPER


def test_what_cannot_stand_at_rest_fails_and_the_next_request_drives(monkeypatch: pytest.MonkeyPatch) -> None:
    class Picky(Driver):
        def __init__(self, config: Config) -> None:
            if config.drive.speed_kmh == 20:
                raise NoEquilibriumError("springs too soft")
            super().__init__(config)

    monkeypatch.setattr(app.runs.runner, "Driver", Picky)
    runner, errors = start(PAPER.replace({SPEED: 20}))
    runner.drive(1.0)
    assert next_of(runner, Failed).message == "springs too soft"
    runner.change(lambda request: request.changed(SPEED, 25))
    assert next_of(runner, Driven).state.config.drive.speed_kmh == 25
    runner.close()
    assert errors == []


# With a tab


def test_a_tab_drives_on_with_sliders_plots_and_player(explore: Any, open_tab: Any) -> None:
    explorer = explore()
    tab: Tab = open_tab(explorer)
    wait_for(lambda: tab.shows_run(1))
    view: FakeView = explorer.sessions[0]._window.view
    tab.use("Mode", "○ Drive")
    wait_for(lambda: tab.widget("Mode")["props"]["options"][1] == "● Drive", "the mode to show")
    wait_for(lambda: "m · " in tab.widget("Driven")["value"])
    wait_for(lambda: len(view.roads) > 10)
    assert isinstance(view.roads[-1], Road)
    assert view.times[-1] > view.times[-5]
    tab.use("Speed, km/h", 25)
    wait_for(lambda: view.runs[-1].config.drive.speed_kmh == 25, "the new speed")
    assert view.runs[-1].t[-1] > 0.3  # no restart
    ends = []
    for _ in range(3):
        ends.append(tab.charts()[0]["data"][0][-1])
        wait_for(lambda: tab.charts()[0]["data"][0][-1] > ends[-1], "plots that go on")
    tab.use("Time scale", "1/8×")
    wait_for(lambda: "of 0.125×" in tab.widget("Driven")["value"], "the target")
    tab.press("Play or pause")
    wait_for(lambda: "look back" in tab.status)
    stood = len(view.roads)
    pass_frames(explorer)
    assert len(view.roads) == stood
    before = len(view.runs)
    tab.use("Playback", "|◀ Restart")
    wait_for(lambda: any(run.t[-1] < 0.2 for run in view.runs[before:]), "the start")
    tab.press("Drive on and on, or back to the run")
    wait_for(lambda: tab.shows_run(3))
    wait_for(lambda: np.isclose(tab.charts()[0]["data"][1][0], 25))
    assert tab.widget("Mode")["props"]["options"][0] == "● Run"


def test_a_page_in_the_background_stands_still(explore: Any, open_tab: Any) -> None:
    explorer = explore()
    tab: Tab = open_tab(explorer)
    wait_for(lambda: tab.shows_run(1))
    view: FakeView = explorer.sessions[0]._window.view
    tab.use("In view", False)
    wait_for(lambda: not explorer.sessions[0]._in_view)
    pass_frames(explorer)
    times = len(view.times)
    pass_frames(explorer)
    assert len(view.times) == times
    tab.use("In view", True)
    wait_for(lambda: len(view.times) > times)
    tab.use("Mode", "○ Drive")
    wait_for(lambda: len(view.roads) > 3)
    tab.use("In view", False)
    wait_for(lambda: explorer.sessions[0]._good.state.stands, "the drive to stand")
    pass_frames(explorer)
    driven = view.runs[-1].t[-1]
    pass_frames(explorer)
    assert view.runs[-1].t[-1] == driven
    tab.close()
    wait_for(lambda: not trackride_threads(), "the threads to end")


def test_a_drive_that_diverges_says_so_and_offers_a_restart(
    explore: Any, open_tab: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    def broken(drive: LiveDrive, until: float) -> None:
        whole(drive, until)
        if drive.time > 0.3:
            drive._run._clock.status = Status.NOT_FINITE

    whole = LiveDrive.advance
    monkeypatch.setattr(LiveDrive, "advance", broken)
    tab: Tab = open_tab(explore())
    wait_for(lambda: tab.shows_run(1))
    tab.use("Mode", "○ Drive")
    notice = wait_for(lambda: tab.notifications, "a notification")[-1]
    assert re.search(r"diverged at t = 0\.[34]", notice["body"].lower())  # a frame is 0.1 s long at most
    assert "Restart" in notice["body"]
    wait_for(lambda: "ended" in tab.widget("Driven")["value"])
    monkeypatch.setattr(LiveDrive, "advance", whole)
    tab.use("Playback", "|◀ Restart")
    wait_for(lambda: "of 1×" in tab.widget("Driven")["value"])
    wait_for(lambda: any(m["type"] == "RemoveNotificationMessage" for m in tab.messages), "the notice to go")


def test_what_the_player_says_of_a_drive() -> None:
    clock = Clock()
    driver = Driver(PAPER, clock)
    for _ in range(40):
        clock.now += 0.05
        state = driver.frame(1.0)
    said = driven_text(state, Playback())
    assert said.startswith("0:0")
    assert said.endswith("m · 1.00× of 1× real time")
    assert driven_text(replace(state, ended="diverged"), Playback()).endswith("m · ended")
