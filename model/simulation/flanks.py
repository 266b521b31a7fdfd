"""Where a wheel passes from one flank of a valley to the other: no step may contain that.

A wheel in a valley tighter than itself touches at the nearest point only. That point jumps from flank to flank, and the
force's direction with it, between two stages of a step: no estimate of the error sees through that. So a step that
contains such a change is made anew to end just before it, and the next begins just behind.

A wheel that is pressed into a corner goes to and fro without end. After MOST_CHANGES in quick succession it counts as
jammed: its changes are let pass, and the speeds of its chain may tremble.

Wheels stand in lanes, as in `Extremes`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from model.compiled import compiled, inlined
from model.dynamics.lanes import BODIES, COORDINATES, HEAD, LANES, SCRATCH_SIZE, STATE_SIZE, C, W, Y, blocks
from model.dynamics.vehicle import System
from model.road.nearest_point import nearest
from model.simulation.dense import entry_within
from model.simulation.extremes import place_of

TURN = 0.06  # of a normal in a step that may be a jump, and more than a gentle road turns it by:
BEND = 0.25  # of the wheel's way over its radius
JUMP = 0.04  # of a normal within RESOLUTION: else the ground is only tightly curved
RESOLUTION = 5e-8  # s
MOST_CHANGES = 300  # of one wheel, each at most QUICK after the one before: then it is jammed
QUICK = 0.01  # s
TREMBLE = 1e-3  # m/s or rad/s: error of a jammed chain's speeds that is allowed whatever rtol is; more, and joints part
CALM = 0.02  # s without a change: then it is free again
NO_NORMAL = 2.0  # of a wheel that bears nothing
NOBODY = -1


class Flanks(NamedTuple):
    """What the stepper remembers of each wheel."""

    normal: np.ndarray  # n_x of the ground under it at the start of the step; NO_NORMAL where it bears nothing
    normal_next: np.ndarray  # the same at the end
    changes: np.ndarray  # in quick succession
    latest: np.ndarray  # s, when the last of them was
    jammed_until: np.ndarray  # s; −1 where it is free
    jammed: np.ndarray  # (1,) how many are
    over_scale: np.ndarray  # (size,) what errors are multiplied by
    usual: np.ndarray  # (size,) the same where no wheel is jammed


def make_flanks(system: System, over_scale: np.ndarray) -> Flanks:
    """No wheel has been looked at yet. over_scale: (size,) what errors of the flat state are multiplied by."""
    count = 2 * blocks(system.n) * LANES
    return Flanks(
        normal=np.full(count, NO_NORMAL),
        normal_next=np.full(count, NO_NORMAL),
        changes=np.zeros(count),
        latest=np.full(count, -np.inf),
        jammed_until=np.full(count, -1.0),
        jammed=np.zeros(1),
        over_scale=over_scale.copy(),
        usual=over_scale,
    )


@inlined
def look(lanes, work, memory, flanks):
    """Note the normals that the forces in work have, as those of the step's end; how many wheels may have changed
    flanks. Without branches, for this comes with every step.
    """
    turned = 0.0
    for b in range(len(work.blocks) // SCRATCH_SIZE):
        for kind in range(2):
            at, first = b * SCRATCH_SIZE + (W.X_w if kind == 0 else W.X_v), (2 * b + kind) * LANES
            place = HEAD + b * STATE_SIZE + (Y.x_w if kind == 0 else Y.x_v)
            w = work.blocks[at : at + len(C) * LANES]
            here, there = memory.y[place : place + 2 * LANES], memory.y_new[place : place + 2 * LANES]
            before, after = flanks.normal[first : first + LANES], flanks.normal_next[first : first + LANES]
            for i in range(lanes.lanes):
                f_n, f_t = w[C.f_n + i], w[C.f_t + i]
                n = (w[C.F_x + i] * f_n - w[C.F_y + i] * f_t) / max(f_n * f_n + f_t * f_t, 1e-300)
                n = n if f_n > 0.0 else NO_NORMAL
                way = abs(there[i] - here[i]) + abs(there[LANES + i] - here[LANES + i])
                bears = (n < NO_NORMAL) & (before[i] < NO_NORMAL)
                turned += 1.0 if bears & (lanes.r * (abs(n - before[i]) - TURN) > BEND * way) else 0.0
                after[i] = n
    return turned


@inlined
def keep(flanks, watching):
    """What was the step's end is the next one's start, unless nothing was looked at."""
    for j in range(len(flanks.normal)):
        flanks.normal[j] = flanks.normal_next[j] if watching else NO_NORMAL


@compiled
def before_change(dense, last, lanes, road, memory, flanks, t, h):
    """After `look` has found some: (s until the first wheel changes flanks, which), or h and NOBODY."""
    soonest, which = h, NOBODY
    for j in range(len(flanks.normal)):
        n_low, n_high = flanks.normal[j], flanks.normal_next[j]
        x = place_of(j)
        y = x + LANES
        way = abs(memory.y_new[x] - memory.y[x]) + abs(memory.y_new[y] - memory.y[y])
        if max(n_low, n_high) >= NO_NORMAL or lanes.r * (abs(n_high - n_low) - TURN) <= BEND * way:
            continue
        if flanks.jammed_until[j] >= t:
            _jam(flanks, j, t + h)
            continue
        low, high = 0.0, 1.0
        while (high - low) * h > RESOLUTION and abs(n_high - n_low) >= JUMP:  # towards where it turns most
            theta = 0.5 * (low + high)
            place_x = entry_within(dense, last, h, theta, memory, x)
            _s, _h, n, _n_y, _d = nearest(road, place_x, entry_within(dense, last, h, theta, memory, y))
            if abs(n - n_low) > abs(n_high - n):
                high, n_high = theta, n
            else:
                low, n_low = theta, n
        if abs(n_high - n_low) >= JUMP and low * h < soonest:
            soonest, which = low * h, j
    return soonest, which


@compiled
def changed(flanks, j, t):
    """Take in that wheel j has changed flanks."""
    flanks.changes[j] = flanks.changes[j] + 1.0 if t - flanks.latest[j] < QUICK else 0.0
    flanks.latest[j] = t
    if flanks.changes[j] >= MOST_CHANGES:
        flanks.changes[j] = 0.0
        _jam(flanks, j, t)


@inlined
def _weigh(flanks, j, most):
    """Errors of the speeds of wheel j's chain are multiplied by that at most."""
    chain = HEAD + j // (2 * LANES) * STATE_SIZE + j % LANES
    for body in range(len(BODIES)):
        for speed in range(len(COORDINATES) // 2, len(COORDINATES)):
            k = chain + (body * len(COORDINATES) + speed) * LANES
            flanks.over_scale[k] = min(flanks.usual[k], most)


@inlined
def _jam(flanks, j, t):
    """Wheel j is jammed at t."""
    if flanks.jammed_until[j] < 0.0:
        flanks.jammed[0] += 1.0
    flanks.jammed_until[j] = t + CALM
    _weigh(flanks, j, 1.0 / TREMBLE)


@compiled
def release(flanks, t):
    """Free the wheels that have come to rest on one flank, or got out."""
    for j in range(len(flanks.normal)):
        if 0.0 <= flanks.jammed_until[j] < t:
            flanks.jammed_until[j] = -1.0
            flanks.jammed[0] -= 1.0
            _weigh(flanks, j, np.inf)
