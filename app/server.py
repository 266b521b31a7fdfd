"""The explorer: one web server, one Session for each browser tab.

The server listens at once: what a session needs is loaded while the first page loads, which takes as long.
"""

from __future__ import annotations

import contextlib
import ctypes
import errno
import gc
import io
import logging
import socket
import sys
import threading
import warnings
import webbrowser
from collections.abc import Sequence
from functools import cache
from typing import TYPE_CHECKING, Any

import viser
from rich.console import Console

from app.format.assets import check_assets
from app.session.error_log import Throttle
from app.web.admission import MAX_TABS, Admission, Listening, OriginError
from app.web.web_server import WebServer
from model.config.config import Config
from model.config.config_files import load_config, preset_names

if TYPE_CHECKING:
    from app.session.session import Session

HOST, PORT = "127.0.0.1", 8080
PORTS_TO_TRY = 100
HAND_OVER = 5e-4  # s until a thread that computes in Python lets another have its turn
CLOSED_FOR = 5.0  # s after a tab has closed until its memory is given back, together with that of others
LOGGERS = "trackride", "asyncio", "websockets.server"  # that what a page sends can fill


class ServerError(Exception):
    """The server cannot listen where it was told to; the message says why."""


class Explorer:
    """A running server. Use `stop` to end it and its sessions."""

    def __init__(
        self,
        config: Config,
        preset: str,
        host: str = HOST,
        port: int = PORT,
        *,
        allowed_origins: Sequence[str] = (),
        with_token: bool = True,
        max_tabs: int = MAX_TABS,
        **session: Any,
    ) -> None:
        """Listen on the first free port from `port` on, or on any with port 0. Raises ServerError.

        config: what each tab runs first; preset: the name it goes by, of a preset or a file; allowed_origins,
        with_token, max_tabs: see Admission. Further arguments go to the sessions.
        """
        sys.setswitchinterval(HAND_OVER)  # a run waits between its chunks for panels that are being filled
        presets = {name: load_config(name) for name in preset_names()}
        presets.setdefault(preset, config)
        self._sessions: dict[int, Session] = {}
        free = free_port(host, port)
        self.listening = Listening.on(host)
        try:
            admission = Admission(self.listening, allowed_origins, with_token, max_tabs)
        except OriginError as error:
            raise ServerError(f"--allow-origin: {error}") from error
        self.server = WebServer(host, free, admission)
        self._token = admission.token
        self._throttle = Throttle()
        for name in LOGGERS:
            logging.getLogger(name).addFilter(self._throttle)
        self._giving_back: threading.Timer | None = None

        @self.server.on_client_connect
        def _(client: viser.ClientHandle) -> None:
            try:
                self._sessions[client.client_id] = _session_class()(client, presets, preset, config, **session)
            except Exception:
                logging.getLogger("trackride").exception("a tab could not be set up")
                client.add_notification("The explorer could not start", "Details are in the terminal.", color="red")
            if client.client_id not in self.server.get_clients():  # gone while it was set up
                self._close(client.client_id)

        @self.server.on_client_disconnect
        def _(client: viser.ClientHandle) -> None:
            self._close(client.client_id)

    @property
    def with_token(self) -> bool:
        """Whether it asks for a token."""
        return bool(self._token)

    @property
    def address(self) -> str:
        """The page, for a browser on this machine; with the token if there is one."""
        return self.address_at(self.listening.browsable)

    def address_at(self, host: str) -> str:
        """The page, for a browser that reaches this machine by this name or address."""
        return f"http://{host}:{self.server.get_port()}" + (f"/{self._token}" if self._token else "")

    @property
    def sessions(self) -> tuple[Session, ...]:
        """Those of the tabs that are open."""
        return tuple(self._sessions.values())

    def stop(self) -> None:
        """End all sessions and the server."""
        for client_id in tuple(self._sessions):
            self._close(client_id)
        with contextlib.redirect_stdout(io.StringIO()):
            self.server.stop()
        if self._giving_back is not None:
            self._giving_back.cancel()
        for name in LOGGERS:
            logging.getLogger(name).removeFilter(self._throttle)

    def _close(self, client_id: int) -> None:
        session = self._sessions.get(client_id)
        if session is not None:
            session.close()
            self._sessions.pop(client_id, None)  # only now: stopping waits for a tab that is just being closed
        if self._giving_back is None or not self._giving_back.is_alive():
            self._giving_back = threading.Timer(CLOSED_FOR, _give_memory_back)
            self._giving_back.daemon = True
            self._giving_back.start()


