"""The first explorer, as issue and user describe it: sliders, plots, playback, pictures, tabs."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path

import numpy as np
from PIL import Image
from playwright.sync_api import expect

from app.runs.study_choice import WHAT_IF
from tests.browser.conftest import OpenTab
from tests.browser.driver import DOWNLOAD, FIRST_RUN, NEW_CURVES, SOON, Explorer


def test_a_slider_moved_by_key_makes_a_new_run_whose_loads_stand_in_the_plot(at_rest: Explorer) -> None:
    before, curves, value = at_rest.run_number(), at_rest.curves(), at_rest.value("Suspension stiffness")
    at_rest.press("Suspension stiffness", "ArrowRight")
    at_rest.wait_for_value("Suspension stiffness", "now > value", value)
    at_rest.wait_for_run(after=before)
    at_rest.page.wait_for_function(NEW_CURVES, arg=curves, timeout=SOON)


def test_a_slider_dragged_makes_runs_on_the_way_and_one_where_it_was_left(at_rest: Explorer) -> None:
    page, value = at_rest.page, at_rest.value("Speed")
    at_rest.thumb("Speed").hover()  # once it stands still
    box = at_rest.thumb("Speed").bounding_box()
    assert box is not None
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.down()
    for step in range(1, 4):
        before = at_rest.run_number()
        page.mouse.move(x + 8 * step, y)
        at_rest.wait_for_run(after=before)  # while the button is held down
    page.mouse.move(x + 40, y)
    page.mouse.up()
    at_rest.wait_for_value("Speed", "now > value", value)
    left_at = at_rest.value("Speed")
    at_rest.page.get_by_role("tab", name="Runs").click()
    expect(page.locator(".trackride-compared")).to_contain_text(f"→ {left_at:g} km/h", timeout=SOON)
    at_rest.page.get_by_role("tab", name="Loads").click()


def test_playback_plays_pauses_and_scrubs(at_rest: Explorer) -> None:
    at_rest.button("Play").first.click()
    at_rest.wait_for_value("Time, s", "now > 0.2")
    at_rest.pause()
    paused_at = at_rest.wait_until_still(lambda: at_rest.value("Time, s"))
    assert paused_at > 0.2
    at_rest.press("Time, s", "Home")
    at_rest.wait_for_value("Time, s", "now < 0.05")


def test_a_screenshot_shows_the_vehicle_and_is_named_after_preset_and_change(at_rest: Explorer) -> None:
    before = at_rest.run_number()
    at_rest.press("Amplitude", "ArrowRight")
    at_rest.wait_for_run(after=before)
    at_rest.fold("Export")
    with at_rest.drawing(), at_rest.page.expect_download(timeout=DOWNLOAD) as download:
        at_rest.button("Screenshot").click()
    at_rest.fold("Export")
    name = download.value.suggested_filename
    assert name.endswith(".png")
    assert "amplitude" in name
    image = Image.open(BytesIO(Path(download.value.path()).read_bytes()))
    assert image.size == (1280, 720)
    pixels = np.asarray(image.convert("RGB")).astype(int)
    red, green, blue = np.moveaxis(pixels, 2, 0)
    olive = (green > red) & (red > blue) & (green - blue > 20) & (green < 200)
    assert olive.mean() > 0.02, "the hull's green is missing"
    # The view of the page is narrow, the picture is wide: the vehicle fills it all the same
    assert np.ptp(np.flatnonzero(olive.sum(axis=0) > 15)) > 0.5 * pixels.shape[1]
    dark = pixels.max(axis=2) < 70
    assert dark.mean() > 0.003, "the running gear's dark parts are missing"


def test_a_value_out_of_range_is_refused_with_range_and_unit_and_the_run_stays(at_rest: Explorer) -> None:
    before = at_rest.status.inner_text()
    at_rest.fold("Ground contact")
    box = at_rest.control("Friction").locator("input").or_(at_rest.control("Friction")).last
    box.fill("9")
    box.press("Enter")
    expect(at_rest.page.get_by_text("Not possible")).to_be_visible(timeout=SOON)
    expect(at_rest.page.get_by_text("Friction").filter(has_text="to").first).to_be_visible(timeout=SOON)
    assert at_rest.status.inner_text() == before
    at_rest.fold("Ground contact")


def test_a_new_tab_has_strips_on_its_sliders_and_is_independent_of_others(at_rest: Explorer, open_tab: OpenTab) -> None:
    before, value = at_rest.status.inner_text(), at_rest.value("Speed")
    other = open_tab(color_scheme="dark")
    other.pause()  # so that two pages do not draw at once
    strips = other.page.locator(".trackride-strip")  # though the tab Study was never in front
    expect(strips).to_have_count(len(WHAT_IF), timeout=FIRST_RUN)
    expect(other.page.locator("trackride-matters")).to_contain_text("mostly speed")
    look = "data-mantine-color-scheme"
    expect(other.page.locator("html")).to_have_attribute(look, "dark")
    other.page.emulate_media(color_scheme="light")
    expect(other.page.locator("html")).to_have_attribute(look, "light")
    expect(at_rest.page.locator("html")).to_have_attribute(look, "light")
    other.press("Speed", "End")
    other.wait_for_run(after=1)
    other.wait_for_value("Speed", "now > value", value)
    at_rest.page.keyboard.press("Shift+ArrowRight")  # what the server had for this tab comes before its answer to this
    at_rest.wait_for_value("Time, s", "now > 0")
    assert (at_rest.status.inner_text(), at_rest.value("Speed")) == (before, value)
