"""Uploads, and what the browser stores, without a server; the last tests go through a tab."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

import pytest

from app.runs.project import Project, project_text
from app.runs.request import Request
from app.runs.storage import state_text
from app.runs.study_choice import StudyChoice
from app.session.transfers import STORED, Transfers
from model.config.config import Config
from model.config.config_files import load_config, parse_config
from model.dynamics.equilibrium import NoEquilibriumError
from model.simulation.trajectory import Trajectory
from tests.app.conftest import PATIENCE, Tab, make_run, simulate_at_once, wait_for
from tests.app.session.conftest import Called, FakeWindow

PAPER = load_config("paper")
FASTER = Request(PAPER).changed("drive.speed_kmh", 22)


class FakeStorage:
    """What a browser has stored."""

    def __init__(self) -> None:
        self.items: dict[str, str] = {}
        self.mute = False

    def get_item(self, key: str, timeout: float) -> str | None:
        if self.mute:
            raise TimeoutError
        return self.items.get(key)

    def set_item(self, key: str, value: str) -> None:
        self.items[key] = value


class FakeClient:
    """The browser's side."""

    def __init__(self) -> None:
        self.local_storage = FakeStorage()


class FakeDrawing:
    """The thread that draws: what it is given is done at once."""

    def __init__(self, shown: Trajectory | None) -> None:
        self.shown = shown
        self.errors: list[Exception] = []

    def post(self, kind: str, act: Callable[[], None]) -> None:
        act()

    def fail(self, error: Exception) -> None:
        self.errors.append(error)


class Rig:
    """Transfers among stand-ins."""

    def __init__(self, simulate: Any = simulate_at_once) -> None:
        self.run = make_run(FASTER.config())
        self.client, self.drawing = FakeClient(), FakeDrawing(self.run)
        self.window, self.workspace = FakeWindow(), Called()
        parts: Any = (self.client, self.drawing, self.window, self.workspace)
        self.transfers = Transfers(*parts, simulate)

    def wait(self) -> None:
        """Until nothing is under way."""
        jobs = (self.transfers._files, self.transfers._memory)
        wait_for(lambda: not any(job.busy for job in jobs), "the job to end")


@pytest.fixture
def rig() -> Rig:
    return Rig()


def test_an_uploaded_configuration_is_used_or_its_faults_are_shown(rig: Rig) -> None:
    rig.transfers.take_configuration("tank.yaml", b"name: My tank\ndrive: {speed_kmh: 40}\n")
    assert rig.workspace.calls == [("use_configuration", Config(name="My tank").replace({"drive.speed_kmh": 40}))]
    rig.transfers.take_configuration("bad.yaml", b"drive: {speed_kmh: 4000}\nroads: {}\n")
    title, faults = rig.window.faults[-1]
    assert title == "bad.yaml cannot be used"
    assert len(faults.faults) == 2
    assert len(rig.workspace.calls) == 1
    assert rig.window.to_mend == "drive: {speed_kmh: 4000}\nroads: {}\n"


def test_an_uploaded_profile_becomes_the_road_or_its_faults_are_shown(rig: Rig) -> None:
    rig.transfers.take_profile("good.csv", b"x [m],y [m]\n0,0\n1,0.1\n3,0\n")
    rig.wait()
    ((name, changes_of),) = rig.workspace.calls
    assert name == "change_road"
    assert changes_of(PAPER)["road.type"] == "profile"
    assert rig.window.said == [("Another road", "good.csv: 3 points, 0 to 3 m, heights 0 to 100 mm; read as m.")]
    rig.transfers.take_profile("bad.csv", b"x,y\n0,0\n1,high\n")
    rig.wait()
    assert "'high' is no number" in str(rig.window.faults[-1][1])
    assert len(rig.workspace.calls) == 1


def test_a_profile_that_is_not_clear_is_asked_about_and_so_is_one_in_use_on_demand(rig: Rig) -> None:
    content = b"x,y\n0,0\n1,90\n3,0\n"
    rig.transfers.take_profile("a.csv", content)
    rig.wait()
    (asked,) = rig.window.profiles
    assert (asked.name, asked.reading.units, rig.workspace.calls) == ("a.csv", ("m", "mm"), [])
    rig.transfers.ask_about_profile()  # it is not in use yet
    assert rig.window.titles == ["No file here"]
    read = asked.source.read(asked.reading.columns, asked.reading.units)
    rig.transfers.use_profile("a.csv", read, asked.reading)
    changes = rig.workspace.calls[0][1](PAPER)
    assert changes["road.units"] == ("m", "mm")
    assert (
        rig.window.said[-1][1]
        == "a.csv: 3 points, 0 to 3 m, heights 0 to 90 mm; x read as m, heights as mm; columns x and y."
    )
    rig.drawing.shown = make_run(PAPER.replace(changes))
    rig.transfers.ask_about_profile()
    rig.wait()
    assert [(question.reading, question.why) for question in rig.window.profiles[1:]] == [(asked.reading, "")]
    assert rig.window.faults == []


