"""`make pictures`: the README's pictures, taken in a real browser."""

from __future__ import annotations

from pathlib import Path

from tests.browser.driver import Explorer, chromium, running_explorer

PICTURES = Path(__file__).parents[2] / "assets" / "pictures"
SIZE = {"width": 1600, "height": 900}


def main() -> None:
    PICTURES.mkdir(exist_ok=True)
    with running_explorer() as address, chromium() as browser:
        explorer = Explorer(browser.new_page(viewport=SIZE)).open(address)
        notice = explorer.page.locator(".mantine-Notification-closeButton")
        if notice.count():  # that WebGL runs in software
            notice.first.click()
        explorer.button("Pause").click()
        explorer.page.mouse.move(SIZE["width"] / 2, 40)  # no hint in the way
        explorer.page.wait_for_timeout(4000)
        explorer.page.screenshot(path=PICTURES / "explorer.png")


if __name__ == "__main__":
    main()
