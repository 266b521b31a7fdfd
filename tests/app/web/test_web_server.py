"""What viser's server does that ours does not, and what it lacks."""

from __future__ import annotations

import asyncio
import gzip
from typing import Any
from urllib.parse import quote
from urllib.request import Request, urlopen

import pytest
import websockets.asyncio.server

from app.web.web_server import _AnyThreadEvent, _asked_first
from tests.app.conftest import Tab, wait_for


def test_what_one_tab_says_of_a_form_is_kept_for_no_other(explore: Any, open_tab: Any) -> None:
    explorer = explore()
    one: Tab = open_tab(explorer)
    wait_for(lambda: one.shows_run(1))
    for number in range(20):
        one.send("GuiFormDirtyMessage", uuid=f"form {number}")
    one.use("Speed, km/h", 20)
    wait_for(lambda: one.shows_run(2))
    later: Tab = open_tab(explorer)
    wait_for(lambda: later.shows_run(1))
    assert not [message for message in later.messages if message["type"] == "GuiFormDirtyMessage"]


def test_a_server_that_would_let_everyone_in_does_not_start() -> None:
    serve = websockets.asyncio.server.serve
    with pytest.raises(RuntimeError, match="nobody would be turned away"), _asked_first(lambda *_: None):
        pass
    assert websockets.asyncio.server.serve is serve


def test_an_event_that_is_set_on_another_thread_leaves_those_who_wait_to_the_loop() -> None:
    async def check() -> None:
        event = _AnyThreadEvent()
        waiter = asyncio.create_task(event.wait())
        await asyncio.sleep(0)
        await asyncio.to_thread(event.set)
        await asyncio.sleep(0)
        assert event.is_set()
        assert not waiter.done()
        event.set()
        assert await waiter
        event.clear()
        assert not event.is_set()

    asyncio.run(check())


def test_tabs_wait_for_such_events(explore: Any, open_tab: Any) -> None:
    explorer = explore()
    tab: Tab = open_tab(explorer)
    wait_for(lambda: tab.shows_run(1))
    states = explorer.server._websock_server._client_state_from_id.values()
    assert {type(state.message_buffer.message_event) for state in states} == {_AnyThreadEvent}


@pytest.mark.parametrize("packed", [False, True])
def test_the_page_has_our_title_and_icon_and_hides_visers_panel_until_ours_stands(explore: Any, packed: bool) -> None:
    asked = Request(explore().address, headers={"Accept-Encoding": "gzip" if packed else "identity"})
    with urlopen(asked) as answer:
        body = answer.read()
        assert answer.headers["Content-Encoding"] == ("gzip" if packed else "identity")
    head = (gzip.decompress(body) if packed else body).decode().partition("<script")[0]
    assert head.count("<title>") == head.count('rel="icon"') == 1
    assert "<title>Trackride</title>" in head
    assert quote("#1c6cb2") in head
    assert "html:not([data-trackride-stands]) #root { visibility: hidden" in head
