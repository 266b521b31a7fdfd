"""The explorer as a user starts it, and a real browser that looks at it: for tests and for pictures."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from time import monotonic
from typing import TypeVar

from playwright.sync_api import Browser, Locator, Page, expect, sync_playwright

T = TypeVar("T")

FLAGS = [
    "--headless=new", "--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
    "--disable-accelerated-2d-canvas", "--disable-background-networking", "--disable-component-update",
    "--disable-gpu-compositing", "--disable-sync", "--no-first-run", "--disable-quic",
]  # fmt: skip
FIRST_RUN = 120_000  # ms: the interface, and the model's compilation if nobody has run it yet
SOON = 60_000  # ms: anything else, on a busy machine with software WebGL…
DOWNLOAD = 120_000  # ms: … but what the browser has to draw a large picture for

DRAWING = """['drawArrays', 'drawElements', 'drawArraysInstanced', 'drawElementsInstanced'].forEach(name => {
  const canvas = WebGL2RenderingContext.prototype, draw = canvas[name];
  canvas[name] = function (...what) { if (window.drawing) draw.apply(this, what); };
})"""  # for pages that draw in 3-D only while they are told to
TOURED = "try { localStorage.setItem('trackride-toured', 'yes') } catch { /* a page without an address */ }"
FOLDER = "[data-trackride-folder] > [role=button]"  # what opens and closes it
# How a test has left the page: palette open, drives, plays, at the start, loads in front
LEFT = """() => {
  // A test that failed leaves messages, and folders that are open
  document.querySelectorAll('.mantine-Notification-closeButton').forEach(button => button.click());
  document.querySelectorAll('[data-trackride-folder] > [role=button]:has(> svg[class*="chevron-up"])')
    .forEach(button => button.click());
  const time = [...document.querySelectorAll('label[for]')].find(label => label.textContent.startsWith('Time, s'));
  return [
    document.querySelector('.mantine-Spotlight-overlay') !== null,
    document.querySelector('button[aria-label="Drive"][aria-pressed="true"]') !== null,
    [...document.querySelectorAll('button')].some(button => button.offsetParent && /Pause/.test(button.textContent)),
    document.getElementById(time?.htmlFor)?.querySelector('[role=slider]')?.ariaValueNow === '0',
    [...document.querySelectorAll('[role=tab]')].some(tab => tab.title === 'Loads' && tab.ariaSelected === 'true'),
  ];
}"""
NEW_CURVES = "old => document.querySelector('.uplot canvas').toDataURL() !== old"  # JavaScript

expect.set_options(timeout=SOON)


def running_explorer(*arguments: str) -> AbstractContextManager[str]:
    """The address of an explorer in a process of its own."""
    return running([sys.executable, "-m", "app", "explore", "--no-browser", "--port", "0", *arguments])


@contextmanager
def running(command: list[str]) -> Iterator[str]:
    """The address that a server in a process of its own prints among its first lines."""
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        found = next(filter(None, (re.search(r"http://\S+", line) for line in process.stdout)), None)
        assert found, "the server did not say where it can be opened"
        try:
            yield found.group()
        finally:
            process.terminate()


@contextmanager
def chromium(*flags: str) -> Iterator[Browser]:
    """Chromium with WebGL in software, and with more flags."""
    path = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
    assert path, "no Chromium was found: `make chromium` installs one"
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=path, args=[*FLAGS, *flags])
        yield browser
        browser.close()


class Explorer:
    """The explorer's page, by what a user sees on it."""

    def __init__(self, page: Page, *, first_visit: bool = False) -> None:
        """first_visit: the browser has never seen the tour, which begins by itself then."""
        self.page = page
        if not first_visit:
            page.add_init_script(TOURED)
        page.set_default_timeout(SOON)

    def open(self, address: str) -> Explorer:
        """Until the first run stands in the plots."""
        self.page.goto(address)
        expect(self.status).to_contain_text("real time", timeout=FIRST_RUN)
        expect(self.charts.first).to_be_visible(timeout=SOON)
        return self

    def come_to_rest(self) -> None:
        """As after opening, but paused at the start of the run, without messages and with all folders closed.

        What is to be done is found out at once: to look for each button by its name takes the page as long as a run.
        """
        asks, drives, plays, started, front = self.page.evaluate(LEFT)
        if asks:
            self.page.keyboard.press("Escape")
        if drives:
            self.mode("Run", on=False).click()
            expect(self.status).to_contain_text("real time")
        if (drives or plays) and self.button("Pause").is_visible():
            self.pause()
        if drives or plays or not started:
            self.press("Time, s", "Home")
            self.wait_for_value("Time, s", "now === 0")
        if not front:
            self.page.get_by_role("tab", name="Loads").click()
        before = self.run_number()
        self.status.click()  # no box has the keys any more
        self.page.keyboard.press("r")
        self.wait_for_run(after=before)
        expect(self.messages).to_have_count(0)

    def pause(self) -> None:
        """Stop what plays, and see it stopped: the button is another then, and a later click on it could miss it."""
        self.button("Pause").click()
        expect(self.button("▶ Play")).to_be_visible(timeout=SOON)

    @contextmanager
    def drawing(self) -> Iterator[None]:
        """Draw in 3-D meanwhile, in a page that does not otherwise (DRAWING)."""
        self.page.evaluate("window.drawing = true")
        yield
        self.page.evaluate("window.drawing = false")

    @property
    def messages(self) -> Locator:
        """What closes them."""
        return self.page.locator(".mantine-Notification-closeButton")

    def close_messages(self) -> None:
        """Those that there are."""
        self.messages.evaluate_all("all => all.forEach(one => one.click())")

    @property
    def status(self) -> Locator:
        """The line that names the run."""
        return self.page.locator(".trackride-status")

    @property
    def strips(self) -> Locator:
        """The box that switches the strips on the sliders; while they are on, each run is followed by a study."""
        return self.page.get_by_label("What each slider would do")

    @property
    def charts(self) -> Locator:
        return self.page.locator(".uplot canvas")

    def control(self, label: str) -> Locator:
        """What stands behind a label."""
        text = self.page.locator("label", has_text=re.compile(rf"^{re.escape(label)}"))
        return self.page.locator(f"[id='{text.first.get_attribute('for')}']")

    def thumb(self, label: str) -> Locator:
        """The handle of a slider."""
        return self.control(label).locator("[role=slider]")

    def box(self, label: str) -> Locator:
        """The box beside a slider."""
        return self.control(label).locator("xpath=..").locator("input[type=text]")

    def value(self, label: str) -> float:
        """What a slider stands at."""
        return float(self.thumb(label).get_attribute("aria-valuenow") or "nan")

    def wait_for_value(self, label: str, condition: str, value: float = 0.0) -> None:
        """Until a slider stands where the condition, in JavaScript of `now` and `value`, says."""
        self.page.wait_for_function(
            "([id, value]) => { const now = Number(document.getElementById(id)"
            f"?.querySelector('[role=slider]')?.ariaValueNow); return {condition} }}",
            arg=[self.control(label).get_attribute("id"), value],
            timeout=SOON,
        )

    def press(self, label: str, key: str) -> None:
        """A key on a slider."""
        self.thumb(label).focus()
        self.page.keyboard.press(key)

    def fold(self, name: str) -> None:
        """Open or close a folder of controls."""
        folder = self.page.locator(FOLDER).filter(has_text=re.compile(f"^{name}$"))
        is_open = folder.get_attribute("aria-expanded") == "true"
        folder.click()
        expect(folder).to_have_attribute("aria-expanded", "false" if is_open else "true")

    def run_number(self) -> int:
        found = re.search(r"Run (\d+)", self.status.inner_text())
        assert found
        return int(found.group(1))

    def curves(self, chart: int = 0) -> str:
        """The pixels of a chart."""
        return self.charts.nth(chart).evaluate("canvas => canvas.toDataURL()")

    def wait_for_run(self, after: int) -> int:
        """Until a run with a higher number stands in the page."""
        self.page.wait_for_function(
            "after => { const found = /Run (\\d+) · .*real time/.exec("
            "document.querySelector('.trackride-status')?.innerText ?? ''); return found && Number(found[1]) > after }",
            arg=after,
            timeout=SOON,
        )
        return self.run_number()

    def wait_until_still(self, read: Callable[[], T]) -> T:
        """Until what is read has not changed for a good half second; what it is then."""
        now, end = read(), monotonic() + SOON / 1000
        while monotonic() < end:
            self.page.wait_for_timeout(600)
            before, now = now, read()
            if before == now:
                return now
        raise AssertionError("it never stood still")

    def button(self, name: str) -> Locator:
        """A button whose name has this in it, with this case: "Reset" is not in "Import and presets"."""
        return self.page.get_by_role("button", name=re.compile(re.escape(name)))

    def mode(self, name: str, *, on: bool = True) -> Locator:
        """The button Run or Drive of the player, while it is on, or off."""
        return self.page.get_by_role("button", name=name, exact=True, pressed=on)
