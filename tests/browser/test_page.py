"""The page as a whole: all sizes, names and keys for those who see or point less well, hints, nothing of viser's own.

The tests leave the tab as they found it, at 1280 × 720 px.
"""

from __future__ import annotations

import re

import pytest
from playwright.sync_api import expect

from tests.browser.conftest import SIZE
from tests.browser.driver import FOLDER, SOON, Explorer

BOXES = """() => Object.fromEntries(Object.entries({
  view: 'canvas[data-engine]', plots: '[data-dock-region="right"]', controls: '[data-dock-region="left"]',
}).map(([name, css]) => {
  const {x, y, width, height} = document.querySelector(css).getBoundingClientRect();
  return [name, {x, y, width, height}];
}))"""
TAB_ROWS = """() => new Set([...document.querySelector('[data-dock-region="right"]').querySelectorAll('[role="tab"]')]
  .map(tab => Math.round(tab.getBoundingClientRect().top))).size"""
TYPE = "() => parseFloat(getComputedStyle(document.documentElement).fontSize)"
USED = "slider", "textbox", "button", "combobox", "checkbox", "spinbutton", "tab"  # roles of what is used


@pytest.mark.parametrize(
    ("width", "height"), [(2560, 1440), (1920, 1080), (1600, 900), (1280, 720), (1024, 768), (768, 1024)]
)
def test_the_panels_share_pages_of_all_sizes(at_rest: Explorer, width: int, height: int) -> None:
    page = at_rest.page
    page.set_viewport_size({"width": width, "height": height})
    try:
        page.wait_for_function(f"() => Math.abs(({BOXES})().plots.x + ({BOXES})().plots.width - {width}) < 2")
        at_rest.wait_until_still(lambda: page.evaluate(BOXES))
        boxes = page.evaluate(BOXES)
        view, plots = boxes["view"], boxes["plots"]
        if width < 1200:
            assert view["width"] > width / 2
            assert view["height"] > height / 2
            assert plots["y"] >= view["y"] + view["height"] - 1
        else:
            assert view["width"] > width / 3
            assert view["height"] == height
            assert plots["x"] >= view["x"] + view["width"] - 1
        assert page.evaluate(TAB_ROWS) == 1
        charts = page.locator(".uplot:visible").first.bounding_box()
        assert charts is not None
        assert charts["width"] > (0.45 if width == 1024 else 0.9) * plots["width"] - 30
        assert page.evaluate(TYPE) > 18 if width == 2560 else page.evaluate(TYPE) < 17
    finally:
        page.set_viewport_size(SIZE)
        page.wait_for_function(f"() => Math.abs(({BOXES})().view.height - {SIZE['height']}) < 2")
        at_rest.wait_until_still(lambda: page.evaluate(BOXES))


def test_all_that_can_be_used_has_a_name_in_closed_folders_and_in_open_ones(at_rest: Explorer) -> None:
    page = at_rest.page
    folders = page.locator(FOLDER)
    names = [folder.inner_text() for folder in folders.all()]
    assert len(names) >= 10
    for name in names:
        folder = page.locator(FOLDER).filter(has_text=re.compile(f"^{name}$"))
        folder.focus()
        page.keyboard.press("Enter")
        expect(folder).to_have_attribute("aria-expanded", "true")
    page.wait_for_timeout(600)  # names come four times a second
    nameless = re.compile(rf"^\s*- ({'|'.join(USED)})(?! \")\b.*$", re.MULTILINE)
    assert [found.group().strip() for found in nameless.finditer(page.locator("body").aria_snapshot())] == []
    for name in reversed(names):  # what lies within a folder before it
        folder = page.locator(FOLDER).filter(has_text=re.compile(f"^{name}$"))
        folder.focus()
        page.keyboard.press("Space")
        expect(folder).to_have_attribute("aria-expanded", "false")


def test_folders_are_reached_by_tab(at_rest: Explorer) -> None:
    page = at_rest.page
    at_rest.button("Reset").focus()
    page.keyboard.press("Tab")
    assert page.evaluate("document.activeElement.textContent") == "View"


def test_run_and_drive_say_which_is_on(at_rest: Explorer) -> None:
    expect(at_rest.mode("Run")).to_be_visible()
    expect(at_rest.mode("Drive", on=False)).to_be_visible()


def test_a_hint_stands_beside_its_panel_and_goes_at_the_first_key(at_rest: Explorer) -> None:
    page = at_rest.page
    page.get_by_text("Amplitude, mm").first.hover()
    hint = page.get_by_role("tooltip").filter(has_text="Height of a crest")
    expect(hint).to_be_visible(timeout=SOON)
    page.wait_for_function(
        """() => document.querySelector('.mantine-Tooltip-tooltip').getBoundingClientRect().left
          > document.querySelector('[data-dock-region="left"]').getBoundingClientRect().right"""
    )
    page.keyboard.press("Shift")
    expect(hint).to_be_hidden()
    page.mouse.move(640, 60)
    expect(page.get_by_role("tooltip")).to_have_count(0, timeout=SOON)


def test_nothing_of_visers_own_is_seen(at_rest: Explorer) -> None:
    page = at_rest.page
    assert page.title() == "Paper vehicle, sine · Trackride"
    expect(page.get_by_role("button", name="Settings of viser")).to_have_count(0)
    page.locator(".trackride-status").click()  # no box has the keys
    page.keyboard.press("Control+k")
    palette = page.locator(".mantine-Spotlight-body")
    expect(palette).to_contain_text("Shift+→")
    expect(palette).not_to_contain_text("arrow")
    page.keyboard.press("Escape")
    expect(palette).to_have_count(0)
