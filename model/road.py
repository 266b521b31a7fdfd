"""Road profiles y = h(x), and the point of a profile nearest to a wheel's centre (model.md, "Terrain").

A road is a row of smooth pieces, each a NumPy function with its first two derivatives. To add a road type, write one
function that returns its pieces and name it in PROFILES: contact, drawing and the compiled kernel follow from the
pieces. Frame: x = 0 is the chassis's centre of mass at t = 0, y = 0 the flat ground before the road; m.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from model import config as configuration
from model.config import Config
from model.road_table import CELLS_PER_RADIUS, RoadTable, nearest_points, tabulate

Derivatives = tuple[np.ndarray, np.ndarray, np.ndarray]
RAMP_AHEAD = 1.0  # m from the first wheel to the default start of the road
CELLS_PER_WAVE = 128  # a quintic of this length misses a sine by 1e-13 of its amplitude


class Piece(NamedTuple):
    """A smooth stretch of road: from nodes[0] to nodes[-1], smooth enough between nodes for one quintic each."""

    nodes: np.ndarray  # (K,) rising x, m
    derivatives: Callable[[np.ndarray], Derivatives]  # x -> h, h′, h″


class Profile(NamedTuple):
    """Adjoining pieces; before the first and, unless it repeats, behind the last, the road is level."""

    pieces: list[Piece]
    period: float = 0.0  # m, by which the last piece repeats; 0: it does not


@dataclass(frozen=True)
class Road:
    """A road under wheels of one radius."""

    profile: Profile
    radius: float  # of the wheels that touch it, m

    @cached_property
    def table(self) -> RoadTable:
        """The same profile as quintics, for the kernel."""
        rows = []
        for piece in self.profile.pieces:
            x = _refined(piece.nodes, self.radius / CELLS_PER_RADIUS)
            rows.append((x, *piece.derivatives(x)))
        return tabulate(rows, self.profile.period, self.radius)

    def derivatives(self, x: np.ndarray) -> Derivatives:
        """h, h′, h″ at x (any shape), exact; at a corner, those of the piece ahead."""
        x = np.asarray(x, dtype=float)
        pieces, period = self.profile
        last = pieces[-1].nodes
        if period > 0.0:
            x = np.where(x > last[0], last[0] + np.mod(x - last[0], period), x)
        h, h1, h2 = np.zeros(x.shape), np.zeros(x.shape), np.zeros(x.shape)
        h[x < pieces[0].nodes[0]] = pieces[0].derivatives(pieces[0].nodes[:1])[0][0]
        h[x >= last[-1]] = pieces[-1].derivatives(last[-1:])[0][0]
        for piece in pieces:
            here = (x >= piece.nodes[0]) & (x < piece.nodes[-1])
            h[here], h1[here], h2[here] = piece.derivatives(x[here])
        return h, h1, h2

    def height(self, x: np.ndarray) -> np.ndarray:
        """h(x), m."""
        return self.derivatives(x)[0]

    def nearest(self, centres: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Contact geometry of wheel centres (K, 2): nearest points (K, 2), normals n (K, 2), distances d (K,), m.

        Points are sought within one and a half radii; d is negative and n turned round for a centre below the road.
        """
        return nearest_points(self.table, np.ascontiguousarray(centres, dtype=float))


def build_road(config: Config) -> Road:
    """The road of a configuration, under its wheels."""
    wheels = config.vehicle.road_wheels
    return Road(PROFILES[config.road.type](config.road, wheels.x[0]), wheels.radius)


def _refined(nodes: np.ndarray, longest: float) -> np.ndarray:
    """The nodes, with every gap cut into equal parts no longer than asked."""
    gap = np.diff(nodes)
    parts = np.maximum(1, np.ceil(gap / longest).astype(int))
    start, size = np.repeat(nodes[:-1], parts), np.repeat(gap / parts, parts)
    number = np.arange(parts.sum()) - np.repeat(np.cumsum(parts) - parts, parts)  # of the part in its gap
    return np.append(start + number * size, nodes[-1])


def _flat(road: configuration.FlatRoad, front_wheel: float) -> Profile:
    return Profile([Piece(np.array([0.0, 1.0]), lambda x: (0 * x, 0 * x, 0 * x))])


def _sine(road: configuration.SineRoad, front_wheel: float) -> Profile:
    """h = A w sin(2π (x − x_s)/λ); w rises from 0 to 1 over the ramp ℓ."""
    x_s = front_wheel + RAMP_AHEAD if road.start is None else road.start
    ramp = road.wavelength if road.ramp is None else road.ramp
    A, k = road.amplitude, 2 * np.pi / road.wavelength

    def sine(x: np.ndarray) -> Derivatives:
        angle = k * (x - x_s)
        return A * np.sin(angle), A * k * np.cos(angle), -A * k**2 * np.sin(angle)

    def risen(x: np.ndarray) -> Derivatives:
        u = (x - x_s) / ramp
        w, w1, w2 = u**2 * (3 - 2 * u), 6 * u * (1 - u) / ramp, (6 - 12 * u) / ramp**2
        h, h1, h2 = sine(x)
        return w * h, w * h1 + w1 * h, w * h2 + 2 * w1 * h1 + w2 * h

    wave = x_s + ramp + np.linspace(0.0, road.wavelength, CELLS_PER_WAVE + 1)
    steady = Piece(wave, sine)
    if ramp == 0.0:
        return Profile([steady], road.wavelength)
    cells = CELLS_PER_WAVE * max(1, int(np.ceil(ramp / road.wavelength)))
    return Profile([Piece(x_s + np.linspace(0.0, ramp, cells + 1), risen), steady], road.wavelength)


def _half_round(road: configuration.HalfRoundRoad, front_wheel: float) -> Profile:
    """The part above ground of a circle; the last 5° of a foot that would stand upright run straight."""
    R, top = road.radius, road.height
    half_angle = np.arccos((R - top) / R)
    steepest = min(half_angle, np.radians(85.0))
    x_arc, y_arc = R * np.sin(steepest), R * np.cos(steepest) - (R - top)

    def arc(x: np.ndarray) -> Derivatives:
        u = x - road.position
        y = np.sqrt(R**2 - u**2)
        return y - (R - top), -u / y, -(R**2) / y**3

    cells = max(16, int(np.ceil(np.degrees(2 * steepest) / 0.25)))
    pieces = [Piece(road.position + R * np.sin(np.linspace(-steepest, steepest, cells + 1)), arc)]
    if steepest < half_angle:
        slope = np.tan(steepest)
        foot = y_arc / slope

        def flank(sign: float) -> Callable[[np.ndarray], Derivatives]:
            edge = road.position + sign * x_arc
            return lambda x: (y_arc - sign * slope * (x - edge), np.full(x.shape, -sign * slope), 0 * x)

        left, right = road.position - x_arc, road.position + x_arc
        pieces = [
            Piece(np.array([left - foot, left]), flank(-1.0)),
            *pieces,
            Piece(np.array([right, right + foot]), flank(1.0)),
        ]
    return Profile(pieces)


PROFILES: dict[str, Callable[..., Profile]] = {"flat": _flat, "sine": _sine, "half_round": _half_round}
