"""Tables of text with the points of a profile: their cells, what their headings say, and the columns of x and height.

What could be read in two ways is refused with a PointsError, which says where, what is wrong and what to do.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from model.config.parameters import UNITS
from model.config.profile_points import POINT_LIMIT, PointsError, points_count

ALONG = {"x", "distance", "dist", "station", "stationing", "chainage", "s"}  # words in headings of x …
UP = {"y", "z", "height", "heights", "elevation", "elev", "level", "altitude"}  # … and of y
SPELLED = {
    **dict.fromkeys(("meter", "meters", "metre", "metres"), "m"),
    **dict.fromkeys(("millimeter", "millimeters", "millimetre", "millimetres"), "mm"),
    **dict.fromkeys(("centimeter", "centimeters", "centimetre", "centimetres"), "cm"),
    **dict.fromkeys(("decimeter", "decimeters", "decimetre", "decimetres"), "dm"),
    **dict.fromkeys(("kilometer", "kilometers", "kilometre", "kilometres"), "km"),
    **dict.fromkeys(("foot", "feet", "'"), "ft"),
    **dict.fromkeys(("inch", "inches", '"'), "in"),
}
LOOKED_AT = 1000  # lines that tell blanks from commas between columns
NO_UNIT = {"", "-", "1"}  # in brackets
FOREIGN = {"yd", "yard", "yards", "mi", "mile", "miles", "um", "µm", "μm", "nm", "v", "g", "s", "deg", "rad", "%"}
MISSING = {
    "nan",
    "inf",
    "na",
    "n/a",
    "#n/a",
    "null",
    "none",
    "-",
    "--",
    "?",
    "-nan",
    "-inf",
    "infinity",
    "+inf",
    "+nan",
}
NUMBER = re.compile(r"[+-]?(\d+[.,]?\d*|[.,]\d+)([eE][+-]?\d+)?", re.ASCII)
GROUPED = re.compile(r"[+-]?[1-9]\d{0,2}(,\d{3})+", re.ASCII)
COMMENT = ("#", "%", "!", "//")
ALLOWED_UNITS = ", ".join(UNITS)


@dataclass(frozen=True)
class Column:
    heading: str
    cells: Sequence[str]
    second: str = ""  # what a line of units below the headings says


@dataclass(frozen=True)
class Table:
    """A table of text."""

    columns: list[Column]
    plain: np.ndarray | None  # (rows, columns), where all cells are plain numbers; the columns then have no cells
    rows: list[str]
    lines: list[int]  # number of the line of each row, from 1
    headed: bool
    separator: str
    remarks: list[str]  # comments and titles

    def name(self, number: int) -> str:
        """Of a column, counted from 0."""
        return self.columns[number].heading or f"column {number + 1}"


# Headings


def unit_named(text: str) -> str | None:
    """The unit that a text names, in brackets or spelled out, if it names one that is known."""
    word = text.strip().strip("[]()").strip().lower().rstrip(".")
    return word if word in UNITS else SPELLED.get(word)


def heading_of(column: Column) -> tuple[set[str], str | None]:
    """The words of a heading, and the unit that it or the line below names. Raises PointsError."""
    found = {unit_named(column.second)} if column.second.strip() else set()
    for bracket, inside in re.findall(r"([\[(])([^\])]*)[\])]", column.heading):
        unit, word = unit_named(inside), inside.strip().lower()
        if unit is None and word not in NO_UNIT and (bracket == "[" or word in FOREIGN):
            raise PointsError(
                f"the unit of {column.heading[:60]!r} is unknown; give one of {ALLOWED_UNITS}, or road.units"
            )
        found |= {unit}
    words = re.findall(r"[^\W_]+", re.sub(r"[\[(][^\])]*[\])]", " ", column.heading).lower())
    if len(words) > 1 and unit_named(words[-1]):
        found |= {unit_named(words.pop())}
    found -= {None}
    if len(found) > 1:
        raise PointsError(
            f"the heading {column.heading[:60]!r} names two units, {' and '.join(sorted(filter(None, found)))}; "
            "leave the right one, or give road.units"
        )
    return set(words), next(iter(found), None)


def words_of(column: Column) -> set[str]:
    """The words of a heading that may name two units, or none that is known."""
    try:
        return heading_of(Column(re.sub(r"[\[(][^\])]*[\])]", " ", column.heading), ()))[0]
    except PointsError:
        return set()


def chosen(table: Table, columns: Sequence[str]) -> tuple[int, int]:
    """The columns of x and y, from 0. Raises PointsError, which lists them."""
    count = len(table.columns)
    if count < 2:
        raise PointsError(f"line {table.lines[0]}: one column; two are needed, x and height")
    if len(columns) == 2:
        return _found(table, columns[0]), _found(table, columns[1])
    words = [words_of(column) for column in table.columns]
    along = [k for k in range(count) if words[k] & ALONG]
    up = [_found(table, columns[0])] if columns else [k for k in range(count) if words[k] & UP and k not in along]
    if count == 2 and len(along) != 1:
        along = [1 - up[0]] if len(up) == 1 else [0]
    if count == 2 and len(up) != 1:
        up = [1 - along[0]]
    if len(along) == len(up) == 1:
        return along[0], up[0]
    for number in range(count):
        _refuse_empty(table, number)
    names = ", ".join(table.name(k) for k in range(count))
    raise PointsError(
        f"which columns are x and height? There are {count}: {names[:200]}; give names or numbers by road.columns, "
        f"such as [{table.name(0)[:30] if table.headed else 1}, {table.name(1)[:30] if table.headed else 2}]"
    )


def _found(table: Table, name: str) -> int:
    """The column of this name, with its unit or without, or of this number. Raises PointsError."""
    wanted = " ".join(name.lower().split())
    for shown in (
        [" ".join(column.heading.lower().split()) for column in table.columns],
        [re.sub(r"\s*[\[(][^\])]*[\])]", "", column.heading.lower()).strip() for column in table.columns],
        [str(number + 1) for number in range(len(table.columns))],
    ):
        if shown.count(wanted) == 1:
            return shown.index(wanted)
    names = ", ".join(table.name(k) for k in range(len(table.columns)))
    raise PointsError(f"there is no column {name[:40]!r}, or more than one; there are {names[:200]}")


# Tables of text


def read_table(text: str) -> Table:
    """The cells of a table. Raises PointsError."""
    numbered = [(number, line.strip(" \r")) for number, line in enumerate(text.split("\n"), 1) if line.strip()]
    separator = None
    if numbered and (told := re.fullmatch(r"(?i)\"?sep=(.)\"?", numbered[0][1])):
        separator = told[1]
        del numbered[0]
    remarks = [line.lstrip("#%!/ ") for _, line in numbered if line.startswith(COMMENT)]
    numbered = [(number, line) for number, line in numbered if not line.startswith(COMMENT)]
    separator = separator or _separator([line for _, line in numbered])
    above: list[list[str]] = []
    for number, line in numbered:
        row = _split(line, separator, number)
        if _is_data(row):
            break
        above.append(row)
    lines, rows = [number for number, _ in numbered[len(above) :]], [line for _, line in numbered[len(above) :]]
    if len(rows) < 2:
        raise PointsError(f"{points_count(len(rows))}; give 2 to {POINT_LIMIT}, two numbers each: x and y in m")
    plain, cells = _plain_numbers(rows, separator), []
    if plain is None:
        cells = _cells(rows, lines, separator)
    width = len(cells) if plain is None else plain.shape[1]
    units = above.pop() if above and _is_units(above[-1]) else []
    heading = above.pop() if above and (len(above[-1]) > 1 or width == 1) else []
    remarks += [" ".join(row) for row in above]
    if not heading and remarks:
        comment = _split(remarks[-1], separator, 0)
        if len(comment) == width and any(words_of(Column(cell, ())) & (ALONG | UP) for cell in comment):
            heading = comment
    heading, units = (row[:width] if not any(row[width:]) else row for row in (heading, units))
    for row, what in ((heading, "headings"), (units, "units")):
        if row and len(row) != width:
            raise PointsError(f"line {lines[0]}: {width} numbers below {len(row)} {what}; give as many of both")
    headings, second = heading or [""] * width, units or [""] * width
    columns = [Column(headings[k], cells[k] if cells else (), second[k]) for k in range(width)]
    return Table(columns, plain, rows, lines, bool(heading), separator, remarks)


def _plain_numbers(rows: list[str], separator: str) -> np.ndarray | None:
    """The table of rows that hold finite numbers with decimal points and nothing else, quickly; else None."""
    try:
        table = np.loadtxt(rows, delimiter=None if separator == " " else separator, comments=None, ndmin=2)
    except ValueError:
        return None
    return table if len(table) == len(rows) and np.isfinite(table).all() else None


def _cells(rows: list[str], lines: list[int], separator: str) -> list[list[str]]:
    """The cells of each column. Raises PointsError where a row has more or fewer than the first."""
    data = [_split(row, separator, number) for row, number in zip(rows, lines, strict=True)]
    width = max(len(data[0]), 1)
    while width > 2 and not any(len(row) >= width and row[width - 1] for row in data):
        width -= 1  # every line ends in a separator
    for row, number in zip(data, lines, strict=True):
        if len(row) < width or any(row[width:]):
            raise PointsError(f"line {number}: {len(row)} numbers; give {width}, as in line {lines[0]}")
    return [[row[k] for row in data] for k in range(width)]


def _separator(lines: list[str]) -> str:
    """A semicolon, a tab, a comma or blanks: between blanks, commas are decimal points."""
    for separator in (";", "\t"):
        if any(separator in line for line in lines):
            return separator
    if not any("," in line for line in lines):
        return " "
    with_numbers = [line.split() for line in lines[:LOOKED_AT] if NUMBER.match(line)]
    blanks = with_numbers and all(len(row) > 1 and all(map(NUMBER.fullmatch, row)) for row in with_numbers)
    return " " if blanks else ","


def _split(line: str, separator: str, number: int) -> list[str]:
    if separator == " ":
        return re.sub(r"\s+(?=[\[(])", "", line).split()
    if '"' in line:
        try:
            return [cell.strip() for cell in next(csv.reader([line], delimiter=separator, skipinitialspace=True))]
        except (csv.Error, StopIteration, ValueError):
            raise PointsError(f"line {number}: the quotes cannot be read") from None
    cells = line.split(separator)
    return [cell.strip() for cell in cells] if " " in line or (separator != "\t" and "\t" in line) else cells


def _is_data(row: list[str]) -> bool:
    """Whether it is no heading: it holds a number, or what stands for a missing one."""
    return any(NUMBER.fullmatch(cell) or cell.lower() in MISSING for cell in row)


def _is_units(row: list[str]) -> bool:
    named = [cell for cell in row if cell]
    return bool(named) and all(unit_named(cell) for cell in named)


def _refuse_empty(table: Table, number: int) -> None:
    cells = table.columns[number].cells
    if "" in cells and any(cells):
        raise PointsError(
            f"line {table.lines[cells.index('')]}: the cell of {table.name(number)!r} is empty; fill it, or leave the "
            "line out"
        )


def numbers(table: Table, *which: int) -> list[np.ndarray]:
    """The numbers of these columns. Raises PointsError for a cell that holds none."""
    if table.plain is not None:
        return [table.plain[:POINT_LIMIT, number] for number in which]
    columns = [table.columns[number].cells[:POINT_LIMIT] for number in which]
    for number in which:
        _refuse_empty(table, number)
    commas = [(k, cell) for cells in columns for k, cell in enumerate(cells) if "," in cell]
    if commas:
        grouped = [(k, cell) for k, cell in commas if cell.count(",") > 1 or "." in cell]
        if grouped or all(GROUPED.fullmatch(cell) for _, cell in commas):
            row, cell = (grouped or commas)[0]
            raise PointsError(
                f"line {table.lines[row]}: the comma in {cell[:40]!r} may separate thousands; write "
                f"{cell.replace(',', '')[:40]!r}, or a decimal point"
            )
    found = []
    for number, cells in zip(which, columns, strict=True):
        try:
            values = np.array([float(cell.replace(",", ".")) for cell in cells] if commas else list(map(float, cells)))
            all_cells = "".join(cells)
            sound = bool(np.isfinite(values).all()) and "_" not in all_cells and all_cells.isascii()
        except ValueError:
            sound = False
        if not sound:
            row, cell = next(
                (
                    (k, c)
                    for k, c in enumerate(cells)
                    if not NUMBER.fullmatch(c) or not np.isfinite(float(c.replace(",", ".")))
                ),
                (0, cells[0]),
            )
            raise PointsError(
                f"line {table.lines[row]}: {cell[:40]!r} is no number; give x and y in m (here {table.name(number)})"
            )
        found.append(values)
    return found
