"""A road as quintics in cells, and the compiled search for the point nearest to a wheel's centre.

D(s) = (s − X)² + (h(s) − Y)² is the squared distance from the centre P = (X, Y) to the profile; half its slope is
g(s) = (s − X) + (h − Y) h′. Where the road is too gently curved for a wheel in contact to have two minima of D, a
Halley iteration on g = 0 from s = X finds the one. Elsewhere all cells that can hold the lowest minimum are searched,
so that the wheel bridges valleys tighter than itself.

Which cells can, is found beforehand for all centres in a box: a bin of X, and of Y what a wheel in contact has that has
not sunk in deeper than SEARCHED radii. For two points a and b, |P − a|² − |P − b|² is linear in P: where b is nearer
than all of a cell from each of the box's corners, it is nearer from anywhere in the box, and the cell is left out.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from model.compiled import allocating, compiled, inlined

REACH = 1.5  # half-width of the table's search window, in wheel radii
CELLS_PER_RADIUS = 8  # on level stretches, so that no minimum hides inside a long cell
SAFE = 0.15  # least curvature of D/2 that counts as "one minimum only"
SEARCHED = 0.2  # of the radius: how deep a wheel may sink in until all cells about it are searched
NARROWEST_BIN = 1 / 32  # of the radius
SINKING = 0.04  # of the radius: how deep a wheel is taken to have sunk in for a first guess of its contact point
FINAL_ERROR = 1e-12  # m: of the contact point along the road


Row = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]  # x, h, h′, h″ at nodes


class RoadTable(NamedTuple):
    """Cells c = 0…C−1 between nodes; h = Σ_k coefficients[c, k] u^k, u = x − node[c]. Bins are of equal width."""

    node: np.ndarray  # (C + 1,) m; the last is NaN
    height: np.ndarray  # (C + 1,) h at the nodes, m
    coefficients: np.ndarray  # (C, 6)
    slack: np.ndarray  # (C,) how far D can dip below its values at the cell's ends, m²
    bin_start: float
    bins_per_metre: float
    first_cell: np.ndarray  # (bins,) the cell in which a bin begins
    ceiling: np.ndarray  # (bins,) a centre above this does not touch, m
    floor: np.ndarray  # (bins,) down to here the stretches hold the nearest point, m
    first_stretch: np.ndarray  # (bins + 1,) where in `stretch` a bin's begin
    stretch: np.ndarray  # (stretches, 2) first and last cell of each
    safe: np.ndarray  # (bins,) one minimum only, for every wheel in contact
    guess: np.ndarray  # (bins + 1, 4) contact of a wheel above a bin's edge that has sunk in a little: s, its slope
    # ds/dX × the bin's width, Y, ds/dY; m
    final_step: np.ndarray  # (bins,) m: a Halley step shorter than this is the last
    radius: float
    reach: float
    repeat_from: float
    period: float  # 0: does not repeat


def tabulate(rows: list[Row], period: float, radius: float) -> RoadTable:
    """The table of adjoining rows of (x, h, h′, h″) at nodes; the last row repeats by the period, if there is one."""
    reach = REACH * radius
    repeat_from = float(rows[-1][0][0])
    if period > 0.0:
        copies = int(np.ceil(2 * reach / period))
        x, h, h1, h2 = rows[-1]
        rows = rows + [(x + (copy + 1) * period, h, h1, h2) for copy in range(copies)]
    first, last = rows[0], rows[-1]
    level = max(2, int(np.ceil(2 * reach / radius * CELLS_PER_RADIUS)))
    before = first[0][0] + np.linspace(-2 * reach, 0.0, level + 1)
    behind = last[0][-1] + np.linspace(0.0, 2 * reach, level + 1)
    rows = [_level(before, first[1][0]), *rows]
    if period == 0.0:
        rows.append(_level(behind, last[1][-1]))

    start = np.concatenate([row[0][:-1] for row in rows])
    size = np.concatenate([np.diff(row[0]) for row in rows])
    coefficients = np.concatenate([quintics(np.diff(row[0]), row[1:]) for row in rows])
    s_a, s_b = (np.concatenate([row[2][ends] for row in rows]) for ends in (slice(-1), slice(1, None)))
    node = np.append(start, start[-1] + size[-1])
    height = np.append(coefficients[:, 0], rows[-1][1][-1])
    corner = np.zeros(len(node), dtype=np.bool_)
    corner[1:-1] = np.abs(s_b[:-1] - s_a[1:]) > 1e-9 * (1 + np.abs(s_a[1:]))

    # How far D can dip below its values at a cell's ends, from bounds on D″/2 = 1 + h′² + (h − Y) h″
    steep = np.maximum(np.abs(s_a), np.abs(s_b))
    hollow, crest = _curvature(coefficients, size)
    steep += size * np.maximum(hollow, crest) / 2
    near = size * steep
    slack = size**2 / 4 * (1 + steep**2 + (reach + near) * np.maximum(hollow, crest))
    slack_above = size**2 / 4 * (1 + steep**2 + np.maximum((radius + near) * crest, near * hollow))
    bulge = size**2 / 8 * crest

    width = max(float(np.median(size)), NARROWEST_BIN * radius)
    bins = int(np.clip(np.ceil((node[-1] - node[0]) / width), 16, 1_000_000))
    edges = np.linspace(node[0], node[-1], bins + 1)
    first_cell = np.clip(np.searchsorted(node, edges[:-1], side="right") - 1, 0, len(size) - 1)
    # A Halley step s leaves about s³ [(g″/2g′)² − g‴/6g′]
    bend = np.maximum(hollow, crest)
    third, fourth = np.abs(6 * coefficients[:, 3]), np.abs(24 * coefficients[:, 4])
    wildness = (3 * steep * bend + radius * third) ** 2 / 4 + bend**2 / 2 + steep * third + radius * fourth / 6
    last_step = np.clip(np.cbrt(FINAL_ERROR / np.maximum(wildness, 1e-12)), 1e-5, 2e-3)
    cells = Cells(node, height, coefficients, corner, bulge, slack_above, last_step)
    ceiling, floor, safe = _judge_bins(edges, cells, radius)
    guess, final_step = _guess_contacts(edges, cells, safe, radius)
    first_stretch, stretch = _find_stretches(edges, cells, ceiling, floor, radius)
    node[-1] = np.nan  # which no x exceeds: the first and last cells are level and reach on without end
    return RoadTable(
        node=node,
        height=height,
        coefficients=coefficients,
        slack=slack,
        bin_start=float(edges[0]),
        bins_per_metre=bins / float(edges[-1] - edges[0]),
        first_cell=first_cell,
        ceiling=ceiling,
        floor=floor,
        first_stretch=first_stretch,
        stretch=stretch,
        safe=safe,
        guess=guess,
        final_step=final_step,
        radius=radius,
        reach=reach,
        repeat_from=repeat_from,
        period=period,
    )


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
    """Bounds (C,) on h″ and on −h″ in each cell, not below 0: h″ lies between its Bernstein coefficients."""
    p0, p1, p2, p3 = ((order + 1) * (order + 2) * coefficients[:, order + 2] * size**order for order in range(4))
    bernstein = np.stack([p0, p0 + p1 / 3, p0 + 2 * p1 / 3 + p2 / 3, p0 + p1 + p2 + p3])
    return np.maximum(bernstein.max(axis=0), 0.0), np.maximum(-bernstein.min(axis=0), 0.0)


class Cells(NamedTuple):
    """What the bins are judged by: nodes (C + 1,) and cells (C,)."""

    node: np.ndarray
    height: np.ndarray
    coefficients: np.ndarray
    corner: np.ndarray  # (C + 1,) the slope jumps at this node
    bulge: np.ndarray  # how far h rises above its values at the cell's ends, at most, m
    slack: np.ndarray  # how far D can dip there, from a centre in contact above the road, m²
    last_step: np.ndarray  # a Halley step shorter than this is the last, m


@allocating
def _judge_bins(edges, cells, radius):
    """For each bin of wheel positions X: the highest centre that touches; the lowest of those above the road that have
    not sunk in too deep, where D is not convex; and whether it is, for all in contact.
    """
    node, height, coefficients = cells.node, cells.height, cells.coefficients
    corner, bulge = cells.corner, cells.bulge
    bins = len(edges) - 1
    count = len(node) - 1
    ceiling, floor = np.empty(bins), np.full(bins, np.inf)
    safe = np.empty(bins, dtype=np.bool_)
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
        ceiling[b] = highest
        safe[b] = True
        c = first
        while c < count and node[c] <= right + radius and safe[b]:
            safe[b] = not corner[c + 1] or node[c + 1] > right + radius
            size = node[c + 1] - node[c]
            for u in (0.0, 0.5 * size, size):
                h, h1, h2, _ = _quintic(coefficients, c, u)
                if 1.0 + h1 * h1 - (highest - h) * max(h2, 0.0) < SAFE:
                    safe[b] = False
            c += 1
        if not safe[b] and lowest - SEARCHED * radius > below:
            floor[b] = lowest - SEARCHED * radius
    return ceiling, floor, safe


@allocating
def _guess_contacts(edges, cells, safe, radius):
    """RoadTable's `guess` and `final_step`."""
    node, coefficients, last_step = cells.node, cells.coefficients, cells.last_step
    bins, count = len(edges) - 1, len(node) - 1
    width = edges[1] - edges[0]
    guess = np.zeros((bins + 1, 4))
    final_step = np.empty(bins)
    d = (1.0 - SINKING) * radius
    under, before = 0, 0
    for b in range(bins + 1):
        s, slope = edges[b], 1.0
        if 0 < b < bins and safe[b - 1] and safe[b]:
            for _ in range(8):  # Newton on: the point at s, d along its normal, lies above the edge
                while under > 0 and s < node[under]:
                    under -= 1
                while under < count - 1 and s >= node[under + 1]:
                    under += 1
                h, h1, h2, _h3 = _quintic(coefficients, under, s - node[under])
                length = np.sqrt(1.0 + h1 * h1)
                slope = 1.0 / (1.0 - d * h2 / length**3)
                step = (s - d * h1 / length - edges[b]) * slope
                s -= step
                if abs(step) < 1e-9:
                    break
            guess[b, 2] = h + d / length
            guess[b, 3] = h1 / (1.0 + h1 * h1 - d * h2 / length)
        else:
            while under > 0 and s < node[under]:
                under -= 1
            while under < count - 1 and s >= node[under + 1]:
                under += 1
            guess[b, 2] = _quintic(coefficients, under, s - node[under])[0] + d
        guess[b, 0], guess[b, 1] = s, slope * width
        if b > 0:
            low, high = max(min(before, under) - 1, 0), min(max(before, under) + 2, count)
            final_step[b - 1] = last_step[low:high].min()
        before = under
    return guess, final_step


