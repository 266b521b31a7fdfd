"""A measured profile from a file of any of the usual formats: x and y in m, and a sentence that says what was read.

Tables of text are read in profile_tables.py, files of ERD and OpenCRG in profile_formats.py; units and columns are
those that the file's heading names, unless `road.units` and `road.columns` say otherwise. What could be read in two
ways is refused; what is likely then, the user may choose (`ProfileSource.likely`).
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import Protocol

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
from model.config.profile_tables import (
    ALLOWED_UNITS,
    ALONG,
    NO_UNIT,
    UP,
    Column,
    Table,
    chosen,
    heading_of,
    numbers,
    read_table,
    unit_named,
    words_of,
)

ROUGHEST = 0.5  # median change of slope over ROUGH_SPACING that no road in m has: class H has a fifth of it
ROUGH_SPACING = 0.25  # m
IMPERIAL = ("ft", "in")
LIKELY_ALONG = ("km", "mm", "cm", "ft", "in")  # units of x that is not in m, the likeliest first …
LIKELY_UP = ("mm", "cm", "in", "ft")  # … and of heights
TRIED = 8  # columns, and pairs of columns, among which x and height are looked for


@dataclass(frozen=True, eq=False)
class ProfileFile:
    """What was read of a file."""

    x: np.ndarray  # (K,), m
    y: np.ndarray  # (K,), m
    said: str  # "241 points, 0 to 60 m, heights −31 to 45 mm; read as ft"

    @cached_property
    def points(self) -> str:
        """The points as in a configuration."""
        return points_text(self.x, self.y)


@dataclass(frozen=True)
class Reading:
    """How a file is to be read, in the words of `road.columns` and `road.units`."""

    columns: tuple[str, ...]  # of x and height; of height alone where the file's header tells x
    units: tuple[str, ...]  # of x and height


class ProfileSource(Protocol):
    """A file's content, which may be read in several ways."""

    @property
    def columns(self) -> tuple[str, ...]:
        """What `road.columns` calls each column."""

    @property
    def labels(self) -> tuple[str, ...]:
        """What people call each column; no two are the same."""

    @property
    def x_is_column(self) -> bool:
        """Whether x stands in a column; else the file's header tells it."""

    @property
    def doubt(self) -> str:
        """What the file does not say, so that the user should; empty: nothing. To be asked once `read` was able to."""

    def read(self, columns: Sequence[str] = (), units: Sequence[str] = ()) -> ProfileFile:
        """The profile; columns and units as in a configuration, empty: as the heading says. Raises PointsError."""

    def likely(self) -> Reading | None:
        """How it is probably meant, in a way in which it can be read; None: there is no such way."""


def read_profile_file(data: bytes, columns: Sequence[str] = (), units: Sequence[str] = ()) -> ProfileFile:
    """The profile in a file's content.

    columns: names, or numbers from 1, of the columns of x and y, or of y alone; units: of x and y. Empty: as the
    heading says. Raises PointsError, which says where, what is wrong, and what to do.
    """
    return open_profile_file(data).read(columns, units)


def open_profile_file(data: bytes) -> ProfileSource:
    """The content of a file. Raises PointsError."""
    if len(data) > FILE_LIMIT:
        raise PointsError(f"the file is larger than {FILE_LIMIT} bytes")
    with np.errstate(all="ignore"):  # a file may hold any numbers: `check` refuses those that make no road
        if is_crg(data):
            return ChannelSource(read_crg(data))
        text = decoded(data)
        return ChannelSource(read_erd(text)) if is_erd(text) else TableSource(read_table(text))


def _called(names: Sequence[str]) -> tuple[str, ...]:
    """What `road.columns` calls each column: its name or, where that will not do, its number."""
    return tuple(name if clear else str(k) for k, name, clear in _clear(names))


def _labels(names: Sequence[str]) -> tuple[str, ...]:
    """The same for people."""
    return tuple(name if clear else f"{name[:60]}, column {k}".removeprefix(", ") for k, name, clear in _clear(names))


def _clear(names: Sequence[str]) -> list[tuple[int, str, bool]]:
    """Each column's number, from 1, its name, and whether `road.columns` can call it by that."""
    often = Counter(name.lower() for name in names)

    def clear(name: str) -> bool:
        simple = name == " ".join(name.split()) and name.isprintable() and "," not in name
        return bool(name) and simple and len(name) <= 100 and often[name.lower()] == 1

    return [(k, name, clear(name)) for k, name in enumerate(names, 1)]


# Files of equal steps


