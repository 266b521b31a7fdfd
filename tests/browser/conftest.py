"""One explorer and one browser for all tests; a tab for each."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import pytest
from playwright.sync_api import Browser, expect

from tests.browser.driver import Explorer, chromium, running_explorer

OpenTab = Callable[..., Explorer]


@pytest.fixture(scope="session")
def address() -> Iterator[str]:
    with running_explorer() as address:
        yield address


@pytest.fixture(scope="session")
def browser() -> Iterator[Browser]:
    with chromium() as browser:
        yield browser


@pytest.fixture
def open_tab(browser: Browser, address: str) -> Iterator[OpenTab]:
    """A function that opens the explorer in a tab of its own."""
    contexts = []

    def open_one(width: int = 1280, height: int = 720) -> Explorer:
        contexts.append(browser.new_context(viewport={"width": width, "height": height}))
        return Explorer(contexts[-1].new_page()).open(f"{address}/?fixedDpr=0.5")

    yield open_one
    for context in contexts:
        context.close()


@pytest.fixture
def explorer(open_tab: OpenTab) -> Explorer:
    return open_tab()


@pytest.fixture(scope="module")
def at_rest(browser: Browser, address: str) -> Iterator[Explorer]:
    """A tab that all tests of a module share: opening one takes seconds. Paused, so that it draws only changes."""
    context = browser.new_context(viewport={"width": 1280, "height": 720})
    explorer = Explorer(context.new_page()).open(f"{address}/?fixedDpr=0.5")
    explorer.button("Pause").click()
    expect(explorer.button("Play").first).to_be_visible()
    yield explorer
    context.close()