@allocating
def _find_stretches(edges, cells, ceiling, floor, radius):
    """For each bin with a floor, the stretches of cells that hold the nearest point for all centres of its box."""
    node, height, slack = cells.node, cells.height, cells.slack
    bins = len(edges) - 1
    first_stretch = np.zeros(bins + 1, dtype=np.int64)
    stretch = np.empty((64, 2), dtype=np.int64)
    found, first = 0, 0
    X, Y, best = np.empty(5), np.empty(5), np.empty(5, dtype=np.int64)
    for b in range(bins):
        first_stretch[b] = found
        while first < len(node) - 2 and node[first + 1] < edges[b] - radius:
            first += 1
        if not np.isfinite(floor[b]):
            continue
        last = first
        while last < len(node) - 2 and node[last + 1] <= edges[b + 1] + radius:
            last += 1

        # The nodes that are nearest to the box's corners and to its middle rule out what is further away
        X[:] = edges[b], edges[b + 1], edges[b], edges[b + 1], (edges[b] + edges[b + 1]) / 2
        Y[:] = floor[b], floor[b], ceiling[b], ceiling[b], (floor[b] + ceiling[b]) / 2
        for i in range(5):
            least = np.inf
            for k in range(first, last + 2):
                D = (node[k] - X[i]) ** 2 + (height[k] - Y[i]) ** 2
                if D < least:
                    least, best[i] = D, k
        end = -2
        for c in range(first, last + 1):
            possible = True
            for i in range(5):
                nearer = True
                for k in range(4):
                    D_a = (node[c] - X[k]) ** 2 + (height[c] - Y[k]) ** 2
                    D_b = (node[c + 1] - X[k]) ** 2 + (height[c + 1] - Y[k]) ** 2
                    D = (node[best[i]] - X[k]) ** 2 + (height[best[i]] - Y[k]) ** 2
                    if min(D_a, D_b) - slack[c] <= D + 1e-9:
                        nearer = False
                        break
                if nearer:
                    possible = False
                    break
            if not possible:
                continue
            if c == end + 1:
                stretch[found - 1, 1] = c
            else:
                if found == len(stretch):
                    longer = np.empty((2 * found, 2), dtype=np.int64)
                    longer[:found] = stretch
                    stretch = longer
                stretch[found] = c
                found += 1
            end = c
    first_stretch[bins] = found
    return first_stretch, stretch[:found].copy()


