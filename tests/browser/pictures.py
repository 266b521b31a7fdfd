"""`make pictures`: the README's pictures, taken in a real browser."""

from __future__ import annotations

from pathlib import Path

from playwright.sync_api import Browser, expect

from tests.browser.driver import Explorer, chromium, running_explorer

PICTURES = Path(__file__).parents[2] / "assets" / "pictures"
SIZE = {"width": 1600, "height": 900}
STUDIED = """localStorage.setItem('trackride-study', JSON.stringify({rows: ['absorbed_power', 'peak_load']}))"""
GALLERY = {  # three vehicles on three roads: preset, what is set, time in s, and the view's key
    "m113": ("m113", {"road.type": "half_round", "road.height": 0.2, "road.radius": 0.3, "road.position": 8}, 2.1, "1"),
    "marder": ("marder", {"road.type": "random", "road.roughness_class": "E", "drive.speed_kmh": 30}, 7.1, "1"),
    "robot": ("robot", {}, 6.0, "2"),
}


def take(explorer: Explorer, name: str) -> None:
    """A picture of the whole page, once everything has been drawn, without messages."""
    explorer.page.mouse.move(SIZE["width"] / 2, 40)  # no hint in the way
    explorer.page.wait_for_timeout(5000)
    explorer.close_messages()
    explorer.page.wait_for_timeout(500)  # they fade
    explorer.page.screenshot(path=PICTURES / f"{name}.png")


def open_at_rest(explorer: Explorer, address: str) -> None:
    """The explorer, paused in the middle of the run."""
    explorer.open(address)
    explorer.page.wait_for_timeout(4000)  # to where the waves are in full height
    explorer.pause()
    explorer.page.wait_for_timeout(1000)


def take_gallery(browser: Browser) -> None:
    """Each vehicle in an explorer of its own."""
    for name, (preset, changes, time, view) in GALLERY.items():
        settings = [f"--set={key}={value}" for key, value in changes.items()]
        with running_explorer(preset, *settings) as address:
            explorer = Explorer(browser.new_page(viewport=SIZE))
            open_at_rest(explorer, address)
            at = explorer.box("Time")
            at.fill(str(time))
            at.press("Enter")
            explorer.page.locator(".trackride-status").click()  # no box has the keys any more
            explorer.page.keyboard.press(view)
            take(explorer, name)
            explorer.page.close()


def main() -> None:
    PICTURES.mkdir(exist_ok=True)
    with running_explorer() as address, chromium() as browser:
        take_gallery(browser)
        explorer = Explorer(browser.new_page(viewport=SIZE))
        page = explorer.page
        page.add_init_script(STUDIED)
        open_at_rest(explorer, address)
        take(explorer, "explorer")

        page.get_by_role("tab", name="Study").click()
        page.get_by_title("Large, over the view").click()
        expect(page.locator("trackride-study .body svg")).to_be_visible()
        page.wait_for_timeout(15_000)  # the curves grow finer
        take(explorer, "profiler")
        page.keyboard.press("Escape")

        page.keyboard.press("b")
        page.get_by_role("tab", name="Runs").click()
        before = explorer.run_number()
        explorer.box("Suspension damping").fill("2.366")
        explorer.wait_for_run(after=before)
        take(explorer, "comparison")

        page.get_by_text("View", exact=True).first.click()
        page.get_by_text("Dark", exact=True).click()
        page.locator(".trackride-status").click()  # no box has the keys any more
        page.keyboard.press("2")
        page.get_by_role("tab", name="Spectrum").click()
        take(explorer, "spectrum")


if __name__ == "__main__":
    main()
