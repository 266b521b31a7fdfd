"""Downloads: what is sent, and in which order, without a server; the last tests go through a tab."""

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

import app.reports.run_report
import app.reports.sheet
from app.files.movie_frames import LENGTHS, MovieChoice
from app.files.pictures import FIGURE_SIZE
from app.runs.drive import Driver
from app.runs.request import Request
from app.session.downloads import AT_REST, MOST, NO_RUN, PAUSE_FIRST, SHOWN_AFTER, Download, Downloads, duration_words
from app.session.window import InView
from model.analysis.channels import USUAL
from model.config.config_files import load_config, parse_config
from model.simulation.trajectory import Trajectory
from tests.app.conftest import PATIENCE, Tab, make_run, wait_for
from tests.app.runs.test_drive import Clock
from tests.app.session.conftest import FakeWindow

PAPER = load_config("paper")
FASTER = Request(PAPER).changed("drive.speed_kmh", 22)
SHORT = MovieChoice(length=0.3)


class FakeClient:
    """The browser's side: it draws pictures of one colour and keeps what it is sent."""

    def __init__(self) -> None:
        self.sent: dict[str, bytes] = {}  # name -> content
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

    def __init__(self) -> None:
        self.errors: list[Exception] = []

    def post(self, kind: str, act: Callable[[], None]) -> None:
        act()

    def show_now(self, act: Callable[[], None]) -> None:
        act()

    def fail(self, error: Exception) -> None:
        self.errors.append(error)


class Rig:
    """Downloads among stand-ins, and a run to take home."""

    def __init__(self) -> None:
        self.run = make_run(FASTER.config())
        self.client, self.drawing, self.window = FakeClient(), FakeDrawing(), FakeWindow()
        parts: Any = (self.client, self.drawing, self.window)
        self.downloads = Downloads(*parts)
        self.download = Download(
            request=FASTER,
            run=self.run,
            baseline=None,
            beside=(),
            size=(64, 36),
            transparent=False,
            background="#ffffff",
            dark=False,
            movie=SHORT,
            channels=USUAL,
            time=1.0,
            drive=None,
            mode_shown=False,
        )

    def send(self, what: str, **changes: Any) -> tuple[str, bytes]:
        """Name and content of what the browser got last."""
        self.downloads.send(what, replace(self.download, **changes))
        self.wait()
        return list(self.client.sent.items())[-1] if self.client.sent else ("", b"")

    def wait(self) -> None:
        """Until nothing is under way."""
        wait_for(lambda: not any(queue.jobs for queue in self.downloads._queues), "the jobs to end")
        assert self.drawing.errors == []

    @property
    def lines(self) -> dict[str, int]:
        """Of the list of exports, once they have been there for a while: text -> number."""
        now = max((job.since for queue in self.downloads._queues for job in queue.jobs), default=0.0)
        self.downloads.tick(now + SHOWN_AFTER)
        return {line.text: line.number for line in self.window.exports.lines}


@pytest.fixture
def rig() -> Rig:
    return Rig()


def test_data_is_named_after_preset_and_change_and_holds_the_run(rig: Rig) -> None:
    name, content = rig.send("yaml")
    assert name == "paper-vehicle_speed-22-km-h.yaml"
    assert parse_config(content.decode()) == FASTER.config()
    name, content = rig.send("run.npz")
    assert name == "paper-vehicle_speed-22-km-h.npz"
    assert Trajectory.load(io.BytesIO(content), name).config == FASTER.config()
    assert rig.send("run.csv")[1] == rig.run.to_bytes(".csv")
    assert rig.send("run.csv", channels=("seat",))[1].startswith(b"t [s],seat forward acceleration [m/s2],")


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

    def hidden() -> None:
        raise TimeoutError

    rig.client.before_picture = hidden
    assert rig.send("figure.png")[0].endswith("_figure.png")
    assert [picture is not None for picture in pictures] == [True, False]


