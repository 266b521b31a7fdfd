"""The first explorer, as issue and user describe it: sliders, plots, playback, pictures, tabs."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path

import numpy as np
from PIL import Image
from playwright.sync_api import expect

from tests.browser.driver import SOON


def test_a_slider_moved_by_key_makes_a_new_run_whose_loads_stand_in_the_plot(explorer):
    before, curves, value = explorer.run_number(), explorer.curves(), explorer.value("Road stiffness")
    explorer.press("Road stiffness", "ArrowRight")
    assert explorer.wait_for_run(after=before) > before
    assert explorer.value("Road stiffness") > value
    explorer.page.wait_for_function(
        "old => document.querySelector('.uplot canvas').toDataURL() !== old", arg=curves, timeout=SOON
    )


def test_a_slider_dragged_makes_runs_on_the_way_and_one_where_it_was_left(explorer):
    before = explorer.run_number()
    box = explorer.thumb("Speed").bounding_box()
    assert box is not None
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    mouse = explorer.page.mouse
    mouse.move(x, y)
    mouse.down()
    seen = set()
    for step in range(1, 13):
        mouse.move(x + 2 * step, y)
        explorer.page.wait_for_timeout(100)
        seen.add(explorer.run_number())
    mouse.up()
    assert len(seen) >= 3, f"the runs seen while dragging were {sorted(seen)}"
    last = explorer.wait_for_run(after=max(seen) - 1)
    assert last > before
    assert explorer.value("Speed") > 15.0


def test_playback_plays_pauses_and_scrubs(explorer):
    explorer.button("Pause").click()
    expect(explorer.button("Play").first).to_be_visible()
    explorer.page.wait_for_timeout(500)
    stopped = explorer.value("Time")
    explorer.page.wait_for_timeout(600)
    assert explorer.value("Time") == stopped
    explorer.press("Time", "Home")
    explorer.page.wait_for_function(
        "id => document.getElementById(id).querySelector('[role=slider]').ariaValueNow < 0.05",
        arg=explorer.control("Time").get_attribute("id"),
        timeout=SOON,
    )
    explorer.button("▶ Play").click()
    explorer.page.wait_for_timeout(1500)
    assert 0.2 < explorer.value("Time") < 9.0


def test_a_screenshot_shows_the_vehicle_and_is_named_after_preset_and_change(explorer, tmp_path: Path):
    before = explorer.run_number()
    explorer.press("Amplitude", "ArrowRight")
    explorer.wait_for_run(after=before)
    explorer.page.get_by_text("Export", exact=True).click()
    with explorer.page.expect_download(timeout=60_000) as download:
        explorer.button("Screenshot").click()
    name = download.value.suggested_filename
    assert name.endswith(".png")
    assert "amplitude" in name
    download.value.save_as(tmp_path / name)
    image = Image.open(BytesIO((tmp_path / name).read_bytes()))
    assert image.size == (1280, 720)
    pixels = np.asarray(image.convert("RGB")).reshape(-1, 3).astype(int)
    red, green, blue = pixels.T
    olive = (green > red) & (red > blue) & (green - blue > 20)
    assert olive.mean() > 0.02, "the hull's green is missing"
    dark = pixels.max(axis=1) < 70
    assert dark.mean() > 0.003, "the running gear's dark parts are missing"


def test_a_value_out_of_range_is_refused_with_range_and_unit_and_the_run_stays(explorer):
    before = explorer.status.inner_text()
    explorer.page.get_by_text("Ground contact", exact=True).click()
    box = explorer.control("Friction").locator("input").or_(explorer.control("Friction")).last
    box.fill("9")
    box.press("Enter")
    expect(explorer.page.get_by_text("Not possible")).to_be_visible(timeout=SOON)
    expect(explorer.page.get_by_text("Friction").filter(has_text="to").first).to_be_visible()
    assert explorer.status.inner_text() == before


def test_tabs_are_independent(open_tab):
    one, other = open_tab(), open_tab()
    before, curves, value = one.status.inner_text(), one.run_number(), one.value("Speed")
    other.press("Speed", "End")
    other.wait_for_run(after=1)
    one.page.wait_for_timeout(1000)
    assert (one.status.inner_text(), one.run_number(), one.value("Speed")) == (before, curves, value)
    assert other.value("Speed") > value
