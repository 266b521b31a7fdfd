"""The points of a measured profile: what makes a road, and their text in a configuration, "x y, x y, …" in m."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

import numpy as np

from model.config.parameters import STEEPEST, number_text

POINT_LIMIT = 200_001  # 10 km, every 5 cm
FILE_LIMIT = 20_000_000  # bytes of a file, and characters of a text
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


def points_count(count: int) -> str:
    """ "1 point", "2 points"."""
    return f"{count} point{'' if count == 1 else 's'}"


def span_text(x: np.ndarray, y: np.ndarray) -> str:
    """What points (K,) in m span, in words: "241 points, 0 to 60 m, heights −31 to 45 mm"."""
    unit, factor = height_unit(y)
    low, high = (f"{value:.4g}".replace("-", "\u2212") for value in (y.min() * factor + 0.0, y.max() * factor + 0.0))
    first, last = (number_text(round(float(value), 2) + 0.0).replace("-", "\u2212") for value in (x[0], x[-1]))
    return f"{points_count(len(x))}, {first} to {last} m, heights {low} to {high} {unit}"


def height_unit(y: np.ndarray) -> tuple[str, float]:
    """The unit in which people read heights (K,) in m, and how many of it are a metre."""
    return ("mm", 1e3) if np.abs(y).max() < 1.0 else ("m", 1.0)


def _checked(rows: list[str], name: Callable[[int], str]) -> tuple[np.ndarray, np.ndarray]:
    """x and y of rows of two numbers each; `name` says where a row, counted from 0, stands."""
    if not 2 <= len(rows) <= POINT_LIMIT:
        raise PointsError(f"{points_count(len(rows))}; give 2 to {POINT_LIMIT}, two numbers each: x and y in m")
    try:
        table = np.loadtxt(rows, comments=None, ndmin=2)
    except ValueError:
        table = np.empty((0, 0))
    if table.shape != (len(rows), 2):
        table = _one_by_one(rows, name)
    x, y = table.T.copy()
    check(x, y, name)
    x.setflags(write=False)
    y.setflags(write=False)
    return x, y


def check(x: np.ndarray, y: np.ndarray, name: Callable[[int], str]) -> None:
    """Raise PointsError for the first of the points (K,) in m that makes no road; `name` says where a row stands."""
    if not 2 <= len(x) <= POINT_LIMIT:
        raise PointsError(f"{points_count(len(x))}; give 2 to {POINT_LIMIT}")

    def refuse(bad: np.ndarray, message: str) -> None:
        if bad.any():
            raise PointsError(f"{name(int(np.argmax(bad)))}: {message}")

    refuse(~(np.abs(x) <= FURTHEST), f"x must be from -{number_text(FURTHEST)} to {number_text(FURTHEST)} m")
    refuse(~(np.abs(y) <= HIGHEST), f"y must be from -{number_text(HIGHEST)} to {number_text(HIGHEST)} m")
    gap = np.diff(x)
    if (gap < 0.0).all():
        raise PointsError("x falls all along, as it must grow from point to point: turn the order of the lines round")
    refuse(
        np.append(False, gap < 0.999 * NEAREST),
        f"x must grow from point to point, by {number_text(1e3 * NEAREST)} mm at least",
    )
    refuse(
        np.append(False, np.abs(np.diff(y)) > STEEPEST * gap),
        f"steeper than 85°, which no wheel climbs; let y change by less than {STEEPEST:.3g} times x's change",
    )


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
