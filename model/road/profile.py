"""What a road is made of: smooth pieces, level stretches before and behind. Frame as in model/road/road.py, m."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from model.road.table import SAME, quintics

LEVEL = 1e-9  # of heights, m, slopes and curvatures, 1/m: smaller ones are none

Derivatives = tuple[np.ndarray, np.ndarray, np.ndarray]


class Piece(NamedTuple):
    """A smooth stretch of road: from nodes[0] to nodes[-1], smooth enough between nodes for one quintic each."""

    nodes: np.ndarray  # (K,) rising x, m
    derivatives: Callable[[np.ndarray], Derivatives]  # x -> h, h′, h″


class Profile(NamedTuple):
    """Adjoining pieces; before the first and, unless it repeats, behind the last, the road is level."""

    pieces: list[Piece]
    period: float = 0.0  # m, by which the last piece repeats, joining itself smoothly; 0: it does not


def uneven(profile: Profile) -> tuple[float, float] | None:
    """x from where to where a profile's pieces are not level, m; None where they are all level at one height."""
    found: list[float] = []
    height = None
    for piece in profile.pieces:
        h, h1, h2 = piece.derivatives(piece.nodes)
        if height is not None and abs(h[0] - height) > LEVEL:
            found.append(float(piece.nodes[0]))
        bare = (np.abs(h1) < LEVEL) & (np.abs(h2) < LEVEL)
        rough = np.flatnonzero(~(bare[:-1] & bare[1:] & (np.abs(np.diff(h)) < LEVEL)))
        if len(rough):
            found += [float(piece.nodes[rough[0]]), float(piece.nodes[rough[-1] + 1])]
        height = h[-1]
    return (min(found), max(found)) if found else None


def level(low: float, high: float, height: float = 0.0) -> Piece:
    """A level piece."""
    return Piece(np.array([low, high]), lambda x: (np.full(x.shape, height), 0 * x, 0 * x))


def ramp(low: float, high: float, start: float, end: float) -> Piece:
    """A straight piece from height `start` to height `end`."""
    slope = (end - start) / (high - low)
    return Piece(np.array([low, high]), lambda x: (start + slope * (x - low), np.full(x.shape, slope), 0 * x))


def spline(nodes: np.ndarray, h: np.ndarray, h1: np.ndarray, h2: np.ndarray) -> Piece:
    """Quintics through heights, slopes and curvatures (K,) at nodes (K,): the road itself, not near it."""
    coefficients = quintics(np.diff(nodes), (h, h1, h2))

    def derivatives(x: np.ndarray) -> Derivatives:
        cell = np.clip(np.searchsorted(nodes, x, side="right") - 1, 0, len(nodes) - 2)
        u, c = x - nodes[cell], np.moveaxis(coefficients[cell], -1, 0)
        return (
            c[0] + u * (c[1] + u * (c[2] + u * (c[3] + u * (c[4] + u * c[5])))),
            c[1] + u * (2 * c[2] + u * (3 * c[3] + u * (4 * c[4] + u * (5 * c[5])))),
            2 * c[2] + u * (6 * c[3] + u * (12 * c[4] + u * (20 * c[5]))),
        )

    return Piece(nodes, derivatives)


def rising(u: np.ndarray, length: float) -> Derivatives:
    """A weight that grows from 0 at u = 0 to 1 at u = 1 with two continuous derivatives, and these per m.

    length: of the stretch that u runs over, m. Beyond its ends the weight stays.
    """
    u = np.clip(u, 0.0, 1.0)
    return (
        u**3 * (10 - 15 * u + 6 * u**2),
        30 * u**2 * (1 - u) ** 2 / length,
        60 * u * (1 - u) * (1 - 2 * u) / length**2,
    )


def weighted(w: Derivatives, h: Derivatives) -> Derivatives:
    """The product of a weight and a height, with its derivatives."""
    return w[0] * h[0], w[0] * h[1] + w[1] * h[0], w[0] * h[2] + 2 * w[1] * h[1] + w[2] * h[0]


def distinct(x: np.ndarray) -> np.ndarray:
    """Rising, without those that are the same."""
    x = np.unique(x)
    return x[np.append(True, np.diff(x) > SAME)] if len(x) else x
