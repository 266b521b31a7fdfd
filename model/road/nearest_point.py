"""The compiled search for the point of a road nearest to a wheel's centre, and the form of the table it searches.

D(s) = (s − X)² + (h(s) − Y)² is the squared distance from the centre P = (X, Y) to the profile; half its slope is
g(s) = (s − X) + (h − Y) h′. Where the road is too gently curved for a wheel in contact to have two minima of D, a
Halley iteration on g = 0 from a stored guess finds the one; so it does where a single stretch can hold the nearest
point and has one minimum. Elsewhere all cells that can hold the lowest minimum are searched. Thus a wheel bridges
valleys tighter than itself. How the table is made: table.py.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from model.compiled import allocating, compiled, inlined

NODE, HEIGHT, NEXT = 0, 1, 7  # columns of a cell; from HEIGHT on the coefficients of its quintic
CELL_COLUMNS = 8
# Columns of a bin: the guess s = g₀ + g₁ u + g₂ u² + g₃ u³ + (Y − Y₀ − Y₁ u)(t₀ + t₁ u), u the part of the bin that
# lies before X; the cell that holds the guess at its left edge; and what RoadTable says
GUESS, GUESS_Y, TILT, GUESS_CELL, CEILING, FLOOR, FINAL_STEP = 0, 4, 6, 8, 9, 10, 11
BIN_COLUMNS = 12
FAR = 1e15  # m: farther than any place that is a number of use, and how deep a road lies that a wheel cannot touch


class RoadTable(NamedTuple):
    """A road as quintics in cells c = 0…C−1 between nodes, and bins of equal width. What is looked up for one place
    stands in one row, so that it comes from memory together.
    """

    cell: (
        np.ndarray
    )  # (C + 1, 8) node x₀, coefficients of h = Σ_k c_k (x − x₀)^k, next node (infinite for the last two)
    slack: np.ndarray  # (C,) how far D can dip below its values at the cell's ends, m²
    bin: np.ndarray  # (bins, 12) guess (above); ceiling: a centre above this does not touch, m; floor: down to here the
    # guess leads to the nearest point, or the stretches hold it, m; final step: a Halley step shorter than this is the
    # last, m, or, where there is no guess, −1
    first_cell: np.ndarray  # (bins,) the cell in which a bin begins
    first_stretch: np.ndarray  # (bins + 1,) where in `stretch` a bin's begin
    stretch: np.ndarray  # (stretches, 2) first and last cell of each
    bin_start: float
    bins_per_metre: float
    radius: float
    reach: float
    repeat_from: float
    period: float  # 0: does not repeat

    @property
    def safe(self) -> np.ndarray:
        """(bins,) one minimum only, for every wheel in contact."""
        return np.isneginf(self.bin[:, FLOOR])

    @property
    def valleys(self) -> tuple[float, float]:
        """Places, m, between which a wheel in contact may have two minima; (∞, −∞) where there are none."""
        unsafe = np.flatnonzero(~self.safe)
        if not len(unsafe):
            return np.inf, -np.inf
        first, last = unsafe[0], unsafe[-1] + 1  # the first and last bin go on for ever
        start = self.bin_start + first / self.bins_per_metre if first > 0 else -np.inf
        ends = self.period == 0.0 and last < len(self.first_cell)
        return start, self.bin_start + last / self.bins_per_metre if ends else np.inf

    @property
    def steepness(self) -> float:
        """Root of the mean square slope from node to node, where there are valleys; 0 where there are none."""
        start, end = self.valleys
        if start >= end:
            return 0.0
        x, h = self.cell[:, NODE], self.cell[:, HEIGHT]
        inside = (x >= start) & (x <= end)
        way, rise = np.diff(x[inside]), np.diff(h[inside])
        return float(np.sqrt(np.sum(rise**2 / way) / np.sum(way))) if len(way) else 0.0


@inlined
def quintic(c0, c1, c2, c3, c4, c5, u):
    """h, h′, h″, h‴ at u from a cell's node."""
    h = c0 + u * (c1 + u * (c2 + u * (c3 + u * (c4 + u * c5))))
    h1 = c1 + u * (2 * c2 + u * (3 * c3 + u * (4 * c4 + u * (5 * c5))))
    h2 = 2 * c2 + u * (6 * c3 + u * (12 * c4 + u * (20 * c5)))
    h3 = 6 * c3 + u * (24 * c4 + u * (60 * c5))
    return h, h1, h2, h3