@inlined
def _quintic(coefficients, c, u):
    """h, h′, h″, h‴ at u in cell c."""
    c0, c1, c2 = coefficients[c, 0], coefficients[c, 1], coefficients[c, 2]
    c3, c4, c5 = coefficients[c, 3], coefficients[c, 4], coefficients[c, 5]
    h = c0 + u * (c1 + u * (c2 + u * (c3 + u * (c4 + u * c5))))
    h1 = c1 + u * (2 * c2 + u * (3 * c3 + u * (4 * c4 + u * (5 * c5))))
    h2 = 2 * c2 + u * (6 * c3 + u * (12 * c4 + u * (20 * c5)))
    h3 = 6 * c3 + u * (24 * c4 + u * (60 * c5))
    return h, h1, h2, h3


@inlined
def _bin(road, x):
    b = int((x - road.bin_start) * road.bins_per_metre)
    return min(max(b, 0), len(road.first_cell) - 1)


@inlined
def _cell(road, x):
    c = road.first_cell[_bin(road, x)]
    while x >= road.node[c + 1]:
        c += 1
    return c


@compiled
def _search_all_cells(road, X, Y):
    """The lowest minimum of D within reach of X, whatever the profile's shape: (s, h)."""
    first, last = _cell(road, X - road.reach), _cell(road, X + road.reach)
    D, s, h = _search_nodes(road, X, Y, first, last, np.inf, X, 0.0)
    _D, s, h = _search_cells(road, X, Y, first, last, D, s, h)
    return s, h


