"""The table of a road in which nearest_point.py finds a wheel's contact point: cells of quintics, bins of positions.

What is sought, and how, is said there. Which cells can hold the nearest point is found beforehand for all centres in a
box: a bin of X, and of Y what a wheel in contact has that has not sunk in deeper than SEARCHED radii. For two points a
and b, |P − a|² − |P − b|² is linear in P: where b is nearer than all of a cell from each of the box's corners, it is
nearer from anywhere in the box, and the cell is left out.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from model.compiled import allocating, inlined
from model.road.nearest_point import (
    BIN_COLUMNS,
    CEILING,
    CELL_COLUMNS,
    FINAL_STEP,
    FLOOR,
    GUESS,
    GUESS_CELL,
    GUESS_Y,
    HEIGHT,
    NEXT,
    NODE,
    TILT,
    RoadTable,
    quintic,
)

REACH = 1.5  # half-width of the table's search window, in wheel radii
CELLS_PER_RADIUS = 8  # on level stretches, so that no minimum hides inside a long cell
SAFE = 0.05  # least curvature of D/2 that counts as "one minimum only"
SEARCHED = 0.2  # of the radius: how deep a wheel may sink in until all cells about it are searched
NARROWEST_BIN = 1 / 32  # of the radius
SINKING = 0.04  # of the radius: how deep a wheel is taken to have sunk in for a first guess of its contact point
FINAL_ERROR = 1e-12  # m: of the contact point along the road
SAME = 1e-7  # m: places as close as this are one; a quintic between them would be made of rounding
TAME = 8.0  # times 1/radius: by how much h″ may differ in a cell that is hollow somewhere …
MOST_PARTS = 32  # … unless it has been cut into so many parts: then hardly more than rounding is missed


Row = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]  # x, h, h′, h″ at nodes


def tabulate(rows: list[Row], period: float, radius: float) -> RoadTable:
    """The table of adjoining rows of (x, h, h′, h″) at nodes; the last row repeats by the period, if there is one."""
    reach = REACH * radius
    cells, slack = _cells(_with_ends(rows, period, radius), radius)
    edges, first_cell = _bins(cells, radius)
    ceiling, floor = _judge_bins(edges, cells, radius)
    first_stretch, stretch = _find_stretches(edges, cells, ceiling, floor, radius)

    cell = np.zeros((len(cells.node), CELL_COLUMNS))
    cell[:, NODE], cell[:, HEIGHT], cell[:-1, HEIGHT + 1 : NEXT] = cells.node, cells.height, cells.coefficients[:, 1:]
    cell[:, NEXT] = np.inf  # of the last but one too: the first and last cells are level and reach on without end
    cell[:-2, NEXT] = cells.node[1:-1]
    bin = np.zeros((len(first_cell), BIN_COLUMNS))
    bin[:, CEILING], bin[:, FLOOR] = ceiling, floor
    _guess_contacts(edges, cells, first_stretch, stretch, radius, bin)
    return RoadTable(
        cell=cell,
        slack=slack,
        bin=bin,
        first_cell=first_cell,
        first_stretch=first_stretch,
        stretch=stretch,
        bin_start=float(edges[0]),
        bins_per_metre=len(first_cell) / float(edges[-1] - edges[0]),
        radius=radius,
        reach=reach,
        repeat_from=float(rows[-1][0][0]),
        period=period,
    )


def _with_ends(rows: list[Row], period: float, radius: float) -> list[Row]:
    """The rows with what wheels at their ends may touch: level ground before and, unless they repeat, behind them."""
    reach = REACH * radius
    nodes = max(2, int(np.ceil(2 * reach / radius * CELLS_PER_RADIUS))) + 1
    x, h, h1, h2 = rows[-1]
    if period > 0.0:
        copies = int(np.ceil(2 * reach / period))
        behind = [(x + (copy + 1) * period, h, h1, h2) for copy in range(copies)]
    else:
        behind = [_level(x[-1] + np.linspace(0.0, 2 * reach, nodes), h[-1])]
    first = rows[0]
    return [_level(first[0][0] + np.linspace(-2 * reach, 0.0, nodes), first[1][0]), *rows, *behind]


def _cells(rows: list[Row], radius: float) -> tuple[Cells, np.ndarray]:
    """The cells of adjoining rows, and how far D can dip in each (C,) below its values at the ends, m²."""
    start = np.concatenate([row[0][:-1] for row in rows])
    size = np.concatenate([np.diff(row[0]) for row in rows])
    coefficients = np.concatenate([quintics(np.diff(row[0]), row[1:]) for row in rows])
    s_a, s_b = (np.concatenate([row[2][ends] for row in rows]) for ends in (slice(-1), slice(1, None)))
    node = np.append(start, start[-1] + size[-1])
    corner = np.zeros(len(node), dtype=np.bool_)
    corner[1:-1] = np.abs(s_b[:-1] - s_a[1:]) > 1e-9 * (1 + np.abs(s_a[1:]))

    # From bounds on D″/2 = 1 + h′² + (h − Y) h″
    hollow, crest = _curvature(coefficients, size)
    bend = np.maximum(hollow, crest)
    steep = np.maximum(np.abs(s_a), np.abs(s_b)) + size * bend / 2
    near = size * steep
    slack = size**2 / 4 * (1 + steep**2 + (REACH * radius + near) * bend)
    slack_above = size**2 / 4 * (1 + steep**2 + np.maximum((radius + near) * crest, near * hollow))

    # A Halley step s leaves about s³ [(g″/2g′)² − g‴/6g′]
    third, fourth = np.abs(6 * coefficients[:, 3]), np.abs(24 * coefficients[:, 4])
    wildness = (3 * steep * bend + radius * third) ** 2 / 4 + bend**2 / 2 + steep * third + radius * fourth / 6
    return Cells(
        node=node,
        height=np.append(coefficients[:, 0], rows[-1][1][-1]),
        coefficients=coefficients,
        corner=corner,
        bulge=size**2 / 8 * crest,
        slack=slack_above,
        convex=_convex_up_to(node, coefficients),
        last_step=np.clip(np.cbrt(FINAL_ERROR / np.maximum(wildness, 1e-12)), 1e-5, 2e-3),
    ), slack


def _bins(cells: Cells, radius: float) -> tuple[np.ndarray, np.ndarray]:
    """Edges of the bins (bins + 1,), m, and the cell in which each begins (bins,)."""
    node = cells.node
    width = max(float(np.median(np.diff(node))), NARROWEST_BIN * radius)
    bins = int(np.clip(np.ceil((node[-1] - node[0]) / width), 16, 1_000_000))
    edges = np.linspace(node[0], node[-1], bins + 1)
    return edges, np.clip(np.searchsorted(node, edges[:-1], side="right") - 1, 0, len(node) - 2)


def tame_parts(row: Row, radius: float) -> np.ndarray:
    """Into how many parts (C,) each cell is to be cut, so that none hides a minimum of D from what looks at its ends.

    Between measured points that climb a kerb h″ rises, falls and is nothing at both ends: a wheel on the shoulder
    inside would be seen by neither, nor by the judgement of whether D is convex.
    """
    size = np.diff(row[0])
    bend = _bends(quintics(size, row[1:]), size)
    variation = radius * (bend.max(axis=0) - bend.min(axis=0))
    parts = np.minimum(np.ceil(variation / TAME), np.minimum(MOST_PARTS, size / SAME))
    return np.where(bend.max(axis=0) > 0.0, parts, 1)


def _level(x: np.ndarray, height: float) -> Row:
    return x, np.full(x.shape, height), np.zeros(x.shape), np.zeros(x.shape)


def quintics(size: np.ndarray, ends: tuple[np.ndarray, np.ndarray, np.ndarray]) -> np.ndarray:
    """Coefficients (K − 1, 6) of the quintics of these sizes (K − 1,) that have h, h′, h″ (K,) at their ends."""
    (h_a, s_a, c_a), (h_b, s_b, c_b) = ([values[part] for values in ends] for part in (slice(-1), slice(1, None)))
    d0 = (h_b - h_a - s_a * size - c_a * size**2 / 2) / size**3
    d1 = (s_b - s_a - c_a * size) / size**2
    d2 = (c_b - c_a) / size
    return np.column_stack(
        [
            h_a,
            s_a,
            c_a / 2,
            10 * d0 - 4 * d1 + d2 / 2,
            (-15 * d0 + 7 * d1 - d2) / size,
            (6 * d0 - 3 * d1 + d2 / 2) / size**2,
        ]
    )


def _curvature(coefficients: np.ndarray, size: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Bounds (C,) on h″ and on −h″ in each cell, not below 0."""
    bend = _bends(coefficients, size)
    return np.maximum(bend.max(axis=0), 0.0), np.maximum(-bend.min(axis=0), 0.0)


