"""Thinning curves to what pixels show without losing a peak. Compiled: each run needs it on its way to the page."""

from __future__ import annotations

import numpy as np

from model.compiled import compiled

BUCKETS = 400  # stretches of time, each drawn by its smallest and its largest value: about as many as pixels
SEEN = 2.5e-3  # of the range of all values: a point nearer than that to the line drawn is not missed
SPARSEST = 1 / 160  # of all time: points are no farther apart, since the cursor shows the values of the nearest one


def thin(x: np.ndarray, values: np.ndarray, buckets: int = BUCKETS) -> tuple[np.ndarray, np.ndarray]:
    """(K,) and (K, C) with K ≤ 2·buckets that look like the (N,) and (N, C) given.

    Samples that lie on the lines between others are left out, but never a column's largest or smallest. If too many
    remain, each bucket of samples gives two points: of every column the smallest and the largest value, so that no peak
    is lost; the smallest first where the bucket rises from its first sample to its last. They stand at its first and
    last x. The arrays returned may be the ones given; otherwise each column lies in one piece of memory.
    """
    count = len(x)
    if count <= 2 * buckets:
        return x, values
    columns = np.ascontiguousarray(values.T, dtype=float)
    range_ = float(np.nanmax(columns, initial=-np.inf) - np.nanmin(columns, initial=np.inf))
    longest = SPARSEST * float(x[-1] - x[0])
    kept = np.zeros(count, dtype=np.bool_)
    _keep(x, columns, SEEN * range_, longest, np.empty((2, len(columns))), kept)
    if kept.sum() <= 2 * buckets:
        return x[kept], columns[:, kept].T
    size = -(-count // buckets)
    first = np.arange(0, count, size)
    ends = np.stack([first, np.minimum(first + size, count) - 1], axis=1).ravel()
    pairs = np.empty((len(columns), len(ends)))
    _pair(columns, size, pairs)
    return x[ends], pairs.T


def warm_up() -> None:
    """Compile the thinning, or load it compiled."""
    steep = np.arange(5.0) ** 9 * (-1) ** np.arange(5)
    thin(np.arange(5.0), steep[:, None], buckets=1)


@compiled
def _pair(values: np.ndarray, size: int, pairs: np.ndarray) -> None:
    """Fill pairs (C, K) with the two values of each bucket of `size` of the values (C, N); the last may be smaller."""
    for column in range(values.shape[0]):
        for k in range(pairs.shape[1] // 2):
            first = k * size
            last = min(first + size, values.shape[1]) - 1
            low = high = values[column, first]
            for row in range(first + 1, last + 1):
                value = values[column, row]
                if value < low:
                    low = value
                if value > high:
                    high = value
            rises = values[column, first] <= values[column, last]
            pairs[column, 2 * k] = low if rises else high
            pairs[column, 2 * k + 1] = high if rises else low


@compiled
def _keep(
    x: np.ndarray, values: np.ndarray, tolerance: float, longest: float, cone: np.ndarray, kept: np.ndarray
) -> None:
    """Tick in kept (K,) which of the values (C, K) at x (K,) are needed, so that all others lie within the tolerance of
    the lines between them, which are no longer than `longest` where that can be.

    cone: (2, C) to work with: the slopes of lines from the last point kept that pass all points since near enough.
    """
    columns, count = values.shape
    for column in range(columns):
        low = high = 0
        for k in range(count):
            if values[column, k] < values[column, low]:
                low = k
            if values[column, k] > values[column, high]:
                high = k
        kept[low] = kept[high] = True
    kept[0] = kept[count - 1] = True
    start = 0
    cone[0], cone[1] = -np.inf, np.inf
    for k in range(1, count):
        along = x[k] - x[start]
        fits = 0.0 < along <= longest
        for column in range(columns):
            rise = values[column, k] - values[column, start]
            fits &= np.isnan(values[column, k]) == np.isnan(values[column, start])
            fits &= not (rise < cone[0, column] * along or rise > cone[1, column] * along)
        if not fits:
            start = k - 1
            kept[start] = True
            along = x[k] - x[start]
            cone[0], cone[1] = -np.inf, np.inf
        if kept[k] or along <= 0.0:
            start = k
            kept[k] = True
            cone[0], cone[1] = -np.inf, np.inf
            continue
        for column in range(columns):
            rise = values[column, k] - values[column, start]
            cone[0, column] = max(cone[0, column], (rise - tolerance) / along)
            cone[1, column] = min(cone[1, column], (rise + tolerance) / along)
