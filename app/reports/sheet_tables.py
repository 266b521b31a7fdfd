"""The tables of a stamped figure: ride figures beside a baseline's, and every parameter, the changed ones first."""

from __future__ import annotations

from typing import Any

from app.format.differences import change_text, row_texts
from app.format.load_unit import heading
from app.format.parameters import value_text
from app.reports.sheet_page import BAND, GREY, MARKED, Sheet, plain
from model.analysis.figures import AIR_TIME, LOAD_PEAK, LOAD_RMS, TRAVEL, Row
from model.analysis.signals import Window
from model.config.config import Config
from model.config.parameters import NOTES, PARAMETER, Parameter

ROW = 0.132  # inches, like all lengths: height of a row, at most
LEAST_ROW = 0.125  # below which wheels are left out of the tables instead
HEADINGS = 0.9  # height of what stands above and between the rows
POINTS_PER_ROW = 48.0  # size of text for each inch of a row's height
HEAD, SUBHEAD = 7.6, 6.1  # points
RIDE = 0.35  # width of the word "Ride"
NAMES = 0.3  # width of the wheels' names
MOST = 999.0  # %: a larger change is not told in figures
WHEEL_FIGURES = (LOAD_PEAK, LOAD_RMS, TRAVEL, AIR_TIME)  # for which there is room
COLUMNS, GAP = 3, 0.1  # of the unchanged parameters, and between them


