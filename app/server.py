"""The explorer: one web server, one Session for each browser tab.

The server listens at once: what a session needs is loaded while the first page loads, which takes as long.
"""

from __future__ import annotations

import contextlib
import errno
import gc
import io
import logging
import socket
import sys
import warnings
import webbrowser
from functools import cache
from typing import TYPE_CHECKING, Any

import viser
from rich.console import Console

from model.config.config import Config, load_config, preset_names

if TYPE_CHECKING:
    from app.session.session import Session

HOST, PORT = "127.0.0.1", 8080
PORTS_TO_TRY = 100
HAND_OVER = 5e-4  # s until a thread that computes in Python lets another have its turn
EVERYWHERE = ("0.0.0.0", "::", "")  # hosts that mean all of this machine's addresses


class ServerError(Exception):
    """The server cannot listen where it was told to; the message says why."""


class Explorer:
    """A running server. Use `stop` to end it and its sessions."""

    def __init__(self, config: Config, preset: str, host: str = HOST, port: int = PORT, **session: Any) -> None:
        """Listen on the first free port from `port` on, or on any with port 0. Raises ServerError.

        config: what each tab runs first; preset: the name it goes by, of a preset or a file. Further arguments go to
        the sessions.
        """
        sys.setswitchinterval(HAND_OVER)  # a run waits between its chunks for panels that are being filled
        presets = {name: load_config(name) for name in preset_names()}
        presets.setdefault(preset, config)
        self._sessions: dict[int, Session] = {}
        free = free_port(host, port)
        with contextlib.redirect_stdout(io.StringIO()):  # viser's own announcement
            self.server = _Server(host=host, port=free, verbose=False)
        self.address = f"http://{_browsable(host)}:{self.server.get_port()}"

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
    def sessions(self) -> tuple[Session, ...]:
        """Those of the tabs that are open."""
        return tuple(self._sessions.values())

    def stop(self) -> None:
        """End all sessions and the server."""
        for client_id in tuple(self._sessions):
            self._close(client_id)
        with contextlib.redirect_stdout(io.StringIO()):
            self.server.stop()

    def _close(self, client_id: int) -> None:
        session = self._sessions.get(client_id)
        if session is not None:
            session.close()
            self._sessions.pop(client_id, None)  # only now: stopping waits for a tab that is just being closed


class _Server(viser.ViserServer):
    def request_share_url(self, verbose: bool = True) -> None:
        """Never: a visitor's message would open a public tunnel to this machine."""


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


def serve(config: Config, preset: str, host: str = HOST, port: int = PORT, open_browser: bool = True) -> None:
    """Run the explorer until Ctrl+C. Exits with a message when it cannot listen."""
    warnings.filterwarnings("ignore", message="Queued a .* on a closed connection")
    console = Console(highlight=False)
    try:
        explorer = Explorer(config, preset, host, port)
    except ServerError as error:
        sys.exit(f"trackride: {error}")
    try:
        used = explorer.server.get_port()
        if port not in (0, used):
            console.print(f"Port {port} is taken, so this is port {used}.")
        if host in EVERYWHERE:
            console.print("Everyone in this network can open it.", style="yellow")
        console.print(f"Trackride explorer: [bold]{explorer.address}[/bold]   (Ctrl+C ends it)")
        if open_browser and not webbrowser.open(explorer.address):
            console.print("No browser could be started; open the address above in one.")
        prepare()
        explorer.server.sleep_forever()
    except KeyboardInterrupt:
        console.print("\nStopping …")
    finally:
        explorer.stop()
        console.print("Stopped.")


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


def _browsable(host: str) -> str:
    """The host as a browser on this machine can reach it."""
    if host in EVERYWHERE:
        return "127.0.0.1"
    return f"[{host}]" if ":" in host else host
