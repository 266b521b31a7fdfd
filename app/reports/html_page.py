"""A page to read, print and pass on: one HTML file with everything in it, that needs no network."""

from __future__ import annotations

import html
from base64 import b64encode
from collections.abc import Iterable, Sequence
from datetime import datetime
from importlib import resources
from importlib.metadata import version

from app.reports.drawings import LOOKS, Drawing

_KIND = {".svg": "image/svg+xml", ".png": "image/png"}


class Html(str):
    """Text that is HTML already; all other text is escaped where it is put on the page."""


def safe(text: str) -> Html:
    """Any text as HTML; what is HTML already stays as it is."""
    return text if isinstance(text, Html) else Html(html.escape(text))


def element(tag: str, *content: str, **attributes: str) -> Html:
    """An element with that content, one part after the other. class_ stands for class."""
    given = "".join(f' {name.rstrip("_")}="{html.escape(value)}"' for name, value in attributes.items() if value)
    return Html(f"<{tag}{given}>{joined(content)}</{tag}>")


def joined(parts: Iterable[str]) -> Html:
    return Html("".join(map(safe, parts)))


def table(heads: Sequence[str], rows: Iterable[Sequence[str]], kind: str = "") -> Html:
    """A table; the first cell of a row is its heading. kind: a class of assets/report.css. No heads: no head row."""
    head = element("thead", element("tr", *(element("th", text) for text in heads))) if heads else Html()
    body = [element("tr", element("th", first), *(element("td", cell) for cell in cells)) for first, *cells in rows]
    return element("div", element("table", head, element("tbody", *body), class_=kind), class_="scroll")


def picture(drawing: Drawing, caption: str = "", suffix: str = ".svg") -> Html:
    """A drawing as a figure in the page, once for light screens and paper, once for dark ones; suffix: .svg or .png."""
    light, dark = (f"data:{_KIND[suffix]};base64,{b64encode(drawing.bytes(suffix, look)).decode()}" for look in LOOKS)
    alt = html.escape(drawing.title)
    source = f'<source media="(prefers-color-scheme: dark)" srcset="{dark}">'
    shown = Html(f'<picture>{source}<img src="{light}" alt="{alt}"></picture>')
    return element("figure", shown, element("figcaption", caption) if caption else Html())


def document(title: str, subtitle: str, body: Iterable[str]) -> str:
    """The whole file. It is stamped with version and date."""
    style = (resources.files("assets") / "report.css").read_text(encoding="utf-8")
    stamp = f"Trackride {version('trackride')}, {datetime.now():%Y-%m-%d %H:%M}"
    header = element("header", element("p", stamp, class_="stamp"), element("h1", title), element("p", subtitle))
    head = (
        '<meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">'
        f'<meta name="color-scheme" content="light dark"><title>{safe(title)}</title><style>{style}</style>'
    )
    return (
        f'<!doctype html>\n<html lang="en"><head>{head}</head><body><main>{header}{joined(body)}</main></body></html>\n'
    )
