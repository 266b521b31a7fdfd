"""The replay is opened from disk in a real browser: it shows the vehicle, and playing moves it."""

from __future__ import annotations

import io
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from PIL import Image
from playwright.sync_api import Browser, Page

from app.files.replay import RATE, replay_html
from app.view3d.meshes.hull import PAINT
from model import load_config, simulate
from tests.browser.driver import DRAWING, SOON

DURATION = 2.0  # s
PLACE = "() => Number(document.querySelector('[role=slider]')?.ariaValueNow)"  # where it is in the run, s
STANDS = f"""() => new Promise((resolve) => {{  // whether it comes to stand for 30 of the page's next 100 frames
  let place, stood = 0, left = 100;
  const look = () => {{
    stood = place === ({PLACE})() ? stood + 1 : 0;
    place = ({PLACE})();
    if (stood < 30 && left--) requestAnimationFrame(look);
    else resolve(stood === 30);
  }};
  look();
}})"""
FRAMES = """() => new Promise((drawn) => {  // until the page has drawn six more
  const draw = (left) => left ? requestAnimationFrame(() => draw(left - 1)) : drawn();
  draw(6);
})"""
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
    paused: bool  # whether it then stood still
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
def seen(browser: Browser, page_file: Path) -> Seen:
    page = browser.new_page(viewport={"width": 480, "height": 270})
    page.set_default_timeout(3 * SOON)  # software WebGL has to share the machine with other tests
    page.add_init_script(DRAWING)
    requests: list[str] = []
    page.on("request", lambda request: requests.append(request.url))
    page.goto(f"{page_file.as_uri()}?fixedDpr=0.5")
    page.wait_for_function(f"() => ({PLACE})() > {DURATION / 2}")  # by then it has put viser's own lights out
    page.evaluate(COUNT_LIGHTS)
    page.wait_for_function(f"() => ({PLACE})() < {DURATION / 2}")  # after its end it starts anew
    page.locator("xpath=//*[@role='slider']/ancestor::div[button][1]/button[1]").click()
    paused = page.evaluate(STANDS)

    page.evaluate("window.drawing = true")
    start, end, again = (_picture(page, part) for part in (0.0, 0.9, 0.0))
    lights = page.evaluate("() => [...window.lights]")
    ghost = page.evaluate("() => '/ghost' in window.__viserMutable.nodePoseData")
    duration = float(page.locator("[role=slider]").get_attribute("aria-valuemax") or "nan")
    text = page.inner_text("body")
    page.close()
    return Seen(text, duration, requests, lights, ghost, paused, start, end, again)


def _click(page: Page, part: float) -> None:
    """On the rail of the slider, this part of its length from the left."""
    rail = page.locator(".mantine-Slider-root").bounding_box()
    assert rail is not None
    page.mouse.click(rail["x"] + part * rail["width"], rail["y"] + rail["height"] / 2)


def _picture(page: Page, part: float) -> np.ndarray:
    """What is seen at this part of the run, once it no longer changes."""
    _click(page, part)
    page.wait_for_function(f"() => Math.abs(({PLACE})() - {part * DURATION}) < {0.1 * DURATION}")
    before = np.zeros(0)
    while True:
        page.evaluate(FRAMES)
        after = np.asarray(Image.open(io.BytesIO(page.screenshot())).convert("RGB")).astype(float)
        if np.array_equal(before, after):
            return after
        before = after


def test_it_is_one_small_file_that_needs_nothing_else(page_file, seen):
    assert page_file.stat().st_size < 3e6
    assert all(address.startswith(("file:", "data:", "blob:")) for address in seen.requests), seen.requests
    assert "<title>Paper &lt;vehicle&gt; &amp; road</title>" in page_file.read_text(encoding="utf-8")
    assert "Paper <vehicle> & road" in seen.text


def test_it_plays_by_itself_over_and_over_and_pauses(seen):
    assert seen.duration == pytest.approx(DURATION + 1 / RATE, abs=0.01)
    assert seen.paused


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


def test_neither_starting_anew_nor_scrubbing_back_flashes(seen):
    """Viser's own lights, which it turns on whenever it starts anew, never reach the picture."""
    assert len(seen.lights) == 1


def test_the_baseline_goes_along_as_a_ghost(seen):
    assert seen.ghost
