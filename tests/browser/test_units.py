"""The page in the units of choice: what is shown, what a typed number means, and that files stay metric."""

from __future__ import annotations

import re

from playwright.sync_api import Browser, expect

from tests.browser.conftest import new_context
from tests.browser.driver import Explorer
from tests.browser.test_typing import type_into

AXES = """unit => Object.values(window.__viserTestpoints.uplots).some(({chart}) => chart.axes[1].label === unit)"""


def test_all_of_the_page_is_told_in_us_units_and_back(browser: Browser, address: str) -> None:
    context = new_context(browser)
    explorer = Explorer(context.new_page()).open(f"{address}/?fixedDpr=0.25#paper&wheel=R1")
    page = explorer.page
    card = page.locator(".trackride-wheel")
    expect(card).to_contain_text("kN")
    explorer.pause()
    explorer.press("Time, s", "Home")  # where the wheel is on the ground
    explorer.fold("View")
    page.get_by_role("button", name="US", exact=True).click()
    expect(page.locator("label", has_text="Speed, mph")).to_be_visible()
    explorer.wait_for_value("Speed, mph", "now === 9.321")
    expect(card).to_contain_text("lbf")
    expect(card).to_contain_text("ft/s")
    page.wait_for_function(AXES, arg="lbf")
    assert explorer.run_number() == 1
    page.wait_for_url(re.compile(r"#paper&.*\bwheel=R1"))

    type_into(explorer, "Speed, mph", "20")
    explorer.wait_for_run(after=1)
    explorer.wait_for_value("Speed, mph", "now === 20")
    page.wait_for_url(re.compile(r"#paper&drive\.speed_kmh=32\.18688&.*\bwheel=R1"))
    type_into(explorer, "Speed, mph", "70")
    expect(page.get_by_text("Speed: 70 mph is not allowed. Give 0.3107 to 62.14 mph.")).to_be_visible()
    page.get_by_role("tab", name="Ride").click()
    for unit in ("g", "mph", "in"):
        page.wait_for_function(AXES, arg=unit)

    page.reload()
    explorer.wait_for_value("Speed, mph", "now === 20")
    explorer.fold("View")
    page.get_by_role("button", name="Metric", exact=True).click()
    explorer.wait_for_value("Speed, km/h", "now === 32.18688")
    page.wait_for_function(AXES, arg="kN")
    context.close()