@inlined
def profile(cell, c, u):
    """h, h′, h″, h‴ at u from the node of cell c."""
    return quintic(cell[c, 1], cell[c, 2], cell[c, 3], cell[c, 4], cell[c, 5], cell[c, 6], u)


@inlined
def _bin(road, x):
    b, last = (x - road.bin_start) * road.bins_per_metre, len(road.first_cell) - 1.0
    b = b if b > 0.0 else 0.0  # so is NaN: as an integer it would be anything
    return int(b if b < last else last)


@inlined
def _cell(road, x):
    c = road.first_cell[_bin(road, x)]
    x = min(x, FAR)  # else infinity would lie beyond the last cell
    while x >= road.cell[c, NEXT]:
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
    cell = road.cell
    for k in range(first, last + 2):
        D = (cell[k, NODE] - X) ** 2 + (cell[k, HEIGHT] - Y) ** 2
        if D < best_D:
            best_D, best_s, best_h = D, cell[k, NODE], cell[k, HEIGHT]
    return best_D, best_s, best_h


@inlined
def _search_cells(road, X, Y, first, last, best_D, best_s, best_h):
    """The lowest minimum of D inside cells first…last, or what was nearer before: (D, s, h)."""
    cell = road.cell
    for c in range(first, last + 1):
        node = cell[c, NODE]
        D_a = (node - X) ** 2 + (cell[c, HEIGHT] - Y) ** 2
        D_b = (cell[c + 1, NODE] - X) ** 2 + (cell[c + 1, HEIGHT] - Y) ** 2
        if min(D_a, D_b) - road.slack[c] > best_D:
            continue
        a, b = 0.0, min(X + road.reach, cell[c, NEXT]) - node
        if c == 0:
            a = min(a, X - road.reach - node)
        h, h1, h2, _ = profile(cell, c, a)
        g_a = node + a - X + (h - Y) * h1
        h, h1, h2, _ = profile(cell, c, b)
        g_b = node + b - X + (h - Y) * h1
        if not (g_a < 0.0 < g_b):
            continue
        u = (a * g_b - b * g_a) / (g_b - g_a)
        for _ in range(60):  # Newton, kept inside the bracket by bisection
            h, h1, h2, _h3 = profile(cell, c, u)
            g = node + u - X + (h - Y) * h1
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
        h, h1, h2, _h3 = profile(cell, c, u)
        s = node + u
        D = (s - X) ** 2 + (h - Y) ** 2
        if D < best_D:
            best_D, best_s, best_h = D, s, h
    return best_D, best_s, best_h


@inlined
def _repeats(road, X):
    """How far back, m, the stretch of the table lies that X repeats."""
    shift = 0.0
    if road.period > 0.0 and X > road.repeat_from + road.reach:
        shift = np.floor((X - road.repeat_from - road.reach) / road.period) * road.period
    return shift


@inlined
def _guessed(road, b, X, Y):
    """A point within micrometres of the nearest, where there is one minimum only: (s, a cell at or just before it)."""
    u = (X - road.bin_start) * road.bins_per_metre - b
    bins = road.bin
    s = bins[b, GUESS] + u * (bins[b, GUESS + 1] + u * (bins[b, GUESS + 2] + u * bins[b, GUESS + 3]))
    s += (Y - bins[b, GUESS_Y] - bins[b, GUESS_Y + 1] * u) * (bins[b, TILT] + bins[b, TILT + 1] * u)
    c = int(bins[b, GUESS_CELL])
    here = min(s, FAR)  # as in _cell
    while here < road.cell[c, NODE] and c > 0:
        c -= 1
    c += here >= road.cell[c, NEXT]
    while here >= road.cell[c, NEXT]:
        c += 1
    return s, c


