"""The road of an endless drive: shapes joined one behind the other, each laid for as far as it is needed.

A shape may be any profile. One that repeats goes on without end. One that comes to an end comes again after a level
stretch, every second time backwards, so that it begins at the height where it left off.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise

import numpy as np

from model.road.nearest_point import RoadTable
from model.road.profile import distinct, rising, weighted
from model.road.road import Derivatives, Piece, Profile, Road
from model.road.table import SAME

BLEND = 3.0  # m over which a new shape takes the old one's place
GAP = 20.0  # m of level road until a road with an end comes again
MOVED = 0.1  # of the way between two comings: a place that is too near by less moves on a little
SMOOTH = (1e-9, 1e-4)  # jumps of h′ and, m⁻¹, of h″ that are none


@dataclass(frozen=True)
class Shape:
    """A road from `start` on, blended in; its own x is the drive's x + shift."""

    road: Road
    start: float
    shift: float

    @property
    def period(self) -> float:
        """m; 0: it has an end."""
        return self.road.profile.period

    @cached_property
    def first(self) -> float:
        """Its own x where it begins, m."""
        return float(self.road.profile.pieces[0].nodes[0])

    @cached_property
    def last(self) -> float:
        """Its own x where it ends, m."""
        return float(self.road.profile.pieces[-1].nodes[-1])

    @property
    def every(self) -> float:
        """m after which a road with an end comes again."""
        return self.last - self.first + GAP

    def derivatives(self, x: np.ndarray) -> Derivatives:
        """h, h′, h″ at x (K,) of the drive."""
        own = x + self.shift
        if self.period > 0.0:
            return self.road.derivatives(own)
        count, within = np.divmod(own - self.first, self.every)
        backwards = (count > 0) & (count % 2 == 1)
        again = np.where(backwards, self.last - within, self.first + within)
        h, h1, h2 = self.road.derivatives(np.where(count < 0, own, again))
        return h, np.where(backwards, -h1, h1), h2

    def pieces(self, low: float, high: float) -> list[np.ndarray]:
        """The nodes of its pieces between two x of the drive, of each piece as often as it comes."""
        profile, shift = self.road.profile, self.shift
        if self.period > 0.0:
            once = [_between(piece.nodes - shift, low, high) for piece in profile.pieces[:-1]]
            wave = profile.pieces[-1].nodes - shift
            return once + [_between(wave + k * self.period, low, high) for k in _comings(wave, self.period, low, high)]
        found = []
        for k in _comings(np.array([self.first, self.last]) - shift, self.every, low, high):
            for piece in profile.pieces:
                nodes = self.first + self.last - piece.nodes[::-1] if k % 2 else piece.nodes
                found.append(_between(nodes - shift + k * self.every, low, high))
        return found

    def weight(self, x: np.ndarray) -> Derivatives:
        """0 before the start, 1 from BLEND behind it on, with two continuous derivatives."""
        return rising((x - self.start) / BLEND, BLEND)

    def moved(self, by: float) -> Shape:
        """The same in a frame whose origin lies `by` further along, m."""
        return Shape(self.road, self.start - by, self.shift + by)


