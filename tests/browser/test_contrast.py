"""Text can be read, in the light look and in the dark one."""

from __future__ import annotations

from contextlib import suppress

from playwright.sync_api import TimeoutError as PlaywrightTimeoutError
from playwright.sync_api import expect

from tests.browser.driver import SOON, Explorer

TABS = "Loads", "Ride", "Spectrum", "Load map", "Runs", "Study", "Trust", "About"
LEAST = 4.5  # contrast of small text, WCAG 2.2, success criterion 1.4.3

# Texts with less contrast to what they stand on than asked for: [text, contrast]. What cannot be used may be pale.
PALE = """least => {
  const numbers = css => (css.match(/[\\d.]+/g) ?? [0, 0, 0, 0]).map(Number);
  const over = ([r, g, b, a = 1], below) => [r, g, b].map((part, k) => a * part + (1 - a) * below[k]);
  const light = colour => colour.map(part => part / 255)
    .map(part => part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4)
    .reduce((sum, part, k) => sum + part * [0.2126, 0.7152, 0.0722][k], 0);
  const behind = element => element === null ? [255, 255, 255]
    : over(numbers(getComputedStyle(element).backgroundColor), behind(element.parentElement));
  const opacity = element => element === null ? 1
    : getComputedStyle(element).opacity * opacity(element.parentElement);
  const pale = [], texts = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  while (texts.nextNode()) {
    const text = texts.currentNode.textContent.trim(), element = texts.currentNode.parentElement;
    const hidden = !/\\w/.test(text) || !element.offsetWidth || element.closest('style, script, [data-disabled]')
      || getComputedStyle(element).visibility === 'hidden';
    if (hidden) continue;
    const ground = behind(element), [r, g, b, a = 1] = numbers(getComputedStyle(element).color);
    const [low, high] = [light(over([r, g, b, a * opacity(element)], ground)), light(ground)].sort((p, q) => p - q);
    const contrast = (high + 0.05) / (low + 0.05);
    if (contrast < least) pale.push([text.slice(0, 40), contrast]);
  }
  return pale;
}"""


def test_all_text_stands_out_from_what_is_behind_it(at_rest: Explorer) -> None:
    page = at_rest.page
    at_rest.strips.check()
    for look in ("dark", "light"):
        at_rest.fold("View")
        at_rest.control("Dark").evaluate("box => box.click()")
        expect(page.locator("html")).to_have_attribute("data-mantine-color-scheme", look)
        at_rest.fold("View")
        for tab in TABS:
            page.get_by_role("tab", name=tab, exact=True).click()
            with suppress(PlaywrightTimeoutError):  # colours change in a moment
                page.wait_for_function(f"least => !({PALE})(least).length", arg=LEAST, polling=250, timeout=SOON)
            assert page.evaluate(PALE, LEAST) == [], f"{tab}, {look}"
    at_rest.strips.uncheck()