@inlined
def halley(X, Y, s, h, h1, h2, h3):
    """From s to the minimum of D nearby: (step, h there)."""
    e = h - Y
    g = s - X + e * h1
    g1 = 1.0 + h1 * h1 + e * h2
    g2 = 3.0 * h1 * h2 + e * h3
    step = -2.0 * g * g1 / (2.0 * g1 * g1 - g * g2)
    return step, h + step * (h1 + step * (0.5 * h2 + step * h3 / 6.0))


@inlined
def approach(road, X, Y):
    """Where one Halley step leads to the point nearest to P = (X, Y), nearly always: (X less what the road repeats by,
    s, a place in a cell, that cell's six coefficients, the longest step that may be the last).

    A centre too high to touch gets a road far below; one for which more must be searched, −1 as the longest step.
    """
    X -= _repeats(road, X)
    b = _bin(road, X)
    final = road.bin[b, FINAL_STEP]
    if Y > road.bin[b, CEILING]:
        return X, X, 0.0, -FAR, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0
    if final < 0.0 or Y < road.bin[b, FLOOR]:
        return X, X, 0.0, -FAR, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0
    s, c = _guessed(road, b, X, Y)
    cell = road.cell
    u = s - cell[c, NODE]
    return X, s, u, cell[c, 1], cell[c, 2], cell[c, 3], cell[c, 4], cell[c, 5], cell[c, 6], final


@inlined
def nearest(road, X, Y):
    """The profile's point nearest to P = (X, Y): (s, h, n_x, n_y, d).

    A centre too high to touch gets the point below it and d infinite.
    """
    shift = _repeats(road, X)
    X = X - shift
    b = _bin(road, X)
    if Y > road.bin[b, CEILING]:
        c = _cell(road, X)
        h, _h1, _h2, _h3 = profile(road.cell, c, X - road.cell[c, NODE])
        return X + shift, h, 0.0, 1.0, np.inf
    s, h = X, Y
    found = False
    final, above_floor = road.bin[b, FINAL_STEP], Y >= road.bin[b, FLOOR]
    if final > 0.0 and above_floor:
        s, c = _guessed(road, b, X, Y)
        for _ in range(12):
            if not road.cell[c, NODE] <= s < road.cell[c, NEXT]:
                c = _cell(road, s)
            h, h1, h2, h3 = profile(road.cell, c, s - road.cell[c, NODE])
            step, h = halley(X, Y, s, h, h1, h2, h3)
            s += step
            if abs(step) < final:
                # Below the road, far aside, outside the stretch that holds the nearest point, D may have other minima
                found = Y > h and abs(s - X) <= road.radius
                if road.first_stretch[b] < road.first_stretch[b + 1]:
                    first, last = road.stretch[road.first_stretch[b]]
                    found = found and road.cell[first, NODE] <= s <= road.cell[last + 1, NODE]
                break
    if not found and above_floor and road.first_stretch[b] < road.first_stretch[b + 1]:
        s, h = _search_stretches(road, X, Y, b)
        found = True
    if not found:
        s, h = _search_all_cells(road, X, Y)
    n_x, n_y = X - s, Y - h
    d = np.sqrt(n_x * n_x + n_y * n_y)
    if d < 1e-9:  # the centre lies on the road: its normal is the profile's
        c = _cell(road, s)
        _h, h1, _h2, _h3 = profile(road.cell, c, s - road.cell[c, NODE])
        length = np.sqrt(1.0 + h1 * h1)
        return s + shift, h, -h1 / length, 1.0 / length, d
    if not found:
        c = _cell(road, X)
        h_X, _h1, _h2, _h3 = profile(road.cell, c, X - road.cell[c, NODE])
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
