"""Roads as a user changes them in the page."""

from __future__ import annotations

from playwright.sync_api import expect

from tests.browser.driver import SOON


def test_an_obstacle_is_added_to_the_road_and_seen_ahead(explorer):
    before = explorer.run_number()
    explorer.page.get_by_text("Road", exact=True).first.click()
    view = explorer.page.locator(".trackride-road polyline")
    expect(view).to_be_visible(timeout=SOON)
    explorer.button("Trapezoid").click()
    explorer.wait_for_run(after=before)
    parts = "sine: amplitude 100, wavelength 7\ntrapezoid: position 5.1, height 100, top 0.5, base 1.5"
    expect(explorer.page.locator("textarea:not([aria-hidden])")).to_have_value(parts, timeout=SOON)
    explorer.press("Time", "Home")
    seen = view.get_attribute("points")
    explorer.press("Time", "End")
    explorer.page.wait_for_function(
        "old => document.querySelector('.trackride-road polyline').getAttribute('points') !== old",
        arg=seen,
        timeout=SOON,
    )
