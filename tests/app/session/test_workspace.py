"""Undo, runs, baseline and presets: what the workspace shows and requests, by a clock that the test sets.

The last tests go through a tab, over viser's own protocol.
"""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import app.session.workspace
from app.format.units import METRIC
from app.runs.history import REST, Runs
from app.runs.project import project_from, project_text
from app.runs.request import Finished, Request, first_request
from app.runs.storage import State, state_from, state_text
from app.runs.study_choice import StudyChoice
from app.session.workspace import BESIDE, CALM, COMPARE_EVERY, Workspace
from model.config.config import Config
from model.config.config_files import load_config
from model.simulation.trajectory import Trajectory
from tests.app.conftest import Tab, make_run, simulate_at_once, wait_for
from tests.app.session.conftest import FakeRunner, FakeWindow

PAPER, HALF_ROUND = load_config("paper"), load_config("half_round")
PRESETS = {"paper": PAPER, "half_round": HALF_ROUND}
SPEED, SPEED_KEY, AMPLITUDE_KEY = "Speed, km/h", "drive.speed_kmh", "road.amplitude"


class Visit:
    """What a user does at a workspace, and the time that passes meanwhile."""

    def __init__(self, config: Config = PAPER, preset: str = "paper", state: State | None = None) -> None:
        self.now = 100.0  # s
        self.window = FakeWindow()
        self.runner = FakeRunner(first_request(PRESETS[preset], config))
        window, runner = self.window, self.runner
        self.workspace = Workspace(window, runner, dict(PRESETS))  # type: ignore[arg-type]
        self.stored: State | None = None  # what the browser has
        self.workspace.restore(state)
        self.run()

    @property
    def config(self) -> Config:
        """That is requested."""
        return self.runner.latest.config()

    def run(self) -> None:
        """The run of the latest request comes, and the user looks at it."""
        self.come()
        self.rest()

    def come(self) -> None:
        """The run of the latest request comes."""
        request = self.runner.latest
        self.workspace.finished(Finished(request, make_run(request.config(), samples=21)), self.now)
        self.pass_by(0.1)

    def rest(self) -> None:
        for _ in range(12):
            self.pass_by(REST / 10)

    def pass_by(self, seconds: float) -> None:
        self.now += seconds
        self.workspace.tick(self.now)
        news = self.workspace.news(self.now)
        if news is not None:
            self.stored = state_from(news)

    def change(self, key: str, value: Any) -> None:
        """Move a slider, and look at the run."""
        self.runner.change(lambda request: request.changed(key, value))
        self.run()

    def choose(self, preset: str) -> None:
        base = self.workspace.presets[preset]
        self.runner.change(lambda request: Request(base))
        self.run()

    def again(self) -> Visit:
        """The same browser comes back later."""
        return Visit(state=self.stored)


@pytest.fixture
def visit() -> Visit:
    return Visit()


# ── Projects ──


def test_a_project_takes_the_place_of_what_was_at_hand(visit: Visit) -> None:
    visit.change(SPEED_KEY, 20)
    visit.workspace.rename("Mine")
    visit.workspace.pin()
    visit.workspace.tick_run(visit.window.runs.numbered("Paper vehicle"))
    visit.workspace.save_preset("My tank")
    visit.run()
    visit.change(AMPLITUDE_KEY, 0.02)
    study = StudyChoice(view="map", fit=3)
    saved = project_from("p.trackride", project_text(visit.workspace.project(study)).encode())

    other = Visit()
    assert other.workspace.at_hand == ""
    other.change(SPEED_KEY, 33)
    other.workspace.save_preset("Its own")
    other.run()
    assert other.workspace.at_hand == "2 kept runs"
    other.workspace.pin()
    assert other.workspace.at_hand.endswith(" and the baseline")
    other.workspace.open_project(saved)
    other.run()
    assert other.config == visit.config
    assert other.window.runs.rows == visit.window.runs.rows
    assert other.window.runs.baseline is not None
    assert other.window.runs.baseline.name == "Mine"
    assert {"My tank", "Its own"} <= {config.name for config in other.window.presets.values()}
    assert other.window.runs.ticked == [other.window.runs.numbered("Paper vehicle")]
    assert other.window.study.calls == [("choose", replace(study, fit=0))]
    other.workspace.go(-1)
    assert other.config.name == "Its own"


