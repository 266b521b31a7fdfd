"""The roads that follow a formula or points, as pieces; model/road/random_road.py has the random ones.

Corners (the foot of a half-round, a step's edges, a trapezoid's) are where one piece ends and the next begins with
another slope. A wheel rolls over a corner that stands out and bridges one that is hollow, where it can touch two faces
at once: of these the nearer counts, so that its load passes from one face to the other within a step or two. A face
that is asked to be steeper than 85° runs at 85°: a step is a short ramp.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np

from model.config import config as configuration
from model.config.parameters import STEEPEST
from model.config.profile_points import STATIONED, points
from model.road.profile import Derivatives, Piece, Profile, distinct, level, ramp, spline, weighted
from model.road.table import SAME
from model.road.thinning import thinned

SHORTEST_RAMP = 1e-4  # m: over less, waves grow at once
DENSE = 0.3  # m between measured points that are samples of a curve, at most
SHARP = 0.5  # change of slope that is an edge, however dense the points are
ROUNDED = 0.05  # m on either side of a measured corner over which it is rounded, at most …
MISSED = 0.001  # m: … and so that the road misses the corner by no more
CELLS_PER_WAVE = 128  # a quintic of this length misses a sine by 1e-13 of its amplitude


def flat(road: configuration.FlatRoad | None = None) -> Profile:
    return Profile([level(0.0, 1.0)])


def sine(road: configuration.SineRoad, x_s: float) -> Profile:
    """h = A w sin(2π (x − x_s)/λ); w rises from 0 to 1 over the ramp ℓ."""
    rise = road.wavelength if road.ramp is None else road.ramp
    rise = rise if rise > SHORTEST_RAMP else 0.0
    A, k = road.amplitude, 2 * np.pi / road.wavelength

    def wave(x: np.ndarray) -> Derivatives:
        angle = k * (x - x_s)
        return A * np.sin(angle), A * k * np.cos(angle), -A * k**2 * np.sin(angle)

    def risen(x: np.ndarray) -> Derivatives:
        u = (x - x_s) / rise
        w = u**2 * (3 - 2 * u), 6 * u * (1 - u) / rise, (6 - 12 * u) / rise**2
        return weighted(w, wave(x))

    steady = Piece(x_s + rise + np.linspace(0.0, road.wavelength, CELLS_PER_WAVE + 1), wave)
    if rise == 0.0:
        return Profile([steady], road.wavelength)
    cells = CELLS_PER_WAVE * max(1, int(np.ceil(rise / road.wavelength)))
    return Profile([Piece(x_s + np.linspace(0.0, rise, cells + 1), risen), steady], road.wavelength)


def half_round(road: configuration.HalfRoundRoad) -> Profile:
    """The part above ground of a circle; the last 5° of a foot that would stand upright run straight."""
    R, top = road.radius, road.height
    half_angle = np.arccos((R - top) / R)
    steepest = min(half_angle, np.arctan(STEEPEST))
    x_arc, y_arc = R * np.sin(steepest), R * np.cos(steepest) - (R - top)

    def arc(x: np.ndarray) -> Derivatives:
        u = x - road.position
        y = np.sqrt(R**2 - u**2)
        return y - (R - top), -u / y, -(R**2) / y**3

    cells = max(16, int(np.ceil(np.degrees(2 * steepest) / 0.25)))
    round_part = Piece(road.position + R * np.sin(np.linspace(-steepest, steepest, cells + 1)), arc)
    if steepest == half_angle:
        return Profile([round_part])
    foot, left, right = y_arc / STEEPEST, road.position - x_arc, road.position + x_arc
    return Profile([ramp(left - foot, left, 0.0, y_arc), round_part, ramp(right, right + foot, y_arc, 0.0)])


def trapezoid(road: configuration.TrapezoidRoad) -> Profile:
    """Two straight faces and a level top, its middle at the position."""
    top = road.top / 2
    base = max(road.base / 2, top + road.height / STEEPEST)
    return Profile(
        [
            ramp(road.position - base, road.position - top, 0.0, road.height),
            level(road.position - top, road.position + top, road.height),
            ramp(road.position + top, road.position + base, road.height, 0.0),
        ]
    )


def step(road: configuration.StepRoad) -> Profile:
    """A ramp from the ground, its foot at the position, to a level that goes on."""
    length = max(road.ramp or 0.0, road.height / STEEPEST)
    return Profile([ramp(road.position, road.position + length, 0.0, road.height)])


# Roads that stand where their configuration puts them, whatever the vehicle
PLACED: dict[type, Callable[[Any], Profile]] = {
    configuration.FlatRoad: flat,
    configuration.HalfRoundRoad: half_round,
    configuration.TrapezoidRoad: trapezoid,
    configuration.StepRoad: step,
}


def measured(road: configuration.ProfileRoad, ahead: float, radius: float) -> Profile:
    """A line through the points: before the first at ground level, behind the last one level.

    ahead: where a profile begins that its stations put far away, m; radius: of the wheels, m.

    Points are of two sorts. Where a point, both its neighbours and theirs lie within DENSE of each other, and the line
    turns there by less than SHARP, it is a sample of a curve: road profilers take one every 0.25 m or closer. Any other
    is a corner that somebody gave, or an edge: straight lines lead to it and on. Slope and curvature are continuous.

    A corner between lines of slopes s₁, s₂ is rounded within r on either side: there h is the quintic that joins the
    lines, its slope goes from s₁ to s₂ and nowhere beyond. It misses the point by 3/16 |s₂ − s₁| r; r is at most
    ROUNDED and half of either line, and keeps that below MISSED.

    Through samples runs a curve that stays within the heights of neighbours, where a cubic spline would swing. Slopes
    are those of PCHIP (Fritsch and Butland: the weighted harmonic mean of the slopes to both neighbours, level at a
    crest), at most twice the gentler of the two; curvatures are those of the cubics with these slopes on either side,
    the smaller of the two where they bend the same way, else none.
    """
    x, y = thinned(*placed(road, ahead), radius)
    gap = np.diff(x)
    rise = np.concatenate([[0.0], np.diff(y) / gap, [0.0]])
    turn = np.abs(np.diff(rise))
    near = np.concatenate([[False, False], gap <= DENSE, [False, False]])
    curved = near[:-3] & near[1:-2] & near[2:-1] & near[3:] & (turn < SHARP)

    half = np.concatenate([[np.inf], gap / 2, [np.inf]])
    r = np.minimum(np.minimum(half[:-1], half[1:]), ROUNDED)
    r = np.where(curved, 0.0, np.minimum(r, MISSED / (3 / 16) / np.maximum(turn, 1e-9)))
    slope, bend = _curve(gap, rise[1:-1])
    before = np.where(curved, slope, rise[:-1])
    behind = np.where(curved, slope, rise[1:])
    bend = np.where(curved, bend, 0.0)
    nodes = np.column_stack([x - r, x + r]).ravel()
    h = np.column_stack([y - before * r, y + behind * r]).ravel()
    h1, h2 = np.column_stack([before, behind]).ravel(), np.repeat(bend, 2)
    keep = np.append(True, np.diff(nodes) > SAME)  # a sample is one node, and so is where two roundings meet
    return Profile([spline(nodes[keep], h[keep], h1[keep], h2[keep])])


def _curve(gap: np.ndarray, rise: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Slope and curvature, 1/m, (K,) at points that lie `gap` (K − 1,) apart, m, with slopes `rise` between them."""
    before, ahead = rise[:-1], rise[1:]
    same = before * ahead > 0.0
    share = (gap[:-1] + 2 * gap[1:]) / (3 * (gap[:-1] + gap[1:]))  # of the slope behind a point
    mean = before * ahead / np.where(same, share * ahead + (1 - share) * before, 1.0)
    gentler = np.minimum(np.abs(before), np.abs(ahead))
    slope = np.zeros(len(gap) + 1)
    slope[1:-1] = np.where(same, np.sign(before) * np.minimum(np.abs(mean), 2 * gentler), 0.0)
    into = (2 * slope[:-1] + 4 * slope[1:] - 6 * rise)[:-1] / gap[:-1]  # the cubics' curvatures at inner points
    out = (6 * rise - 4 * slope[:-1] - 2 * slope[1:])[1:] / gap[1:]
    bend = np.zeros(len(gap) + 1)
    bend[1:-1] = np.where(into * out > 0.0, np.sign(into) * np.minimum(np.abs(into), np.abs(out)), 0.0)
    return slope, bend


