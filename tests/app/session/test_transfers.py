"""Downloads and uploads of a tab, over viser's own protocol."""

from __future__ import annotations

import io
import time
import zipfile
from typing import Any

import numpy as np
import pytest
from PIL import Image

import app.session.background
from app.files.uploads import configuration, run_from
from model.config.config import SIZE_LIMIT, ConfigError, load_config, parse_config
from model.simulation.trajectory import Trajectory
from tests.app.conftest import Tab, make_run, trackride_threads, wait_for

PAPER = load_config("paper")


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


def test_data_is_named_after_preset_and_change_and_holds_the_run(tab: Tab) -> None:
    tab.use("Data", "YAML")
    name, content = download(tab, ".yaml")
    assert name == "paper-vehicle_speed-22-km-h.yaml"
    assert parse_config(content.decode()) == PAPER.replace({"drive.speed_kmh": 22})
    tab.use("Data", "NPZ")
    name, content = download(tab, ".npz")
    assert name == "paper-vehicle_speed-22-km-h.npz"
    assert Trajectory.load(io.BytesIO(content), name).config.drive.speed_kmh == 22
    tab.use("Data", "CSV")
    assert download(tab, ".csv")[1].startswith(b"t [s],")


def test_a_figure_is_made_with_the_scene_of_the_page(tab: Tab) -> None:
    tab.use("Figure", "SVG")
    wait_for(lambda: answer_renders(tab), "a picture of the scene")
    name, content = download(tab, ".svg")
    assert name == "paper-vehicle_speed-22-km-h_figure.svg"
    assert b"<svg" in content


def test_a_transparent_picture_has_neither_sky_nor_ground(explore: Any, open_tab: Any) -> None:
    explorer = explore()
    tab: Tab = open_tab(explorer)
    wait_for(lambda: tab.shows_run(1))
    scene: Any = explorer.sessions[0]._window.view
    tab.use("Transparent", True)
    tab.press("Screenshot")
    wait_for(lambda: [m for m in tuple(tab.messages) if m["type"] == "GetRenderRequestMessage"], "a request")
    assert not scene.show_surroundings
    answer_renders(tab)
    assert Image.open(io.BytesIO(download(tab, ".png")[1])).mode == "RGBA"
    wait_for(lambda: scene.show_surroundings, "sky and ground to come back")