def test_the_run_that_is_shown_is_part_of_a_project_though_the_user_has_not_rested(visit: Visit) -> None:
    visit.runner.change(lambda request: request.changed(SPEED_KEY, 44))
    visit.come()
    runs = visit.workspace.project(StudyChoice()).runs
    assert [kept.config.drive.speed_kmh for kept in runs] == [15, 44]


# ── Runs beside ──


def test_kept_runs_are_shown_beside_and_taken_away_again(visit: Visit) -> None:
    visit.change(SPEED_KEY, 20)
    visit.change(SPEED_KEY, 30)
    first, second = (visit.window.runs.numbered(name) for name in ("Paper vehicle", "Speed 15 → 20 km/h"))
    visit.workspace.tick_run(second)
    visit.workspace.tick_run(first)
    assert [other.name for other in visit.window.beside] == ["Speed 15 → 20 km/h", "Paper vehicle"]
    assert [other.run.config.drive.speed_kmh for other in visit.window.beside] == [20, 15]
    assert len({other.colour for other in visit.window.beside}) == 2
    assert visit.window.runs.ticked == [second, first]
    visit.rest()
    assert visit.window.runs.compared_beside == ["Speed 15 → 20 km/h", "Paper vehicle"]
    visit.workspace.tick_run(second)
    assert [other.name for other in visit.window.beside] == ["Paper vehicle"]
    visit.workspace.delete(first)
    assert visit.window.beside == ()


def test_eight_runs_are_beside_at_most(visit: Visit) -> None:
    for speed in range(20, 29):
        visit.change(SPEED_KEY, speed)
    numbers = [kept.number for kept in visit.window.runs.kept][:9]
    for number in numbers:
        visit.workspace.tick_run(number)
    assert visit.window.runs.ticked == numbers[:BESIDE]
    assert visit.window.titles == ["Eight at most"]


def test_a_run_beside_of_an_earlier_visit_is_made_again(visit: Visit) -> None:
    visit.change(SPEED_KEY, 20)
    visit.change(SPEED_KEY, 30)
    later = visit.again()
    number = later.window.runs.numbered("Speed 15 → 20 km/h")
    later.workspace.tick_run(number)
    assert later.window.beside == ()
    missing = later.workspace.missing_run
    assert missing == PAPER.replace({SPEED_KEY: 20})
    later.workspace.made_again(missing, make_run(missing))
    assert [other.name for other in later.window.beside] == ["Speed 15 → 20 km/h"]
    assert later.workspace.missing_run is None


def test_one_that_cannot_be_made_again_is_left_out(visit: Visit) -> None:
    visit.change(SPEED_KEY, 20)
    visit.change(SPEED_KEY, 30)
    later = visit.again()
    later.workspace.tick_run(later.window.runs.numbered("Speed 15 → 20 km/h"))
    missing = later.workspace.missing_run
    assert missing is not None
    later.workspace.made_again(missing, None)
    assert later.workspace.missing_run is None


# ── Steps ──


def test_undo_and_redo_request_what_was_before(visit: Visit) -> None:
    visit.change(SPEED_KEY, 20)
    visit.change(SPEED_KEY, 30)
    visit.workspace.go(-1)
    assert visit.config.drive.speed_kmh == 20
    visit.run()
    visit.workspace.go(-1)
    visit.run()
    assert visit.config == PAPER
    visit.workspace.go(-1)
    assert visit.window.titles == ["Nothing to undo"]
    visit.workspace.go(+2)
    assert visit.config.drive.speed_kmh == 30
    visit.run()
    visit.workspace.go(+1)
    assert visit.window.titles[-1] == "Nothing to redo"
    visit.runner.change(lambda request: Request(request.base))
    visit.run()
    visit.workspace.go(-1)
    assert visit.config.drive.speed_kmh == 30  # a reset is a step as well


def test_undo_before_a_run_has_come_leads_back_to_what_is_shown(visit: Visit) -> None:
    visit.change(SPEED_KEY, 20)
    visit.runner.change(lambda request: request.changed(SPEED_KEY, 30))
    visit.workspace.go(-1)
    assert visit.config.drive.speed_kmh == 20


