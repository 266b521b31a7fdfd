"""Seeing the physics: a wheel picked in the 3-D view, and what can be switched on in it."""

from __future__ import annotations

from contextlib import suppress

from playwright.sync_api import TimeoutError as PlaywrightTimeoutError
from playwright.sync_api import expect

from tests.browser.driver import SOON, Explorer

FRONT_WHEEL = 686, 397  # px, in the side view
CLICK = "box => box.click()"  # wherever it is while its folder unfolds


def test_a_click_on_a_wheel_opens_its_card_and_another_closes_it(at_rest: Explorer) -> None:
    explorer, page = at_rest, at_rest.page
    page.keyboard.press("1")  # the side view, in case another test has turned it
    explorer.wait_until_still(lambda: page.evaluate("__viserTestpoints.rendererInfo.render.frame"))
    card = page.locator(".trackride-wheel")
    for _ in range(15):  # the first click may come before the wheel is drawn where it is then, and meet another
        page.mouse.click(*FRONT_WHEEL)
        with suppress(PlaywrightTimeoutError):
            card.filter(has_text="R1").wait_for(timeout=SOON / 10)
            break
    expect(card).to_contain_text("R1")
    expect(card).to_contain_text("kN")
    explorer.button("Close").click()
    expect(card).to_have_count(0)

    explorer.fold("View")
    explorer.control("Load colours").evaluate(CLICK)
    expect(page.get_by_text("Normal load, kN").first).to_be_visible()
    explorer.control("Load colours").evaluate(CLICK)
    explorer.fold("View")
