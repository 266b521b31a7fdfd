"""A server that goes away under an open page, and comes back."""

from __future__ import annotations

import socket
from itertools import pairwise

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
        explorer.pause()
        explorer.press("Time, s", "Home")
        explorer.press("Time, s", "ArrowRight")
        page.wait_for_function("() => sessionStorage.getItem('trackride-place')?.includes('\"time\": 0.01,')")
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
        explorer.wait_for_value("Time, s", "now === 0.01")
        expect(explorer.button("▶ Play")).to_be_visible()
        assert explorer.wait_until_still(lambda: explorer.control("Time, s").bounding_box()) == slider
        context.close()


def test_what_a_busy_page_tells_comes_one_at_a_time(at_rest: Explorer) -> None:
    """viser sends only the first and the last of what is set within 50 ms."""
    times = at_rest.page.evaluate(
        """() => new Promise((done) => {
          const times = [];
          for (let k = 0; k < 3; k++) trackrideInTurn(() => {
            times.push(performance.now());
            if (times.length === 3) done(times);
          });
          setTimeout(() => { for (const end = performance.now() + 500; performance.now() < end;); });
        })"""
    )
    assert min(after - before for before, after in pairwise(times)) > 50