def _bends(coefficients: np.ndarray, size: np.ndarray) -> np.ndarray:
    """Bernstein coefficients (4, C) of h″ in each cell: it lies between them."""
    p0, p1, p2, p3 = ((order + 1) * (order + 2) * coefficients[:, order + 2] * size**order for order in range(4))
    return np.stack([p0, p0 + p1 / 3, p0 + 2 * p1 / 3 + p2 / 3, p0 + p1 + p2 + p3])


class Cells(NamedTuple):
    """What the bins are judged by: nodes (C + 1,) and cells (C,)."""

    node: np.ndarray
    height: np.ndarray
    coefficients: np.ndarray
    corner: np.ndarray  # (C + 1,) the slope jumps at this node
    bulge: np.ndarray  # how far h rises above its values at the cell's ends, at most, m
    slack: np.ndarray  # how far D can dip there, from a centre in contact above the road, m²
    convex: np.ndarray  # D is convex over the cell for centres up to this height, m
    last_step: np.ndarray  # a Halley step shorter than this is the last, m


@allocating
def _convex_up_to(node, coefficients):
    """(C,) how high a centre may be for D to be convex over a cell, as far as three points of the cell tell, m."""
    highest = np.full(len(coefficients), np.inf)
    for c in range(len(coefficients)):
        size = node[c + 1] - node[c]
        for u in (0.0, 0.5 * size, size):
            h, h1, h2, _h3 = _height(coefficients, c, u)
            if h2 > 0.0:
                highest[c] = min(highest[c], h + (1.0 + h1 * h1 - SAFE) / h2)
    return highest


