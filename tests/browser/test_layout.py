"""Nothing jumps while a slider is dragged, and labels and buttons say what they are."""

from __future__ import annotations

import json
from collections.abc import Iterator

import pytest
from playwright.sync_api import expect

from tests.browser.driver import SOON, Explorer

WATCH = """() => {
  const what = '.mantine-Slider-root, .trackride-status, button, label, .uplot-container, .u-over, .u-legend .u-series,'
    + ' .trackride-page, canvas';
  window.boxes = new Set();
  const look = () => {
    const seen = [...document.querySelectorAll(what)].filter(element => element.offsetWidth);
    window.boxes.add(JSON.stringify(seen.map(element => {
      const box = element.getBoundingClientRect();
      return [element.className || element.tagName, ...[box.x, box.y, box.width, box.height].map(Math.round)].join(' ');
    })));
    window.watch = requestAnimationFrame(look);
  };
  look();
}"""
SEEN = "() => { cancelAnimationFrame(window.watch); return [...window.boxes].map(JSON.parse) }"


@pytest.fixture(scope="module")
def explorer(browser, address) -> Iterator[Explorer]:
    context = browser.new_context(viewport={"width": 1280, "height": 720})
    explorer = Explorer(context.new_page()).open(f"{address}/?fixedDpr=0.5")
    explorer.button("Pause").click()
    explorer.page.get_by_role("button", name="▶ Play").wait_for()
    explorer.press("Time", "End")  # where the values beside the names change
    yield explorer
    context.close()


@pytest.mark.parametrize("tab", ["Loads", "Ride"])
def test_no_box_moves_while_a_slider_is_dragged(explorer, tab):
    page = explorer.page
    page.get_by_role("tab", name=tab, exact=True).click()
    page.wait_for_function("() => document.querySelectorAll('.u-legend .u-value').length > 5")
    page.wait_for_timeout(1500)
    before = explorer.run_number()
    box = explorer.thumb("Amplitude").bounding_box()
    assert box is not None
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.wait_for_timeout(500)
    page.evaluate(WATCH)
    page.mouse.down()
    for step in range(1, 11):
        page.mouse.move(x + 5 * step, y)
        page.wait_for_timeout(100)
    page.mouse.up()
    explorer.wait_for_run(after=before)
    page.wait_for_timeout(500)
    seen = page.evaluate(SEEN)
    moved = [(old, new) for old, new in zip(seen[0], seen[-1], strict=False) if old != new]
    assert len(seen) == 1, f"{len(seen)} arrangements were seen: {json.dumps(moved[:10])}"


def test_a_hint_comes_over_the_label_and_goes_again(explorer):
    page = explorer.page
    hint = page.get_by_role("tooltip").filter(has_text="presses an imaginary wheel to the ground")
    page.get_by_text("Imaginary stiffness").first.hover()
    expect(hint).to_be_visible(timeout=SOON)
    page.mouse.move(640, 60)
    expect(hint).to_have_count(0, timeout=SOON)
    page.get_by_text("Export", exact=True).click()
    explorer.button("Screenshot").hover()
    expect(explorer.button("Screenshot")).to_have_attribute("title", "The 3-D view as a PNG file (S)", timeout=SOON)