@compiled
def _search_stretches(road, X, Y, b):
    """The lowest minimum of D in a bin's stretches: (s, h)."""
    D, s, h = np.inf, X, 0.0
    for k in range(road.first_stretch[b], road.first_stretch[b + 1]):
        D, s, h = _search_nodes(road, X, Y, road.stretch[k, 0], road.stretch[k, 1], D, s, h)
    for k in range(road.first_stretch[b], road.first_stretch[b + 1]):
        D, s, h = _search_cells(road, X, Y, road.stretch[k, 0], road.stretch[k, 1], D, s, h)
    return s, h


@inlined
def _search_nodes(road, X, Y, first, last, best_D, best_s, best_h):
    """The nearest node of cells first…last, or what was nearer before: (D, s, h)."""
    node, height = road.node, road.height
    for k in range(first, last + 2):
        D = (node[k] - X) ** 2 + (height[k] - Y) ** 2
        if D < best_D:
            best_D, best_s, best_h = D, node[k], height[k]
    return best_D, best_s, best_h


@inlined
def _search_cells(road, X, Y, first, last, best_D, best_s, best_h):
    """The lowest minimum of D inside cells first…last, or what was nearer before: (D, s, h)."""
    node, height = road.node, road.height
    for c in range(first, last + 1):
        D_a = (node[c] - X) ** 2 + (height[c] - Y) ** 2
        D_b = (node[c + 1] - X) ** 2 + (height[c + 1] - Y) ** 2
        if min(D_a, D_b) - road.slack[c] > best_D:
            continue
        a, b = 0.0, X + road.reach - node[c]
        if c == 0:
            a = min(a, X - road.reach - node[c])
        if node[c + 1] - node[c] < b:
            b = node[c + 1] - node[c]
        h, h1, h2, _ = _quintic(road.coefficients, c, a)
        g_a = node[c] + a - X + (h - Y) * h1
        h, h1, h2, _ = _quintic(road.coefficients, c, b)
        g_b = node[c] + b - X + (h - Y) * h1
        if not (g_a < 0.0 < g_b):
            continue
        u = (a * g_b - b * g_a) / (g_b - g_a)
        for _ in range(60):  # Newton, kept inside the bracket by bisection
            h, h1, h2, _h3 = _quintic(road.coefficients, c, u)
            g = node[c] + u - X + (h - Y) * h1
            if g < 0.0:
                a = u
            else:
                b = u
            slope = 1.0 + h1 * h1 + (h - Y) * h2
            step = -g / slope if slope > 0.0 else np.inf
            u_next = u + step
            if not (a <= u_next <= b):
                u_next = 0.5 * (a + b)
            moved = abs(u_next - u)
            u = u_next
            if moved < 1e-13:
                break
        h, h1, h2, _h3 = _quintic(road.coefficients, c, u)
        s = node[c] + u
        D = (s - X) ** 2 + (h - Y) ** 2
        if D < best_D:
            best_D, best_s, best_h = D, s, h
    return best_D, best_s, best_h


