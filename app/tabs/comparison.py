"""The figures of a run beside those of its baseline, as HTML. Pure."""

from __future__ import annotations

import html
from collections.abc import Sequence

from app.format.differences import NONE, change_text, row_texts
from app.format.load_unit import heading
from model.analysis.figures import AIR_TIME, LOAD_COEFFICIENT, LOAD_PEAK, LOAD_RMS, TRAVEL, Row

PAIRS = (
    (LOAD_PEAK, AIR_TIME),
    (LOAD_RMS, TRAVEL),
    (LOAD_COEFFICIENT,),
)  # figures of each wheel side by side in one table
NOTABLE = 0.5  # %: a smaller change is not coloured


def comparison_table(rows: Sequence[Row], compared: bool) -> str:
    """Tables of all figures: the vehicle's first, then each wheel's. compared: there is a baseline."""
    whole = [row for row in rows if not row.wheel]
    wheels = list(dict.fromkeys(row.wheel for row in rows if row.wheel))
    by_place = {(row.figure, row.wheel): row for row in rows}
    heads = ("now", "baseline", "change") if compared else ("now",)
    tables = [_table(["Whole vehicle", *heads], [[_whole_label(row), *cells(row, compared)] for row in whole])]
    for pair in PAIRS:
        over = "<tr><th></th>" + "".join(
            f'<th colspan="{len(heads)}">{html.escape(heading(figure.label, rows))}</th>' for figure in pair
        )
        lines = [
            [
                f"<td>{html.escape(wheel)}</td>",
                *(cell for figure in pair for cell in cells(by_place.get((figure.label, wheel)), compared)),
            ]
            for wheel in wheels
        ]
        tables.append(_table(["Wheel", *heads * len(pair)], lines, over + "</tr>"))
    return "".join(tables)


def _table(heads: Sequence[str], lines: Sequence[Sequence[str]], over: str = "") -> str:
    head = "<tr>" + "".join(f"<th>{html.escape(text)}</th>" for text in heads) + "</tr>"
    body = "".join(f"<tr>{''.join(cells)}</tr>" for cells in lines)
    kind = "trackride-figures by-wheel" if over else "trackride-figures"
    return f'<table class="{kind}">{over}{head}{body}</table>'


def _whole_label(row: Row) -> str:
    return f"<td>{html.escape(row.figure)}, {html.escape(row.unit)}</td>"


def cells(row: Row | None, compared: bool) -> list[str]:
    """Now, baseline and change."""
    now, baseline, change = (NONE, NONE, None) if row is None else (*row_texts(row), row.change)
    if not compared:
        return [f"<td>{now}</td>"]
    sign = "" if change is None or abs(change) < NOTABLE else "more" if change > 0 else "less"
    return [f"<td>{now}</td>", f"<td>{baseline}</td>", f'<td class="{sign}">{change_text(change)}</td>']