class Tables:
    """A column of tables from (x, top) downwards, of some width, that ends above `bottom`; inches."""

    def __init__(self, sheet: Sheet, x: float, top: float, bottom: float, width: float) -> None:
        self._sheet, self._x, self._width = sheet, x, width
        self._y, self._height = top, top - bottom

    def draw(
        self, rows: list[Row], taken: Window, colours: dict[str, str], config: Config, baseline: Config | None
    ) -> None:
        """rows: the comparison of two runs, or of one with none; taken: the window of the run that is shown; colours:
        CSS, by the names of its wheels."""
        hull = [row for row in rows if not row.wheel]
        wheels = {(row.figure, row.wheel): row for row in rows if row.wheel}
        reference = baseline or Config()
        values, before = config.values(), reference.values()
        shown = [key for key in values if PARAMETER[key].group != NOTES]
        changed = [key for key in shown if before.get(key) != values[key]]
        same = [key for key in shown if key not in changed]
        names = list(dict.fromkeys(name for _, name in wheels))
        others = len(hull) + len(changed) + -(-len(same) // COLUMNS)
        told = names if (others + len(names)) * LEAST_ROW <= self._height - HEADINGS else telling(names, wheels)
        lines = others + len(told) + (len(told) < len(names))
        self._row = min(ROW, (self._height - HEADINGS) / lines)
        self._size = self._row * POINTS_PER_ROW

        compared = baseline is not None
        self._hull_table(hull, taken, compared)
        self._wheel_table(told, wheels, colours, compared)
        if len(told) < len(names):
            self._remark(f"Of {len(names)} wheels the first and last of each kind, and those with the largest figures.")
        self._y -= 0.26
        against = "the baseline" if compared else "the paper's vehicle"
        self._head("Parameters", f"changed against {against}: first, marked" if changed else f"as in {against}")
        for key in changed:
            was = value_text(reference.parameter(key), before[key]) if key in before else ""
            self._changed_row(config.parameter(key), values[key], was)
        self._other_rows([(config.parameter(key), values[key]) for key in same])

    def _head(self, title: str, remark: str = "") -> None:
        self._sheet.write(self._x, self._y, title, HEAD, weight="bold")
        self._sheet.write(self._x + self._width, self._y, remark, SUBHEAD, color=GREY, ha="right")
        self._rule()

    def _rule(self) -> None:
        self._y -= 0.05
        self._sheet.rule(self._x, self._y, self._width)

    def _next(self, colour: str = "", x: float | None = None, width: float | None = None) -> None:
        """Go down a row, on a bar if a colour is given."""
        self._y -= self._row
        if colour:
            self._sheet.bar(x or self._x, self._y - 0.24 * self._row, width or self._width, self._row, colour)

    def _remark(self, text: str) -> None:
        self._next()
        self._sheet.write(self._x, self._y, text, SUBHEAD, color=GREY)

    def _cell(self, x: float, text: str, **style: Any) -> None:
        self._sheet.write(x, self._y, text, self._size, **style)

    # ── Ride figures ──

    def _hull_table(self, rows: list[Row], taken: Window, compared: bool) -> None:
        heads = ("now", "baseline", "change") if compared else ("now",)
        ends = [self._x + self._width - 0.7 * k for k in reversed(range(len(heads)))]
        for end, head in zip(ends, heads, strict=True):
            self._sheet.write(end, self._y, head, SUBHEAD, color=GREY, ha="right")
        words = f"means of {taken.start:.2f} to {taken.end:.2f} s"
        self._sheet.write(self._x + RIDE, self._y, words, SUBHEAD, color=GREY)
        self._head("Ride")
        for row in rows:
            self._next()
            self._cell(self._x, f"{row.figure}, {row.unit}")
            for end, head, text in zip(ends, heads, _texts(row), strict=False):
                self._cell(end, text, ha="right", weight="bold" if head == "change" else "normal")
        self._y -= 0.24

    def _wheel_table(
        self, names: list[str], rows: dict[tuple[str, str], Row], colours: dict[str, str], compared: bool
    ) -> None:
        heads = ("now", "base", "Δ %") if compared else ("",)
        block = (self._width - NAMES) / len(WHEEL_FIGURES)
        rights = [self._x + NAMES + (k + 1) * block for k in range(len(WHEEL_FIGURES))]
        offsets = [0.36 * k for k in reversed(range(len(heads)))]
        self._sheet.write(self._x, self._y, "Wheel", SUBHEAD, weight="bold")
        for right, figure in zip(rights, WHEEL_FIGURES, strict=True):
            words = heading(figure.label, list(rows.values()))
            self._sheet.write(right, self._y, words, SUBHEAD, weight="bold", ha="right")
        if compared:
            self._y -= 0.125
            for right in rights:
                for offset, head in zip(offsets, heads, strict=True):
                    self._sheet.write(right - offset, self._y, head, SUBHEAD, color=GREY, ha="right")
        self._rule()
        for number, name in enumerate(names):
            self._next(BAND if number % 2 == 0 else "")
            self._cell(self._x + 0.02, name, weight="bold", color=colours.get(name, GREY))
            for right, figure in zip(rights, WHEEL_FIGURES, strict=True):
                if (figure.label, name) in rows:
                    for offset, text in zip(offsets, _texts(rows[figure.label, name]), strict=False):
                        self._cell(right - offset, text.removesuffix(" %"), ha="right")

    # ── Parameters ──

    def _changed_row(self, parameter: Parameter, value: Any, was: str) -> None:
        self._next(MARKED)
        self._cell(self._x + 0.02, _named(parameter), weight="bold")
        self._cell(self._x + 1.85, plain(value_text(parameter, value), 32), weight="bold")
        if was:
            self._cell(self._x + self._width - 0.02, plain(f"was {was}", 26), ha="right")

    def _other_rows(self, parameters: list[tuple[Parameter, Any]]) -> None:
        """In columns."""
        self._y -= 0.03
        top, width = self._y, (self._width - GAP * (COLUMNS - 1)) / COLUMNS
        high = -(-len(parameters) // COLUMNS)
        for column in range(COLUMNS):
            part = parameters[column * high : (column + 1) * high]
            self._y, x = top, self._x + column * (width + GAP)
            for number, (parameter, value) in enumerate(part):
                self._next(BAND if number % 2 == 0 else "", x, width)
                self._cell(x + 0.02, _named(parameter))
                self._cell(x + width - 0.02, plain(value_text(parameter, value), 11), ha="right")


def telling(names: list[str], rows: dict[tuple[str, str], Row]) -> list[str]:
    """Of road wheels and of imaginary wheels the first, the last, and for each figure the one where it is largest."""
    chosen: set[str] = set()
    for kind in "RI":
        wheels = [name for name in names if name.startswith(kind)]
        chosen |= {*wheels[:1], *wheels[-1:]}
        for figure in WHEEL_FIGURES:
            values = {name: rows[figure.label, name].now or 0.0 for name in wheels if (figure.label, name) in rows}
            chosen |= {max(values, key=lambda name: values[name])} if any(values.values()) else set()
    return [name for name in names if name in chosen]


def _texts(row: Row) -> tuple[str, str, str]:
    """Now, baseline and change."""
    change = change_text(row.change) if row.change is None or row.change < MOST else f">{MOST:g} %"
    return *row_texts(row), change


def _named(parameter: Parameter) -> str:
    """Its label and its symbol as a formula: "Suspension damping  $c_{s}$"."""
    symbol, _, index = parameter.symbol.partition("_")
    formula = f"  ${symbol}_{{{index}}}$" if index else f"  ${symbol}$" if symbol else ""
    return parameter.label + formula
