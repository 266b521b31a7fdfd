"""The first visit: a tour that blocks nothing, is left at any step and comes once; and examples in the page itself."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, Locator, expect

from tests.browser.conftest import new_context
from tests.browser.driver import Explorer

# Whether the frame number k is around the middle of each part that a selector finds
FRAMED = """([k, css]) => {
  const frame = document.querySelectorAll('.trackride-frame')[k].getBoundingClientRect();
  return [...document.querySelectorAll(css)].every((part) => {
    const {left, right, top, bottom} = part.getBoundingClientRect(), x = (left + right) / 2, y = (top + bottom) / 2;
    return frame.left < x && x < frame.right && frame.top < y && y < frame.bottom;
  });
}"""


@pytest.fixture(scope="module")
def visitor(browser: Browser, address: str) -> Iterator[Explorer]:
    context = new_context(browser)
    yield Explorer(context.new_page(), first_visit=True).open(f"{address}/?fixedDpr=0.25")
    context.close()


def tour(explorer: Explorer) -> Locator:
    return explorer.page.get_by_role("dialog", name="Tour of the page")


def begin(explorer: Explorer) -> None:
    explorer.page.evaluate("trackrideTour()")
    expect(tour(explorer)).to_be_visible()


def test_a_first_visit_is_shown_five_steps_with_what_they_point_at(visitor: Explorer) -> None:
    page, card = visitor.page, tour(visitor)
    expect(card).to_contain_text("1 of 5")
    speed = visitor.control("Speed").get_attribute("id")
    page.wait_for_function(FRAMED, arg=[0, f"[id='{speed}']"])
    expect(card).to_be_focused()  # no button yet: Space still plays
    page.keyboard.press("Tab")
    page.keyboard.press("Tab")
    expect(card.get_by_role("button", name="Next")).to_be_focused()
    for step, points_at in enumerate(
        ('[data-trackride="view"]', '[data-dock-region="right"]', "#none", "#none"), start=2
    ):
        page.keyboard.press("Enter")
        expect(card).to_contain_text(f"{step} of 5")
        page.wait_for_function(FRAMED, arg=[0, points_at])
        assert page.evaluate("document.querySelectorAll('.trackride-frame:not([hidden])').length") > 0
    expect(card.get_by_role("button", name="Find the worst speed")).to_be_visible()
    card.get_by_role("button", name="Back").click()
    expect(card).to_contain_text("4 of 5")
    page.keyboard.press("Escape")
    expect(card).to_have_count(0)
    expect(page.locator(".trackride-frame")).to_have_count(0)


def test_it_does_not_come_again_by_itself(visitor: Explorer) -> None:
    page = visitor.page
    page.reload()
    expect(visitor.status).to_contain_text("real time")
    expect(visitor.charts.first).to_be_visible()
    page.wait_for_timeout(1000)  # three times as long as it would wait
    expect(tour(visitor)).to_have_count(0)


def test_what_it_points_at_can_be_used_and_a_click_elsewhere_ends_it(visitor: Explorer) -> None:
    begin(visitor)
    before = visitor.run_number()
    visitor.thumb("Speed").click()
    visitor.page.keyboard.press("ArrowRight")
    visitor.wait_for_run(after=before)
    expect(tour(visitor)).to_be_visible()
    visitor.status.click()
    expect(tour(visitor)).to_have_count(0)
    begin(visitor)
    tour(visitor).get_by_role("button", name="Skip").click()
    expect(tour(visitor)).to_have_count(0)


def test_an_example_runs_in_the_page_and_one_click_undoes_it(visitor: Explorer) -> None:
    page = visitor.page
    visitor.come_to_rest()
    page.get_by_role("tab", name="About").click()
    page.get_by_role("button", name="Halve the damping").click()
    card = page.locator(".trackride-example")
    expect(card).to_contain_text("The damping is half of what it was")
    visitor.wait_for_value("Suspension damping", "now < 2.4")
    expect(page.get_by_role("tab", name="Runs")).to_have_attribute("aria-selected", "true")
    expect(page.locator(".trackride-compared")).to_contain_text("Baseline ● Paper vehicle")
    card.get_by_role("button", name="Undo example").click()
    expect(card).to_have_count(0)
    visitor.wait_for_value("Suspension damping", "now > 4.7")
    expect(page.get_by_role("tab", name="About")).to_have_attribute("aria-selected", "true")