def placed(road: configuration.ProfileRoad, ahead: float) -> tuple[np.ndarray, np.ndarray]:
    """x and y (K,) of a profile's points on the road, m: where they say, or moved so that the first lies at the start.

    A first point beyond STATIONED is a station of a survey: it is put `ahead`.
    """
    x, y = points(road.points)
    start = ahead if road.start is None and x[0] > STATIONED else road.start
    return (x, y) if start is None else (x - x[0] + start, y - y[0])


def total(profiles: list[Profile], reach: float, finest: float) -> Profile:
    """The sum of profiles: without end if just one of them repeats, else as far as `reach` and level behind.

    finest: nodes of a repeating part that are closer than this are thinned out, m.
    """
    if not profiles:
        return flat()
    last = float(max(profile.pieces[-1].nodes[-1 if profile.period == 0.0 else 0] for profile in profiles))
    periods = [profile.period for profile in profiles if profile.period > 0.0]
    period = periods[0] if len(periods) == 1 else 0.0
    if period == 0.0 and periods:
        last = max(last + 1.0, reach)
    lines = [_line(profile, last + period, finest) for profile in profiles]
    ends = [piece.nodes[[0, -1]] for line in lines for piece in line]
    splits = distinct(np.concatenate([[last, last + period], *ends]))
    return Profile([_sum_of(lines, a, b) for a, b in pairwise(splits)], period)