@pytest.mark.parametrize("what", ["picture", "figure.svg"])
def test_a_picture_shows_what_was_shown_when_it_was_asked_for(
    rig: Rig, what: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(app.reports.sheet, "stamped_figure", lambda *of: b"a figure")
    seen: list[tuple[InView | None, list[float]]] = []
    rig.client.before_picture = lambda: seen.append((rig.window.held, list(rig.window.times)))
    baseline = make_run()
    rig.send(what, time=0.7, baseline=baseline)
    assert seen == [(InView(rig.run, None, baseline, ()), [0.7])]
    assert rig.window.held is None


def test_a_picture_of_a_mode_shows_the_mode(rig: Rig) -> None:
    rig.window.shows_mode = True
    rig.send("picture", mode_shown=True)
    assert rig.window.times == []
    rig.window.shows_mode = False  # the user has left it meanwhile
    rig.send("picture", mode_shown=True)
    assert rig.window.times == [1.0]


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


def test_a_report_is_the_commands_with_the_baseline_and_says_how_far_it_is(
    rig: Rig, monkeypatch: pytest.MonkeyPatch
) -> None:
    parts: list[float | None] = []

    def page(run: Any, source: str, baseline: Any, on_progress: Callable[[float], None]) -> str:
        for part in (0.0, 0.5):
            on_progress(part)
            parts.append(rig.downloads._queues[1].jobs[0].part)
        return f"{source}, {run.config.drive.speed_kmh} against {baseline.config.drive.speed_kmh}"

    monkeypatch.setattr(app.reports.run_report, "report_page", page)
    name, content = rig.send("report", baseline=make_run(PAPER))
    assert name == "paper-vehicle_speed-22-km-h_report.html"
    assert content.decode() == "Paper vehicle: Speed 15 → 22 km/h, 22.0 against 15.0"
    assert parts == [0.0, 0.5]


def test_a_movie_films_what_was_shown_and_leaves_the_view_as_it_was(rig: Rig) -> None:
    name, content = rig.send("movie")
    assert name == "paper-vehicle_speed-22-km-h.mp4"
    assert b"ftyp" in content[:32]
    assert rig.window.times == pytest.approx([1.0, 1.0, 1.05, 1.1, 1.15, 1.2, 1.25])
    assert rig.window.held is None
    assert rig.client.sizes == 6 * [(64, 36)]


def test_a_movie_says_how_far_it_is_and_how_long_it_will_take(rig: Rig) -> None:
    seen: list[str] = []
    rig.client.before_picture = lambda: seen.extend(rig.lines)
    rig.send("movie", movie=MovieChoice(length=0.5, stamped=True))
    assert seen[:3] == ["Movie: under way", "Movie: 10 %", "Movie: 20 %"]
    assert seen[-1] == "Movie: 90 %, about 1 s left"
    assert duration_words(200) == "about 3 min left"
    assert rig.lines == {}


def test_one_export_is_cancelled_and_the_others_go_on(rig: Rig) -> None:
    go_on = threading.Event()
    rig.client.before_picture = lambda: go_on.wait(PATIENCE)
    for what in ("movie", "figure.png", "picture", "yaml"):
        rig.downloads.send(what, rig.download)
    wait_for(lambda: rig.client.sent, "what needs no browser")
    assert [name[-5:] for name in rig.client.sent] == [".yaml"]
    lines = ["Movie: under way", "Figure (PNG): waits for its turn", "Screenshot: waits for its turn"]
    assert list(rig.lines) == lines
    rig.downloads.cancel(rig.lines[lines[1]])
    rig.downloads.cancel(rig.lines[lines[0]])
    assert list(rig.lines) == ["Movie: ends", lines[2]]
    go_on.set()
    rig.wait()
    assert [name[-4:] for name in rig.client.sent] == ["yaml", ".png"]
    assert rig.window.said == [("Nothing was downloaded", "Movie was cancelled.")]
    assert rig.window.held is None
    assert rig.drawing.errors == []


def test_there_is_an_end_to_what_waits(rig: Rig) -> None:
    go_on = threading.Event()
    rig.client.before_picture = lambda: go_on.wait(PATIENCE)
    for _ in range(MOST + 1):
        rig.downloads.send("picture", rig.download)
    assert rig.window.titles == ["Enough for now"]
    go_on.set()
    rig.downloads.close()
    rig.wait()
    assert rig.client.sent == {}


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
    assert stood.refusal.keys() == {"run.npz", "report"}
    assert stood.title == "Paper vehicle: Speed 15 → 22 km/h, drive 0–0 s"


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
    monkeypatch.setitem(LENGTHS, "4 s", 0.3)
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
    wait_for(lambda: not any("Movie:" in str(w["props"].get("label")) for w in tuple(tab.widgets.values())), "no line")
