"""`make pictures`: the README's pictures, taken in a real browser."""

from __future__ import annotations

from pathlib import Path

from tests.browser.driver import Explorer, chromium, running_explorer

PICTURES = Path(__file__).parents[2] / "assets" / "pictures"
SIZE = {"width": 1600, "height": 900}


def take(explorer: Explorer, name: str) -> None:
    """A picture of the whole page, once everything has been drawn."""
    explorer.page.mouse.move(SIZE["width"] / 2, 40)  # no hint in the way
    explorer.page.wait_for_timeout(5000)
    explorer.page.screenshot(path=PICTURES / f"{name}.png")


def open_at_rest(explorer: Explorer, address: str) -> None:
    """The explorer, paused in the middle of the run."""
    explorer.open(address)
    notice = explorer.page.locator(".mantine-Notification-closeButton")
    if notice.count():  # that WebGL runs in software
        notice.first.click()
    explorer.page.wait_for_timeout(4000)  # to where the waves are in full height
    explorer.button("Pause").click()
    explorer.page.wait_for_timeout(1000)


def main() -> None:
    PICTURES.mkdir(exist_ok=True)
    with running_explorer() as address, chromium() as browser:
        explorer = Explorer(browser.new_page(viewport=SIZE))
        page = explorer.page
        open_at_rest(explorer, address)
        take(explorer, "explorer")

        page.keyboard.press("b")
        page.get_by_role("tab", name="Runs").click()
        page.get_by_text("Suspension", exact=True).click()
        before = explorer.run_number()
        explorer.control("Road damping").fill("2.366")
        explorer.wait_for_run(after=before)
        take(explorer, "comparison")

        page.get_by_text("Suspension", exact=True).click()
        page.get_by_text("View", exact=True).first.click()
        page.get_by_text("Dark", exact=True).click()
        page.locator(".trackride-status").click()  # no box has the keys any more
        page.keyboard.press("2")
        page.get_by_role("tab", name="Spectrum").click()
        take(explorer, "spectrum")


if __name__ == "__main__":
    main()