@allocating
def _judge_bins(edges, cells, radius):
    """For each bin of wheel positions X: the highest centre that touches; and −inf where D has one minimum for all in
    contact, elsewhere the lowest of those above the road that have not sunk in too deep.
    """
    node, height = cells.node, cells.height
    corner, bulge = cells.corner, cells.bulge
    bins = len(edges) - 1
    count = len(node) - 1
    ceiling, floor = np.empty(bins), np.empty(bins)
    first = 0
    for b in range(bins):
        left, right = edges[b], edges[b + 1]
        while first < count - 1 and node[first + 1] < left - radius:
            first += 1
        highest, lowest, below = -np.inf, -np.inf, -np.inf
        c = first
        while c < count and node[c] <= right + radius:
            top = max(height[c], height[c + 1]) + bulge[c]
            away = max(node[c] - right, left - node[c + 1], 0.0)
            highest = max(highest, top + np.sqrt(max(radius * radius - away * away, 0.0)))
            away = max(right - node[c], node[c] - left)
            if away < radius:
                lowest = max(lowest, height[c] + np.sqrt(radius * radius - away * away))
            if node[c] <= right and node[c + 1] >= left:
                below = max(below, top)
            c += 1
        safe = True
        c = first
        while c < count and node[c] <= right + radius and safe:
            safe = highest <= cells.convex[c] and (not corner[c + 1] or node[c + 1] > right + radius)
            c += 1
        ceiling[b] = highest
        floor[b] = lowest - SEARCHED * radius
        if floor[b] <= below:
            floor[b] = np.inf
        if safe:
            floor[b] = -np.inf
    return ceiling, floor


