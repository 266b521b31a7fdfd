"""Who may open the explorer: the names it is asked for by, the pages that connect, a token, the number of tabs.

viser itself lets everyone in. Without these checks any page in the user's browser could speak with the explorer: a page
of its own origin opens a websocket to it (Origin), or its server's name is made to lead to this machine (Host).
"""

from __future__ import annotations

import html
import secrets
import socket
from collections.abc import Sequence
from dataclasses import dataclass
from http import HTTPStatus
from ipaddress import IPv4Address, IPv6Address, ip_address
from urllib.parse import parse_qs, urlsplit

from websockets.asyncio.server import ServerConnection
from websockets.datastructures import Headers
from websockets.http11 import Request, Response

MAX_TABS = 20  # open at a time, unless the user says otherwise
DEFAULT_PORT = {"http": 80, "https": 443}
AGAIN = 5  # s until a page that found no room asks again
LONGEST_NAME = 253  # characters of a name that is shown again

Address = IPv4Address | IPv6Address


class OriginError(ValueError):
    """What was given is no origin; the message says what one is."""


@dataclass(frozen=True)
class Listening:
    """Where the explorer listens: the host as the user gave it, and the addresses that it stands for."""

    host: str
    addresses: frozenset[Address]

    @classmethod
    def on(cls, host: str) -> Listening:
        """Look up the host in any of its spellings. Raises OSError or UnicodeError where there is none of that name."""
        found = socket.getaddrinfo(host or None, 0, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE)
        return cls(host, frozenset(_plain(ip_address(info[4][0])) for info in found))

    @property
    def local(self) -> bool:
        """Only this machine can reach it."""
        return all(address.is_loopback for address in self.addresses)

    @property
    def everywhere(self) -> bool:
        """It listens on all addresses of this machine."""
        return any(address.is_unspecified for address in self.addresses)

    @property
    def names(self) -> frozenset[str]:
        """What others may call it, besides the address that they reach it by."""
        machine = socket.gethostname().lower()
        others = set() if self.local else {machine, f"{machine}.local"}
        return frozenset({self.host.lower()} | others) - {""}

    @property
    def browsable(self) -> str:
        """The host as a browser on this machine can reach it."""
        if self.everywhere:
            return "127.0.0.1" if IPv4Address(0) in self.addresses else "[::1]"
        return f"[{self.host}]" if ":" in self.host else self.host

    @property
    def from_elsewhere(self) -> str | None:
        """The address by which other machines reach it, where it listens on all; None where there is no network."""
        fourth = IPv4Address(0) in self.addresses
        family, beyond = (socket.AF_INET, "192.0.2.1") if fourth else (socket.AF_INET6, "2001:db8::1")
        with socket.socket(family, socket.SOCK_DGRAM) as probe:
            try:
                probe.connect((beyond, 9))  # sends nothing: asks only which way it would go
            except OSError:
                return None
            own = probe.getsockname()[0]
        return own if fourth else f"[{own}]"


