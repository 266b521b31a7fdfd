"""A page to read, print and pass on: one HTML file with everything in it, that needs no network."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Iterable, Sequence
from datetime import datetime

from app.format.assets import asset
from app.format.markup import Content, Html, element, style, table
from app.reports.drawings import LOOKS, Drawing, stamp

_KIND = {".svg": "image/svg+xml", ".png": "image/png"}


def wide_table(heads: Sequence[str], rows: Iterable[Sequence[Content]], kind: str | None = None) -> Html:
    """A table that a narrow page lets the reader move sideways. kind: a class of assets/report.css."""
    return element("div", table(heads, rows, kind), class_="scroll")


def picture(drawing: Drawing, caption: str = "", suffix: str = ".svg") -> Html:
    """A drawing as a figure in the page, once for light screens and paper, once for dark ones; suffix: .svg or .png."""
    light, dark = (f"data:{_KIND[suffix]};base64,{b64encode(drawing.bytes(suffix, look)).decode()}" for look in LOOKS)
    on_dark = element("source", media="(prefers-color-scheme: dark)", srcset=dark)
    shown = element("picture", on_dark, element("img", src=light, alt=drawing.title))
    return element("figure", shown, element("figcaption", caption) if caption else "")


def document(title: str, subtitle: str, body: Iterable[Content]) -> str:
    """The whole file. It is stamped with version and date."""
    made = element("p", f"{stamp()}, {datetime.now():%Y-%m-%d %H:%M}", class_="stamp")
    header = element("header", made, element("h1", title), element("p", subtitle))
    head = (
        '<meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">'
        f'<meta name="color-scheme" content="light dark">{element("title", title)}{style(asset("report.css"))}'
    )
    main = element("main", header, *body)
    return f'<!doctype html>\n<html lang="en"><head>{head}</head><body>{main}</body></html>\n'
