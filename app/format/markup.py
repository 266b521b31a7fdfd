"""HTML built of elements and tables, in which all text is escaped; and formulas set as in print.

In formulas x_i gets an index, and letters that stand alone are slanted.
"""

from __future__ import annotations

import html
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

_NAMES = ("max", "min", "sin", "cos", "Σ", "π")  # upright
_SYMBOL = r"([^\W\d_ᵀ²])([\u0300-\u036f′]*)(?:_(\{[^}]+\}|[A-Za-z0-9]+))?"
_BRACKET = r"\)_([A-Za-z0-9]+)"
_INDEXED = r"(?<!\w)([^\W\d_])_([A-Za-z0-9]+)\b"
_WITHOUT_END = ("br", "img", "source")  # elements without content and end tag


@dataclass(frozen=True)
class Html:
    """Text that is HTML already; all other text is escaped where it goes into an element.

    It is no str, so that neither is taken for the other. str() gives what a browser or viser takes.
    """

    text: str = ""

    def __str__(self) -> str:
        return self.text


class Cell(Html):
    """A cell of a table."""


Content = str | Html


def safe(content: Content) -> Html:
    """Any text as HTML; what is HTML already stays as it is."""
    return content if isinstance(content, Html) else Html(html.escape(content))


def joined(parts: Iterable[Content]) -> Html:
    """The parts, one after the other."""
    return Html("".join(safe(part).text for part in parts))


def element(tag: str, *content: Content, **attributes: str | None) -> Html:
    """An element with that content, one part after the other.

    Attributes that are None are left out. class_ stands for class, and a _ within a name for -.
    """
    given = "".join(
        f' {name.rstrip("_").replace("_", "-")}="{html.escape(value)}"'
        for name, value in attributes.items()
        if value is not None
    )
    end = "" if tag in _WITHOUT_END else f"</{tag}>"
    return Html(f"<{tag}{given}>{joined(content)}{end}")


def style(css: str, **attributes: str | None) -> Html:
    """Rules for the page; css: our own."""
    return element("style", Html(css), **attributes)


def running(script: str, **data: str) -> Html:
    """Something invisible that runs a script of our own once it is on the page.

    The browser runs no <script> that is put into a page later, as viser does, but it tells a picture that it cannot be
    loaded. data: data_name=text, which the script finds as this.dataset.name.
    """
    return element("img", hidden="", src="data:,", onerror=script, **data)


def page(*content: Content) -> str:
    """HTML of a tab that is read from top to bottom."""
    return str(element("div", *content, class_="trackride-page"))


def table(
    heads: Sequence[str],
    rows: Iterable[Sequence[Content] | Html],
    kind: str | None = None,
    *,
    over: Sequence[Content] = (),
    titled: bool = True,
) -> Html:
    """A table of texts, which become cells, and of cells that are made already (by `cell` or `heading_cell`).

    heads: of the columns; without them there is no head. over: a row above them. rows: see `row`; one that is an
    element already stays as it is. kind: classes of the style. titled: the first text of each row is its heading.
    """
    above = [element("tr", *(_cell("th", text) for text in texts)) for texts in (over, heads) if texts]
    body = [cells if isinstance(cells, Html) else row(cells, titled=titled) for cells in rows]
    head = element("thead", *above) if above else Html()
    return element("table", head, element("tbody", *body), class_=kind)


def row(cells: Sequence[Content], *, titled: bool = True, **attributes: str | None) -> Html:
    """A row of a table, with attributes of its own."""
    made = (_cell("th" if titled and k == 0 else "td", text) for k, text in enumerate(cells))
    return element("tr", *made, **attributes)


def cell(*content: Content, **attributes: str | None) -> Cell:
    """A cell with attributes of its own."""
    return Cell(str(element("td", *content, **attributes)))


def heading_cell(*content: Content, **attributes: str | None) -> Cell:
    """A heading with attributes of its own."""
    return Cell(str(element("th", *content, **attributes)))


def formula_html(text: str) -> Html:
    """A formula, of symbols of one letter with indices as in C_q or F_max; words in "quotes" stay as they are."""
    parts = re.split(r'"([^"]*)"', text)
    return joined(part if k % 2 else _symbols(part) for k, part in enumerate(parts))


def words_html(text: str) -> Html:
    """A sentence: of its words only those with an index, as k_s, are symbols."""
    return Html(re.sub(_INDEXED, lambda found: str(_set(found[1], found[2])), html.escape(text, quote=False)))


def _cell(tag: str, content: Content) -> Html:
    return content if isinstance(content, Cell) else element(tag, content)


def _symbols(text: str) -> Html:
    pieces, at = [], 0
    for found in re.finditer(rf"{'|'.join(_NAMES)}|{_BRACKET}|{_SYMBOL}", text):
        pieces.append(safe(text[at : found.start()]))
        bracket_index, letter, accents, index = found.groups()
        if bracket_index is not None:
            pieces.append(Html(f")<sub>{bracket_index}</sub>"))
        else:
            pieces.append(Html(found[0]) if letter is None else _set(letter + accents, index))
        at = found.end()
    return joined([*pieces, text[at:]])


def _set(symbol: str, index: str | None) -> Html:
    return joined((element("i", symbol), element("sub", index.strip("{}")) if index else ""))
