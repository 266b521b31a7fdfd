"""Roads as a user changes them in the page."""

from __future__ import annotations

from playwright.sync_api import expect

from tests.browser.driver import SOON, Explorer


def test_an_obstacle_is_added_to_the_road_and_seen_ahead(at_rest: Explorer) -> None:
    before = at_rest.run_number()
    at_rest.fold("Road")
    view = at_rest.page.locator(".trackride-road polyline")
    expect(view).to_be_visible(timeout=SOON)
    at_rest.button("Trapezoid").click()
    at_rest.wait_for_run(after=before)
    parts = "sine: amplitude 100 mm, wavelength 7 m\ntrapezoid: position 5.1 m, height 100 mm, top 0.5 m, base 1.5 m"
    expect(at_rest.page.locator("textarea:not([aria-hidden])")).to_have_value(parts, timeout=SOON)
    seen = view.get_attribute("points")
    at_rest.press("Time, s", "End")
    at_rest.page.wait_for_function(
        "old => document.querySelector('.trackride-road polyline').getAttribute('points') !== old",
        arg=seen,
        timeout=SOON,
    )
    at_rest.fold("Road")