def test_a_movie_films_the_run_and_playback_goes_on(
    explore: Any, open_tab: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("app.session.transfers.MOVIE_LENGTH", 0.3)
    monkeypatch.setattr("app.files.pictures.MOVIE_SIZE", (64, 36))
    explorer = explore()
    tab: Tab = open_tab(explorer)
    wait_for(lambda: tab.shows_run(1))
    scene: Any = explorer.sessions[0]._window.view
    tab.use("Time, s", 1.0)
    wait_for(lambda: scene.times[-1:] == [1.0])
    tab.use("In motion", "Movie")
    count = 0
    times = []
    while count < 6:
        wait_for(lambda count=count: renders(tab) > count, "a request")
        times.append(scene.times[-1])
        count = answer_renders(tab, count)
    assert times == pytest.approx([1.0, 1.05, 1.1, 1.15, 1.2, 1.25])
    name, content = download(tab, ".mp4")
    assert name == "paper-vehicle.mp4"
    assert b"ftyp" in content[:32]
    wait_for(lambda: scene.times[-1] == 1.0, "the time that was shown before")
    assert [n for n in tab.notifications if n["title"] == "One moment"]


def test_a_movie_is_cancelled_by_the_user_and_by_a_new_run(tab: Tab) -> None:
    for act in (lambda: tab.use("In motion", "Cancel"), lambda: tab.use("Speed, km/h", 33)):
        before = len(tab.notifications)
        count = answer_renders(tab)
        tab.use("In motion", "Movie")
        wait_for(lambda count=count: renders(tab) > count, "a request")
        act()
        time.sleep(0.2)
        answer_renders(tab, count)
        wait_for(
            lambda before=before: [n for n in tab.notifications[before:] if n["title"] == "Nothing was downloaded"],
            "a word",
        )
        wait_for(lambda: trackride_threads() == {"trackride-runner", "trackride-view"})


def test_an_uploaded_configuration_is_run_and_can_be_undone(tab: Tab) -> None:
    upload(tab, "Open a configuration", "tank.yaml", b"name: My tank\ndrive: {speed_kmh: 40}\n")
    wait_for(lambda: tab.widget("Speed, km/h")["value"] == 40)
    wait_for(lambda: tab.widget("Preset")["value"] == "My tank")
    tab.use("Parameters", "Undo")
    wait_for(lambda: tab.widget("Speed, km/h")["value"] == 22)
    wait_for(lambda: tab.widget("Preset")["value"] == "Paper vehicle", "the preset")


def test_faults_of_an_uploaded_configuration_are_all_shown_escaped_and_nothing_changes(tab: Tab) -> None:
    text = "drive: {speed_kmh: 4000}\nvehicle: {'<img src=x onerror=alert(1)>': 3}\nroads: {}\n"
    upload(tab, "Open a configuration", "bad.yaml", text.encode())
    shown = wait_for(lambda: html(tab, "trackride-faults"), "the faults")
    assert shown.count("<li>") == 3
    assert "<style>" in shown  # those of tabs that nobody has opened are not there
    assert "from 0.5 to 100 km/h" in shown
    assert "the nearest known one is road" in shown
    assert "<img" not in shown
    assert tab.shows_run(2)
    tab.use("Close", True)
    wait_for(lambda: [m for m in tab.messages if m["type"] == "GuiCloseModalMessage"])


def test_a_configuration_is_edited_as_text(tab: Tab) -> None:
    tab.use("As they are", "Edit YAML")
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
    tab.use("Parameters", "Reset")
    wait_for(lambda: tab.widget("Speed, km/h")["value"] == 15)  # it was a change of the preset


def test_an_uploaded_run_becomes_the_baseline(explore: Any, open_tab: Any) -> None:
    explorer = explore()
    tab: Tab = open_tab(explorer)
    wait_for(lambda: tab.shows_run(1))
    scene: Any = explorer.sessions[0]._window.view
    run = make_run(PAPER.replace({"drive.speed_kmh": 44}))
    upload(tab, "Open a run as baseline", "mine.npz", run.to_bytes(".npz"))
    wait_for(lambda: scene.ghosts and scene.ghosts[-1], "the ghost")
    assert scene.ghosts[-1].config.drive.speed_kmh == 44
    wait_for(lambda: "mine" in html(tab, "trackride-compared"))
    upload(tab, "Open a run as baseline", "<b>.npz", b"PK\x03\x04 nonsense")
    wait_for(lambda: [n for n in tab.notifications if n["title"] == "No run"], "a message")
    assert scene.ghosts[-1].config.drive.speed_kmh == 44


def test_files_of_any_content_lead_to_a_message(monkeypatch: pytest.MonkeyPatch) -> None:
    run = make_run(samples=3)
    good = run.to_bytes(".npz")
    assert np.array_equal(run_from("a.npz", good).normal_load, run.normal_load)
    for content in (b"", b"\0" * 100, good[:-100], good[: len(good) // 2], b"PK\x05\x06" + bytes(18)):
        with pytest.raises(ValueError, match="a\\.npz"):
            run_from("a.npz", content)
    monkeypatch.setattr("app.files.uploads.RUN_LIMIT", 2e6)
    with pytest.raises(ValueError, match="larger than 2 MB"):
        run_from("a.npz", bytes(2_000_001))
    monkeypatch.setattr("app.files.uploads.UNPACKED_LIMIT", 5e6)
    bomb = io.BytesIO()
    with zipfile.ZipFile(bomb, "w", zipfile.ZIP_DEFLATED) as archive, archive.open("q.npy", "w") as file:
        file.write(bytes(6_000_000))
    with pytest.raises(ValueError, match="more than 5 MB"):
        run_from("a.npz", bomb.getvalue())
    for content in (b"\xff\xfe", b"a" * (SIZE_LIMIT + 1), b"[", b"- 1"):
        with pytest.raises(ConfigError):
            configuration("a.yaml", content)


def test_an_error_in_a_job_is_told_and_the_next_one_begins(monkeypatch: pytest.MonkeyPatch) -> None:
    errors: list[Exception] = []
    job = app.session.background.BackgroundJob(errors.append)
    assert job.start(lambda: 1 / 0)
    wait_for(lambda: errors and not job.busy)
    done: list[bool] = []
    assert job.start(lambda: wait_for(job.stopped) and done.append(True))
    assert not job.start(lambda: None)
    job.close()
    assert done == [True]