@dataclass(frozen=True)
class ChannelSource:
    """A file of ERD or OpenCRG."""

    channels: Channels

    x_is_column = False

    @property
    def columns(self) -> tuple[str, ...]:
        return _called(self.channels.names)

    @property
    def labels(self) -> tuple[str, ...]:
        return _labels(self.channels.names)

    @property
    def doubt(self) -> str:
        channels = self.channels
        if channels.across is None and len(channels.names) > 1:
            return f"It has several channels: {', '.join(channels.names)[:200]}"
        if unit_named(channels.units[0]) is None or unit_named(channels.x_unit) is None:
            return "Its header does not name the units of distance and height"
        return ""

    @np.errstate(all="ignore")
    def read(self, columns: Sequence[str] = (), units: Sequence[str] = ()) -> ProfileFile:
        channels = self.channels
        y, name, unit = channels.along(columns[-1] if columns else None)
        named = [_named(text, given) for text, given in ((channels.x_unit, _unit(units, 0)), (unit, _unit(units, 1)))]
        along, up = (_unit(units, k) or named[k] or "m" for k in range(2))
        y = y[:POINT_LIMIT]
        if len(y) < 2:
            raise PointsError(f"{channels.format}: {points_count(len(y))} below the header; give 2 to {POINT_LIMIT}")
        if np.isnan(y).any():
            sample = int(np.isnan(y).argmax()) + 1
            raise PointsError(
                f"{channels.format}, {name}: sample {sample} is missing; choose another line by road.columns"
            )
        x = (channels.start + np.arange(len(y)) * channels.step) * UNITS[along]
        y = y * UNITS[up]
        check(x, y, lambda row: f"{channels.format}, sample {row + 1}")
        how = f"{channels.format}, {name}, {_units_text(along, up)}{_overruled(units, named)}"
        return _file(x, y, how, len(channels.heights))

    def likely(self) -> Reading | None:
        channels = self.channels
        order = np.arange(len(channels.names))
        if channels.across is not None:  # the middle first
            order = np.argsort(np.abs(channels.across - (channels.across[0] + channels.across[-1]) / 2), kind="stable")
        called, along = self.columns, unit_named(channels.x_unit) or "m"
        for number in order[:TRIED]:
            for up in (unit_named(channels.units[number]) or "m", *LIKELY_UP):
                reading = Reading((called[number],), (along, up))
                if _reads(self, reading):
                    return reading
        return None


def _reads(source: ProfileSource, reading: Reading) -> bool:
    try:
        source.read(reading.columns, reading.units)
    except PointsError:
        return False
    return True


def _named(text: str, given: str) -> str | None:
    """The unit of a file with a header, None where it names none. Raises PointsError for one that we do not know,
    unless a unit is given.
    """
    unit = unit_named(text)
    if unit is None and text.strip() not in NO_UNIT and not given:
        raise PointsError(f"the unit {text.strip()[:40]!r} is unknown; give road.units, each of {ALLOWED_UNITS}")
    return unit


# Tables of text


@dataclass(frozen=True)
class TableSource:
    """A file with a table of text."""

    table: Table

    x_is_column = True

    @property
    def _names(self) -> list[str]:
        return [column.heading for column in self.table.columns]

    @property
    def columns(self) -> tuple[str, ...]:
        return _called(self._names)

    @property
    def labels(self) -> tuple[str, ...]:
        return _labels(self._names)

    @property
    def doubt(self) -> str:
        first, second = chosen(self.table, ())
        if not self._words_tell(first, second):
            return "No heading says which columns are distance and height"
        unnamed = [self.table.name(k) for k in (first, second) if heading_of(self.table.columns[k])[1] is None]
        return f"The heading of {' and of '.join(unnamed)[:200]} names no unit" if unnamed else ""

    def _words_tell(self, first: int, second: int) -> bool:
        """Whether a heading says that the one column is x, or the other height."""
        one, other = (words_of(self.table.columns[k]) for k in (first, second))
        return bool(one & ALONG or other & UP)

    @np.errstate(all="ignore")
    def read(self, columns: Sequence[str] = (), units: Sequence[str] = ()) -> ProfileFile:
        table = self.table
        first, second = chosen(table, columns)
        x, y, headed, (along, up) = self._points(first, second, numbers(table, first, second), units)
        named = "no unit named, read as m" if along is None and up is None else _units_text(along or "m", up or "m")
        named += _overruled(units, headed)
        known = words_of(table.columns[first]) & ALONG and words_of(table.columns[second]) & UP
        if len(table.columns) > 2 or columns or (table.headed and not known):
            named += f"; columns {table.name(first)} and {table.name(second)}"
        return _file(x, y, named, len(table.rows))

    def _points(
        self, first: int, second: int, values: Sequence[np.ndarray], units: Sequence[str]
    ) -> tuple[np.ndarray, np.ndarray, list[str | None], list[str | None]]:
        """x and y in m, the units that the headings name, and those that were taken. Raises PointsError.

        values: of the two columns, in the units of the file.
        """
        table = self.table
        headed = [_unit_headed(table.columns[c], _unit(units, k)) for k, c in enumerate((first, second))]
        along, up = (_unit(units, k) or headed[k] for k in range(2))
        _refuse_unclear_units(table, first, second, along, up)
        x, y = values[0] * UNITS[along or "m"], values[1] * UNITS[up or "m"]
        if up is None and (np.diff(x) > 0.0).all():
            _refuse_heights_that_look_like_no_metres(x, y)
        check(x, y, lambda row: f"line {table.lines[row]}")
        if _looks_like_one_column(table, x, y):
            raise PointsError(
                f"line {table.lines[0]}: {table.rows[0][:40]!r} looks like one column "
                "with a decimal comma; two are needed, x and height. If it is two, write x,y above them"
            )
        return x, y, headed, [along, up]

    @np.errstate(all="ignore")
    def likely(self) -> Reading | None:
        called = self.columns
        for first, second in self._likely_columns():
            try:
                values = numbers(self.table, first, second)
            except PointsError:
                continue
            for units in self._likely_units(first, second):
                with suppress(PointsError):
                    _, _, _, (along, up) = self._points(first, second, values, units)
                    return Reading((called[first], called[second]), (along or "m", up or "m"))
        return None

    def _likely_columns(self) -> list[tuple[int, int]]:
        """Pairs of columns that may be x and height, the likeliest first."""
        with suppress(PointsError):
            first, second = chosen(self.table, ())
            if self._words_tell(first, second):
                return [(first, second)]
            one = _looks_like_one_column(self.table, *numbers(self.table, first, second))  # in whatever unit
            return [] if one else [(first, second), (second, first)]
        words = [words_of(column) for column in self.table.columns[:TRIED]]
        values = {}
        for k in range(len(words)):
            try:
                (values[k],) = numbers(self.table, k)
            except PointsError:  # no column of numbers
                continue
        grows = {k for k, column in values.items() if (np.diff(column) > 0.0).all()}
        along = sorted(grows, key=lambda k: (not words[k] & ALONG, k))
        up = sorted(values, key=lambda k: (not words[k] & UP, k in grows, k))
        return [(first, second) for first in along for second in up if first != second][:TRIED]

    def _likely_units(self, first: int, second: int) -> list[tuple[str, str]]:
        """Units of x and height that may be meant, the likeliest first; empty: what the heading says, or m."""
        along, up = (_unit_in_doubt(self.table.columns[k]) for k in (first, second))
        remarked = _units_remarked(self.table.remarks)
        others_along, others_up = (
            list(dict.fromkeys((*remarked, *(IMPERIAL if neighbour in IMPERIAL else ()), *likely)))
            for neighbour, likely in ((up, LIKELY_ALONG), (along, LIKELY_UP))
        )
        unnamed = product([""] if along else ["", *others_along], [""] if up else ["", *others_up])
        contradicted = [*(("", unit) for unit in others_up), *((unit, "") for unit in others_along)]
        return [*unnamed, *contradicted]


