"""The replay is opened from disk in a real browser: it shows the vehicle, and playing moves it."""

from __future__ import annotations

import io
import re
import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from PIL import Image
from playwright.sync_api import Page

from app import replay
from app.replay import RATE, replay_html
from assets.hull import PAINT
from model import load_config, simulate
from tests.app.conftest import make_run, wait_for
from tests.browser.driver import SOON, chromium

DURATION = 2.0  # s
COUNT_LIGHTS = """() => {
  window.lights = new Set();
  setInterval(() => {
    let count = 0;
    window.__viserMutable.scene.traverse((node) => { if (node.isLight) count += 1; });
    window.lights.add(count);
  }, 5);
}"""


class Seen(NamedTuple):
    text: str
    duration: float  # s, that the page's slider spans
    requests: list[str]  # addresses that the page asked for
    lights: list[int]  # how many lights were ever on at once
    ghost: bool  # whether a ghost goes along
    playing: tuple[float, float]  # where it stood, and a second later
    paused: tuple[float, float]
    start: np.ndarray  # pictures (H, W, 3)
    end: np.ndarray  # nearly
    again: np.ndarray  # back at the start


@pytest.fixture(scope="module")
def page_file(tmp_path_factory) -> Path:
    """Of the paper's vehicle, from standing start on level ground to its first waves."""
    path = tmp_path_factory.mktemp("replay") / "replay.html"
    run = simulate(load_config("paper").replace({"simulation.duration": DURATION}))
    page = replay_html(run, simulate(run.config.replace({"drive.speed_kmh": 20})), "Paper <vehicle> & road")
    assert page is not None
    path.write_text(page, encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def seen(page_file) -> Seen:
    with ThreadPoolExecutor(1) as own_thread:  # the tests' thread may have a Playwright open already
        return own_thread.submit(_look_at, page_file).result()


def _look_at(path: Path) -> Seen:
    with chromium() as browser:
        page = browser.new_page(viewport={"width": 480, "height": 270})
        page.set_default_timeout(3 * SOON)  # software WebGL has to share the machine with other tests
        requests: list[str] = []
        page.on("request", lambda request: requests.append(request.url))
        page.goto(f"{path.as_uri()}?fixedDpr=0.5")
        slider = page.locator("[role=slider]")
        slider.wait_for(state="attached")
        page.wait_for_timeout(1000)
        page.evaluate(COUNT_LIGHTS)
        playing = _twice(page)
        page.locator("xpath=//*[@role='slider']/ancestor::div[button][1]/button[1]").click()
        paused = _twice(page)
        pictures = []
        rail = page.locator(".mantine-Slider-root").bounding_box()
        assert rail is not None
        for part in (0.0, 0.9, 0.0):
            page.mouse.click(rail["x"] + part * rail["width"], rail["y"] + rail["height"] / 2)
            pictures.append(_settled(page))
        duration = float(slider.get_attribute("aria-valuemax") or "nan")
        lights = page.evaluate("() => [...window.lights]")
        ghost = page.evaluate("() => '/ghost' in window.__viserMutable.nodePoseData")
        return Seen(page.inner_text("body"), duration, requests, lights, ghost, playing, paused, *pictures)


def _twice(page: Page) -> tuple[float, float]:
    """Where the slider stands, and a second later."""
    places = []
    for _ in range(2):
        page.wait_for_timeout(1000)
        places.append(float(page.locator("[role=slider]").get_attribute("aria-valuenow") or "nan"))
    return places[0], places[1]


def _settled(page: Page) -> np.ndarray:
    """The picture, once it no longer changes."""
    before = np.zeros(0)
    while True:
        page.wait_for_timeout(700)
        after = np.asarray(Image.open(io.BytesIO(page.screenshot())).convert("RGB")).astype(float)
        if np.array_equal(before, after):
            return after
        before = after


def test_it_is_one_small_file_that_needs_nothing_else(page_file, seen):
    assert page_file.stat().st_size < 3e6
    assert all(address.startswith(("file:", "data:", "blob:")) for address in seen.requests), seen.requests
    assert "<title>Paper &lt;vehicle&gt; &amp; road</title>" in page_file.read_text(encoding="utf-8")
    assert "Paper <vehicle> & road" in seen.text


def test_it_plays_by_itself_and_pauses(seen):
    assert seen.duration == pytest.approx(DURATION + 1 / RATE, abs=0.01)
    assert seen.playing[0] != seen.playing[1]
    assert seen.paused[0] == seen.paused[1]


def test_the_vehicle_is_in_the_picture(seen):
    """Its paint covers a good part of the middle, and nothing of the sky's corner."""
    paint = np.array(PAINT[:3]) / np.linalg.norm(PAINT[:3])
    for picture in (seen.start, seen.end):
        brightness = np.linalg.norm(picture, axis=2)
        painted = (picture @ paint > 0.99 * brightness) & (brightness > 60) & (brightness < 280)
        assert painted[60:210, 90:390].mean() > 0.15
        assert painted[:30, 400:].mean() < 0.01


def test_what_is_seen_depends_on_the_time(seen):
    def differing(one: np.ndarray, other: np.ndarray) -> float:
        return float((np.abs(one - other).max(axis=2) > 25)[30:230].mean())

    assert differing(seen.start, seen.end) > 0.05
    assert differing(seen.start, seen.again) < 0.005


def test_scrubbing_back_does_not_flash(seen):
    """Viser's own lights, which it turns on whenever it starts anew, never reach the picture."""
    assert len(seen.lights) == 1


def test_the_baseline_goes_along_as_a_ghost(seen):
    assert seen.ghost


def test_a_long_run_is_cut_and_says_so(monkeypatch):
    monkeypatch.setattr(replay, "LONGEST", 0.2)
    page = replay_html(make_run(), None, "Long")
    assert page is not None
    assert "<title>Long (the first 0.2 s of 2 s)</title>" in page


def test_it_can_be_stopped_and_leaves_nothing_behind(capsys):
    before = set(threading.enumerate())
    asked = []

    def should_stop() -> bool:
        asked.append(True)
        return len(asked) > 3

    assert replay_html(make_run(), None, "Stopped", should_stop=should_stop) is None
    assert len(asked) == 4
    wait_for(lambda: set(threading.enumerate()) <= before, "the server's threads to end")
    assert re.sub(r"\s", "", capsys.readouterr().out) == ""
