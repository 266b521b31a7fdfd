"""Who is let in, asked as a browser asks: by what name, from which page, with which token, beside how many others."""

from __future__ import annotations

from http.client import HTTPConnection
from typing import Any
from urllib.parse import urlsplit

import pytest
import viser

from app.server import Explorer, ServerError
from app.web.admission import Listening
from model.config.config_files import load_config
from tests.app.conftest import Tab, wait_for

WEBSOCKET = {
    "Upgrade": "websocket",
    "Connection": "Upgrade",
    "Sec-WebSocket-Key": "dGhlIHNhbXBsZSBub25jZQ==",
    "Sec-WebSocket-Version": "13",
    "Sec-WebSocket-Protocol": f"viser-v{viser.__version__}",
}
LET_IN, TURNED_AWAY, NO_ROOM = 101, 403, 503
HERE = "127.0.0.1"


def ask(explorer: Explorer, path: str = "/", host: str | None = None, **more: str) -> tuple[int, str]:
    """Status and text of the answer to a request; host: by what name it asks, without the port."""
    port = explorer.server.get_port()
    connection = HTTPConnection(HERE, port, timeout=60)
    try:
        connection.putrequest("GET", path, skip_host=True)
        for name, value in {"Host": f"{host or HERE}:{port}", **more}.items():
            connection.putheader(name, value)
        connection.endheaders()
        answer = connection.getresponse()
        return answer.status, "" if answer.status == LET_IN else answer.read().decode()
    finally:
        connection.close()


def path_of(explorer: Explorer) -> str:
    return urlsplit(explorer.address).path or "/"


@pytest.mark.parametrize("host", ["127.0.0.1", "localhost", "LOCALHOST", "ride.localhost", "[::1]"])
def test_names_of_this_machine_are_let_in(explore: Any, host: str) -> None:
    explorer = explore()
    origin = f"http://{host.lower()}:{explorer.server.get_port()}"
    assert ask(explorer, host=host, **WEBSOCKET, Origin=origin)[0] == LET_IN
    assert ask(explorer, host=host, **WEBSOCKET)[0] == LET_IN  # not from a browser
    assert ask(explorer, host=host)[0] == 200


@pytest.mark.parametrize(
    "host", ["rebound.example.org", "203.0.113.7", "localhost.example.org", "[2001:db8::1]", "0.0.0.0"]
)
def test_other_names_are_turned_away_even_where_they_lead_here(explore: Any, host: str) -> None:
    explorer = explore()
    origin = f"http://{host}:{explorer.server.get_port()}"
    assert ask(explorer, host=host, **WEBSOCKET, Origin=origin)[0] == TURNED_AWAY
    status, text = ask(explorer, host=host)
    assert status == TURNED_AWAY
    assert host.strip("[]") in text
    assert "--allow-origin" in text


def test_a_name_is_shown_as_text(explore: Any) -> None:
    status, text = ask(explore(), host="<script>alert(1)</script>")
    assert status == TURNED_AWAY
    assert "&lt;script&gt;" in text
    assert "<script>" not in text


@pytest.mark.parametrize(
    "origin",
    ["http://example.org", "https://localhost:1", "http://127.0.0.1", "null", "file://", "http://localhost:{port}"],
)
def test_pages_of_others_cannot_connect(explore: Any, origin: str) -> None:
    explorer = explore()  # asked for as 127.0.0.1: a page of localhost is another one
    assert ask(explorer, **WEBSOCKET, Origin=origin.format(port=explorer.server.get_port()))[0] == TURNED_AWAY


@pytest.mark.parametrize(
    "query",
    [
        "websocket=ws://example.org", "websocket=ws://{here}@example.org", "websocket=ws:example.org",
        "websocket=ws:%5C%5Cexample.org", "websocket=ws://[", "websocket=ws://{here}&websocket=ws://example.org",
        "websocket=", "playbackPath=https://example.org/scene.viser",
    ],
)  # fmt: skip
def test_an_address_that_has_the_page_listen_to_others_is_turned_away(explore: Any, query: str) -> None:
    explorer = explore(allowed_origins=["https://ride.example.org"])
    here = f"{HERE}:{explorer.server.get_port()}"
    assert ask(explorer, f"/?{query.format(here=here)}")[0] == TURNED_AWAY
    for ours in (f"ws://{here}", f"ws%3A%2F%2F{here}/x", "wss://ride.example.org"):
        assert ask(explorer, f"/?fixedDpr=1&websocket={ours}")[0] == 200