@allocating
def _guess_contacts(edges, cells, first_stretch, stretch, radius, bin):
    """Fills the columns of a guess and the final step of each bin.

    The guess is cubic between what is found above the bin's edges, for wheels that have sunk in a little, and linear in
    how much lower or higher they are. There is one where D has one minimum, or one in the only stretch to be searched.
    """
    node, corner, last_step = cells.node, cells.corner, cells.last_step
    bins, count = len(edges) - 1, len(node) - 1
    width = edges[1] - edges[0]
    s_b, slope_b, Y_b, tilt_b, behind = edges[0], 1.0, 0.0, 0.0, 0
    shared = False  # what was found above the last bin's right edge holds for this bin too
    for b in range(bins):
        first, last, s = 0, count - 1, edges[b]
        guessed = bin[b, FLOOR] == -np.inf
        if not guessed:
            shared = False
            if first_stretch[b + 1] == first_stretch[b] + 1:
                first = max(stretch[first_stretch[b], 0] - 1, 0)
                last = min(stretch[first_stretch[b], 1] + 1, count - 1)
                guessed = True
                for c in range(first, last + 1):
                    guessed = guessed and not corner[c] and bin[b, CEILING] <= cells.convex[c]
                s = 0.5 * (node[first] + node[last + 1])
        bin[b, FINAL_STEP] = -1.0
        if not guessed:
            continue
        s_a, slope_a, Y_a, tilt_a, under = s_b, slope_b, Y_b, tilt_b, behind
        if not shared:
            s_a, slope_a, Y_a, tilt_a, under = _above(cells, edges[b], s, behind, first, last, radius)
        s_b, slope_b, Y_b, tilt_b, behind = _above(cells, edges[b + 1], s_a, under, first, last, radius)
        rise, shared = s_b - s_a, last - first == count - 1
        bin[b, GUESS], bin[b, GUESS + 1] = s_a, slope_a * width
        bin[b, GUESS + 2] = 3 * rise - (2 * slope_a + slope_b) * width
        bin[b, GUESS + 3] = (slope_a + slope_b) * width - 2 * rise
        bin[b, GUESS_Y], bin[b, GUESS_Y + 1] = Y_a, Y_b - Y_a
        bin[b, TILT], bin[b, TILT + 1] = tilt_a, tilt_b - tilt_a
        bin[b, GUESS_CELL] = under
        final = last_step[behind]
        for c in range(max(min(under, behind) - 1, 0), min(max(under, behind) + 2, count)):
            final = min(final, last_step[c])
        bin[b, FINAL_STEP] = final


@inlined
def _above(cells, x, s, under, first, last, radius):
    """The contact, among cells first…last, of a wheel at x that has sunk in a little, from s by Newton's method:
    (s, ∂s/∂x, the centre's height Y, ∂s/∂Y, cell). The cell is sought from `under` on.
    """
    node, d = cells.node, (1.0 - SINKING) * radius
    h, h1, h2, slope, length = 0.0, 0.0, 0.0, 1.0, 1.0
    for _ in range(8):  # until the point d along the normal at s lies at x
        s = min(max(s, node[first]), node[last + 1])
        while under > first and s < node[under]:
            under -= 1
        while under < last and s >= node[under + 1]:
            under += 1
        h, h1, h2, _h3 = _height(cells.coefficients, under, s - node[under])
        length = np.sqrt(1.0 + h1 * h1)
        slope = 1.0 / (1.0 - d * h2 / length**3)
        step = (s - d * h1 / length - x) * slope
        s -= step
        if abs(step) < 1e-9:
            break
    return s, slope, h + d / length, h1 / (1.0 + h1 * h1 - d * h2 / length), under