def test_undo_leads_back_across_presets_and_shows_which(visit: Visit) -> None:
    visit.change(SPEED_KEY, 20)
    visit.choose("half_round")
    assert visit.window.chosen == "half_round"
    visit.workspace.go(-1)
    visit.run()
    assert visit.window.chosen == "paper"
    assert visit.config == PAPER.replace({SPEED_KEY: 20})


def test_a_drag_leaves_one_run_and_one_step(visit: Visit) -> None:
    for speed in range(20, 50):
        visit.runner.change(lambda request, speed=speed: request.changed(SPEED_KEY, speed))
        visit.come()
    assert visit.window.runs.rows == ["Paper vehicle"]
    visit.rest()
    assert visit.window.runs.rows == ["Speed 15 → 49 km/h", "Paper vehicle"]
    visit.workspace.go(-1)
    visit.run()
    assert visit.config == PAPER
    assert len(visit.window.runs.rows) == 2  # what was kept already is not kept again


# ── Runs and baseline ──


def test_a_run_is_kept_once_the_user_has_rested_on_it_and_not_while_a_newer_one_is_on_its_way(visit: Visit) -> None:
    visit.runner.change(lambda request: request.changed(SPEED_KEY, 20))
    visit.come()
    visit.runner.change(lambda request: request.changed(SPEED_KEY, 30))
    visit.rest()
    assert visit.window.runs.rows == ["Paper vehicle"]
    visit.run()
    assert visit.window.runs.rows == ["Speed 15 → 30 km/h", "Paper vehicle"]