def test_a_proxy_that_is_allowed_can_connect(explore: Any) -> None:
    explorer = explore(allowed_origins=["https://Ride.example.org:443/"])
    origin = "https://ride.example.org"
    assert ask(explorer, **WEBSOCKET, Origin=origin)[0] == LET_IN  # it asks under our name
    assert ask(explorer, host="ride.example.org", **WEBSOCKET, Origin=origin)[0] == LET_IN  # or hands its own on
    assert ask(explorer, **WEBSOCKET, Origin="https://other.example.org")[0] == TURNED_AWAY


@pytest.mark.parametrize("text", ["ride.example.org", "ftp://a.b", "https://a.b/page", "https://", "https://a:b", "*"])
def test_what_is_no_origin_is_refused(text: str) -> None:
    with pytest.raises(ServerError, match=r"--allow-origin: .* is no origin; give one as"):
        Explorer(load_config("paper"), "paper", port=0, allowed_origins=[text])


@pytest.mark.parametrize("host", ["127.0.0.1", "127.1", "127.3.4.5", "localhost", "::1", "::ffff:127.0.0.1"])
def test_all_spellings_of_loopback_are_local(host: str) -> None:
    assert Listening.on(host).local


@pytest.mark.parametrize("host", ["0.0.0.0", "0", "::", "::0", "0:0:0:0:0:0:0:0", ""])
def test_all_spellings_of_everywhere_are_not(host: str) -> None:
    listening = Listening.on(host)
    assert listening.everywhere
    assert not listening.local
    assert listening.browsable == ("[::1]" if ":" in host else HERE)
    others = listening.from_elsewhere  # of the same family as it listens on
    assert others is None or others.startswith("[") == (":" in host)


def test_an_address_of_this_machine_is_not_local() -> None:
    listening = Listening.on("192.0.2.2")
    assert not listening.local
    assert not listening.everywhere
    assert listening.browsable == "192.0.2.2"


def test_others_need_the_token(explore: Any, open_tab: Any) -> None:
    explorer = explore(host="0")
    path = path_of(explorer)
    assert len(path) > 20
    assert ask(explorer, path)[0] == ask(explorer, f"{path}/?fixedDpr=1")[0] == 200
    assert ask(explorer, path, **WEBSOCKET)[0] == LET_IN
    for wrong in ("/", path[:-1], f"{path}x", "/%C3%A9", f"/x{path}"):
        assert ask(explorer, wrong, **WEBSOCKET)[0] == TURNED_AWAY
        status, text = ask(explorer, wrong)
        assert status == TURNED_AWAY
        assert "token" in text
        assert path[1:] not in text
    tab: Tab = open_tab(explorer)
    wait_for(lambda: tab.shows_run(1))


def test_each_start_has_another_token(explore: Any) -> None:
    assert path_of(explore(host="0")) != path_of(explore(host="0"))


def test_no_token_where_none_is_wanted_or_needed(explore: Any) -> None:
    assert path_of(explore()) == path_of(explore(host="0", with_token=False)) == "/"


def test_beyond_the_cap_a_page_says_so_until_there_is_room(explore: Any, open_tab: Any) -> None:
    explorer = explore(max_tabs=2)
    first, second = open_tab(explorer), open_tab(explorer)
    wait_for(lambda: first.shows_run(1) and second.shows_run(1))
    assert ask(explorer, **WEBSOCKET)[0] == NO_ROOM
    status, text = ask(explorer)
    assert status == NO_ROOM
    assert "takes 2 at a time" in text
    assert "refresh" in text
    first.close()
    wait_for(lambda: ask(explorer)[0] == 200, "room")
    third: Tab = open_tab(explorer)
    wait_for(lambda: third.shows_run(1))


def test_who_is_turned_away_takes_no_room(explore: Any, open_tab: Any) -> None:
    explorer = explore(max_tabs=1)
    for _ in range(3):
        assert ask(explorer, **WEBSOCKET, Origin="http://example.org")[0] == TURNED_AWAY
        assert ask(explorer, **(WEBSOCKET | {"Sec-WebSocket-Version": "1"}))[0] not in (LET_IN, NO_ROOM)
    tab: Tab = open_tab(explorer)
    wait_for(lambda: tab.shows_run(1))