def _line(profile: Profile, end: float, finest: float) -> list[Piece]:
    """The pieces of a profile up to `end`, repetitions as one piece."""
    pieces, period = profile
    last = pieces[-1]
    if period == 0.0:
        return pieces
    start = last.nodes[0]
    keep = np.append(True, np.diff(np.floor((last.nodes - start) / finest + 1e-9)) > 0)
    once = last.nodes[keep][:-1] if keep[-1] else last.nodes[keep]
    count = int(np.ceil((end - start) / period - 1e-9))
    nodes = (once + period * np.arange(count)[:, None]).ravel()
    nodes = np.append(nodes[nodes < end - 1e-9], end)
    return [*pieces[:-1], Piece(nodes, lambda x: last.derivatives(start + np.mod(x - start, period)))]


def _sum_of(lines: list[list[Piece]], low: float, high: float) -> Piece:
    """The sum of several lines between two neighbouring splits."""
    middle = (low + high) / 2
    parts: list[Piece] = []
    for line in lines:
        if middle < line[0].nodes[0]:
            parts.append(_held(line[0], 0))
        elif middle > line[-1].nodes[-1]:
            parts.append(_held(line[-1], -1))
        else:
            parts.append(next(piece for piece in line if piece.nodes[0] < middle < piece.nodes[-1]))
    inside = [part.nodes[(part.nodes > low + SAME) & (part.nodes < high - SAME)] for part in parts]
    nodes = distinct(np.concatenate([[low, high], *inside]))

    def derivatives(x: np.ndarray) -> Derivatives:
        h, h1, h2 = np.zeros(x.shape), np.zeros(x.shape), np.zeros(x.shape)
        for part in parts:
            g, g1, g2 = part.derivatives(x)
            h, h1, h2 = h + g, h1 + g1, h2 + g2
        return h, h1, h2

    return Piece(nodes, derivatives)


def _held(piece: Piece, end: int) -> Piece:
    """The level at one end of a piece."""
    x = piece.nodes[end]
    return level(x, x, float(piece.derivatives(np.array([x]))[0][0]))
