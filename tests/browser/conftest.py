"""One explorer, one browser and one tab for all tests of this folder, and more tabs where one is not enough."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import pytest
from playwright.sync_api import Browser, BrowserContext, ViewportSize

from tests.browser.driver import DRAWING, Explorer, chromium, running_explorer

OpenTab = Callable[..., Explorer]
SIZE: ViewportSize = {"width": 1280, "height": 720}


@pytest.fixture(scope="package")
def address() -> Iterator[str]:
    with running_explorer() as address:
        yield address


@pytest.fixture(scope="package")
def browser() -> Iterator[Browser]:
    with chromium() as browser:
        yield browser


def new_context(browser: Browser, **settings: Any) -> BrowserContext:
    """A user of their own, whose pages draw nothing in 3-D until a test says so: in software it takes both cores."""
    context = browser.new_context(viewport=SIZE, **settings)
    context.add_init_script(DRAWING)
    return context


@pytest.fixture
def open_tab(browser: Browser, address: str) -> Iterator[OpenTab]:
    """A function that opens the explorer in a tab of its own, of a browser with these settings."""
    contexts = []

    def open_one(**settings: Any) -> Explorer:
        contexts.append(new_context(browser, **settings))
        return Explorer(contexts[-1].new_page()).open(f"{address}/?fixedDpr=0.25")

    yield open_one
    for context in contexts:
        context.close()


@pytest.fixture(scope="package")
def shared(browser: Browser, address: str) -> Iterator[Explorer]:
    context = new_context(browser)
    explorer = Explorer(context.new_page()).open(f"{address}/?fixedDpr=0.25")
    explorer.strips.uncheck()
    yield explorer
    context.close()


@pytest.fixture
def at_rest(shared: Explorer) -> Explorer:
    """The tab that the tests share, since opening one takes seconds: paused, so that it draws only changes, at the
    run's start, with the parameters of the paper's vehicle, without strips on the sliders. A test leaves strips and
    folders as it found them; what it pins or keeps stays."""
    shared.come_to_rest()
    return shared