def test_an_uploaded_run_becomes_the_baseline_or_is_refused_with_a_word(rig: Rig) -> None:
    rig.transfers.take_run("mine.npz", rig.run.to_bytes(".npz"))
    rig.wait()
    ((name, run, title),) = rig.workspace.calls
    assert (name, run.config, title) == ("take_in", FASTER.config(), "mine")
    rig.transfers.take_run("bad.npz", b"PK\x03\x04 nonsense")
    rig.wait()
    assert rig.window.titles == ["No run"]
    assert len(rig.workspace.calls) == 1


def test_an_uploaded_project_is_opened_at_once_after_a_question_or_not_at_all(rig: Rig) -> None:
    project = Project(FASTER, (), (), (), None, StudyChoice())
    content = project_text(project).encode()
    rig.workspace.at_hand = ""
    rig.transfers.take_project("mine.trackride", content)
    rig.wait()
    assert [name for name, *_ in rig.workspace.calls] == ["open_project"]
    rig.workspace.at_hand = "3 kept runs"
    rig.transfers.take_project("mine.trackride", content)
    rig.wait()
    assert len(rig.workspace.calls) == 1
    title, words, _, act = rig.window.asked[-1]
    assert (title, words) == ("Open mine.trackride?", "It takes the place of 3 kept runs. Your presets stay.")
    act()
    assert len(rig.workspace.calls) == 2
    rig.transfers.take_project("bad.trackride", content.replace(b"22.0", b"2200.0"))
    rig.wait()
    assert "shown: drive.speed_kmh" in str(rig.window.faults[-1][1])
    assert len(rig.workspace.calls) == 2


# ── What the browser remembers ──


@pytest.mark.parametrize("stored", ["", "nonsense", "null", None])
def test_what_is_no_state_is_left_alone(rig: Rig, stored: str | None) -> None:
    if stored is not None:
        rig.client.local_storage.items[STORED] = stored
    rig.transfers.recollect("null")
    rig.wait()
    assert rig.workspace.calls == [("restore", None)]


def test_the_browsers_state_is_restored_and_a_mute_browser_has_none(rig: Rig) -> None:
    rig.transfers.remember(state_text(PAPER, FASTER, [], [], None, dark=True))
    rig.transfers.recollect("null")
    rig.wait()
    ((name, state),) = rig.workspace.calls
    assert (name, state.request.config(), state.dark) == ("restore", FASTER.config(), True)
    rig.client.local_storage.mute = True
    rig.transfers.recollect("null")
    rig.wait()
    assert rig.workspace.calls[-1] == ("restore", None)


def test_a_tab_that_is_loaded_anew_goes_on_where_it_was_with_the_presets_of_all_tabs(rig: Rig) -> None:
    mine, other = PAPER.replace({"name": "Mine"}), PAPER.replace({"name": "Other"})
    rig.transfers.remember(state_text(PAPER, FASTER, [mine], [], None, dark=True))
    (visit,) = rig.window.stored
    rig.transfers.remember(state_text(PAPER, Request(PAPER), [other], [], None, dark=False))
    rig.transfers.recollect(visit)
    rig.wait()
    ((_, state),) = rig.workspace.calls
    assert (state.request.config(), state.dark, state.presets) == (FASTER.config(), True, (other, mine))


def test_a_missing_run_is_made_again_once_at_a_time_and_where_it_cannot_the_workspace_is_told() -> None:
    go_on = threading.Event()
    made: list[Config] = []

    def simulate(config: Config, **how: Any) -> Trajectory:
        made.append(config)
        go_on.wait(PATIENCE)
        if config == PAPER:
            raise NoEquilibriumError("it does not stand")
        return simulate_at_once(config, **how)

    rig = Rig(simulate)
    rig.transfers.run_again(FASTER.config())
    rig.transfers.run_again(FASTER.config())
    go_on.set()
    rig.wait()
    assert made == [FASTER.config()]
    name, config, run = rig.workspace.calls[-1]
    assert (name, config, run.config) == ("made_again", FASTER.config(), FASTER.config())
    rig.transfers.run_again(PAPER)
    rig.wait()
    assert rig.workspace.calls[-1] == ("made_again", PAPER, None)
    assert [type(error) for error in rig.drawing.errors] == [NoEquilibriumError]


# ── With a tab ──


def upload(tab: Tab, button: str, name: str, content: bytes) -> None:
    uuid = tab.find(button)
    tab.send(
        "FileTransferStartUpload",
        source_component_uuid=uuid,
        transfer_uuid=name,
        filename=name,
        mime_type="",
        part_count=1,
        size_bytes=len(content),
    )
    tab.send("FileTransferPart", source_component_uuid=uuid, transfer_uuid=name, part_index=0, content=content)


