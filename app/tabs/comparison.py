"""The figures of a run beside those of its baseline, as HTML. Pure."""

from __future__ import annotations

from collections.abc import Sequence

from app.format.differences import NONE, change_text, row_texts
from app.format.load_unit import heading
from app.format.markup import Content, cell, heading_cell, joined, table
from model.analysis.figures import AIR_TIME, LOAD_COEFFICIENT, LOAD_PEAK, LOAD_RMS, TRAVEL, Row

PAIRS = (
    (LOAD_PEAK, AIR_TIME),
    (LOAD_RMS, TRAVEL),
    (LOAD_COEFFICIENT,),
)  # figures of each wheel side by side in one table
NOTABLE = 0.5  # %: a smaller change is not coloured


def comparison_table(rows: Sequence[Row], compared: bool) -> str:
    """HTML of the tables of all figures: the vehicle's first, then each wheel's. compared: there is a baseline."""
    whole = [row for row in rows if not row.wheel]
    wheels = list(dict.fromkeys(row.wheel for row in rows if row.wheel))
    by_place = {(row.figure, row.wheel): row for row in rows}
    heads = ("now", "baseline", "change") if compared else ("now",)
    lines = [[f"{row.figure}, {row.unit}", *cells(row, compared)] for row in whole]
    tables = [table(["Whole vehicle", *heads], lines, "trackride-figures", titled=False)]
    for pair in PAIRS:
        over: list[Content] = [
            "",
            *(heading_cell(heading(figure.label, rows), colspan=str(len(heads))) for figure in pair),
        ]
        lines = [
            [wheel, *(one for figure in pair for one in cells(by_place.get((figure.label, wheel)), compared))]
            for wheel in wheels
        ]
        every = ["Wheel", *heads * len(pair)]
        tables.append(table(every, lines, "trackride-figures by-wheel", over=over, titled=False))
    return str(joined(tables))


def cells(row: Row | None, compared: bool) -> list[Content]:
    """Now, baseline and change."""
    now, baseline, change = (NONE, NONE, None) if row is None else (*row_texts(row), row.change)
    if not compared:
        return [now]
    sign = None if change is None or abs(change) < NOTABLE else "more" if change > 0 else "less"
    return [now, baseline, cell(change_text(change), class_=sign)]
