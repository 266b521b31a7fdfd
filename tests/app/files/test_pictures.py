"""Pictures of the 3-D view."""

from __future__ import annotations

import io
import time
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from PIL import Image

import app.files.pictures
from app.files.pictures import NoPictureError, framed, take_picture
from model.config.config_files import load_config
from tests.app.conftest import Tab, trackride_threads, wait_for

PAPER = load_config("paper")


class FakeBrowser:
    def __init__(self, answer: np.ndarray | Exception) -> None:
        self.answer = answer
        self.camera = SimpleNamespace(wxyz=np.array([1.0, 0, 0, 0]), position=np.zeros(3), fov=0.4, aspect=0.6)
        self.asked: dict[str, Any] = {}

    def get_render(self, height: int, width: int, **how: Any) -> np.ndarray:
        self.asked = {"size": (width, height), **how}
        if isinstance(self.answer, Exception):
            raise self.answer
        return self.answer


def test_a_picture_is_an_opaque_png() -> None:
    pixels = np.zeros((20, 40, 4), dtype=np.uint8)
    pixels[:10] = (255, 0, 0, 255)
    browser = FakeBrowser(pixels)
    picture = Image.open(io.BytesIO(take_picture(browser, 40, 20, "#0000ff")))
    assert (picture.format, picture.mode, picture.size) == ("PNG", "RGB", (40, 20))
    assert picture.getpixel((0, 0)) == (255, 0, 0)
    assert picture.getpixel((0, 15)) == (0, 0, 255)
    assert browser.asked["size"] == (40, 20)
    assert browser.asked["transport_format"] == "png"
    assert browser.asked["timeout"] is not None
    clear = Image.open(io.BytesIO(take_picture(browser, 40, 20, None)))
    assert clear.mode == "RGBA"
    assert clear.getpixel((0, 15)) == (0, 0, 0, 0)


@pytest.mark.parametrize("page", [0.4, 1.0, 16 / 9, 3.0])
def test_a_picture_is_filled_from_left_to_right_by_what_the_page_shows(page: float) -> None:
    fov = framed(0.36, page, 16 / 9)
    assert np.tan(fov / 2) * 16 / 9 == pytest.approx(np.tan(0.36 / 2) * page)
    browser = FakeBrowser(np.zeros((90, 160, 4), dtype=np.uint8))
    browser.camera.aspect = page
    take_picture(browser, 160, 90, "white")
    assert browser.asked["fov"] == pytest.approx(framed(0.4, page, 16 / 9))


@pytest.mark.parametrize("error", [TimeoutError("late"), RuntimeError("gone")])
def test_a_browser_that_does_not_answer_leads_to_a_message(error: Exception) -> None:
    with pytest.raises(NoPictureError, match="browser"):
        take_picture(FakeBrowser(error), 40, 20, "white")


def downloads(tab: Tab) -> list[dict[str, Any]]:
    return [message for message in tuple(tab.messages) if message["type"] == "FileTransferStartDownload"]


def test_a_screenshot_is_downloaded_while_it_plays(explore: Any, open_tab: Any) -> None:
    tab: Tab = open_tab(explore())
    wait_for(lambda: tab.shows_run(1))
    tab.use("Speed, km/h", 22)
    wait_for(lambda: tab.shows_run(2))
    tab.press("Screenshot")
    request = wait_for(lambda: [m for m in tuple(tab.messages) if m["type"] == "GetRenderRequestMessage"], "a request")[
        0
    ]
    assert (request["width"], request["height"]) == (1280, 720)
    png = io.BytesIO()
    Image.new("RGBA", (1280, 720), (10, 200, 30, 255)).save(png, "PNG")
    tab.send("GetRenderResponseMessage", payload=png.getvalue(), render_uuid=request["render_uuid"])
    download = wait_for(lambda: downloads(tab), "the download")[0]
    assert download["filename"] == "paper-vehicle_speed-22-km-h_1280x720.png"
    assert download["save_immediately"]


def test_a_hidden_tab_leads_to_a_message_and_the_next_picture_can_be_taken(
    explore: Any, open_tab: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(app.files.pictures, "RENDER_TIMEOUT", 0.3)
    tab: Tab = open_tab(explore())
    wait_for(lambda: tab.shows_run(1))
    for count in (1, 2):
        tab.press("Screenshot")
        wait_for(
            lambda count=count: len([n for n in tab.notifications if n["title"] == "No picture"]) == count,
            "a message",
        )
        wait_for(lambda: "trackride-job" not in trackride_threads(), "the job to end")
    assert downloads(tab) == []


def test_a_tab_that_closes_during_a_picture_leaves_nothing_behind(explore: Any, open_tab: Any) -> None:
    tab: Tab = open_tab(explore())
    wait_for(lambda: tab.shows_run(1))
    tab.press("Screenshot")
    wait_for(lambda: [m for m in tuple(tab.messages) if m["type"] == "GetRenderRequestMessage"], "the request")
    assert "trackride-job" in trackride_threads()
    tab.press("Screenshot")
    wait_for(lambda: tab.find("Screenshot: waits for its turn"))
    began = time.monotonic()
    tab.close()
    wait_for(lambda: not trackride_threads(), "the threads to end")
    assert time.monotonic() - began < app.files.pictures.RENDER_TIMEOUT / 2  # the picture is not waited for