class Admission:
    """Answers those who may not come in; the others get no answer from it. For viser's event loop."""

    def __init__(
        self,
        listening: Listening,
        allowed_origins: Sequence[str] = (),
        with_token: bool = True,
        max_tabs: int = MAX_TABS,
    ) -> None:
        """allowed_origins: pages of proxies, such as https://ride.example.org. Raises OriginError.

        with_token: who can come from another machine needs a token in the address.
        """
        self._origins = frozenset(_origin(text) for text in allowed_origins)
        self._names = listening.names | {str(urlsplit(origin).hostname) for origin in self._origins}
        self.token = secrets.token_urlsafe(16) if with_token and not listening.local else ""
        self.max_tabs = max_tabs
        self._tabs: set[ServerConnection] = set()

    def answer(self, connection: ServerConnection, request: Request) -> Response | None:
        """What a request gets that is turned away; None lets it in, its path then without the token."""
        hosts, origins = (request.headers.get_all(name) for name in ("Host", "Origin"))
        host = hosts[0].lower() if len(hosts) == 1 else ""
        if not self._is_ours(_name(host), connection):
            return _page(
                HTTPStatus.FORBIDDEN,
                "Not an address of this explorer",
                f"You came by the name “{_name(host)[:LONGEST_NAME]}”. Open the address that the terminal shows, or, "
                f"if this is a proxy, start the explorer with --allow-origin and the origin of the proxy's page.",
            )
        if any(origin.lower() not in self._origins | {f"http://{host}", f"https://{host}"} for origin in origins):
            return _page(
                HTTPStatus.FORBIDDEN,
                "Not a page of this explorer",
                "Another page has tried to connect. If that page is a proxy of yours, start the explorer with "
                "--allow-origin and its origin.",
            )
        if self._leads_elsewhere(request.path.partition("?")[2], host):
            return _page(
                HTTPStatus.FORBIDDEN,
                "Not only this explorer",
                "This address would have the page speak with another server. Open the address that the terminal shows.",
            )
        if self.token:
            _, first, *rest = request.path.partition("?")[0].split("/", 2)
            if not secrets.compare_digest(first.encode(errors="replace"), self.token.encode()):
                return _page(
                    HTTPStatus.FORBIDDEN,
                    "This explorer asks for its token",
                    "Open the address that the terminal shows, with all that follows the last slash: that is the "
                    "token. It is another one at each start.",
                )
            request.path = "/" + "".join(rest)
        self._tabs &= connection.server.handlers.keys()  # those that are closed are no longer among them
        if len(self._tabs) >= self.max_tabs:
            return _page(
                HTTPStatus.SERVICE_UNAVAILABLE,
                "No room for another tab",
                f"This explorer takes {self.max_tabs} at a time (--max-tabs), and as many are open. Close one, here or "
                f"wherever it is; this page asks again every {AGAIN} seconds.",
                again=True,
            )
        if "Upgrade" in request.headers:
            self._tabs.add(connection)
        return None

    def _is_ours(self, name: str, connection: ServerConnection) -> bool:
        """Whether the explorer goes by this name or address, as a browser gives it."""
        if name in self._names or name == "localhost" or name.endswith(".localhost"):
            return True
        address = _address(name)
        return address is not None and (address.is_loopback or address == _address(connection.local_address[0]))

    def _leads_elsewhere(self, query: str, host: str) -> bool:
        """Whether viser's page, under this query, would listen to a server that is not ours, or play its recording."""
        asked = parse_qs(query, keep_blank_values=True)
        ours = {host} | {urlsplit(origin).netloc for origin in self._origins}
        return "playbackPath" in asked or any(_place(url) not in ours for url in asked.get("websocket", ()))


def _place(url: str) -> str:
    """Host and port of a URL; empty where it has none."""
    try:
        return urlsplit(url.lower()).netloc
    except ValueError:
        return ""


def _origin(text: str) -> str:
    """An origin as browsers write it. Raises OriginError."""
    origin = text.strip().lower().rstrip("/")
    try:
        scheme, place, *rest = urlsplit(origin)
        usual = DEFAULT_PORT[scheme] == urlsplit(origin).port  # browsers leave it out
    except (ValueError, KeyError):
        scheme, place, rest, usual = "", "", [], False
    if not place or any(rest):
        raise OriginError(f"{text} is no origin; give one as https://ride.example.org or http://192.168.1.5:9000")
    return f"{scheme}://{place.rpartition(':')[0] if usual else place}"


def _name(host: str) -> str:
    """The name or address in a Host header, without port and brackets."""
    if host.startswith("["):
        return host[1:].partition("]")[0]
    return host.rpartition(":")[0] if ":" in host else host


def _address(text: str) -> Address | None:
    try:
        return _plain(ip_address(text))
    except ValueError:
        return None


def _plain(address: Address) -> Address:
    """An IPv4 address that is written as one of IPv6 as itself."""
    mapped = address.ipv4_mapped if isinstance(address, IPv6Address) else None
    return mapped or address


def _page(status: HTTPStatus, title: str, text: str, again: bool = False) -> Response:
    """A page that says why; again: it is asked for again by itself."""
    refresh = f'<meta http-equiv="refresh" content="{AGAIN}">' if again else ""
    body = (
        f'<!doctype html><html lang="en"><head><meta charset="utf-8"><title>Trackride: {title}</title>{refresh}'
        '<meta name="viewport" content="width=device-width"><style>:root{color-scheme:light dark}'
        "body{font:16px/1.5 system-ui,sans-serif;max-width:36em;margin:15vh auto;padding:0 1em}</style></head>"
        f"<body><h1>{title}</h1><p>{html.escape(text)}</p></body></html>"
    ).encode(errors="replace")
    headers = Headers(
        {
            "Content-Type": "text/html; charset=utf-8",
            "Content-Length": str(len(body)),
            "Cache-Control": "no-store",
            "Connection": "close",
        }
    )
    if again:
        headers["Retry-After"] = str(AGAIN)
    return Response(status, status.phrase, headers, body)
