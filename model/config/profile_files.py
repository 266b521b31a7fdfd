"""A measured profile from a file of any of the usual formats: x and y in m, and a sentence that says what was read.

Tables of text are read here, files of ERD and OpenCRG in profile_formats.py; units and columns are those that the
file's heading names, unless `road.units` and `road.columns` say otherwise. What could be read in two ways is refused.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from model.config.parameters import UNITS
from model.config.profile_formats import Channels, decoded, is_crg, is_erd, read_crg, read_erd
from model.config.profile_points import (
    FILE_LIMIT,
    POINT_LIMIT,
    STATIONED,
    PointsError,
    check,
    points_count,
    points_text,
    span_text,
)

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
ROUGHEST = 0.5  # median change of slope over ROUGH_SPACING that no road in m has: class H has a fifth of it
ROUGH_SPACING = 0.25  # m
ALLOWED_UNITS = ", ".join(UNITS)


@dataclass(frozen=True)
class ProfileFile:
    """What was read of a file."""

    points: str  # as in a configuration
    said: str  # "241 points, 0 to 60 m, heights −31 to 45 mm; read as ft"


@dataclass(frozen=True)
class _Column:
    heading: str
    cells: Sequence[str]
    second: str = ""  # what a line of units below the headings says


@dataclass(frozen=True)
class _Sheet:
    """A table of text."""

    columns: list[_Column]
    table: np.ndarray | None  # (rows, columns), where all cells are plain numbers; the columns then have no cells
    rows: list[str]
    lines: list[int]  # number of the line of each row, from 1
    headed: bool
    separator: str
    remarks: list[str]  # comments and titles

    def name(self, number: int) -> str:
        """Of a column, counted from 0."""
        return self.columns[number].heading or f"column {number + 1}"


@np.errstate(all="ignore")  # a file may hold any numbers: `check` refuses those that make no road
def read_profile_file(data: bytes, columns: Sequence[str] = (), units: Sequence[str] = ()) -> ProfileFile:
    """The profile in a file's content.

    columns: names, or numbers from 1, of the columns of x and y, or of y alone; units: of x and y. Empty: as the
    heading says. Raises PointsError, which says where, what is wrong, and what to do.
    """
    if len(data) > FILE_LIMIT:
        raise PointsError(f"the file is larger than {FILE_LIMIT} bytes")
    if is_crg(data):
        return _of_channels(read_crg(data), columns, units)
    text = decoded(data)
    return _of_channels(read_erd(text), columns, units) if is_erd(text) else _of_sheet(_sheet(text), columns, units)


# From columns to points


def _of_channels(channels: Channels, columns: Sequence[str], units: Sequence[str]) -> ProfileFile:
    """The profile in a file of equal steps."""
    y, name, unit = channels.along(columns[-1] if columns else None)
    named = [_named(text, given) for text, given in ((channels.x_unit, _unit(units, 0)), (unit, _unit(units, 1)))]
    along, up = (_unit(units, k) or named[k] or "m" for k in range(2))
    y = y[:POINT_LIMIT]
    if len(y) < 2:
        raise PointsError(f"{channels.format}: {points_count(len(y))} below the header; give 2 to {POINT_LIMIT}")
    if np.isnan(y).any():
        sample = int(np.isnan(y).argmax()) + 1
        raise PointsError(f"{channels.format}, {name}: sample {sample} is missing; choose another line by road.columns")
    x = (channels.start + np.arange(len(y)) * channels.step) * UNITS[along]
    y = y * UNITS[up]
    check(x, y, lambda row: f"{channels.format}, sample {row + 1}")
    how = f"{channels.format}, {name}, {_units_text(along, up)}{_overruled(units, named)}"
    return _read(x, y, how, len(channels.heights))


def _of_sheet(sheet: _Sheet, columns: Sequence[str], units: Sequence[str]) -> ProfileFile:
    first, second = _chosen(sheet, columns)
    x, y = _numbers(sheet, first, second)
    headed = [_unit_headed(sheet.columns[c], _unit(units, k)) for k, c in enumerate((first, second))]
    along, up = (_unit(units, k) or headed[k] for k in range(2))
    _refuse_unclear_units(sheet, first, second, along, up)
    x, y = x * UNITS[along or "m"], y * UNITS[up or "m"]
    if up is None and (np.diff(x) > 0.0).all():
        _refuse_heights_that_look_like_no_metres(x, y)
    check(x, y, lambda row: f"line {sheet.lines[row]}")
    _refuse_one_column_of_decimal_commas(sheet, x, y)
    named = "no unit named, read as m" if along is None and up is None else _units_text(along or "m", up or "m")
    named += _overruled(units, headed)
    known = _words(sheet.columns[first]) & ALONG and _words(sheet.columns[second]) & UP
    if len(sheet.columns) > 2 or columns or (sheet.headed and not known):
        named += f"; columns {sheet.name(first)} and {sheet.name(second)}"
    return _read(x, y, named, len(sheet.rows))


def _units_text(along: str, up: str) -> str:
    return f"read as {along}" if along == up else f"x read as {along}, heights as {up}"


def _read(x: np.ndarray, y: np.ndarray, how: str, rows: int) -> ProfileFile:
    said = f"{span_text(x, y)}; {how}"
    if rows > POINT_LIMIT:
        said += f"; only the first {POINT_LIMIT} of {rows} points are taken"
    if x[0] > STATIONED:
        said += "; its first point is a station, and is put 1 m ahead of the first wheel unless road.start is given"
    return ProfileFile(points_text(x, y), said)


def _unit(units: Sequence[str], number: int) -> str:
    return units[number] if number < len(units) else ""


def _overruled(units: Sequence[str], named: Sequence[str | None]) -> str:
    """A word where `road.units` says something else than the file does."""
    pairs = [(what, _unit(units, k), named[k]) for k, what in enumerate(("x", "heights"))]
    others = [f"{what} in {said}" for what, given, said in pairs if given and said and given != said]
    return f" by road.units, though the file says {' and '.join(others)}" if others else ""


def _unit_headed(column: _Column, given: str) -> str | None:
    """The unit that a heading names. Raises PointsError for a heading that is not clear, unless a unit is given."""
    try:
        return _heading(column)[1]
    except PointsError:
        if given:
            return None
        raise


def _named(text: str, given: str) -> str | None:
    """The unit of a file with a header, None where it names none. Raises PointsError for one that we do not know,
    unless a unit is given.
    """
    unit = _unit_named(text)
    if unit is None and text.strip() not in NO_UNIT and not given:
        raise PointsError(f"the unit {text.strip()[:40]!r} is unknown; give road.units, each of {ALLOWED_UNITS}")
    return unit


def _refuse_unclear_units(sheet: _Sheet, first: int, second: int, along: str | None, up: str | None) -> None:
    """Of a column without a unit beside one in ft or in, or below a comment that speaks of one."""
    for one, other, unnamed in ((along, up, second), (up, along, first)):
        if other is None and one in ("ft", "in"):
            raise PointsError(f"{sheet.name(unnamed)!r} names no unit, its neighbour is in {one}; give road.units")
    if along is None and up is None:
        for remark in sheet.remarks:
            for word in re.findall(r"(?:\bin |units?:? |\[|\()\s*([a-z]+)", remark.lower()):
                unit = _unit_named(word)
                if unit not in (None, "m"):
                    raise PointsError(
                        f"a comment speaks of {unit} ({remark[:60]!r}) but no heading names a unit; name it there, "
                        f"such as height [{unit}], or give road.units"
                    )


def _refuse_heights_that_look_like_no_metres(x: np.ndarray, y: np.ndarray) -> None:
    few = np.append(0, np.flatnonzero(np.diff(np.floor((x - x[0]) / ROUGH_SPACING + 1e-6)) > 0) + 1)
    turns = np.abs(np.diff(np.diff(y[few]) / np.diff(x[few])))
    if len(turns) >= 5 and np.median(turns) > ROUGHEST:
        raise PointsError(
            "no unit is named, and heights that rise and fall like this look like mm, cm or inches; name the unit in "
            "the heading, such as height [mm], or give road.units, such as {x: m, y: mm} ({x: m, y: m} if it is m)"
        )


def _refuse_one_column_of_decimal_commas(sheet: _Sheet, x: np.ndarray, y: np.ndarray) -> None:
    """Rows like 100,2: two whole numbers, or one with a decimal comma? No heading says it, but two would be a cliff."""
    if sheet.headed or sheet.separator != "," or len(sheet.columns) != 2:
        return
    if not all(row.replace(",", "").isdigit() for row in sheet.rows):
        return
    if np.abs(np.diff(y) / np.diff(x)).max() > 1.0:
        raise PointsError(
            f"line {sheet.lines[0]}: {sheet.rows[0][:40]!r} looks like one column "
            "with a decimal comma; two are needed, x and height. If it is two, write x,y above them"
        )


# Headings


def _unit_named(text: str) -> str | None:
    word = text.strip().strip("[]()").strip().lower().rstrip(".")
    return word if word in UNITS else SPELLED.get(word)


def _heading(column: _Column) -> tuple[set[str], str | None]:
    """The words of a heading, and the unit that it or the line below names. Raises PointsError."""
    found = {_unit_named(column.second)} if column.second.strip() else set()
    for bracket, inside in re.findall(r"([\[(])([^\])]*)[\])]", column.heading):
        unit, word = _unit_named(inside), inside.strip().lower()
        if unit is None and word not in NO_UNIT and (bracket == "[" or word in FOREIGN):
            raise PointsError(
                f"the unit of {column.heading[:60]!r} is unknown; give one of {ALLOWED_UNITS}, or road.units"
            )
        found |= {unit}
    words = re.findall(r"[^\W_]+", re.sub(r"[\[(][^\])]*[\])]", " ", column.heading).lower())
    if len(words) > 1 and _unit_named(words[-1]):
        found |= {_unit_named(words.pop())}
    found -= {None}
    if len(found) > 1:
        raise PointsError(
            f"the heading {column.heading[:60]!r} names two units, {' and '.join(sorted(filter(None, found)))}; "
            "leave the right one, or give road.units"
        )
    return set(words), next(iter(found), None)


def _words(column: _Column) -> set[str]:
    try:
        return _heading(_Column(re.sub(r"[\[(][^\])]*[\])]", " ", column.heading), ()))[0]
    except PointsError:
        return set()


def _chosen(sheet: _Sheet, columns: Sequence[str]) -> tuple[int, int]:
    """The columns of x and y, from 0. Raises PointsError, which lists them."""
    count = len(sheet.columns)
    if count < 2:
        raise PointsError(f"line {sheet.lines[0]}: one column; two are needed, x and height")
    if len(columns) == 2:
        return _found(sheet, columns[0]), _found(sheet, columns[1])
    words = [_words(column) for column in sheet.columns]
    along = [k for k in range(count) if words[k] & ALONG]
    up = [_found(sheet, columns[0])] if columns else [k for k in range(count) if words[k] & UP and k not in along]
    if count == 2 and len(along) != 1:
        along = [1 - up[0]] if len(up) == 1 else [0]
    if count == 2 and len(up) != 1:
        up = [1 - along[0]]
    if len(along) == len(up) == 1:
        return along[0], up[0]
    for number in range(count):
        _refuse_empty(sheet, number)
    names = ", ".join(sheet.name(k) for k in range(count))
    raise PointsError(
        f"which columns are x and height? There are {count}: {names[:200]}; give names or numbers by road.columns, "
        f"such as [{sheet.name(0)[:30] if sheet.headed else 1}, {sheet.name(1)[:30] if sheet.headed else 2}]"
    )


def _found(sheet: _Sheet, name: str) -> int:
    """The column of this name, with its unit or without, or of this number. Raises PointsError."""
    wanted = " ".join(name.lower().split())
    for shown in (
        [" ".join(column.heading.lower().split()) for column in sheet.columns],
        [re.sub(r"\s*[\[(][^\])]*[\])]", "", column.heading.lower()).strip() for column in sheet.columns],
        [str(number + 1) for number in range(len(sheet.columns))],
    ):
        if shown.count(wanted) == 1:
            return shown.index(wanted)
    names = ", ".join(sheet.name(k) for k in range(len(sheet.columns)))
    raise PointsError(f"there is no column {name[:40]!r}, or more than one; there are {names[:200]}")


# Tables of text


def _sheet(text: str) -> _Sheet:
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
    table, cells = _plain_numbers(rows, separator), []
    if table is None:
        cells = _cells(rows, lines, separator)
    width = len(cells) if table is None else table.shape[1]
    units = above.pop() if above and _is_units(above[-1]) else []
    heading = above.pop() if above and (len(above[-1]) > 1 or width == 1) else []
    remarks += [" ".join(row) for row in above]
    if not heading and remarks:
        comment = _split(remarks[-1], separator, 0)
        if len(comment) == width and any(_words(_Column(cell, ())) & (ALONG | UP) for cell in comment):
            heading = comment
    heading, units = (row[:width] if not any(row[width:]) else row for row in (heading, units))
    for row, what in ((heading, "headings"), (units, "units")):
        if row and len(row) != width:
            raise PointsError(f"line {lines[0]}: {width} numbers below {len(row)} {what}; give as many of both")
    headings, second = heading or [""] * width, units or [""] * width
    columns = [_Column(headings[k], cells[k] if cells else (), second[k]) for k in range(width)]
    return _Sheet(columns, table, rows, lines, bool(heading), separator, remarks)


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
    return bool(named) and all(_unit_named(cell) for cell in named)


def _refuse_empty(sheet: _Sheet, number: int) -> None:
    cells = sheet.columns[number].cells
    if "" in cells and any(cells):
        raise PointsError(
            f"line {sheet.lines[cells.index('')]}: the cell of {sheet.name(number)!r} is empty; fill it, or leave the "
            "line out"
        )


def _numbers(sheet: _Sheet, *chosen: int) -> list[np.ndarray]:
    """The numbers of these columns. Raises PointsError for a cell that holds none."""
    if sheet.table is not None:
        return [sheet.table[:POINT_LIMIT, number] for number in chosen]
    columns = [sheet.columns[number].cells[:POINT_LIMIT] for number in chosen]
    for number in chosen:
        _refuse_empty(sheet, number)
    commas = [(k, cell) for cells in columns for k, cell in enumerate(cells) if "," in cell]
    if commas:
        grouped = [(k, cell) for k, cell in commas if cell.count(",") > 1 or "." in cell]
        if grouped or all(GROUPED.fullmatch(cell) for _, cell in commas):
            row, cell = (grouped or commas)[0]
            raise PointsError(
                f"line {sheet.lines[row]}: the comma in {cell[:40]!r} may separate thousands; write "
                f"{cell.replace(',', '')[:40]!r}, or a decimal point"
            )
    found = []
    for number, cells in zip(chosen, columns, strict=True):
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
                f"line {sheet.lines[row]}: {cell[:40]!r} is no number; give x and y in m (here {sheet.name(number)})"
            )
        found.append(values)
    return found