def _unit_in_doubt(column: Column) -> str | None:
    """The unit that a heading names; None where it names none, or is not clear."""
    try:
        return heading_of(column)[1]
    except PointsError:
        return None


def _unit_headed(column: Column, given: str) -> str | None:
    """The unit that a heading names. Raises PointsError for a heading that is not clear, unless a unit is given."""
    try:
        return heading_of(column)[1]
    except PointsError:
        if given:
            return None
        raise


def _units_remarked(remarks: Iterable[str]) -> list[str]:
    """Units other than m that comments speak of."""
    words = (word for remark in remarks for word in re.findall(r"(?:\bin |units?:? |\[|\()\s*([a-z]+)", remark.lower()))
    return [unit for unit in map(unit_named, words) if unit not in (None, "m")]


def _refuse_unclear_units(table: Table, first: int, second: int, along: str | None, up: str | None) -> None:
    """Of a column without a unit beside one in ft or in, or below a comment that speaks of one."""
    for one, other, unnamed in ((along, up, second), (up, along, first)):
        if other is None and one in IMPERIAL:
            raise PointsError(f"{table.name(unnamed)!r} names no unit, its neighbour is in {one}; give road.units")
    if along is None and up is None:
        for remark in table.remarks:
            for unit in _units_remarked([remark]):
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


def _looks_like_one_column(table: Table, x: np.ndarray, y: np.ndarray) -> bool:
    """Rows like 100,2: two whole numbers, or one with a decimal comma? No heading says it, but two would be a cliff."""
    if table.headed or table.separator != "," or len(table.columns) != 2:
        return False
    if not all(row.replace(",", "").isdigit() for row in table.rows):
        return False
    return bool(np.abs(np.diff(y) / np.diff(x)).max() > 1.0)


# Words


def _file(x: np.ndarray, y: np.ndarray, how: str, rows: int) -> ProfileFile:
    said = f"{span_text(x, y)}; {how}"
    if rows > POINT_LIMIT:
        said += f"; only the first {POINT_LIMIT} of {rows} points are taken"
    if x[0] > STATIONED:
        said += "; its first point is a station, and is put 1 m ahead of the first wheel unless road.start is given"
    return ProfileFile(x, y, said)


def _units_text(along: str, up: str) -> str:
    return f"read as {along}" if along == up else f"x read as {along}, heights as {up}"


def _unit(units: Sequence[str], number: int) -> str:
    return units[number] if number < len(units) else ""


def _overruled(units: Sequence[str], named: Sequence[str | None]) -> str:
    """A word where `road.units` says something else than the file does."""
    pairs = [(what, _unit(units, k), named[k]) for k, what in enumerate(("x", "heights"))]
    others = [f"{what} in {said}" for what, given, said in pairs if given and said and given != said]
    return f" by road.units, though the file says {' and '.join(others)}" if others else ""
