"""A measured profile as text: points "x y, x y, …" of a configuration, or the rows of a CSV file. m."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

import numpy as np

from model.config.parameters import STEEPEST, number_text

POINT_LIMIT = 200_001  # 10 km, every 5 cm
FILE_LIMIT = 20_000_000  # bytes of a CSV file, and characters of a text
FURTHEST = 1e6  # m, of a point from the origin: stations are counted from afar
STATIONED = 1000.0  # m: a profile whose first point lies beyond begins at a station, and is put ahead of the vehicle
HIGHEST = 10_000.0  # m, of a point above or below it: a survey's heights
NEAREST = 0.001  # m between two points


class PointsError(ValueError):
    """Points that make no road; the message says where, what is wrong and what is allowed."""


@lru_cache(maxsize=8)
def points(text: str) -> tuple[np.ndarray, np.ndarray]:
    """x and y (K,) of a configuration's text, not to be changed; the same again costs nothing. Raises PointsError."""
    if len(text) > FILE_LIMIT:
        raise PointsError(f"more than {FILE_LIMIT} characters")
    return _checked(text.split(","), lambda row: f"point {row + 1}")


def points_text(x: np.ndarray, y: np.ndarray) -> str:
    """The text of a configuration for these points, which reads back as the same numbers."""
    return ", ".join(f"{a!r} {b!r}" for a, b in zip(x.tolist(), y.tolist(), strict=True))


def read_csv(data: bytes) -> str:
    """The text of a configuration for a file of two columns, x and y in m, with or without a line of headings.

    Columns end in a comma, a semicolon, a tab or blanks; beside semicolons or tabs, a comma is a decimal point.
    Raises PointsError.
    """
    if len(data) > FILE_LIMIT:
        raise PointsError(f"the file is larger than {FILE_LIMIT} bytes")
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise PointsError("the file is not UTF-8 text") from None
    text = text.replace("\r\n", "\n").replace("\r", "\n")
    text = text.replace(",", "." if ";" in text or "\t" in text else " ").replace(";", " ")
    lines = text.split("\n")
    number = [k for k, line in enumerate(lines, 1) if line and not line.isspace()]
    if number and lines[number[0] - 1].lstrip()[0] not in "+-.0123456789":
        del number[0]  # headings
    return points_text(*_checked([lines[k - 1] for k in number], lambda row: f"line {number[row]}"))


def _checked(rows: list[str], name: Callable[[int], str]) -> tuple[np.ndarray, np.ndarray]:
    """x and y of rows of two numbers each; `name` says where a row, counted from 0, stands."""
    if not 2 <= len(rows) <= POINT_LIMIT:
        raise PointsError(f"{len(rows)} points; give 2 to {POINT_LIMIT}, two numbers each: x and y in m")
    try:
        table = np.loadtxt(rows, comments=None, ndmin=2)
    except ValueError:
        table = np.empty((0, 0))
    if table.shape != (len(rows), 2):
        table = _one_by_one(rows, name)
    x, y = table.T.copy()

    def refuse(bad: np.ndarray, message: str) -> None:
        if bad.any():
            raise PointsError(f"{name(int(np.argmax(bad)))}: {message}")

    refuse(~(np.abs(x) <= FURTHEST), f"x must be from -{number_text(FURTHEST)} to {number_text(FURTHEST)} m")
    refuse(~(np.abs(y) <= HIGHEST), f"y must be from -{number_text(HIGHEST)} to {number_text(HIGHEST)} m")
    gap = np.diff(x)
    refuse(
        np.append(False, gap < 0.999 * NEAREST),
        f"x must grow from point to point, by {number_text(1e3 * NEAREST)} mm at least",
    )
    refuse(
        np.append(False, np.abs(np.diff(y)) > STEEPEST * gap),
        f"steeper than 85°, which no wheel climbs; let y change by less than {STEEPEST:.3g} times x's change",
    )
    x.setflags(write=False)
    y.setflags(write=False)
    return x, y


def _one_by_one(rows: list[str], name: Callable[[int], str]) -> np.ndarray:
    """The table (K, 2) of rows among which some are wrong. Raises PointsError for the first of these."""
    table = np.empty((len(rows), 2))
    for k, row in enumerate(rows):
        words = row.split()
        if len(words) != 2:
            raise PointsError(f"{name(k)}: {len(words)} numbers; give two, x and y in m")
        for column, word in enumerate(words):
            try:
                table[k, column] = float(word)
            except ValueError:
                raise PointsError(f"{name(k)}: {word[:40]!r} is no number; give x and y in m") from None
    return table
