"""A server that goes away under an open page, and comes back."""

from __future__ import annotations

import socket

from playwright.sync_api import Browser, expect

from tests.browser.conftest import new_context
from tests.browser.driver import SOON, Explorer, running_explorer


def test_a_page_waits_for_its_server_and_comes_back_as_it_was(browser: Browser) -> None:
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = str(free.getsockname()[1])
    context = new_context(browser)
    with running_explorer("--port", port) as address:
        explorer = Explorer(context.new_page()).open(f"{address}/?fixedDpr=0.25")
        page = explorer.page
        before = explorer.run_number()
        explorer.press("Speed", "ArrowRight")
        explorer.wait_for_run(after=before)
        page.wait_for_function(
            "text => Object.values(localStorage).some(stored => stored.includes(text))", arg='"drive.speed_kmh": 15.5'
        )
        slider = explorer.wait_until_still(lambda: explorer.control("Time, s").bounding_box())
    lost = page.locator(".trackride-lost")
    expect(lost).to_be_visible()
    explorer.press("Speed", "ArrowRight")
    explorer.press("Speed", "End")
    assert explorer.value("Speed") == 15.5
    page.evaluate("() => window.before = true")
    with running_explorer("--port", port):
        page.wait_for_function("() => !window.before && document.querySelector('trackride-title')", timeout=SOON)
        expect(page).to_have_title("Paper vehicle, sine · Trackride")
        expect(lost).to_be_hidden()
        explorer.wait_for_value("Speed", "now === 15.5")
        assert explorer.wait_until_still(lambda: explorer.control("Time, s").bounding_box()) == slider
        context.close()
