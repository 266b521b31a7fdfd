"""Undo, runs, baseline and presets in a tab, over viser's own protocol."""

from __future__ import annotations

import json
import re
import time
from typing import Any

import numpy as np
import pytest

import app.session.workspace
from app.runs.history import Runs
from app.runs.request import Request
from app.runs.storage import state_text
from model.config.config import Config, load_config
from model.dynamics.equilibrium import NoEquilibriumError
from model.simulation.trajectory import Trajectory
from tests.app.conftest import Tab, make_run, simulate_at_once, wait_for

SPEED, SPEED_KEY = "Speed, km/h", "drive.speed_kmh"


@pytest.fixture(autouse=True)
def _no_long_rest(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(app.session.workspace, "REST", 0.15)
    monkeypatch.setattr(app.runs.history, "REST", 0.15)


def rows(tab: Tab) -> list[str]:
    """Names of the runs that are kept, newest first."""
    found = [w["props"] for w in tuple(tab.widgets.values()) if "Compare" in w["props"].get("options", ())]
    return [props["label"] for props in sorted(found, key=lambda props: props["order"])]


def html(tab: Tab, mark: str) -> str:
    """The HTML that holds a class."""
    texts = [w["props"]["content"] for w in tuple(tab.widgets.values()) if w["type"] == "GuiHtmlMessage"]
    return next((text for text in texts if f'class="{mark}"' in text), "")


def style(tab: Tab) -> list[str]:
    """Colours of the rows of runs, in the order of their rules."""
    rules = next(w["props"]["content"] for w in tuple(tab.widgets.values()) if "trackride-runs" in str(w["props"]))
    return re.findall(r"::before { color: (#\w+)", rules)


def text_of(markup: str) -> str:
    return " ".join(re.sub("<[^>]*>", " ", markup).split())


def change(tab: Tab, label: str, value: Any, run: int) -> None:
    tab.use(label, value)
    wait_for(lambda: tab.shows_run(run), f"run {run}")
    time.sleep(0.3)


@pytest.fixture
def tab(explore: Any, open_tab: Any) -> Tab:
    opened: Tab = open_tab(explore())
    wait_for(lambda: opened.shows_run(1), "run 1")
    wait_for(lambda: rows(opened) == ["Paper vehicle"], "the first run to be kept")
    return opened


def test_undo_and_redo_move_the_controls_and_run_again(tab: Tab) -> None:
    change(tab, SPEED, 20, 2)
    change(tab, SPEED, 30, 3)
    tab.use("Parameters", "Undo")
    wait_for(lambda: tab.shows_run(4))
    wait_for(lambda: tab.widget(SPEED)["value"] == 20, "the slider to follow")
    tab.press("Undo the last change")
    wait_for(lambda: tab.widget(SPEED)["value"] == 15)
    tab.press("Redo the change")
    tab.press("Redo the change")  # both count, however quickly they come
    wait_for(lambda: tab.widget(SPEED)["value"] == 30)
    tab.use("Parameters", "Redo")
    wait_for(lambda: [n for n in tab.notifications if n["title"] == "Nothing to redo"])
    tab.use("Parameters", "Reset")
    wait_for(lambda: tab.widget(SPEED)["value"] == 15)
    time.sleep(0.3)
    tab.use("Parameters", "Undo")
    wait_for(lambda: tab.widget(SPEED)["value"] == 30)


def test_undo_leads_back_across_presets_and_shows_which(tab: Tab) -> None:
    change(tab, SPEED, 20, 2)
    change(tab, "Preset", "Half-round obstacle", 3)
    tab.use("Parameters", "Undo")
    wait_for(lambda: tab.widget("Preset")["value"] == "Paper vehicle")
    wait_for(lambda: tab.widget(SPEED)["value"] == 20)


def test_during_a_drive_the_figures_are_said_to_be_those_of_the_last_run(tab: Tab) -> None:
    wait_for(lambda: "Now Paper vehicle" in text_of(html(tab, "trackride-compared")).replace("● ", ""))
    tab.use("Mode", "○ Drive")
    wait_for(lambda: "Last run Paper vehicle" in text_of(html(tab, "trackride-compared")), "the heading of a drive")
    tab.use("Mode", "○ Run")
    wait_for(lambda: "Now ● Paper vehicle" in text_of(html(tab, "trackride-compared")), "the run")


def test_a_drag_leaves_one_run_and_one_step(tab: Tab, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(app.session.workspace, "REST", 1.0)
    monkeypatch.setattr(app.runs.history, "REST", 1.0)
    slider = tab.find(SPEED)
    for step in range(30):
        tab.send("GuiUpdateMessage", uuid=slider, updates={"value": 20 + step})
        time.sleep(0.01)
    wait_for(lambda: len(rows(tab)) == 2, "the run to be kept")
    assert rows(tab) == ["Speed 15 → 49 km/h", "Paper vehicle"]
    tab.use("Parameters", "Undo")
    wait_for(lambda: tab.widget(SPEED)["value"] == 15)
    time.sleep(0.3)
    assert len(rows(tab)) == 2  # what was kept already is not kept again


def test_a_pinned_run_stays_in_plots_scene_and_table(explore: Any, open_tab: Any) -> None:
    explorer = explore()
    tab: Tab = open_tab(explorer)
    wait_for(lambda: tab.shows_run(1))
    scene: Any = explorer.sessions[0]._window.view
    tab.press("Pin this run as the baseline")
    wait_for(lambda: scene.ghosts, "the ghost")
    assert scene.ghosts[-1].config.drive.speed_kmh == 15
    change(tab, SPEED, 30, 2)
    wait_for(lambda: "+100 %" in html(tab, "trackride-figures"), "the comparison")
    chart = tab.charts()[0]
    assert any(np.allclose(column[:-3], 15, atol=1) for column in chart["data"][1:])  # the baseline's loads
    assert "Now ● Speed 15 → 30 km/h Baseline ● Paper vehicle" in text_of(html(tab, "trackride-compared"))
    tab.use("Baseline", "Swap")
    wait_for(lambda: tab.widget(SPEED)["value"] == 15)
    wait_for(lambda: "−50 %" in html(tab, "trackride-figures"), "the comparison the other way round")
    assert scene.ghosts[-1].config.drive.speed_kmh == 30
    tab.use("Baseline", "Clear")
    wait_for(lambda: scene.ghosts[-1] is None)
    wait_for(lambda: "change" not in text_of(html(tab, "trackride-figures")))
    tab.use("Baseline", "Swap")
    wait_for(lambda: [n for n in tab.notifications if n["title"] == "Nothing to swap"])


def test_runs_are_recalled_compared_renamed_and_deleted(tab: Tab) -> None:
    change(tab, SPEED, 20, 2)
    change(tab, "Amplitude, mm", 200, 3)
    wait_for(lambda: len(rows(tab)) == 3)
    first, second, third = "Paper vehicle", "Speed 15 → 20 km/h", "Speed 15 → 20 km/h, Amplitude 100 → 200 mm"
    assert rows(tab) == [third, second, first]
    assert tab.widget("Name")["value"] == third
    tab.use(second, "Show")
    wait_for(lambda: tab.widget("Amplitude, mm")["value"] == 100)
    wait_for(lambda: tab.widget("Name")["value"] == second)
    tab.use("Name", "the <b>quick</b> one")
    wait_for(lambda: "the <b>quick</b> one" in rows(tab))
    wait_for(lambda: "the &lt;b&gt;quick&lt;/b&gt; one" in html(tab, "trackride-compared"), "the name, escaped")
    tab.use(first, "Compare")
    wait_for(lambda: "Baseline ● Paper vehicle" in text_of(html(tab, "trackride-compared")))
    tab.use(first, "✕")
    wait_for(lambda: first not in rows(tab))
    assert "Baseline ● Paper vehicle" in text_of(html(tab, "trackride-compared"))  # it stays to be compared with
    tab.use("the <b>quick</b> one", "✕")
    wait_for(lambda: rows(tab) == [third])
    time.sleep(0.4)
    assert rows(tab) == [third]  # what the user has deleted does not come back by itself


def test_runs_that_nobody_rested_on_are_not_kept_and_runs_are_bounded(
    tab: Tab, monkeypatch: pytest.MonkeyPatch
) -> None:
    bound = 5
    monkeypatch.setattr(app.runs.history, "RUNS", bound)
    for k in range(bound + 3):
        tab.use(SPEED, 20 + k)
        wait_for(lambda k=k: tab.shows_run(k + 2))
        if k:
            wait_for(lambda k=k: f"Speed 15 → {20 + k} km/h" in rows(tab))
    assert len(rows(tab)) == bound
    assert "Paper vehicle" not in rows(tab)


def test_a_preset_is_saved_and_chosen_and_reset_leads_back_to_it(tab: Tab) -> None:
    change(tab, SPEED, 20, 2)
    tab.use("Preset name", "Mine")
    tab.use("As they are", "Save preset")
    wait_for(lambda: tab.widget("Preset")["value"] == "Mine")
    assert "Paper vehicle" in tab.widget("Preset")["props"]["options"]
    wait_for(lambda: tab.shows_run(3))
    change(tab, SPEED, 40, 4)
    tab.use("Parameters", "Reset")
    wait_for(lambda: tab.widget(SPEED)["value"] == 20)
    tab.use("Preset", "Paper vehicle")
    wait_for(lambda: tab.widget(SPEED)["value"] == 15)
    tab.use("Preset", "Mine")
    wait_for(lambda: tab.widget(SPEED)["value"] == 20)
    tab.use("Preset name", "x" * 200)
    tab.use("As they are", "Save preset")
    wait_for(lambda: "at most 100" in text_of(html(tab, "trackride-faults")), "the fault")


def test_the_state_comes_back_with_the_browser(explore: Any, open_tab: Any) -> None:
    explorer = explore()
    storage: dict[str, str] = {}
    tab: Tab = open_tab(explorer, storage=storage)
    wait_for(lambda: tab.shows_run(1))
    tab.use("Preset", "Half-round obstacle")
    change(tab, SPEED, 25, 3)
    wait_for(lambda: '"drive.speed_kmh": 25' in storage.get("trackride", ""), "the browser's storage")
    tab.use("Preset name", "Mine")
    tab.use("As they are", "Save preset")
    wait_for(lambda: '"name": "Mine"' in storage["trackride"])
    change(tab, SPEED, 26, 5)
    wait_for(lambda: '"drive.speed_kmh": 26' in storage["trackride"])
    tab.close()
    again: Tab = open_tab(explorer, storage=storage)
    wait_for(lambda: again.widget(SPEED)["value"] == 26, "the speed of the last visit")
    wait_for(lambda: again.widget("Preset")["value"] == "Mine", "the preset")
    assert again.widget("Road type")["value"] == "half round"
    again.use("Parameters", "Reset")
    wait_for(lambda: again.widget(SPEED)["value"] == 25)


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
    change(tab, SPEED, 20, 2)
    wait_for(lambda: len(rows(tab)) == 2)
    tab.use("Name", "the <b>quick</b> one")
    wait_for(lambda: "quick" in storage.get("trackride", ""), "the browser's storage")
    change(tab, SPEED, 30, 3)
    wait_for(lambda: len(rows(tab)) == 3)
    tab.use("Paper vehicle", "✕")
    wait_for(lambda: len(rows(tab)) == 2)
    wait_for(lambda: len(json.loads(storage["trackride"])["runs"]) == 2, "the browser's storage")
    assert rows(tab) == ["Speed 15 → 30 km/h", "the <b>quick</b> one"]
    colours = style(tab)
    tab.close()
    made.clear()

    again: Tab = open_tab(explorer, storage=storage)
    wait_for(lambda: [row for row in rows(again) if row != "Paper vehicle"] == rows(tab), "the runs of the last visit")
    wait_for(lambda: set(colours) <= set(style(again)), "their colours")
    wait_for(lambda: "Baseline ● Paper vehicle" in text_of(html(again, "trackride-compared")))
    wait_for(lambda: "+100 %" in html(again, "trackride-figures"), "the comparison with the baseline")
    scene: Any = explorer.sessions[-1]._window.view
    assert scene.ghosts[-1].config.drive.speed_kmh == 15
    assert 20 not in {config.drive.speed_kmh for config in made}  # nobody has asked for that run yet
    again.use("the <b>quick</b> one", "Compare")
    wait_for(lambda: scene.ghosts[-1] and scene.ghosts[-1].config.drive.speed_kmh == 20, "the run, made again")


def test_a_baseline_that_cannot_be_made_again_is_given_up_with_a_word(explore: Any, open_tab: Any) -> None:
    def simulate(config: Config, **how: Any) -> Trajectory:
        if config.drive.speed_kmh == 44:
            raise NoEquilibriumError("it does not stand")
        return simulate_at_once(config, **how)

    paper = load_config("paper")
    request = Request(paper).changed(SPEED_KEY, 44)
    kept = Runs().keep(request, make_run(request.config()))
    stored = state_text(paper, Request(paper), [], [], kept, dark=False)
    tab: Tab = open_tab(explore(run=simulate), storage={"trackride": stored})
    wait_for(lambda: [n for n in tab.notifications if n["title"] == "No baseline"], "a word")
    wait_for(lambda: "No baseline" in text_of(html(tab, "trackride-compared")))
    wait_for(lambda: json.loads(tab.storage["trackride"])["baseline"] is None)


def test_nothing_is_stored_before_the_browser_has_told_what_it_has(explore: Any, open_tab: Any) -> None:
    storage = {"trackride": "old"}
    tab: Tab = open_tab(explore(), storage=storage, mute=True)
    wait_for(lambda: rows(tab) == ["Paper vehicle"], "a run to be kept")
    time.sleep(0.4)
    assert storage == {"trackride": "old"}


def test_the_look_comes_back(explore: Any, open_tab: Any) -> None:
    explorer, storage = explore(), {}
    tab: Tab = open_tab(explorer, storage=storage)
    wait_for(lambda: tab.shows_run(1))
    wait_for(lambda: tab.widget("Dark")["value"] is False)
    tab.use("Dark", True)
    wait_for(lambda: json.loads(storage["trackride"])["dark"], "the look to be stored")
    again: Tab = open_tab(explorer, storage=storage)
    wait_for(lambda: again.widget("Dark")["value"] is True, "the look of the last visit")
    wait_for(lambda: explorer.sessions[-1]._window.view.dark)


def test_the_browsers_look_is_taken_until_another_is_chosen(explore: Any, open_tab: Any) -> None:
    explorer, storage = explore(), {}
    tab: Tab = open_tab(explorer, storage=storage)
    wait_for(lambda: tab.shows_run(1) and tab.widget("Dark")["value"] is False)
    tab.use("Dark pages", True)
    wait_for(lambda: tab.widget("Dark")["value"] is True, "the browser's look")
    wait_for(lambda: explorer.sessions[-1]._window.view.dark)
    wait_for(lambda: json.loads(storage["trackride"])["dark"] is None)
    tab.use("Dark", False)
    wait_for(lambda: json.loads(storage["trackride"])["dark"] is False, "the choice to be stored")
    again: Tab = open_tab(explorer, storage=storage)
    again.use("Dark pages", True)
    wait_for(lambda: again.shows_run(1) and explorer.sessions[-1]._workspace._prefers_dark)
    wait_for(lambda: rows(again) == ["Paper vehicle"])
    assert again.widget("Dark")["value"] is False


@pytest.mark.parametrize("stored", ["", "nonsense", "null", "{}", '{"presets": [1], "wish": 2, "runs": [{}]}'])
def test_what_is_no_state_is_left_alone(explore: Any, open_tab: Any, stored: str) -> None:
    tab: Tab = open_tab(explore(), storage={"trackride": stored})
    wait_for(lambda: tab.shows_run(1))
    wait_for(lambda: rows(tab) == ["Paper vehicle"])
    assert tab.shows_run(1)
    assert tab.notifications == []


def test_what_the_explorer_was_started_with_goes_before_the_last_visit(explore: Any, open_tab: Any) -> None:
    paper = load_config("paper")
    request = Request(paper).changed(SPEED_KEY, 33)
    kept = Runs().keep(request, make_run(request.config()))
    stored = state_text(paper, request, [paper.replace({"name": "Mine"})], [kept], kept, dark=False)
    tab: Tab = open_tab(explore(load_config("half_round"), "half_round"), storage={"trackride": stored})
    wait_for(lambda: "Mine" in tab.widget("Preset")["props"]["options"], "the saved preset")
    wait_for(lambda: "Speed 15 → 33 km/h" in rows(tab), "the kept run")
    assert tab.widget("Preset")["value"] == "Half-round obstacle"
    assert tab.widget(SPEED)["value"] == load_config("half_round").drive.speed_kmh
    assert "No baseline" in text_of(html(tab, "trackride-compared"))
