"""Measured points that lie closer together than a wheel can feel, thinned out before a run."""

from __future__ import annotations

import numpy as np

from model.compiled import allocating

FINE = 1 / 32  # of the wheel's radius: points this far from both neighbours, or further, are kept
BRIDGING = 0.5  # of the wheel's radius: no wheel's centre comes nearer to the road than this
LONGEST = 1000  # points that a line may pass, which bounds the work
CHANGED = 1e-4  # m: by how much the distance from a wheel's centre to the road may change


def thinned(x: np.ndarray, y: np.ndarray, radius: float) -> tuple[np.ndarray, np.ndarray]:
    """The points (x, y) (K,) that a wheel of this radius feels, m.

    From a point that is kept, a line is drawn to the furthest one such that what lies between may be left out:
    - nothing stands out of the line by more than CHANGED;
    - nothing lies below it by more than CHANGED, or the line is so short that a circle of half the wheel's radius that
      rests on both its ends dips by no more than that below it: no wheel touches what lies deeper.
    So the distance to the road from any point that is half a radius away or more changes by CHANGED at most.
    """
    gap = np.diff(x)
    fine = gap < FINE * radius
    if not fine.any():
        return x, y
    free = np.concatenate([[False], fine[:-1] & fine[1:], [False]])
    bridged = np.sqrt(8 * BRIDGING * radius * CHANGED)  # a chord of a circle with this much below it
    kept = _kept(x, y, free, bridged)
    return x[kept], y[kept]


@allocating
def _kept(x, y, free, bridged):
    """(K,) whether each point is kept; bridged: length of a line under which a wheel feels nothing, m."""
    count = len(x)
    kept = np.zeros(count, dtype=np.bool_)
    kept[0] = True
    a = 0
    while a < count - 1:
        last = a + 1
        highest, lowest = -np.inf, np.inf  # slopes of lines from a that pass what lies between within CHANGED
        c = a + 1
        while c < min(count, a + LONGEST):
            run, rise = x[c] - x[a], y[c] - y[a]
            slope = rise / run
            short = run * run + rise * rise <= bridged * bridged
            if slope >= highest and (short or slope <= lowest):
                last = c
            if not free[c] or not (short or highest <= lowest):
                break
            highest = max(highest, slope - CHANGED / run)
            lowest = min(lowest, slope + CHANGED / run)
            c += 1
        kept[last] = True
        a = last
    return kept
