"""Road profiles y = h(x), and the point of a profile nearest to a wheel's centre.

As model/MODEL.md says in "Terrain and contact geometry".

A road is a row of smooth pieces (model/road/profile.py), each a NumPy function with its first two derivatives. To add a
road type, write one function in shapes.py that returns its pieces and name it in PLACED there: contact, drawing and the
compiled kernel follow from the pieces. Frame: x = 0 is the chassis's centre of mass at t = 0, y = 0 the flat ground
before the road; m.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from model.config import config as configuration
from model.config.config import Config
from model.road import shapes
from model.road.nearest_point import RoadTable, nearest_points
from model.road.profile import Derivatives, Piece, Profile, uneven
from model.road.random_road import random_profile
from model.road.table import CELLS_PER_RADIUS, tabulate, tame_parts

__all__ = ["Derivatives", "Piece", "Profile", "Road", "build_road"]

RAMP_AHEAD = 1.0  # m from the first wheel to the default start of the road
OVERRUN = 1.1  # times the distance at the speed to be kept, and…
SPARE = 50.0  # … m: how far a run should come
STRETCH = 100.0  # m by which the reach grows, so that not every speed has a road of its own
FINEST = 0.01  # m between nodes of a wave that is part of a sum


@dataclass(frozen=True)
class Road:
    """A road under wheels of one radius."""

    profile: Profile
    radius: float  # of the wheels that touch it, m
    reach: float = np.inf  # m, as far as wheels come; behind, the table is level

    @cached_property
    def table(self) -> RoadTable:
        """The same profile as quintics, for the kernel."""
        rows = []
        pieces, period = self.profile
        for piece in pieces:
            within = int(np.searchsorted(piece.nodes, self.reach)) + 1
            if within == 1:
                break
            if within < len(piece.nodes):
                period = 0.0
            nodes = piece.nodes[:within]
            x = _cut(nodes, np.ceil(np.diff(nodes) * CELLS_PER_RADIUS / self.radius))
            row = (x, *piece.derivatives(x))
            parts = tame_parts(row, self.radius)
            if (parts > 1).any():
                x = _cut(x, parts)
                row = (x, *piece.derivatives(x))
            rows.append(row)
        if not rows:
            x = np.array([0.0, 1.0])
            rows, period = [(x, *self.derivatives(x))], 0.0
        return tabulate(rows, period, self.radius)

    @cached_property
    def uneven(self) -> tuple[float, float] | None:
        """x from where to where it is not level, m; None where it is level everywhere."""
        return uneven(self.profile)

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


def build_road(config: Config, reach: float = 0.0) -> Road:
    """The road of a configuration, under its wheels; contact as far as its run should come, and to `reach`, m."""
    wheels = config.vehicle.road_wheels
    distance = config.drive.speed_kmh / 3.6 * config.simulation.duration
    reach = max(reach, wheels.x[0] + OVERRUN * distance + SPARE)
    return _road(config.road, wheels.x[0], wheels.radius, float(np.ceil(reach / STRETCH) * STRETCH))


@lru_cache(maxsize=4)
def _road(road: configuration.Road, front_wheel: float, radius: float, reach: float) -> Road:
    """What most sliders leave as it is, and what run, drawing and figures of a configuration share."""
    return Road(profile_of(road, front_wheel, radius, reach), radius, reach)


def profile_of(road: configuration.Road, front_wheel: float, radius: float, reach: float) -> Profile:
    """The profile of a configuration's road; front_wheel: x of its centre at t = 0, m; reach: see Road."""
    ahead = front_wheel + RAMP_AHEAD
    match road:
        case configuration.SineRoad():
            return _sine(road, ahead if road.start is None else road.start)
        case configuration.RandomRoad():
            return _random(road, ahead, radius)
        case configuration.ProfileRoad():
            return _measured(road, ahead, radius)
        case configuration.SumRoad():
            return shapes.total([profile_of(part, front_wheel, radius, reach) for part in road.parts], reach, FINEST)
        case _:
            return shapes.PLACED[type(road)](road)


def profile_start(config: Config) -> float | None:
    """x of the first measured point of a road, m; None where the road has none."""
    return min((float(x[0]) for x in _measured_x(config)), default=None)


def profile_end(config: Config) -> float | None:
    """x of the last measured point of a road, m, behind which it is level; None where the road has none or goes on."""
    roads = config.road.parts if isinstance(config.road, configuration.SumRoad) else (config.road,)
    if any(isinstance(road, configuration.SineRoad | configuration.RandomRoad) for road in roads):
        return None
    return max((float(x[-1]) for x in _measured_x(config)), default=None)


def _measured_x(config: Config) -> list[np.ndarray]:
    """x (K,) of the points of each measured profile, m."""
    roads = config.road.parts if isinstance(config.road, configuration.SumRoad) else (config.road,)
    ahead = config.vehicle.road_wheels.x[0] + RAMP_AHEAD
    return [shapes.placed(road, ahead)[0] for road in roads if isinstance(road, configuration.ProfileRoad)]


# A slider of the vehicle leaves these as they are.
_sine = lru_cache(maxsize=4)(shapes.sine)
_random = lru_cache(maxsize=4)(random_profile)
_measured = lru_cache(maxsize=4)(shapes.measured)


def _cut(nodes: np.ndarray, parts: np.ndarray) -> np.ndarray:
    """The nodes (K,), with every gap cut into so many equal parts (K − 1,)."""
    count = np.maximum(parts, 1).astype(int)
    start, size = np.repeat(nodes[:-1], count), np.repeat(np.diff(nodes) / count, count)
    number = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)  # of the part in its gap
    return np.append(start + number * size, nodes[-1])
