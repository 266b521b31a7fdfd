"""The track around its wheels: the path of a belt, and points at even distances on it. Compiled: each frame needs both.

Points of the model's plane are complex, x + iy; m.
"""

from __future__ import annotations

import cmath

import numpy as np

from model.compiled import compiled

ARC = np.linspace(0.0, 1.0, 9)  # where the track's path has points along its arc around a wheel
SHARPEST_HOLLOW = 2.0  # rad: a belt that turns by more goes clockwise around a wheel


def track_path(centres: np.ndarray, radii: np.ndarray) -> np.ndarray:
    """The closed line (9 C,) of a belt around circles, clockwise; C centres (C,) in that order, radii (C,).

    The belt runs straight between neighbours and lies on a circle where it bends around it. Where it bends the other
    way (a wheel higher than its neighbours) it passes outside of that circle.
    """
    path = np.empty((len(centres), len(ARC)), dtype=complex)
    _lay(centres, radii, ARC, np.empty(len(centres), dtype=complex), path)
    return path.ravel()


def points_along(path: np.ndarray, at: int, beyond: float, count: int, part: float) -> np.ndarray:
    """Points (count + 1,) on a closed path (K,) at even distances, the last where the first is.

    The first lies `beyond` m, and that part of a distance, after the path's point number `at`.
    """
    points = np.empty(count + 1, dtype=complex)
    _walk(path, at, beyond, part, np.empty(len(path) + 1), points)
    return points


def warm_up() -> None:
    """Compile what is compiled here, or load it."""
    points_along(track_path(np.array([1 + 0j, 0j]), np.ones(2)), 0, 0.0, 1, 0.0)


@compiled
def _lay(centres: np.ndarray, radii: np.ndarray, arc: np.ndarray, leaving: np.ndarray, path: np.ndarray) -> None:
    """Fill path (C, len(arc)). leaving: (C,) of complex numbers to work with."""
    count = len(centres)
    for i in range(count):  # outward normals of the straight runs
        following = (i + 1) % count
        ahead = centres[following] - centres[i]
        distance = abs(ahead)
        sine = min(max((radii[i] - radii[following]) / distance, -1.0), 1.0)
        leaving[i] = ahead / distance * complex(sine, np.sqrt(1.0 - sine * sine))
    for i in range(count):
        entering = leaving[i - 1]
        bend = leaving[i] * entering.conjugate()
        turn = cmath.phase(bend)
        if turn > SHARPEST_HOLLOW:
            turn -= 2.0 * np.pi
        mitre = (entering + leaving[i]) / max(1.0 + bend.real, 0.1)
        for k in range(len(arc)):
            outward = mitre if turn > 0.0 else entering * cmath.rect(1.0, turn * arc[k])
            path[i, k] = centres[i] + radii[i] * outward


@compiled
def _walk(path: np.ndarray, at: int, beyond: float, part: float, along: np.ndarray, points: np.ndarray) -> None:
    """Fill points. along: (K + 1,) to work with."""
    corners, count = len(path), len(points) - 1
    along[0] = 0.0
    for k in range(corners):
        along[k + 1] = along[k] + abs(path[(k + 1) % corners] - path[k])
    length = along[corners]
    piece = 0
    for k in range(count + 1):
        there = (along[at] + beyond + (k + part) * length / count) % length
        if there < along[piece]:
            piece = 0
        while piece < corners - 1 and along[piece + 1] < there:
            piece += 1
        share = (there - along[piece]) / max(along[piece + 1] - along[piece], 1e-12)
        points[k] = path[piece] + share * (path[(piece + 1) % corners] - path[piece])
