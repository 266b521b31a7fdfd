"""viser's web server, with what it lacks: a check of each request, and messages that are safe to send on any thread."""

from __future__ import annotations

import asyncio
import contextlib
import gzip
import io
import re
from collections.abc import Callable, Iterator
from functools import cache
from typing import Any
from urllib.parse import quote

import viser
import viser._messages as messages
import websockets.asyncio.server as websocket_server
from viser.infra import WebsockClientConnection
from websockets.asyncio.server import ServerConnection
from websockets.http11 import Request, Response

from app.format.assets import asset
from app.web.admission import Admission

UNHEARD = (  # what a tab may say to all of viser's tabs, those that come later too, and what would open a tunnel
    messages.GuiFormDirtyMessage,
    messages.ShareUrlRequest,
    messages.ShareUrlDisconnect,
)

VISERS = r'<link\s+rel="icon".*?/>|<title>.*?</title>|<meta name="description".*?/>'  # in the head of its page

Answer = Callable[[ServerConnection, Request], Response | None]


class WebServer(viser.ViserServer):
    """viser's server for those whom `admission` lets in."""

    def __init__(self, host: str, port: int, admission: Admission) -> None:
        with contextlib.redirect_stdout(io.StringIO()), _asked_first(admission.answer):  # viser announces itself
            super().__init__(host=host, port=port, verbose=False)
        for message in UNHEARD:
            self._websock_server.unregister_handler(message)
        self._websock_server.on_client_connect(_make_safe)


@contextlib.contextmanager
def _asked_first(answer: Answer) -> Iterator[None]:
    """A server that viser starts meanwhile asks `answer` first, at each request; viser itself has no place for it."""
    serve, asks = websocket_server.serve, False

    def asking(*arguments: Any, process_request: Answer, **named: Any) -> Any:
        nonlocal asks
        asks = True

        def ask(connection: ServerConnection, request: Request) -> Response | None:
            response = answer(connection, request)
            if response is None:
                response = process_request(connection, request)
                _head(response)
            return response

        return serve(*arguments, process_request=ask, **named)

    websocket_server.serve = asking  # type: ignore[assignment,misc]
    try:
        yield
    finally:
        websocket_server.serve = serve  # type: ignore[misc]
    if not asks:
        raise RuntimeError("this version of viser starts its server in another way: nobody would be turned away")


def _head(response: Response | None) -> None:
    """Give viser's page our title and icon, and hide its own panel until ours stand."""
    if response is None or not response.body or not response.headers.get("Content-Type", "").startswith("text/html"):
        return
    response.body = _with_head(bytes(response.body), response.headers.get("Content-Encoding") == "gzip")
    if "Content-Length" in response.headers:
        del response.headers["Content-Length"]
        response.headers["Content-Length"] = str(len(response.body))


@cache
def _with_head(page: bytes, packed: bool) -> bytes:
    """The page, packed as it was, with assets/head.html and assets/icon.svg in place of viser's title and icon."""
    text = (gzip.decompress(page) if packed else page).decode()
    icon = f'<link rel="icon" href="data:image/svg+xml,{quote(asset("icon.svg").strip())}">'
    head, rest = re.split(r"(?=<script)", text, maxsplit=1)
    head = re.sub(
        r"<link\s+rel=\"icon\".*?/>|<title>.*?</title>|<meta name=\"description\".*?/>", "", head, flags=re.DOTALL
    )
    ours = (head + icon + asset("head.html") + rest).encode()
    return gzip.compress(ours) if packed else ours


def _make_safe(connection: WebsockClientConnection) -> None:
    """viser calls this for each new tab, before it waits for messages to it."""
    connection.get_message_buffer().message_event = _AnyThreadEvent()


class _AnyThreadEvent(asyncio.Event):
    """An event that may be set on any thread.

    viser sets its own on the thread that sends, then once more on the event loop. The first of these walks through
    those who wait while the loop may change them ("deque mutated during iteration"), and half a vehicle was drawn.
    """

    _value: bool
    _waiters: Any  # futures of those who wait

    def set(self) -> None:
        self._value = True
        try:
            asyncio.get_running_loop()
        except RuntimeError:
            return  # those who wait are told on the loop
        for waiter in self._waiters:
            if not waiter.done():
                waiter.set_result(True)
