"""The endless drive, the keys and the text boxes, as a user meets them."""

from __future__ import annotations

import re
from collections.abc import Callable
from time import monotonic

from playwright.sync_api import expect

from tests.browser.driver import DOWNLOAD, NEW_CURVES, SOON, Explorer

# Whether the line that tells the stretch of the drive is there and covers no other text and no box.
CLEAR = """() => {
  const said = [...document.querySelectorAll('.trackride-stretch span')].find(line => line.offsetWidth);
  if (!said) return false;
  const panel = said.closest('.mantine-Paper-root'), boxes = [...panel.querySelectorAll('input, canvas, img')];
  const texts = document.createTreeWalker(panel, NodeFilter.SHOW_TEXT), range = document.createRange();
  while (texts.nextNode()) {
    range.selectNodeContents(texts.currentNode);
    if (texts.currentNode.parentElement !== said && texts.currentNode.parentElement.tagName !== 'STYLE')
      boxes.push({getBoundingClientRect: (rect => () => rect)(range.getBoundingClientRect())});
  }
  const own = said.getBoundingClientRect();
  return boxes.map(box => box.getBoundingClientRect()).every(box => !box.width ||
    box.right <= own.left || box.left >= own.right || box.bottom <= own.top || box.top >= own.bottom);
}"""


def driven(explorer: Explorer) -> str:
    """What the player says of the drive: "0:05 · 21 m · 1.00× of 1× real time"."""
    return explorer.page.locator("label", has_text="Driven").locator("xpath=../../..").locator("input").input_value()


def seconds(explorer: Explorer) -> int:
    found = re.match(r"(\d+):(\d+) · \d+ m · ", driven(explorer))
    return 60 * int(found.group(1)) + int(found.group(2)) if found else 0


def last_row(explorer: Explorer) -> float:
    """Where the player's last row stands, px: it stays there."""
    return explorer.page.locator("label", has_text="Time scale").evaluate("label => label.getBoundingClientRect().y")


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


def test_the_drive_goes_on_follows_sliders_and_rests_in_the_background(at_rest: Explorer) -> None:
    page, run = at_rest.page, at_rest.run_number()
    assert not page.get_by_text("In view").is_visible()
    height = last_row(at_rest)
    at_rest.button("○ Drive").click()
    wait_until(at_rest, lambda: seconds(at_rest) >= 2)
    wait_until(at_rest, lambda: abs(last_row(at_rest) - height) < 1)
    curves = at_rest.curves()
    before = seconds(at_rest)
    at_rest.press("Speed", "ArrowRight")
    wait_until(at_rest, lambda: seconds(at_rest) > before)
    page.wait_for_function(NEW_CURVES, arg=curves)
    wait_until(at_rest, lambda: bool(re.search(r"\d\.\d\d× of 1× real time", driven(at_rest))))
    expect(at_rest.status).to_contain_text("Drive")

    set_hidden(at_rest, True)
    at_rest.wait_until_still(at_rest.curves)
    set_hidden(at_rest, False)
    rested = seconds(at_rest)
    wait_until(at_rest, lambda: seconds(at_rest) > rested)

    at_rest.button("◀ Step").click()
    expect(at_rest.status).to_contain_text("look back")
    at_rest.wait_for_value("Time, s", "now > value", rested)
    end = at_rest.value("Time, s")
    page.get_by_role("tab", name="Spectrum").click()
    expect(page.get_by_text("The drive from").locator("visible=true")).to_have_count(1)
    for tab in ("Trust", "Load map", "Spectrum"):
        page.get_by_role("tab", name=tab, exact=True).click()
        page.wait_for_function(CLEAR)
    at_rest.press("Time, s", "Home")
    at_rest.wait_for_value("Time, s", "now < value", end)
    page.get_by_role("tab", name="Loads").click()
    at_rest.button("Drive on").click()
    wait_until(at_rest, lambda: seconds(at_rest) > end)

    before = seconds(at_rest)
    at_rest.button("Restart").click()
    wait_until(at_rest, lambda: " m · " in driven(at_rest) and seconds(at_rest) < before)
    at_rest.button("○ Run").click()
    at_rest.wait_for_run(after=run)
    expect(at_rest.thumb("Time, s")).to_be_visible()


def test_keys_work_outside_of_text_boxes_only(at_rest: Explorer) -> None:
    page, run = at_rest.page, at_rest.run_number()
    downloads: list[object] = []
    page.on("download", lambda download: downloads.append(download))
    at_rest.press("Time, s", "End")
    at_rest.wait_for_value("Time, s", "now > 9")
    box = at_rest.box("Road stiffness")
    box.click()
    for key in (" ", "s", "b", "d", "f", "r"):
        page.keyboard.press(key)
    assert page.evaluate("document.activeElement.tagName") == "INPUT"
    box.blur()
    with page.expect_download(timeout=DOWNLOAD):  # what the keys before it had asked for would come before
        page.keyboard.press("s")
    page.keyboard.press("Shift+ArrowLeft")
    at_rest.wait_for_value("Time, s", "now < 9.95")
    assert len(downloads) == 1
    assert at_rest.run_number() == run
    assert at_rest.button("▶ Play").is_visible()
    assert at_rest.button("● Run").is_visible()

    page.keyboard.press(" ")
    expect(at_rest.button("Pause")).to_be_visible()
    page.keyboard.press(" ")
    expect(at_rest.button("▶ Play")).to_be_visible()
    page.keyboard.press("d")
    expect(at_rest.button("● Drive")).to_be_visible()
    page.keyboard.press("d")
    expect(at_rest.button("● Run")).to_be_visible()