@inlined
def nearest(road, X, Y):
    """The profile's point nearest to P = (X, Y): (s, h, n_x, n_y, d).

    A centre too high to touch gets the point below it and d infinite.
    """
    shift = 0.0
    if road.period > 0.0 and X > road.repeat_from + road.reach:
        shift = np.floor((X - road.repeat_from - road.reach) / road.period) * road.period
        X = X - shift
    b = _bin(road, X)
    if Y > road.ceiling[b]:
        c = _cell(road, X)
        h, _h1, _h2, _h3 = _quintic(road.coefficients, c, X - road.node[c])
        return X + shift, h, 0.0, 1.0, np.inf
    s, h = X, Y
    found = False
    if road.safe[b]:
        u = (X - road.bin_start) * road.bins_per_metre - b
        guess = road.guess
        s_a, s_b, slope_a, slope_b = guess[b, 0], guess[b + 1, 0], guess[b, 1], guess[b + 1, 1]
        rise = s_b - s_a
        s = s_a + u * (slope_a + u * (3 * rise - 2 * slope_a - slope_b + u * (slope_a + slope_b - 2 * rise)))
        Y_0 = guess[b, 2] + u * (guess[b + 1, 2] - guess[b, 2])
        s += (Y - Y_0) * (guess[b, 3] + u * (guess[b + 1, 3] - guess[b, 3]))
        c = _cell(road, s)
        for _ in range(12):
            if not road.node[c] <= s < road.node[c + 1]:
                c = _cell(road, s)
            h, h1, h2, h3 = _quintic(road.coefficients, c, s - road.node[c])
            e = h - Y
            g = s - X + e * h1
            g1 = 1.0 + h1 * h1 + e * h2
            g2 = 3.0 * h1 * h2 + e * h3
            step = -2.0 * g * g1 / (2.0 * g1 * g1 - g * g2)  # Halley
            s += step
            if abs(step) < road.final_step[b]:
                h += step * (h1 + step * (0.5 * h2 + step * h3 / 6.0))
                # Below the road and far aside, D may have other minima
                found = Y > h and abs(s - X) <= road.radius
                break
    if not found and Y >= road.floor[b]:
        s, h = _search_stretches(road, X, Y, b)
        found = True
    if not found:
        s, h = _search_all_cells(road, X, Y)
    n_x, n_y = X - s, Y - h
    d = np.sqrt(n_x * n_x + n_y * n_y)
    if d < 1e-9:  # the centre lies on the road: its normal is the profile's
        c = _cell(road, s)
        _h, h1, _h2, _h3 = _quintic(road.coefficients, c, s - road.node[c])
        length = np.sqrt(1.0 + h1 * h1)
        return s + shift, h, -h1 / length, 1.0 / length, d
    if not found:
        c = _cell(road, X)
        h_X, _h1, _h2, _h3 = _quintic(road.coefficients, c, X - road.node[c])
        if Y < h_X:
            d = -d
    return s + shift, h, n_x / d, n_y / d, d


@allocating
def nearest_points(road, centres):
    """Nearest points (K, 2), normals (K, 2) and distances (K,) for wheel centres (K, 2)."""
    count = len(centres)
    points, normals, distances = np.empty((count, 2)), np.empty((count, 2)), np.empty(count)
    for k in range(count):
        s, h, n_x, n_y, d = nearest(road, centres[k, 0], centres[k, 1])
        points[k, 0], points[k, 1] = s, h
        normals[k, 0], normals[k, 1] = n_x, n_y
        distances[k] = d
    return points, normals, distances