def html(tab: Tab, mark: str) -> str:
    texts = [w["props"]["content"] for w in tuple(tab.widgets.values()) if w["type"] == "GuiHtmlMessage"]
    return next((text for text in texts if f'class="{mark}"' in text), "")


def test_an_uploaded_configuration_is_run_and_can_be_undone(tab: Tab) -> None:
    upload(tab, "Open a configuration", "tank.yaml", b"name: My tank\ndrive: {speed_kmh: 40}\n")
    wait_for(lambda: tab.widget("Speed, km/h")["value"] == 40)
    wait_for(lambda: tab.widget("Preset")["value"] == "My tank")
    tab.use("Changes", "Undo")
    wait_for(lambda: tab.widget("Speed, km/h")["value"] == 22)
    wait_for(lambda: tab.widget("Preset")["value"] == "Paper vehicle", "the preset")


def test_faults_of_an_uploaded_configuration_are_all_shown_escaped_and_nothing_changes(tab: Tab) -> None:
    text = "drive: {speed_kmh: 4000}\nvehicle: {'<img src=x onerror=alert(1)>': 3}\nroads: {}\n"
    upload(tab, "Open a configuration", "bad.yaml", text.encode())
    shown = wait_for(lambda: html(tab, "trackride-faults"), "the faults")
    assert shown.count("<li") == 3
    assert "<style>" in shown  # those of tabs that nobody has opened are not there
    assert "from 0.5 to 100 km/h" in shown
    assert "the nearest known one is road" in shown
    assert "<img" not in shown
    assert tab.shows_run(2)
    assert "Line 1: drive.speed_kmh" in shown
    tab.use("Close", True)
    wait_for(lambda: [m for m in tab.messages if m["type"] == "GuiCloseModalMessage"])


def test_a_faulty_configuration_is_mended_as_text(tab: Tab) -> None:
    text = "name: My tank\nroad: {type: sine, amplitude: 0.1\ndrive: {speed_kmh: 40}\n"
    upload(tab, "Open a configuration", "bad.yaml", text.encode())
    wait_for(lambda: "line 2 is" in html(tab, "trackride-faults"), "the fault")
    tab.use("Edit", True)
    wait_for(lambda: tab.widget("YAML")["value"] == text, "the text")
    assert 'data-line="2"' in html(tab, "trackride-faults")
    mended = text.replace("0.1", "0.1}")
    tab.use("YAML", mended.replace("40", "4000"))
    tab.use("Use this", True)
    wait_for(lambda: "Line 3: drive.speed_kmh" in html(tab, "trackride-faults"), "the next fault")
    tab.use("YAML", mended)
    tab.use("Use this", True)
    wait_for(lambda: tab.widget("Preset")["value"] == "My tank", "the mended one")
    upload(tab, "Open a configuration", "bad.yaml", b"\xff\xfe\x00")
    wait_for(lambda: "not UTF-8" in html(tab, "trackride-faults"), "the fault")
    assert not [w for w in tab.widgets.values() if w["props"].get("label") == "Edit"]


def test_a_configuration_is_edited_as_text(tab: Tab) -> None:
    tab.use("Present values", "Edit YAML")
    text = tab.widget("YAML")["value"]
    assert "<style>" in html(tab, "trackride-yaml")
    assert parse_config(text).drive.speed_kmh == 22
    tab.use("YAML", text.replace("speed_kmh: 22", "speed_kmh: 2200"))
    tab.use("Use this", True)
    assert "speed_kmh" in wait_for(lambda: html(tab, "trackride-faults"), "the fault")
    assert tab.shows_run(2)
    tab.use("YAML", text.replace("speed_kmh: 22", "speed_kmh: 23"))
    tab.use("Use this", True)
    wait_for(lambda: tab.widget("Speed, km/h")["value"] == 23)
    tab.use("Changes", "Reset")
    wait_for(lambda: tab.widget("Speed, km/h")["value"] == 15)  # it was a change of the preset


def test_an_uploaded_run_becomes_the_baseline(explore: Any, open_tab: Any) -> None:
    explorer = explore()
    tab: Tab = open_tab(explorer)
    wait_for(lambda: tab.shows_run(1))
    view: Any = explorer.sessions[0]._window.view
    run = make_run(PAPER.replace({"drive.speed_kmh": 44}))
    upload(tab, "Open a run as baseline", "mine.npz", run.to_bytes(".npz"))
    wait_for(lambda: view.ghosts and view.ghosts[-1], "the ghost")
    assert view.ghosts[-1].config.drive.speed_kmh == 44
    wait_for(lambda: "mine" in html(tab, "trackride-compared"))
