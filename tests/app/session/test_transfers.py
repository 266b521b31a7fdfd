"""Downloads and uploads: what is sent and what is made of files, without a server; the last tests go through a tab."""

from __future__ import annotations

import io
import threading
from collections.abc import Callable
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from PIL import Image

import app.reports.sheet
from app.files.pictures import FIGURE_SIZE
from app.runs.drive import Driver
from app.runs.request import Request
from app.runs.storage import state_text
from app.session.transfers import AT_REST, NO_RUN, PAUSE_FIRST, STORED, Download, Transfers
from model.config.config import Config
from model.config.config_files import load_config, parse_config
from model.dynamics.equilibrium import NoEquilibriumError
from model.simulation.trajectory import Trajectory
from tests.app.conftest import PATIENCE, Tab, make_run, simulate_at_once, wait_for
from tests.app.runs.test_drive import Clock
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
    """The browser's side: it draws pictures of one colour and keeps what it is sent."""

    def __init__(self) -> None:
        self.sent: dict[str, bytes] = {}  # name -> content
        self.local_storage = FakeStorage()
        self.camera = SimpleNamespace(wxyz=np.array([1.0, 0, 0, 0]), position=np.zeros(3), fov=0.4, aspect=1.6)
        self.sizes: list[tuple[int, int]] = []  # of pictures that were asked for
        self.before_picture: Callable[[], None] = lambda: None

    def get_render(self, height: int, width: int, *, transport_format: str, **how: Any) -> np.ndarray:
        self.sizes.append((width, height))
        self.before_picture()
        return np.full((height, width, 3 if transport_format == "jpeg" else 4), 60, dtype=np.uint8)

    def send_file_download(self, name: str, content: bytes, save_immediately: bool) -> None:
        self.sent[name] = content


class FakeDrawing:
    """The thread that draws: what it is given is done at once."""

    def __init__(self, shown: Trajectory | None) -> None:
        self.shown = shown
        self.times: list[float] = []
        self.toggled = 0
        self.errors: list[Exception] = []

    def post(self, kind: str, act: Callable[[], None]) -> None:
        act()

    def show_now(self, act: Callable[[], None]) -> None:
        act()

    def seek(self, time: float) -> None:
        self.times.append(time)

    def toggle(self) -> None:
        self.toggled += 1

    def fail(self, error: Exception) -> None:
        self.errors.append(error)


class Rig:
    """Transfers among stand-ins, and a run to take home."""

    def __init__(self, simulate: Any = simulate_at_once) -> None:
        self.run = make_run(FASTER.config())
        self.client, self.drawing = FakeClient(), FakeDrawing(self.run)
        self.window, self.workspace = FakeWindow(), Called()
        parts: Any = (self.client, self.drawing, self.window, self.workspace)
        self.transfers = Transfers(*parts, simulate)
        self.download = Download(
            request=FASTER,
            run=self.run,
            baseline=None,
            size=(64, 36),
            transparent=False,
            background="#ffffff",
            dark=False,
            time=1.0,
            playing=False,
            drive=None,
        )

    def send(self, what: str, **changes: Any) -> tuple[str, bytes]:
        """Name and content of what the browser got last."""
        self.transfers.send(what, replace(self.download, **changes))
        self.wait()
        return list(self.client.sent.items())[-1] if self.client.sent else ("", b"")

    def wait(self) -> None:
        """Until nothing is under way."""
        jobs = (self.transfers._files, self.transfers._memory)
        wait_for(lambda: not any(job.busy for job in jobs), "the job to end")


@pytest.fixture
def rig() -> Rig:
    return Rig()


# ── Out ──


def test_data_is_named_after_preset_and_change_and_holds_the_run(rig: Rig) -> None:
    name, content = rig.send("yaml")
    assert name == "paper-vehicle_speed-22-km-h.yaml"
    assert parse_config(content.decode()) == FASTER.config()
    name, content = rig.send("run.npz")
    assert name == "paper-vehicle_speed-22-km-h.npz"
    assert Trajectory.load(io.BytesIO(content), name).config == FASTER.config()
    assert rig.send("run.csv")[1].startswith(b"t [s],")
    assert rig.window.progress == []