@inlined
def _height(coefficients, c, u):
    """h, h′, h″, h‴ at u in cell c."""
    k = coefficients[c]
    return quintic(k[0], k[1], k[2], k[3], k[4], k[5], u)


class _Box(NamedTuple):
    """The wheel centres of a bin: corners 0…3 and the middle of the box, and the node nearest to each."""

    X: np.ndarray  # (5,) m
    Y: np.ndarray  # (5,) m
    nearest: np.ndarray  # (5,) node


@inlined
def _fill_box(box, left, right, low, high, cells, first, last):
    """The box of a bin from left to right, of centres from low to high; nodes are those of cells first…last.

    Element by element: arrays as wholes would cost seconds of compilation, for messages that are never shown.
    """
    X, Y = box.X, box.Y
    X[0], X[1], X[2], X[3], X[4] = left, right, left, right, (left + right) / 2
    Y[0], Y[1], Y[2], Y[3], Y[4] = low, low, high, high, (low + high) / 2
    for i in range(5):
        least = np.inf
        for k in range(first, last + 2):
            D = (cells.node[k] - X[i]) ** 2 + (cells.height[k] - Y[i]) ** 2
            if D < least:
                least, box.nearest[i] = D, k


@inlined
def _may_hold_nearest(cells, c, box):
    """Whether cell c can hold the point nearest to some centre of the box: no node is nearer than all of the cell from
    each of its corners.
    """
    for i in range(5):
        node = box.nearest[i]
        nearer = True
        for k in range(4):
            X, Y = box.X[k], box.Y[k]
            D_a = (cells.node[c] - X) ** 2 + (cells.height[c] - Y) ** 2
            D_b = (cells.node[c + 1] - X) ** 2 + (cells.height[c + 1] - Y) ** 2
            D = (cells.node[node] - X) ** 2 + (cells.height[node] - Y) ** 2
            if min(D_a, D_b) - cells.slack[c] <= D + 1e-9:
                nearer = False
                break
        if nearer:
            return False
    return True


@allocating
def _with_room(stretch, found):
    """The stretches (K, 2), with room for more than those found."""
    if found < len(stretch):
        return stretch
    longer = np.empty((2 * found, 2), dtype=np.int64)
    for k in range(found):
        longer[k, 0], longer[k, 1] = stretch[k, 0], stretch[k, 1]
    return longer


@allocating
def _find_stretches(edges, cells, ceiling, floor, radius):
    """For each bin with a floor, the stretches of cells that hold the nearest point for all centres of its box."""
    node = cells.node
    bins = len(edges) - 1
    first_stretch = np.zeros(bins + 1, dtype=np.int64)
    stretch = np.empty((64, 2), dtype=np.int64)
    found, first = 0, 0
    box = _Box(np.empty(5), np.empty(5), np.empty(5, dtype=np.int64))
    for b in range(bins):
        first_stretch[b] = found
        while first < len(node) - 2 and node[first + 1] < edges[b] - radius:
            first += 1
        if not np.isfinite(floor[b]):
            continue
        last = first
        while last < len(node) - 2 and node[last + 1] <= edges[b + 1] + radius:
            last += 1
        _fill_box(box, edges[b], edges[b + 1], floor[b], ceiling[b], cells, first, last)
        end = -2
        for c in range(first, last + 1):
            if not _may_hold_nearest(cells, c, box):
                continue
            if c == end + 1:
                stretch[found - 1, 1] = c
            else:
                stretch = _with_room(stretch, found)
                stretch[found, 0] = stretch[found, 1] = c
                found += 1
            end = c
    first_stretch[bins] = found
    return first_stretch, stretch[:found].copy()
