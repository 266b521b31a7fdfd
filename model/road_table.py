"""A road as quintics in cells, and the compiled search for the point nearest to a wheel's centre.

D(s) = (s − X)² + (h(s) − Y)² is the squared distance from the centre P = (X, Y) to the profile; half its slope is
g(s) = (s − X) + (h − Y) h′. Where the road is too gently curved for a wheel in contact to have two minima of D, a
Halley iteration on g = 0 from s = X finds the one. Elsewhere all cells under the wheel that can hold the lowest
minimum are searched, so that the wheel bridges valleys tighter than itself.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from model.compiled import allocating, compiled, inlined

REACH = 1.5  # half-width of the table's search window, in wheel radii
CELLS_PER_RADIUS = 8  # on level stretches, so that no minimum hides inside a long cell
SAFE = 0.15  # least curvature of D/2 that counts as "one minimum only"
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
    safe: np.ndarray  # (bins,) one minimum only, for every wheel in contact
    touch: np.ndarray  # (bins + 1,) first guess of the contact point, the centre above a bin's edge, m
    final_step: float  # m: a Halley step shorter than this is the last
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

    # Quintic Hermite cells: h, h′, h″ agree at both ends.
    start = np.concatenate([row[0][:-1] for row in rows])
    size = np.concatenate([np.diff(row[0]) for row in rows])
    h_a, s_a, c_a = (np.concatenate([row[i][:-1] for row in rows]) for i in (1, 2, 3))
    h_b, s_b, c_b = (np.concatenate([row[i][1:] for row in rows]) for i in (1, 2, 3))
    d0 = (h_b - h_a - s_a * size - c_a * size**2 / 2) / size**3
    d1 = (s_b - s_a - c_a * size) / size**2
    d2 = (c_b - c_a) / size
    coefficients = np.column_stack(
        [
            h_a,
            s_a,
            c_a / 2,
            10 * d0 - 4 * d1 + d2 / 2,
            (-15 * d0 + 7 * d1 - d2) / size,
            (6 * d0 - 3 * d1 + d2 / 2) / size**2,
        ]
    )
    node = np.append(start, start[-1] + size[-1])
    height = np.append(h_a, h_b[-1])
    corner = np.zeros(len(node), dtype=np.bool_)
    corner[1:-1] = np.abs(s_b[:-1] - s_a[1:]) > 1e-9 * (1 + np.abs(s_a[1:]))

    steepness = np.maximum(np.abs(s_a), np.abs(s_b)) ** 2
    bend = np.maximum(np.abs(c_a), np.abs(c_b)) + np.abs(d1)
    slack = size**2 * (1 + steepness + 2 * reach * bend) / 2
    # A Halley step s leaves about s³ [(g″/2g′)² − g‴/6g′]
    third, fourth = np.abs(6 * coefficients[:, 3]), np.abs(24 * coefficients[:, 4])
    steep = np.sqrt(steepness)
    wildness = (3 * steep * bend + radius * third) ** 2 / 4 + bend**2 / 2 + steep * third + radius * fourth / 6
    bins = int(np.clip(np.ceil((node[-1] - node[0]) / max(np.median(size), 1e-3)), 16, 1_000_000))
    edges = np.linspace(node[0], node[-1], bins + 1)
    first_cell = np.clip(np.searchsorted(node, edges[:-1], side="right") - 1, 0, len(size) - 1)
    ceiling, safe, touch = _judge_bins(edges, node, height, coefficients, corner, radius)
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
        safe=safe,
        touch=touch,
        final_step=float(np.clip(np.cbrt(FINAL_ERROR / max(wildness.max(), 1e-12)), 1e-5, 2e-3)),
        radius=radius,
        reach=reach,
        repeat_from=repeat_from,
        period=period,
    )


def _level(x: np.ndarray, height: float) -> Row:
    return x, np.full(x.shape, height), np.zeros(x.shape), np.zeros(x.shape)


@allocating
def _judge_bins(edges, node, height, coefficients, corner, radius):
    """For each bin of wheel positions X: the highest centre that touches, whether D is convex for all below it, and
    (at the bins' edges) where a wheel that has sunk in a little touches.
    """
    bins = len(edges) - 1
    cells = len(node) - 1
    ceiling = np.empty(bins)
    safe = np.empty(bins, dtype=np.bool_)
    touch = edges.copy()
    first, under = 0, 0
    for b in range(bins):
        low, high = edges[b] - radius, edges[b + 1] + radius
        while first < cells - 1 and node[first + 1] < low:
            first += 1
        top = max(height[first], height[first + 1])
        c = first
        while c < cells and node[c] <= high:
            top = max(top, height[c + 1])
            c += 1
        ceiling[b] = top + radius
        safe[b] = True
        c = first
        while c < cells and node[c] <= high and safe[b]:
            safe[b] = not corner[c + 1] or node[c + 1] > high
            size = node[c + 1] - node[c]
            for u in (0.0, 0.5 * size, size):
                h, h1, h2, _ = _quintic(coefficients, c, u)
                if 1.0 + h1 * h1 - (ceiling[b] - h) * max(h2, 0.0) < SAFE:
                    safe[b] = False
            c += 1
    for b in range(1, bins):
        if safe[b - 1] and safe[b]:
            s, d = edges[b], (1.0 - SINKING) * radius
            for _ in range(8):  # Newton on: the point at s, d along its normal, lies above the edge
                while under > 0 and s < node[under]:
                    under -= 1
                while under < cells - 1 and s >= node[under + 1]:
                    under += 1
                _h, h1, h2, _h3 = _quintic(coefficients, under, s - node[under])
                length = np.sqrt(1.0 + h1 * h1)
                s -= (s - d * h1 / length - edges[b]) / (1.0 - d * h2 / length**3)
            touch[b] = s
    return ceiling, safe, touch


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
    node, height = road.node, road.height
    best_D, best_s, best_h = np.inf, X, 0.0
    for k in range(first, last + 2):
        D = (node[k] - X) ** 2 + (height[k] - Y) ** 2
        if D < best_D:
            best_D, best_s, best_h = D, node[k], height[k]
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
    return best_s, best_h


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
        part = (X - road.bin_start) * road.bins_per_metre - b
        s = road.touch[b] + part * (road.touch[b + 1] - road.touch[b])
        for _ in range(12):
            c = _cell(road, s)
            h, h1, h2, h3 = _quintic(road.coefficients, c, s - road.node[c])
            e = h - Y
            g = s - X + e * h1
            g1 = 1.0 + h1 * h1 + e * h2
            g2 = 3.0 * h1 * h2 + e * h3
            step = -2.0 * g * g1 / (2.0 * g1 * g1 - g * g2)  # Halley
            s += step
            if abs(step) < road.final_step:
                h += step * (h1 + step * (0.5 * h2 + step * h3 / 6.0))
                found = Y > h  # below the road, D may have other minima
                break
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