def _give_memory_back() -> None:
    """Let go of what closed tabs have left.

    Their panels, and viser's handles with them, hold each other. Python looks for such circles only while much is made
    anew, which a server without tabs does not do; and the C library keeps what it was given back until it is asked.
    """
    gc.collect()
    trim = getattr(ctypes.CDLL(None), "malloc_trim", None) if sys.platform == "linux" else None  # of glibc
    if trim is not None:
        trim(0)


@cache
def _session_class() -> type[Session]:
    from app.session.session import Session

    gc.freeze()  # all that has been imported stays: looking through it would hold up a drag for 100 ms
    return Session


def prepare() -> None:
    """Load what sessions need; the very first time, compile it."""
    _session_class()
    from app.plots import thinning
    from app.view3d import track_belt
    from app.view3d.meshes import solids
    from model.simulation.simulate import warm_up

    thinning.warm_up()
    track_belt.warm_up()
    warm_up()
    solids.warm_up()


def serve(
    config: Config, preset: str, host: str = HOST, port: int = PORT, open_browser: bool = True, **admission: Any
) -> None:
    """Run the explorer until Ctrl+C. Exits with a message when it cannot listen, or lacks files of its page.

    admission: see Explorer.
    """
    warnings.filterwarnings("ignore", message="Queued a .* on a closed connection")
    console = Console(highlight=False, soft_wrap=True)
    try:
        check_assets()
        explorer = Explorer(config, preset, host, port, **admission)
    except (ServerError, FileNotFoundError) as error:
        sys.exit(f"trackride: {error}")
    try:
        used = explorer.server.get_port()
        if port not in (0, used):
            console.print(f"Port {port} is taken, so this is port {used}.")
        console.print(f"Trackride explorer: [bold]{explorer.address}[/bold]   (Ctrl+C ends it)")
        if not explorer.listening.local:
            _warn(console, explorer)
        if open_browser and not webbrowser.open(explorer.address):
            console.print("No browser could be started; open the address above in one.")
        prepare()
        explorer.server.sleep_forever()
    except KeyboardInterrupt:
        console.print("\nStopping …")
    finally:
        explorer.stop()
        console.print("Stopped.")


def _warn(console: Console, explorer: Explorer) -> None:
    """Say who else can open the page, and how."""
    if explorer.listening.everywhere and (host := explorer.listening.from_elsewhere):
        console.print(f"From other machines: [bold]{explorer.address_at(host)}[/bold]", highlight=False)
    if explorer.with_token:
        who = "Who has this address, with its token, can open it from other machines."
    else:
        who = "Everyone in this network can open it: it asks for no token."
    console.print(who, style="yellow")


def free_port(host: str, port: int) -> int:
    """The first port from `port` on that can be listened on; 0 stays 0. Raises ServerError."""
    if not 0 <= port <= 65535:
        raise ServerError(f"port {port} does not exist; give 1 to 65535, or 0 for any that is free")
    try:
        family, kind, _, _, address = socket.getaddrinfo(
            host or None, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE
        )[0]
    except (OSError, UnicodeError) as error:
        raise ServerError(f"cannot listen on {host}: {error}") from error
    last = min(port + PORTS_TO_TRY, 65536) if port else 1
    for candidate in range(port, last):
        with socket.socket(family, kind) as probe:
            if sys.platform != "win32":
                probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            try:
                probe.bind((address[0], candidate, *address[2:]))
            except OSError as error:
                if error.errno == errno.EADDRINUSE:
                    continue
                raise ServerError(f"cannot listen on {host}:{candidate}: {error.strerror}") from error
            return candidate
    raise ServerError(f"no port from {port} to {last - 1} is free on {host}")