def test_a_figure_is_made_with_a_picture_of_the_vehicle_or_without(rig: Rig, monkeypatch: pytest.MonkeyPatch) -> None:
    pictures: list[bytes | None] = []

    def figure(run: Any, baseline: Any, picture: bytes | None, title: str, suffix: str, time: float) -> bytes:
        pictures.append(picture)
        return f"{title} {suffix} {time:g}".encode()

    monkeypatch.setattr(app.reports.sheet, "stamped_figure", figure)
    name, content = rig.send("figure.svg")
    assert name == "paper-vehicle_speed-22-km-h_figure.svg"
    assert content.decode() == "Paper vehicle: Speed 15 → 22 km/h .svg 1"
    assert rig.client.sizes == [FIGURE_SIZE]
    assert rig.window.progress == ["Drawing the figure…", ""]

    def hidden() -> None:
        raise TimeoutError

    rig.client.before_picture = hidden
    assert rig.send("figure.png")[0].endswith("_figure.png")
    assert [picture is not None for picture in pictures] == [True, False]


@pytest.mark.parametrize("what", ["picture", "figure.svg"])
def test_a_picture_taken_while_the_run_plays_shows_the_moment_that_it_says(
    rig: Rig, what: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(app.reports.sheet, "stamped_figure", lambda *of: b"a figure")
    seen: list[tuple[list[float], int]] = []
    rig.client.before_picture = lambda: seen.append((list(rig.drawing.times), rig.drawing.toggled))
    rig.send(what, playing=True, time=0.7)
    assert seen == [([0.7], 0)]
    assert rig.drawing.toggled == 1  # it plays on
    rig.send(what, time=0.7)
    assert rig.drawing.times == [0.7]


def test_a_transparent_picture_has_neither_sky_nor_ground(rig: Rig) -> None:
    seen: list[list[bool]] = []
    rig.client.before_picture = lambda: seen.append(list(rig.window.surroundings))
    name, content = rig.send("picture", transparent=True)
    assert name == "paper-vehicle_speed-22-km-h_64x36.png"
    assert Image.open(io.BytesIO(content)).mode == "RGBA"
    assert seen == [[False]]
    assert rig.window.surroundings == [False, True]
    assert Image.open(io.BytesIO(rig.send("picture")[1])).mode == "RGB"


def test_sky_and_ground_come_back_after_a_picture_that_failed(rig: Rig) -> None:
    def gone() -> None:
        raise RuntimeError

    rig.client.before_picture = gone
    assert rig.send("picture", transparent=True) == ("", b"")
    assert rig.window.titles == ["No picture"]
    assert rig.window.surroundings == [False, True]


@pytest.fixture
def _short_movie(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("app.session.transfers.MOVIE_LENGTH", 0.3)
    monkeypatch.setattr("app.files.pictures.MOVIE_SIZE", (64, 36))


@pytest.mark.usefixtures("_short_movie")
def test_a_movie_films_the_run_and_playback_goes_on(rig: Rig) -> None:
    name, content = rig.send("movie", playing=True)
    assert name == "paper-vehicle_speed-22-km-h.mp4"
    assert b"ftyp" in content[:32]
    assert rig.drawing.times == pytest.approx([1.0, 1.05, 1.1, 1.15, 1.2, 1.25, 1.0])
    assert rig.drawing.toggled == 1
    assert rig.window.progress[-2:] == ["Filming… 100 %", ""]
    rig.send("movie", time=1.9)
    assert rig.drawing.times[7] == pytest.approx(1.7)  # so that it is as long as others


@pytest.mark.usefixtures("_short_movie")
def test_a_movie_is_cancelled_by_the_user_and_by_a_new_run(rig: Rig) -> None:
    rig.client.before_picture = rig.transfers.stop
    rig.send("movie")
    assert rig.window.said[-1] == ("Nothing was downloaded", "The movie was cancelled.")

    def other_run() -> None:
        rig.drawing.shown = make_run()

    rig.client.before_picture = other_run
    rig.send("movie")
    assert "The run changed" in rig.window.said[-1][1]
    assert rig.client.sent == {}
    assert rig.drawing.times[-1] == 1.0
    assert rig.drawing.errors == []


def test_one_file_is_made_at_a_time(rig: Rig) -> None:
    go_on = threading.Event()
    rig.client.before_picture = lambda: go_on.wait(PATIENCE)
    rig.transfers.send("picture", rig.download)
    rig.transfers.send("yaml", rig.download)
    assert rig.window.titles == ["One at a time"]
    go_on.set()
    rig.wait()
    assert [name[-4:] for name in rig.client.sent] == [".png"]
    rig.transfers.close()


def test_what_a_drive_gives_to_take_home(rig: Rig) -> None:
    clock = Clock()
    driver = Driver(FASTER.config(), clock)
    for _ in range(5):
        clock.now += 0.1
        state = driver.frame(1.0)
    drive = {"run": state.past, "drive": state}
    for what in AT_REST:
        rig.send(what, **drive)
        assert rig.window.said[-1] == ("Nothing was downloaded", PAUSE_FIRST)
    rig.send("run.npz", **drive)
    assert rig.window.said[-1][1] == NO_RUN
    assert rig.client.sent == {}
    assert rig.send("run.csv", **drive)[0] == "paper-vehicle_speed-22-km-h_drive-0-0-s.csv"
    state = driver.stand()
    stood = replace(rig.download, run=state.past, drive=state)
    assert stood.refusal.keys() == {"run.npz"}
    assert stood.title == "Paper vehicle: Speed 15 → 22 km/h, drive 0–0 s"


# ── In ──


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
    (asked,) = rig.window.asked
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
    assert [(question.reading, question.why) for question in rig.window.asked[1:]] == [(asked.reading, "")]
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


@pytest.fixture
def tab(explore: Any, open_tab: Any) -> Tab:
    opened: Tab = open_tab(explore())
    wait_for(lambda: opened.shows_run(1), "run 1")
    opened.use("Speed, km/h", 22)
    wait_for(lambda: opened.shows_run(2), "run 2")
    return opened


def download(tab: Tab, suffix: str) -> tuple[str, bytes]:
    """Name and content of the download with this suffix."""
    start = wait_for(
        lambda: [
            m
            for m in tuple(tab.messages)
            if m["type"] == "FileTransferStartDownload" and m["filename"].endswith(suffix)
        ],
        suffix,
    )[-1]

    def parts() -> list[dict[str, Any]]:
        return [
            m
            for m in tuple(tab.messages)
            if m["type"] == "FileTransferPart" and m["transfer_uuid"] == start["transfer_uuid"]
        ]

    wait_for(lambda: len(parts()) == start["part_count"], "all of it")
    return start["filename"], b"".join(
        bytes(part["content"]) for part in sorted(parts(), key=lambda m: m["part_index"])
    )


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


def renders(tab: Tab) -> int:
    """How many pictures were asked for."""
    return len([m for m in tuple(tab.messages) if m["type"] == "GetRenderRequestMessage"])


def answer_renders(tab: Tab, seen: int = 0) -> int:
    """Answer all requests for pictures but the first `seen`; how many there were."""
    requests = [m for m in tuple(tab.messages) if m["type"] == "GetRenderRequestMessage"]
    for request in requests[seen:]:
        file = io.BytesIO()
        kind = request["format"].removeprefix("image/")
        Image.new("RGB" if kind == "jpeg" else "RGBA", (request["width"], request["height"]), "green").save(file, kind)
        tab.send("GetRenderResponseMessage", payload=file.getvalue(), render_uuid=request["render_uuid"])
    return len(requests)


def html(tab: Tab, mark: str) -> str:
    texts = [w["props"]["content"] for w in tuple(tab.widgets.values()) if w["type"] == "GuiHtmlMessage"]
    return next((text for text in texts if f'class="{mark}"' in text), "")


def test_the_run_is_downloaded(tab: Tab) -> None:
    tab.use("Data", "NPZ")
    name, content = download(tab, ".npz")
    assert name == "paper-vehicle_speed-22-km-h.npz"
    assert Trajectory.load(io.BytesIO(content), name).config.drive.speed_kmh == 22


def test_a_figure_is_made_with_the_view_of_the_page(tab: Tab) -> None:
    tab.use("Figure", "SVG")
    wait_for(lambda: answer_renders(tab), "a picture of the view")
    assert b"<svg" in download(tab, ".svg")[1]


def test_a_movie_is_filmed_from_the_page(explore: Any, open_tab: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("app.session.transfers.MOVIE_LENGTH", 0.3)
    monkeypatch.setattr("app.files.pictures.MOVIE_SIZE", (64, 36))
    explorer = explore()
    tab: Tab = open_tab(explorer)
    wait_for(lambda: tab.shows_run(1))
    view: Any = explorer.sessions[0]._window.view
    tab.use("Time, s", 1.0)
    wait_for(lambda: view.times[-1:] == [1.0])
    tab.use("In motion", "Movie")
    count = 0
    times = []
    while count < 6:
        wait_for(lambda count=count: renders(tab) > count, "a request")
        times.append(view.times[-1])
        count = answer_renders(tab, count)
    assert times == pytest.approx([1.0, 1.05, 1.1, 1.15, 1.2, 1.25])
    name, content = download(tab, ".mp4")
    assert name == "paper-vehicle.mp4"
    assert b"ftyp" in content[:32]
    wait_for(lambda: view.times[-1] == 1.0, "the time that was shown before")
    assert [n for n in tab.notifications if n["title"] == "One moment"]


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
