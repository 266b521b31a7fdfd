"""Nothing jumps while a slider is dragged, and labels and buttons say what they are."""

from __future__ import annotations

import json

import pytest
from playwright.sync_api import expect

from tests.browser.driver import SOON, Explorer

ARRANGED = """() => {
  const what = '.mantine-Slider-root, .trackride-status, button, label, .uplot-container, .u-over, .u-legend .u-series,'
    + ' .trackride-page, canvas';
  const seen = [...document.querySelectorAll(what)].filter(element => element.offsetWidth);
  return JSON.stringify(seen.map(element => {
    const box = element.getBoundingClientRect();
    return [element.className || element.tagName, ...[box.x, box.y, box.width, box.height].map(Math.round)].join(' ');
  }));
}"""
WATCH = f"""() => {{
  window.boxes = new Set();
  const look = () => {{
    window.boxes.add(({ARRANGED})());
    window.watch = requestAnimationFrame(look);
  }};
  look();
}}"""
SEEN = "() => { cancelAnimationFrame(window.watch); return [...window.boxes].map(JSON.parse) }"


@pytest.mark.parametrize("tab", ["Loads", "Ride"])
def test_no_box_moves_while_a_slider_is_dragged(at_rest: Explorer, tab: str) -> None:
    page = at_rest.page
    at_rest.press("Time, s", "End")  # where the values beside the names change
    page.get_by_role("tab", name=tab, exact=True).click()
    page.wait_for_function("() => document.querySelectorAll('.u-legend .u-value').length > 5")
    at_rest.thumb("Amplitude").hover()
    at_rest.wait_until_still(lambda: page.evaluate(ARRANGED))
    before = at_rest.run_number()
    box = at_rest.thumb("Amplitude").bounding_box()
    assert box is not None
    page.evaluate(WATCH)
    page.mouse.down()
    for step in range(1, 11):
        page.mouse.move(box["x"] + box["width"] / 2 + 5 * step, box["y"] + box["height"] / 2)
        page.wait_for_timeout(100)
    page.mouse.up()
    at_rest.wait_for_run(after=before)
    at_rest.wait_until_still(lambda: page.evaluate(ARRANGED))
    seen = page.evaluate(SEEN)
    moved = [(old, new) for old, new in zip(seen[0], seen[-1], strict=False) if old != new]
    assert len(seen) == 1, f"{len(seen)} arrangements were seen: {json.dumps(moved[:10])}"


def test_units_stay_on_one_line(at_rest: Explorer) -> None:
    for folder in ("Track", "Ground contact"):
        at_rest.fold(folder)
    lines = """name => {  // the places, from above, at which the letters of a label's unit stand
      const label = [...document.querySelectorAll('label')].find(label => label.textContent.startsWith(name));
      const letters = document.createTreeWalker(label, NodeFilter.SHOW_TEXT), tops = [];
      let unit = false;
      while (letters.nextNode()) [...letters.currentNode.data].forEach((letter, k) => {
        const range = document.createRange();
        range.setStart(letters.currentNode, k);
        range.setEnd(letters.currentNode, k + 1);
        if (unit && letter.trim()) tops.push(range.getBoundingClientRect().top);
        unit ||= letter === ',';
      });
      return tops;
    }"""
    for name in ("Imaginary damping", "Ground damping"):
        at_rest.page.wait_for_function(f"name => new Set(({lines})(name)).size === 1", arg=name)
    for folder in ("Track", "Ground contact"):
        at_rest.fold(folder)


def test_a_hint_comes_over_the_label_and_goes_again(at_rest: Explorer) -> None:
    page = at_rest.page
    hint = page.get_by_role("tooltip").filter(has_text="presses an imaginary wheel to the ground")
    page.get_by_text("Imaginary stiffness").first.hover()
    expect(hint).to_be_visible(timeout=SOON)
    page.mouse.move(640, 60)
    expect(hint).to_have_count(0, timeout=SOON)
    at_rest.fold("Export")
    at_rest.button("Screenshot").hover()
    expect(at_rest.button("Screenshot")).to_have_attribute("title", "The 3-D view as a PNG file (S)", timeout=SOON)
    at_rest.fold("Export")
