"""The thread that runs: the newest request wins, and no old run hides a newer one."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

import pytest

import app.runs.runner
from app.runs.request import Failed, Finished, Outcome, Refused, Request
from app.runs.runner import Runner
from model.config.config import Config
from model.config.config_files import load_config
from model.dynamics.equilibrium import NoEquilibriumError
from model.simulation.trajectory import Trajectory
from tests.app.conftest import PATIENCE, make_run, simulate_at_once, wait_for
from tests.app.runs.test_drive import Clock

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


def test_a_long_drag_still_shows_something(monkeypatch: pytest.MonkeyPatch) -> None:
    """Requests that come faster than runs end do not stop every run. Time passes as the runs compute."""
    clock = Clock()
    monkeypatch.setattr(app.runs.runner, "monotonic", lambda: clock.now)
    ready, shown = threading.Event(), []

    def slow(config: Config, *, on_progress: Any, should_stop: Any) -> Trajectory:
        ready.wait(PATIENCE)
        for part in range(1, 13):
            clock.now += 0.01
            if clock.now < 1.5 and part % 3 == 0:
                runner.change(faster(10 + clock.now))
            on_progress(part / 12)
            if should_stop():
                return make_run(config, status="cancelled")
        return make_run(config)

    def take() -> None:
        shown.extend(outcome.request.number for outcome in runner.take())

    errors: list[Exception] = []
    runner = Runner(Request(PAPER), slow, take, errors.append)
    ready.set()
    wait_for(lambda: shown and shown[-1] == runner.latest.number, "the last run")
    runner.close()
    assert clock.now > 1.5
    assert 4 <= len(shown) < 0.5 * shown[-1]
    assert shown == sorted(shown)
    assert errors == []


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