@dataclass(frozen=True)
class Shapes:
    """A road made of shapes, each of which takes the place of the one before."""

    row: tuple[Shape, ...]  # by rising start; the first has been there ever since

    @staticmethod
    def of(road: Road) -> Shapes:
        """One shape, where its configuration puts it."""
        return Shapes((Shape(road, -np.inf, 0.0),))

    def joined(self, road: Road, start: float, same_kind: bool) -> Shapes:
        """With another road from `start` on, where the waves are fully risen or the obstacle comes soon.

        A shape that was to begin there gives way. same_kind: where the new road can, it keeps to the places of the one
        before, so that what is seen ahead changes its shape and does not move away.
        """
        before = self.row[-1]
        new = Shape(road, start, 0.0)
        if new.period > 0.0:
            risen = float(road.profile.pieces[-1].nodes[0])
            own = start + before.shift if same_kind and new.period == before.period else risen
            own += new.period * np.ceil(max(risen - own, 0.0) / new.period)
            new = replace(new, shift=own - start)
        else:
            nearest, place = start + BLEND, start + BLEND
            if same_kind and before.period == 0.0:
                comings = (nearest + before.shift - before.first) / before.every
                coming = max(np.ceil(comings - MOVED), 0.0)
                place = new.first - before.shift + coming * before.every
            new = replace(new, shift=new.first - float(np.clip(place, nearest, nearest + GAP)))
        return Shapes((*(shape for shape in self.row if shape.start < start), new))

    def seen_from(self, low: float) -> Shapes:
        """Without those that are no part of the road from `low` on."""
        covered = sum(shape.start + BLEND <= low for shape in self.row[1:])
        return Shapes(self.row[covered:]) if covered else self

    def moved(self, by: float) -> Shapes:
        """The same in a frame whose origin lies `by` further along, m."""
        return Shapes(tuple(shape.moved(by) for shape in self.row))

    def derivatives(self, x: np.ndarray) -> Derivatives:
        """h, h′, h″ at x (K,). Each shape is asked only where it weighs."""
        h, h1, h2 = np.zeros(x.shape), np.zeros(x.shape), np.zeros(x.shape)
        for shape, until in zip(self.row, self._untils(), strict=True):
            here = (x >= shape.start) & (x < until)
            if not here.any():
                continue
            own, at = x[here], np.flatnonzero(here)
            old = h[at], h1[at], h2[at]
            g, g1, g2 = (new - before for new, before in zip(shape.derivatives(own), old, strict=True))
            added = weighted(shape.weight(own), (g, g1, g2))
            h[at], h1[at], h2[at] = (before + more for before, more in zip(old, added, strict=True))
        return h, h1, h2

    def laid(self, low: float, high: float) -> Profile:
        """The stretch between two x as one profile, in pieces wherever slope or curvature jumps; level beyond."""
        nodes, ends = [np.array([low, high])], [np.zeros(0)]
        for shape, until in zip(self.row, self._untils(), strict=True):
            first, last = max(low, shape.start), min(high, until)
            if first < last:
                pieces = shape.pieces(first, last)
                blend = np.array([shape.start, shape.start + BLEND])
                nodes += [*pieces, _between(blend, first, last)]
                ends += [piece[[0, -1]] for piece in pieces if len(piece)]
        x = distinct(np.concatenate(nodes))
        breaks = distinct(np.concatenate(ends))
        breaks = breaks[(breaks > low + SAME) & (breaks < high - SAME)]
        sides = self._aside(np.tile(breaks, 2), np.repeat([-SAME, SAME], len(breaks)))
        slope_jump, bend_jump = (np.abs(np.diff(part.reshape(2, -1), axis=0)[0]) for part in sides[1:])
        rough = (slope_jump > SMOOTH[0]) | (bend_jump > SMOOTH[1])
        cuts = np.searchsorted(x, breaks[rough] - SAME)
        return Profile([self._piece(x[i : k + 1]) for i, k in pairwise(np.unique([0, *cuts, len(x) - 1]))])

    def to_see(self, low: float, high: float) -> Profile:
        """The stretch between two x, exact, but in no pieces that could be laid."""
        return Profile([Piece(np.array([low, high]), self.derivatives)])

    def _untils(self) -> list[float]:
        """Where each shape ceases to weigh."""
        return [following.start + BLEND for following in self.row[1:]] + [np.inf]

    def _piece(self, nodes: np.ndarray) -> Piece:
        """A smooth piece: at its ends, the derivatives just inside."""
        first, last = nodes[0] + SAME, nodes[-1] - SAME
        return Piece(nodes, lambda x: self._aside(x, np.clip(x, first, last) - x))

    def _aside(self, x: np.ndarray, step: np.ndarray) -> Derivatives:
        """h, h′, h″ at x as the road `step` away continues there."""
        h, h1, h2 = self.derivatives(x + step)
        return h - step * (h1 - step * h2 / 2), h1 - step * h2, h2


@dataclass(frozen=True)
class LaidRoad(Road):
    """A long stretch of road to be seen, of which a short one is laid for wheels to touch."""

    near: Profile = field(kw_only=True)

    @cached_property
    def table(self) -> RoadTable:
        """The short stretch as quintics, for the kernel."""
        return Road(self.near, self.radius).table


def _between(x: np.ndarray, low: float, high: float) -> np.ndarray:
    """Those of the rising x that lie between."""
    first, last = np.searchsorted(x, [low, high])
    return x[first:last]


def _comings(nodes: np.ndarray, every: float, low: float, high: float) -> range:
    """0, 1, …: which repetitions of nodes lie between two x, in part at least."""
    first, last = np.floor((low - nodes[-1]) / every), np.ceil((high - nodes[0]) / every)
    return range(max(int(first), 0), max(int(last), 0) + 1)
