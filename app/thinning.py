"""Thinning curves to what pixels show without losing a peak: compiled, for each run passes through here on its way."""

from __future__ import annotations

import numpy as np

from model.compiled import compiled

BUCKETS = 400  # stretches of time, each drawn by its smallest and its largest value: about as many as pixels


def thin(x: np.ndarray, values: np.ndarray, buckets: int = BUCKETS) -> tuple[np.ndarray, np.ndarray]:
    """(K,) and (K, C) with K ≤ 2·buckets that look like the (N,) and (N, C) given.

    Each bucket of samples leaves two: of every column the smallest and the largest value, so that no peak is lost; the
    smallest first where the bucket rises from its first sample to its last. They stand at its first and last x.
    What is returned may be what was given; else each column lies in one piece.
    """
    count = len(x)
    if count <= 2 * buckets:
        return x, values
    size = -(-count // buckets)
    first = np.arange(0, count, size)
    ends = np.stack([first, np.minimum(first + size, count) - 1], axis=1).ravel()
    pairs = np.empty((values.shape[1], len(ends)))
    _pair(np.ascontiguousarray(values, dtype=float), size, pairs)
    return x[ends], pairs.T


def warm_up() -> None:
    """Compile the thinning, or load it compiled."""
    _pair(np.zeros((1, 1)), 1, np.empty((1, 2)))


@compiled
def _pair(values: np.ndarray, size: int, pairs: np.ndarray) -> None:
    """Fill pairs (C, K) with the two values of each bucket of `size` rows of values (N, C); the last may be shorter."""
    for column in range(values.shape[1]):
        for k in range(pairs.shape[1] // 2):
            first = k * size
            last = min(first + size, values.shape[0]) - 1
            low = high = values[first, column]
            for row in range(first + 1, last + 1):
                value = values[row, column]
                if value < low:
                    low = value
                if value > high:
                    high = value
            rises = values[first, column] <= values[last, column]
            pairs[column, 2 * k] = low if rises else high
            pairs[column, 2 * k + 1] = high if rises else low
