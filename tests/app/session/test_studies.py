"""When studies begin and when they are given up: a clock and runs made by hand."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import pytest

from app.plots.study_data import Data
from app.runs.study_choice import StudyChoice
from app.runs.turns import COMPUTING
from app.session.studies import REST, Studies
from app.session.study_work import Situation
from model.config.config_files import load_config
from model.study.profiler import LEVELS
from model.study.running import COMPLETE, Outcome
from tests.app.conftest import wait_for

PAPER = load_config("paper")
FASTER = PAPER.replace({"drive.speed_kmh": 20.0})
CHOICE = StudyChoice(columns=("drive.speed_kmh",), rows=("peak_load",), figure="peak_load", strips=False)
RESTING = Situation(number=1, shown=1, touched=True, config=PAPER, baseline=None, front=True, hurries=False)


class Tab:
    """Studies of a tab, what they have shown, and runs that wait at a gate."""

    def __init__(self) -> None:
        self.newest, self.plays = 1, False
        self.shown: list[Data] = []
        self.errors: list[Exception] = []
        self.gate = threading.Event()
        self.gate.set()
        self.begun = threading.Event()
        self.runs = self.at_once = self.most_at_once = 0
        self.gave_up = False
        self._lock = threading.Lock()
        self.studies = Studies(
            {"paper": PAPER},
            lambda: self.newest,
            lambda: self.plays,
            lambda kind, data: self.shown.append(data),
            self.errors.append,
            self.run,
        )
        self.studies.choice = CHOICE

    def run(self, base: Any, changes: Any, figures: tuple[str, ...], *, should_stop: Any) -> Outcome:
        with self._lock:
            self.runs += 1
            self.at_once += 1
            self.most_at_once = max(self.most_at_once, self.at_once)
        self.begun.set()
        self.gate.wait(10)
        self.gave_up |= should_stop()
        with self._lock:
            self.at_once -= 1
        return Outcome(COMPLETE, (base.replace(changes).drive.speed_kmh,) * len(figures))

    @property
    def levels(self) -> list[int]:
        return [data["level"] for data in self.shown]

    def wait_for_curves(self, count: int = len(LEVELS)) -> None:
        wait_for(lambda: len(self.shown) >= count and not self.studies.busy, "curves")


@pytest.fixture
def tab() -> Iterator[Tab]:
    tab = Tab()
    yield tab
    tab.gate.set()
    tab.studies.close()
    assert tab.errors == []


def test_a_study_begins_when_the_user_has_rested_and_comes_coarse_to_fine(tab: Tab) -> None:
    tab.studies.tick(10.0, RESTING)
    tab.studies.tick(10.0 + 0.9 * REST, RESTING)
    assert not tab.studies.busy
    tab.studies.tick(10.0 + REST, RESTING)
    tab.wait_for_curves()
    assert tab.levels == list(LEVELS)


def test_what_nobody_is_moving_needs_no_rest(tab: Tab) -> None:
    tab.studies.tick(10.0, replace(RESTING, touched=False))
    tab.wait_for_curves()


def test_a_study_that_is_done_is_not_repeated(tab: Tab) -> None:
    tab.studies.tick(10.0, replace(RESTING, touched=False))
    tab.wait_for_curves()
    runs = tab.runs
    tab.studies.tick(11.0, RESTING)
    assert not tab.studies.busy
    assert tab.runs == runs


def give_up_under_way(tab: Tab) -> None:
    """Begin a study, and let a newer request come during its first run."""
    tab.gate.clear()
    tab.studies.tick(10.0, replace(RESTING, touched=False))
    assert tab.begun.wait(10)
    tab.newest = 2  # no tick between: the run under way itself looks
    tab.gate.set()
    wait_for(lambda: not tab.studies.busy, "its end")


def test_a_newer_request_gives_it_up_at_once(tab: Tab) -> None:
    give_up_under_way(tab)
    assert tab.gave_up
    assert tab.shown == []
    assert tab.runs <= 2


def test_given_up_for_a_request_that_changed_nothing_it_begins_anew(tab: Tab) -> None:
    give_up_under_way(tab)
    again = replace(RESTING, number=2, shown=2)
    tab.studies.tick(11.0, again)
    tab.studies.tick(11.0 + REST, again)
    tab.wait_for_curves()
    assert tab.levels == list(LEVELS)


def test_after_an_undo_the_curves_are_there_without_a_run(tab: Tab) -> None:
    tab.studies.tick(10.0, replace(RESTING, touched=False))
    tab.wait_for_curves()
    tab.newest = 2
    tab.studies.tick(11.0, replace(RESTING, number=2, shown=2, touched=False, config=FASTER))
    tab.wait_for_curves(2 * len(LEVELS))
    tab.newest, runs = 3, tab.runs
    tab.studies.tick(12.0, replace(RESTING, number=3, shown=3, touched=False))
    tab.wait_for_curves(2 * len(LEVELS) + 1)
    assert tab.runs == runs
    assert tab.levels[-1] == LEVELS[-1]


@pytest.mark.parametrize(
    "otherwise",
    [{"hurries": True}, {"front": False}, {"config": None}, {"shown": 0}],
    ids=["a drive, or a run under way", "nobody looks", "no run", "a run is still to come"],
)
def test_there_is_no_study_while(tab: Tab, otherwise: dict[str, Any]) -> None:
    situation = replace(RESTING, touched=False, **otherwise)
    tab.studies.tick(10.0, situation)
    tab.studies.tick(20.0, situation)
    assert not tab.studies.busy
    assert tab.runs == 0


def test_a_drive_that_begins_gives_it_up_and_it_goes_on_afterwards(tab: Tab) -> None:
    tab.gate.clear()
    tab.studies.tick(10.0, replace(RESTING, touched=False))
    assert tab.begun.wait(10)
    tab.studies.tick(11.0, replace(RESTING, touched=False, hurries=True))
    tab.gate.set()
    wait_for(lambda: not tab.studies.busy, "its end")
    assert tab.shown == []
    tab.studies.tick(12.0, replace(RESTING, touched=False))
    tab.wait_for_curves()


def test_strips_on_the_sliders_take_the_coarse_curves_only(tab: Tab) -> None:
    tab.studies.choice = replace(CHOICE, strips=True)
    tab.studies.tick(10.0, replace(RESTING, touched=False, front=False))
    tab.wait_for_curves(1)
    assert tab.levels == [LEVELS[0]]


def test_while_a_run_plays_there_is_one_run_at_a_time(tab: Tab) -> None:
    tab.plays = True
    tab.studies.tick(10.0, replace(RESTING, touched=False))
    tab.wait_for_curves()
    assert tab.most_at_once == 1


def test_it_waits_while_a_run_is_made_in_any_tab(tab: Tab) -> None:
    with COMPUTING.turn():
        tab.studies.tick(10.0, replace(RESTING, touched=False))
        assert not tab.begun.wait(0.1)
    tab.wait_for_curves()


def test_the_baselines_curves_follow(tab: Tab) -> None:
    tab.studies.tick(10.0, replace(RESTING, touched=False, baseline=FASTER))
    tab.wait_for_curves(len(LEVELS) + 1)
    last = tab.shown[-1]["columns"][0]
    assert last["baseline"]["now"] == 20.0
    assert tab.shown[0]["columns"][0]["baseline"] is None


def test_another_choice_is_studied(tab: Tab) -> None:
    tab.studies.tick(10.0, replace(RESTING, touched=False))
    tab.wait_for_curves()
    tab.studies.choice = replace(CHOICE, rows=("travel",))
    tab.studies.tick(11.0, RESTING)
    tab.wait_for_curves(2 * len(LEVELS))
    assert [figure["name"] for figure in tab.shown[-1]["figures"] if figure["shown"]] == ["travel"]


def test_the_page_can_repeat_it_on_the_command_line(tab: Tab) -> None:
    tab.newest = 2
    tab.studies.tick(10.0, replace(RESTING, number=2, shown=2, touched=False, config=FASTER))
    tab.wait_for_curves()
    assert tab.shown[-1]["commands"] == [
        "trackride sweep paper --set drive.speed_kmh=20 --vary drive.speed_kmh=2:70:25 --figures peak_load "
        "--out speed_kmh.csv"
    ]