def test_kept_runs_are_bounded(visit: Visit, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(app.runs.history, "RUNS", 5)
    for speed in range(20, 28):
        visit.change(SPEED_KEY, speed)
        assert visit.window.runs.rows[0] == f"Speed 15 → {speed} km/h"
    assert len(visit.window.runs.rows) == 5
    assert "Paper vehicle" not in visit.window.runs.rows


def test_runs_are_recalled_compared_renamed_and_deleted(visit: Visit) -> None:
    runs, workspace = visit.window.runs, visit.workspace
    visit.change(SPEED_KEY, 20)
    visit.change(AMPLITUDE_KEY, 0.2)
    first, second, third = "Paper vehicle", "Speed 15 → 20 km/h", "Speed 15 → 20 km/h, Amplitude 100 → 200 mm"
    assert runs.rows == [third, second, first]
    assert runs.name == third
    workspace.recall(runs.numbered(second))
    visit.run()
    assert visit.config == PAPER.replace({SPEED_KEY: 20})
    assert runs.name == second
    workspace.rename("the quick one")
    assert runs.rows == [third, "the quick one", first]
    workspace.compare(runs.numbered(first))
    assert runs.baseline is not None
    assert runs.baseline.name == first
    workspace.delete(runs.numbered(first))
    assert runs.rows == [third, "the quick one"]
    assert runs.baseline.name == first  # it stays to be compared with
    workspace.delete(runs.numbered("the quick one"))
    visit.rest()
    assert runs.rows == [third]  # what the user has deleted does not come back by itself
    for act in (workspace.recall, workspace.compare, workspace.delete):
        act(99)  # a row that has just gone
    assert visit.config == PAPER.replace({SPEED_KEY: 20})


def test_pin_swap_and_clear(visit: Visit) -> None:
    window, workspace = visit.window, visit.workspace
    workspace.swap()
    assert window.titles == ["Nothing to swap"]
    workspace.pin()
    assert window.titles[-1] == "Baseline pinned"
    visit.change(SPEED_KEY, 30)
    now, baseline = window.runs.compared[-1]
    assert (now.config.drive.speed_kmh, baseline and baseline.config) == (30, PAPER)
    workspace.swap()
    assert visit.config == PAPER
    assert window.ghosts[-1] is not None
    assert window.ghosts[-1].config.drive.speed_kmh == 30
    visit.run()
    assert window.runs.compared[-1][1] is window.ghosts[-1]
    workspace.clear_baseline()
    assert window.ghosts[-1] is None
    visit.rest()
    assert window.runs.compared[-1][1] is None


def test_a_renamed_baseline_is_called_so_and_a_run_from_outside_becomes_the_baseline(visit: Visit) -> None:
    visit.workspace.pin()
    visit.workspace.rename("mine")
    assert visit.window.runs.baseline is not None
    assert visit.window.runs.baseline.name == "mine"
    run = make_run(PAPER.replace({SPEED_KEY: 44}))
    visit.workspace.take_in(run, "theirs")
    assert visit.workspace.baseline is run
    assert visit.window.runs.rows == ["theirs", "mine"]


def test_during_a_drag_the_figures_wait_unless_their_tab_is_seen(visit: Visit) -> None:
    runs = visit.window.runs

    def drag(steps: int) -> int:
        before = len(runs.compared)
        for speed in range(steps):
            visit.runner.change(lambda request, speed=speed: request.changed(SPEED_KEY, 20 + speed))
            visit.come()  # ten a second
        return len(runs.compared) - before

    assert drag(30) == 0
    visit.pass_by(CALM)
    assert runs.compared[-1][0].config.drive.speed_kmh == 49
    visit.window.runs_in_front = True
    assert drag(30) == pytest.approx(3.0 / COMPARE_EVERY, abs=3)


def test_during_a_drive_the_figures_are_said_to_be_those_of_the_last_run(visit: Visit) -> None:
    runs = visit.window.runs
    visit.workspace.driven(visit.runner.latest, visit.now)
    assert (runs.before_drive, runs.now) == ("Paper vehicle", None)
    visit.workspace.pin()
    visit.workspace.rename("what?")
    visit.workspace.save_preset("what?")
    assert visit.window.titles == ["Only a run can be pinned"]
    assert runs.rows == ["Paper vehicle"]
    visit.run()
    assert (runs.before_drive, runs.heading) == ("", "Paper vehicle")


# ── Configurations ──


def test_a_preset_is_saved_and_chosen_and_reset_leads_back_to_it(visit: Visit) -> None:
    visit.change(SPEED_KEY, 20)
    visit.workspace.save_preset("  ")
    assert visit.window.titles == ["No name"]
    visit.workspace.save_preset(" My  tank ")
    visit.run()
    assert visit.window.presets[visit.window.chosen].name == "My tank"
    assert visit.window.presets.keys() > PRESETS.keys()
    assert visit.runner.latest.changes == {}
    assert visit.config.drive.speed_kmh == 20
    visit.change(SPEED_KEY, 40)
    visit.workspace.save_preset("My tank")  # in the place of the first
    visit.run()
    assert len(visit.window.presets) == len(PRESETS) + 1
    assert visit.window.presets[visit.window.chosen].drive.speed_kmh == 40
    visit.workspace.save_preset("x" * 200)
    assert "at most 100" in str(visit.window.faults[-1][1])


def test_only_so_many_own_presets_are_kept(visit: Visit, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(app.session.workspace, "PRESETS", 3)
    for name in "abcde":
        visit.workspace.save_preset(name)
        visit.run()
    assert [config.name for config in visit.workspace.presets.values()][-3:] == ["c", "d", "e"]


def test_a_configuration_of_the_presets_name_is_a_change_of_it(visit: Visit) -> None:
    visit.workspace.use_configuration(PAPER.replace({SPEED_KEY: 23}))
    assert (visit.runner.latest.base, visit.runner.latest.changes) == (PAPER, {SPEED_KEY: 23})
    other = PAPER.replace({"name": "My tank", SPEED_KEY: 40})
    visit.workspace.use_configuration(other)
    visit.run()
    assert (visit.runner.latest.base, visit.window.presets[visit.window.chosen]) == (other, other)
    visit.workspace.go(-1)
    visit.run()
    assert visit.window.chosen == "paper"


def test_the_road_of_an_impossible_request_is_left_alone(visit: Visit) -> None:
    visit.workspace.change_road(lambda config: {"road.type": "flat"})
    assert visit.config.road.type == "flat"
    visit.runner.change(lambda request: request.changed(SPEED_KEY, -1))
    visit.workspace.change_road(lambda config: {"road.type": "sine"})
    assert visit.runner.latest.changes == {"road.type": "flat", SPEED_KEY: -1}


# ── From one visit to the next ──


def test_parameters_and_presets_come_back(visit: Visit) -> None:
    visit.choose("half_round")
    visit.change(SPEED_KEY, 25)
    visit.workspace.save_preset("Mine")
    visit.run()
    visit.change(SPEED_KEY, 26)
    again = visit.again()
    assert again.config == HALF_ROUND.replace({"name": "Mine", SPEED_KEY: 26})
    assert again.window.presets[again.window.chosen].name == "Mine"
    assert again.window.titles == ["Welcome back"]
    assert again.runner.latest.base.drive.speed_kmh == 25  # where a reset leads to


def test_runs_and_baseline_come_back_and_what_is_missing_is_made_again(visit: Visit) -> None:
    visit.workspace.pin()
    visit.change(SPEED_KEY, 20)
    visit.workspace.rename("the quick one")
    visit.change(SPEED_KEY, 30)
    visit.workspace.delete(visit.window.runs.numbered("Paper vehicle"))
    visit.rest()
    again = visit.again()
    runs = again.window.runs
    assert runs.rows == visit.window.runs.rows == ["Speed 15 → 30 km/h", "the quick one"]
    assert [kept.colour for kept in runs.kept] == [kept.colour for kept in visit.window.runs.kept]
    assert runs.baseline is not None
    assert runs.baseline.name == "Paper vehicle"
    assert again.workspace.missing_run == PAPER
    again.workspace.made_again(PAPER, make_run(PAPER))
    assert again.workspace.missing_run is None
    again.rest()
    assert again.window.runs.compared[-1][1] is again.workspace.baseline
    again.workspace.compare(runs.numbered("the quick one"))
    assert again.workspace.missing_run == PAPER.replace({SPEED_KEY: 20})


def test_a_baseline_that_cannot_be_made_again_is_given_up_with_a_word(visit: Visit) -> None:
    visit.workspace.take_in(make_run(PAPER.replace({SPEED_KEY: 44})), "fast")
    visit.rest()
    again = visit.again()
    assert again.workspace.missing_run is not None
    again.workspace.made_again(again.workspace.missing_run, None)
    assert again.window.titles[-1] == "No baseline"
    assert again.workspace.missing_run is None
    again.rest()
    assert again.stored is not None
    assert again.stored.baseline is None


def test_nothing_is_stored_before_the_browser_has_told_what_it_has() -> None:
    window, runner = FakeWindow(), FakeRunner(Request(PAPER))
    workspace = Workspace(window, runner, dict(PRESETS))  # type: ignore[arg-type]
    workspace.finished(Finished(runner.latest, make_run()), 100.0)
    workspace.tick(110.0)
    workspace.set_dark(True)
    assert workspace.news(120.0) is None
    workspace.restore(None)
    assert workspace.news(120.0) is not None
    assert workspace.news(130.0) is None  # once


def test_what_the_explorer_was_started_with_goes_before_the_last_visit() -> None:
    request = Request(PAPER).changed(SPEED_KEY, 33)
    kept = Runs().keep(request, make_run(request.config()))
    stored = state_text(PAPER, request, [PAPER.replace({"name": "Mine"})], [kept], kept, dark=False)
    visit = Visit(HALF_ROUND, "half_round", state_from(stored))
    assert "Mine" in {config.name for config in visit.window.presets.values()}
    assert "Speed 15 → 33 km/h" in visit.window.runs.rows
    assert (visit.window.chosen, visit.config) == ("half_round", HALF_ROUND)
    assert visit.window.runs.baseline is None


def test_the_browsers_look_is_taken_until_another_is_chosen(visit: Visit) -> None:
    visit.workspace.prefer_dark(True)
    assert visit.window.dark
    visit.change(SPEED_KEY, 20)
    assert visit.stored is not None
    assert visit.stored.dark is None
    visit.workspace.set_dark(False)
    visit.rest()
    assert not visit.window.dark
    assert visit.stored.dark is False
    again = visit.again()
    again.workspace.prefer_dark(True)
    assert not again.window.dark
    again.workspace.set_dark(True)
    again.rest()
    assert again.again().window.dark


def test_units_are_kept_by_the_browser_and_runs_are_named_in_them(visit: Visit) -> None:
    visit.change(SPEED_KEY, 20)
    visit.workspace.rename("Mine, 20 km/h")
    visit.workspace.pin()
    visit.change(AMPLITUDE_KEY, 0.2)
    visit.workspace.choose_units({"speed": "mph"})
    visit.workspace.choose_units({"length": "in", "force": "stone"})
    visit.rest()
    units = METRIC.changed({"speed": "mph", "length": "in"})
    assert visit.window.units == visit.window.runs.units == units
    names = ["Speed 9.321 → 12.43 mph, Amplitude 3.937 → 7.874 in", "Mine, 20 km/h", "Paper vehicle"]
    assert visit.window.runs.rows == names
    assert visit.window.runs.heading == names[0]
    again = visit.again()
    again.rest()
    assert again.window.units == units
    assert again.window.runs.rows == names
    again.workspace.choose_units(METRIC.chosen)
    again.rest()
    assert again.window.runs.rows[0] == "Speed 15 → 20 km/h, Amplitude 100 → 200 mm"
    assert again.stored is not None
    assert again.stored.units == METRIC
    assert again.config == visit.config


# ── With a tab ──


def test_all_of_the_page_is_told_in_the_units_of_choice(explore: Any, open_tab: Any) -> None:
    tab: Tab = open_tab(explore())
    wait_for(lambda: tab.shows_run(1))
    tab.use("Units", "US")
    wait_for(lambda: tab.widget("Speed, mph")["value"] == 9.321)
    wait_for(lambda: tab.widget("Speeds")["value"] == "mph")
    loads = wait_for(lambda: [props for props in tab.charts() if props["axes"][1].get("label") == "lbf"])
    assert np.isclose(loads[0]["data"][1][0], 15e3 / 4.4482216, atol=0.01)
    tab.use("Speed, mph", 20)
    wait_for(lambda: tab.shows_run(2))
    assert np.isclose(tab.charts()[0]["data"][1][0], 32186.88 / 4.4482216, atol=0.01)
    tab.use("Tabs in front", "Runs")
    wait_for(lambda: "Peak load, lbf" in tab.html("<trackride-figures"))
    assert "Suspension travel, in" in tab.html("<trackride-figures")
    assert wait_for(lambda: tab.html("Speed 9.321 → 20 mph"))
    tab.use("Speeds", "km/h")
    wait_for(lambda: tab.widget("Speed, km/h")["value"] == 32.18688)
    tab.press("Metric units")
    wait_for(lambda: [props for props in tab.charts() if props["axes"][1].get("label") == "kN"])
    assert {tab.widget(choice)["value"] for choice in ("Forces", "Lengths", "Accelerations")} == {"kN", "mm", "m/s²"}


def rows(tab: Tab) -> list[str]:
    """Names of the runs that are kept, newest first."""
    found = [w["props"] for w in tuple(tab.widgets.values()) if "Compare" in w["props"].get("options", ())]
    return [props["label"] for props in sorted(found, key=lambda props: props["order"])]


def html(tab: Tab, mark: str) -> str:
    """The HTML that holds a class."""
    texts = [w["props"]["content"] for w in tuple(tab.widgets.values()) if w["type"] == "GuiHtmlMessage"]
    return next((text for text in texts if f'class="{mark}"' in text), "")


def text_of(markup: str) -> str:
    return " ".join(re.sub("<[^>]*>", " ", markup).split())


def stored_speeds(storage: dict[str, str]) -> list[float]:
    """Of the runs that the browser has stored, km/h."""
    return [kept.config.drive.speed_kmh for kept in state_from(storage["trackride"]).runs]


@pytest.fixture
def _quick_rest(monkeypatch: pytest.MonkeyPatch) -> None:
    """A moment is a rest, so that no test waits for one."""
    monkeypatch.setattr(app.session.workspace, "REST", 0.05)
    monkeypatch.setattr(app.runs.history, "REST", 0.05)


def test_buttons_and_keys_undo_and_redo(explore: Any, open_tab: Any) -> None:
    tab: Tab = open_tab(explore())
    wait_for(lambda: tab.shows_run(1), "run 1")
    tab.use(SPEED, 20)
    wait_for(lambda: tab.shows_run(2), "run 2")
    tab.use("Amplitude, mm", 200)
    wait_for(lambda: tab.shows_run(3), "run 3")
    tab.use("Changes", "Undo")
    wait_for(lambda: tab.shows_run(4), "the run before")
    tab.press("Undo the last change")
    wait_for(lambda: tab.shows_run(5), "the first run again")
    tab.press("Redo the change")
    tab.press("Redo the change")  # both count, however quickly they come
    wait_for(lambda: tab.widget(SPEED)["value"] == 20 and tab.widget("Amplitude, mm")["value"] == 200, "the sliders")
    tab.use("Changes", "Redo")
    wait_for(lambda: [n for n in tab.notifications if n["title"] == "Nothing to redo"])


def test_a_pinned_run_stays_in_plots_scene_and_table(explore: Any, open_tab: Any) -> None:
    explorer = explore()
    tab: Tab = open_tab(explorer)
    wait_for(lambda: tab.shows_run(1))
    view: Any = explorer.sessions[0]._window.view
    tab.press("Pin this run as the baseline")
    wait_for(lambda: view.ghosts, "the ghost")
    assert view.ghosts[-1].config.drive.speed_kmh == 15
    tab.use(SPEED, 30)
    wait_for(lambda: "+100 %" in html(tab, "trackride-figures"), "the comparison")
    chart = tab.charts()[0]
    assert any(np.allclose(column[:-3], 15, atol=1) for column in chart["data"][1:])  # the baseline's loads
    wait_for(lambda: "Speed 15 → 30 km/h Baseline ● Paper vehicle" in text_of(html(tab, "trackride-compared")))
    tab.use("Baseline", "Swap")
    wait_for(lambda: tab.widget(SPEED)["value"] == 15)
    wait_for(lambda: "−50 %" in html(tab, "trackride-figures"), "the comparison the other way round")
    assert view.ghosts[-1].config.drive.speed_kmh == 30
    tab.use("Baseline", "Clear")
    wait_for(lambda: view.ghosts[-1] is None)
    wait_for(lambda: "change" not in text_of(html(tab, "trackride-figures")))
    tab.use("Mode", "○ Drive")
    wait_for(lambda: "Last run Paper vehicle" in text_of(html(tab, "trackride-compared")), "the heading of a drive")


@pytest.mark.usefixtures("_quick_rest")
def test_runs_and_baseline_come_back_with_the_browser(explore: Any, open_tab: Any) -> None:
    made: list[Config] = []

    def simulate(config: Config, **how: Any) -> Trajectory:
        made.append(config)
        return simulate_at_once(config, **how)

    explorer = explore(run=simulate)
    storage: dict[str, str] = {}
    tab: Tab = open_tab(explorer, storage=storage)
    wait_for(lambda: rows(tab) == ["Paper vehicle"])
    tab.press("Pin this run as the baseline")
    wait_for(lambda: "Baseline ● Paper vehicle" in text_of(html(tab, "trackride-compared")))
    tab.use(SPEED, 20)
    wait_for(lambda: len(rows(tab)) == 2)
    tab.use("Name", "the <b>quick</b> one")
    wait_for(lambda: "the &lt;b&gt;quick&lt;/b&gt; one" in html(tab, "trackride-compared"), "the name, escaped")
    tab.use(SPEED, 30)
    wait_for(lambda: len(rows(tab)) == 3)
    tab.use("Paper vehicle", "✕")
    wait_for(lambda: rows(tab) == ["Speed 15 → 30 km/h", "the <b>quick</b> one"])
    wait_for(lambda: stored_speeds(storage) == [20, 30], "the browser's storage")
    tab.close()
    made.clear()

    again: Tab = open_tab(explorer, storage=storage)
    wait_for(lambda: [row for row in rows(again) if row != "Paper vehicle"] == rows(tab), "the runs of the last visit")
    wait_for(lambda: "Baseline ● Paper vehicle" in text_of(html(again, "trackride-compared")))
    wait_for(lambda: "+100 %" in html(again, "trackride-figures"), "the comparison with the baseline")
    wait_for(lambda: again.widget(SPEED)["value"] == 30, "the speed of the last visit")
    view: Any = explorer.sessions[-1]._window.view
    assert view.ghosts[-1].config.drive.speed_kmh == 15
    assert 20 not in {config.drive.speed_kmh for config in made}  # nobody has asked for that run yet
    again.use("the <b>quick</b> one", "Compare")
    wait_for(lambda: view.ghosts[-1] and view.ghosts[-1].config.drive.speed_kmh == 20, "the run, made again")


def test_the_look_reaches_page_and_view(explore: Any, open_tab: Any) -> None:
    explorer = explore()
    tab: Tab = open_tab(explorer)
    wait_for(lambda: tab.shows_run(1) and tab.widget("Dark")["value"] is False)
    tab.use("Dark pages", True)
    wait_for(lambda: tab.widget("Dark")["value"] is True, "the browser's look")
    wait_for(lambda: explorer.sessions[-1]._window.view.dark)
