"""What a step leaves behind, and the state inside of it: cubic Hermite, and what a method adds to that."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from model.compiled import inlined

STAGES = 7  # rows of Memory.k
SPARE = 1  # the row that is lent to samples: once a step is accepted, nothing needs it
CUBIC = np.zeros(STAGES)  # nothing to add to cubic Hermite


class Memory(NamedTuple):
    """A stepper's arrays, its own to change; `size` entries of the flat state."""

    y: np.ndarray  # (size,) the state now
    y_new: np.ndarray  # (size,) at the end of a step
    between: np.ndarray  # (size,) at a stage or a sample
    k: np.ndarray  # (STAGES, size) derivatives: k[0] at y, then of the stages


@inlined
def state_within(dense, last, h, theta, memory):
    """The state at t + θ h in the step from y to y_new: cubic Hermite, and what the tableau adds to it.

    k[0] and k[last]: the derivatives at both ends.
    """
    size = len(memory.y)
    y, y_new, out, k = memory.y, memory.y_new, memory.between, memory.k
    first, final = k[0], k[last]
    rest = 1.0 - theta
    risen, begin, end = theta * theta * (3.0 - 2.0 * theta), h * theta * rest * rest, h * theta * theta * rest
    for i in range(size):  # of few arrays at a time, so that it is done in lanes
        out[i] = y[i] + risen * (y_new[i] - y[i]) + begin * first[i] - end * final[i]
    d1, _, d3, d4, d5, d6, d7 = dense
    if d1 != 0.0:
        k3, k4, k5, k6, k7 = k[2], k[3], k[4], k[5], k[6]
        for i in range(size):
            out[i] += end * rest * (d1 * first[i] + d3 * k3[i] + d4 * k4[i] + d5 * k5[i] + d6 * k6[i] + d7 * k7[i])


@inlined
def entry_within(dense, last, h, theta, memory, i):
    """Entry i of that state, which is found alone."""
    y, y_new, k = memory.y[i], memory.y_new[i], memory.k
    rest = 1.0 - theta
    end = h * theta * theta * rest
    out = y + theta * theta * (3.0 - 2.0 * theta) * (y_new - y) + h * theta * rest * rest * k[0, i] - end * k[last, i]
    d1, _, d3, d4, d5, d6, d7 = dense
    if d1 != 0.0:
        more = d1 * k[0, i] + d3 * k[2, i] + d4 * k[3, i] + d5 * k[4, i] + d6 * k[5, i] + d7 * k[6, i]
        out += end * rest * more
    return out
