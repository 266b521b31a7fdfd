"""The figures of a run beside those of its baseline, as HTML. Pure.

One line for each figure: of a figure of each wheel the worst wheel, or what all road wheels come to together, and its
wheels folded below. assets/runs.js unfolds them and puts the lines in another order.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from app.format.differences import NONE, change_text, row_texts
from app.format.markup import Content, Html, cell, element, heading_cell, joined, row
from model.analysis.figures import Row, overall

WIDEST = 50.0  # %: a change of this size, or more, fills half of the bar


@dataclass(frozen=True)
class Other:
    """A run that is shown beside."""

    name: str
    colour: str  # CSS
    rows: Sequence[Row]  # the present run's, with this one in the place of the baseline


def comparison_table(rows: Sequence[Row], compared: bool, others: Sequence[Other] = ()) -> str:
    """HTML of the table of all figures, the vehicle's first, then its wheels'. compared: there is a baseline.

    others: a column for each.
    """
    beside = [_by_place(other.rows) for other in others]
    bodies = [_body(_named(row), row, (), compared, beside) for row in rows if not row.wheel]
    for of in overall(rows):
        wheels = [row for row in rows if row.figure == of.row.figure and row.wheel]
        before = of.baseline_wheel if of.baseline_wheel != of.row.wheel and of.row.baseline is not None else ""
        which = f"{of.row.wheel}, before {before}" if before else of.row.wheel or "road wheels together"
        words = _named(of.row), " ", element("small", which)
        bodies.append(_body(joined(words), of.row, wheels, compared, beside))
    heads = ("now", "baseline", "change", "") if compared else ("now",)
    dots = [heading_cell("●", style=f"color:{other.colour}", title=other.name) for other in others]
    head = element("thead", row([*(heading_cell(name) for name in ("Figure", *heads)), *dots]))
    made = element("table", head, *bodies, class_="trackride-figures")
    return str(element("trackride-figures", made, compared="" if compared else None))


def _named(row: Row) -> str:
    return f"{row.figure}, {row.unit}" if row.unit else row.figure


def _by_place(rows: Sequence[Row]) -> dict[tuple[str, str], Row]:
    """By figure and wheel; under no wheel what a figure of each wheel comes to for all of them."""
    return {(row.figure, row.wheel): row for row in rows} | {(of.row.figure, ""): of.row for of in overall(rows)}


def _body(
    name: Content, whole: Row, wheels: Sequence[Row], compared: bool, beside: Sequence[Mapping[tuple[str, str], Row]]
) -> Html:
    """A figure's line, and those of its wheels."""

    def others(wheel: str) -> list[Content]:
        found = (other.get((whole.figure, wheel)) for other in beside)
        return [NONE if row is None else row_texts(row)[1] for row in found]

    head = cell(element("button", name, type="button", aria_expanded="false") if wheels else name)
    lines = [row([head, *_with_bar(whole, compared), *others("")], titled=False)]
    lines += [
        row([one.wheel, *_with_bar(one, compared), *others(one.wheel)], titled=False, class_="wheel") for one in wheels
    ]
    change = 0.0 if whole.change is None or not whole.resolved else abs(whole.change)
    return element("tbody", *lines, data_figure=whole.figure, data_change=f"{change:.4g}")


def cells(row: Row, compared: bool) -> list[Content]:
    """Now, baseline and change."""
    now, baseline = row_texts(row)
    if not compared:
        return [now]
    sign = None
    if row.baseline is not None and row.now is not None:
        sign = "same" if not row.resolved else "more" if row.now > row.baseline else "less"
    return [now, baseline, cell(change_text(row.change), class_=sign)]


def _with_bar(row: Row, compared: bool) -> list[Content]:
    """The same, and the change as a bar."""
    return [*cells(row, compared), *([cell(_bar(row), class_="bar")] if compared else [])]


def _bar(row: Row) -> Html:
    """From the baseline, in the middle, to now."""
    if row.change is None or not row.resolved:
        return Html()
    long = min(abs(row.change) / WIDEST, 1.0) * 50
    start = 50.0 if row.change > 0 else 50 - long
    beyond = " beyond" if abs(row.change) > WIDEST else ""
    return element(
        "i",
        class_=("more" if row.change > 0 else "less") + beyond,
        style=f"left:{start:.0f}%;width:{max(long, 1):.0f}%",
    )
