"""Seeing the physics: a wheel picked in the 3-D view, and what can be switched on in it."""

from __future__ import annotations

from contextlib import suppress

from playwright.sync_api import TimeoutError as PlaywrightTimeoutError
from playwright.sync_api import expect

from tests.browser.driver import SOON

FRONT_WHEEL = 915, 510  # px, in the side view of a page of 1600 × 900


def test_a_click_on_a_wheel_opens_its_card_and_another_closes_it(open_tab):
    page = open_tab(1600, 900)
    page.button("Pause").click()
    page.press("Time", "Home")
    card = page.page.locator(".trackride-wheel")
    page.wait_for_value("Time", "now < 0.05")
    for _ in range(6):  # the first click may come before the wheel is drawn where it is then, and meet another
        page.page.mouse.click(*FRONT_WHEEL)
        with suppress(PlaywrightTimeoutError):
            card.filter(has_text="R1").wait_for(timeout=SOON / 3)
            break
    expect(card).to_contain_text("R1", timeout=SOON)
    expect(card).to_contain_text("kN")
    page.button("Close").click()
    expect(card).to_have_count(0, timeout=SOON)

    page.page.get_by_text("View", exact=True).first.click()
    box = page.control("Load colours")
    while not box.is_checked():
        page.page.wait_for_timeout(500)  # the folder unfolds
        box.click(force=True)
    expect(page.page.get_by_text("Normal load, kN").first).to_be_visible(timeout=SOON)
