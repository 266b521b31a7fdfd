"""The endless drive, the keys and the text boxes, as a user meets them."""

from __future__ import annotations

import re
from collections.abc import Callable
from time import monotonic

from playwright.sync_api import expect

from tests.browser.driver import SOON, Explorer


def driven(explorer: Explorer) -> str:
    """What the player says of the drive: "0:05 · 21 m · 1.00× of 1× real time"."""
    return explorer.page.locator("label", has_text="Driven").locator("xpath=../../..").locator("input").input_value()


def seconds(explorer: Explorer) -> int:
    found = re.match(r"(\d+):(\d+) · \d+ m · ", driven(explorer))
    return 60 * int(found.group(1)) + int(found.group(2)) if found else 0


def wait_until(explorer: Explorer, condition: Callable[[], bool]) -> None:
    end = monotonic() + SOON / 1000
    while not condition():
        assert monotonic() < end, "waited in vain"
        explorer.page.wait_for_timeout(100)


def set_hidden(explorer: Explorer, hidden: bool) -> None:
    """As if the tab went to the background, or came back."""
    explorer.page.evaluate(
        "hidden => { Object.defineProperty(document, 'hidden', {value: hidden, configurable: true});"
        " document.dispatchEvent(new Event('visibilitychange')) }",
        hidden,
    )


def test_the_drive_goes_on_follows_sliders_and_rests_in_the_background(explorer):
    page = explorer.page
    assert not page.get_by_text("In view").is_visible()
    explorer.button("○ Drive").click()
    wait_until(explorer, lambda: seconds(explorer) >= 2)
    curves = explorer.curves()
    before = seconds(explorer)
    explorer.press("Speed", "ArrowRight")
    wait_until(explorer, lambda: seconds(explorer) > before)
    assert explorer.curves() != curves
    assert re.search(r"\d\.\d\d× of 1× real time", driven(explorer))
    assert "Drive" in explorer.status.inner_text()

    set_hidden(explorer, True)
    explorer.wait_until_still(explorer.curves)
    set_hidden(explorer, False)
    rested = seconds(explorer)
    wait_until(explorer, lambda: seconds(explorer) > rested)

    explorer.button("◀ Step").click()
    expect(explorer.status).to_contain_text("look back")
    expect(explorer.thumb("Time")).to_be_visible()
    end = explorer.value("Time")
    assert end > rested
    page.get_by_role("tab", name="Spectrum").click()
    expect(page.get_by_text("The drive from").locator("visible=true")).to_have_count(1)
    explorer.press("Time", "Home")
    wait_until(explorer, lambda: explorer.value("Time") < end)
    page.get_by_role("tab", name="Loads").click()
    explorer.button("Drive on").click()
    wait_until(explorer, lambda: seconds(explorer) > end)

    explorer.button("Restart").click()
    wait_until(explorer, lambda: driven(explorer).startswith("0:00 "))
    explorer.button("○ Run").click()
    explorer.wait_for_run(after=2)
    expect(explorer.thumb("Time")).to_be_visible()


def test_keys_work_outside_of_text_boxes_only(explorer):
    page = explorer.page
    downloads: list[object] = []
    page.on("download", lambda download: downloads.append(download))
    box = explorer.control("Road stiffness").locator("xpath=..").locator("input[type=text]")
    box.click()
    for key in (" ", "s", "b", "d", "f", "r"):
        page.keyboard.press(key)
    page.wait_for_timeout(1500)
    assert downloads == []
    assert explorer.button("Pause").is_visible()
    assert explorer.button("● Run").is_visible()

    assert page.evaluate("document.activeElement.tagName") == "INPUT"
    box.blur()
    page.keyboard.press(" ")
    page.get_by_role("button", name="▶ Play").wait_for()
    time = explorer.value("Time")
    page.keyboard.press("Shift+ArrowLeft")
    wait_until(explorer, lambda: explorer.value("Time") < time)
    page.keyboard.press("d")
    page.get_by_role("button", name="● Drive").wait_for()
    page.keyboard.press("d")
    page.get_by_role("button", name="● Run").wait_for()
