"""The page's address says what is shown, opens it again, and the back button leads through what was shown."""

from __future__ import annotations

from playwright.sync_api import Browser, expect

from tests.browser.conftest import new_context
from tests.browser.driver import Explorer


def test_a_link_opens_what_it_says_and_back_leads_to_what_was_before(browser: Browser, address: str) -> None:
    context = new_context(browser)
    link = "m113&drive.speed_kmh=25&vs=m113"
    explorer = Explorer(context.new_page()).open(f"{address}/#{link}")
    page = explorer.page
    expect(explorer.control("Preset")).to_have_value("M113")
    explorer.wait_for_value("Speed", "now === 25")
    page.wait_for_url(f"**/#{link}")
    explorer.press("Speed", "ArrowRight")
    page.wait_for_url("**/#m113&drive.speed_kmh=25.5&vs=m113")
    page.go_back()
    explorer.wait_for_value("Speed", "now === 25")
    page.get_by_role("tab", name="Runs").click()
    expect(page.locator(".trackride-compared")).to_contain_text("Baseline ● M113")
    context.close()


def test_the_palette_leads_to_a_parameter_and_a_change_has_its_own_reset(at_rest: Explorer) -> None:
    page = at_rest.page
    page.keyboard.press("Control+k")
    expect(page.locator("input.mantine-Spotlight-search")).to_be_focused()
    page.keyboard.type("Friction")
    expect(page.locator(".mantine-Spotlight-action").first).to_contain_text("Friction")  # the others are gone
    page.keyboard.press("Enter")
    expect(page.locator("label", has_text="Friction").first).to_be_visible()
    at_rest.press("Speed", "ArrowRight")
    back = page.get_by_role("button", name="Speed back to 15 km/h")
    back.click()
    at_rest.wait_for_value("Speed", "now === 15")
    expect(back).to_have_count(0)
    at_rest.fold("Ground contact")
