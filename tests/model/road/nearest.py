"""The judge of contact: the nearest point of a road by brute force, and wheels to judge it at."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from model.road.road import Road


def brute_force(road: Road, centre: np.ndarray) -> float:
    """Distance from a centre to the profile: every dip of a fine sampling polished by itself."""
    X, Y = centre

    def D(s: float) -> float:
        return float((s - X) ** 2 + (road.height(np.array([s]))[0] - Y) ** 2)

    ends = np.concatenate([piece.nodes[[0, -1]] for piece in road.profile.pieces])  # maybe corners
    s = np.union1d(X + np.linspace(-1.5, 1.5, 6001) * road.radius, ends[np.abs(ends - X) < 1.5 * road.radius])
    values = (s - X) ** 2 + (road.height(s) - Y) ** 2
    inner = values[1:-1]
    dips = 1 + np.flatnonzero((inner <= values[:-2]) & (inner <= values[2:]))
    dips = dips[values[dips] <= values.min() + 1e-3 * road.radius**2]
    found = [
        minimize_scalar(D, bounds=(s[k - 1], s[k + 1]), method="bounded", options={"xatol": 1e-12}).fun for k in dips
    ]
    return float(np.sqrt(min([*found, values.min()])))


def centres_near(road: Road, rng: np.random.Generator, x: np.ndarray) -> np.ndarray:
    """Wheel centres above these x, resting a little sunk in or not quite, some deep in the ground: (K, 2)."""
    depth = road.radius * rng.choice([rng.uniform(-0.1, 0.1), 0.02, rng.uniform(0.1, 0.7)], len(x))
    return np.column_stack([x, resting_height(road, x, depth)])


def resting_height(road: Road, x: np.ndarray, depth: np.ndarray) -> np.ndarray:
    """How high the centre is of a wheel that has sunk in by these depths: the lowest that keeps r − depth away."""
    away = (road.radius - depth)[:, None]
    u = np.linspace(-1.0, 1.0, 2001) * away
    return (road.height(x[:, None] + u) + np.sqrt(away**2 - u**2)).max(axis=1)


def assert_nearest(road: Road, centres: np.ndarray, tolerance: float = 1e-10) -> None:
    """The road's answer is a point of the road, as far away as brute force finds, and n points from it to P."""
    points, normals, distances = road.nearest(centres)
    for P, point, n, d in zip(centres, points, normals, distances, strict=True):
        right = brute_force(road, P)
        if np.isinf(d):
            assert right >= road.radius - tolerance
            continue
        assert abs(d) == pytest.approx(np.hypot(*(P - point)), abs=1e-12)
        assert point[1] == pytest.approx(road.height(point[:1])[0], abs=tolerance)
        np.testing.assert_allclose(point + d * n, P, atol=1e-12)
        assert np.hypot(*n) == pytest.approx(1.0, abs=1e-12)
        if right < road.radius:
            assert abs(d) == pytest.approx(right, abs=tolerance)
            assert (d < 0.0) == (P[1] < road.height(P[:1])[0])
        else:  # only that it does not touch matters
            assert d >= road.radius - tolerance
