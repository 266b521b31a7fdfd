"""Texts as HTML. In formulas x_i gets an index, and letters that stand alone are slanted as in print."""

from __future__ import annotations

import html
import re

_NAMES = ("max", "min", "sin", "cos", "Σ", "π")  # upright
_SYMBOL = r"([^\W\d_ᵀ²])([\u0300-\u036f′]*)(?:_(\{[^}]+\}|[A-Za-z0-9]+))?"
_BRACKET = r"\)_([A-Za-z0-9]+)"
_INDEXED = r"(?<!\w)([^\W\d_])_([A-Za-z0-9]+)\b"


def page(content: str) -> str:
    """HTML of a tab that is read from top to bottom."""
    return f'<div class="trackride-page">{content}</div>'


def formula_html(text: str) -> str:
    """A formula, of symbols of one letter with indices as in C_q or F_max; words in "quotes" stay as they are."""
    parts = re.split(r'"([^"]*)"', text)
    return "".join(html.escape(part) if k % 2 else _symbols(part) for k, part in enumerate(parts))


def words_html(text: str) -> str:
    """A sentence: of its words only those with an index, as k_s, are symbols."""
    return re.sub(_INDEXED, lambda found: _set(found[1], found[2]), html.escape(text, quote=False))


def _symbols(text: str) -> str:
    pieces, at = [], 0
    for found in re.finditer(rf"{'|'.join(_NAMES)}|{_BRACKET}|{_SYMBOL}", text):
        pieces.append(html.escape(text[at : found.start()]))
        bracket_index, letter, accents, index = found.groups()
        if bracket_index is not None:
            pieces.append(f")<sub>{bracket_index}</sub>")
        else:
            pieces.append(found[0] if letter is None else _set(letter + accents, index))
        at = found.end()
    return "".join(pieces) + html.escape(text[at:])


def _set(symbol: str, index: str | None) -> str:
    index = f"<sub>{html.escape(index.strip('{}'))}</sub>" if index else ""
    return f"<i>{symbol}</i>{index}"
