"""Roads as a user changes them in the page."""

from __future__ import annotations

import re
from pathlib import Path

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


def test_a_profile_that_is_not_clear_is_looked_at_before_it_is_used(at_rest: Explorer, tmp_path: Path) -> None:
    page, before = at_rest.page, at_rest.run_number()
    file = tmp_path / "course.csv"
    rows = (f"{0.5 * k},{25 * (k % 3)},{20 * (k % 2)}" for k in range(100))
    file.write_text("\n".join(["x [m],left,right", *rows]))
    at_rest.fold("Road")
    with page.expect_file_chooser() as chooser:
        at_rest.button("Open a profile").click()
    chooser.value.set_files(file)
    form = page.get_by_role("dialog")
    said, line = form.locator(".trackride-said"), form.locator(".trackride-preview polyline")
    expect(said).to_have_text(re.compile("^100 points, 0 to 49.5 m, heights 0 to 50 mm; .*columns x \\[m\\] and left"))
    seen = line.get_attribute("points")
    at_rest.control("Height column").click()
    page.get_by_role("option", name="right", exact=True).click()
    expect(said).to_contain_text("heights 0 to 20 mm")
    assert line.get_attribute("points") != seen
    at_rest.control("Height unit").click()
    page.get_by_role("option", name="m", exact=True).click()
    use = form.get_by_role("button", name="Use", exact=True)
    expect(form.locator(".trackride-refused")).to_contain_text("steeper than 85°")
    expect(use).to_be_disabled()
    at_rest.control("Height unit").click()
    page.get_by_role("option", name="mm", exact=True).click()
    assert at_rest.run_number() == before
    use.click()
    expect(form).to_have_count(0)
    at_rest.wait_for_run(after=before)
    expect(page.locator(".trackride-extent")).to_have_text("100 points, 49.5 m long, 0.02 m high")
    at_rest.button("Columns and units").click()
    expect(at_rest.control("Height column")).to_have_value("right")
    form.get_by_role("button", name="Cancel").click()
    expect(form).to_have_count(0)
    at_rest.fold("Road")
