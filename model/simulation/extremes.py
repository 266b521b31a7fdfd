"""The largest values of a motion, not of its samples: looked for at the end of each step, and between the ends.

Where a load, or the hull's acceleration, is larger at a step's start than at both ends of its two steps, it had a peak
nearby: if that may be the largest of all, it is sought on the dense output. A step in which a wheel lands or lifts off
is looked into in thirds. Arms and depths change slowly enough to be read at these instants only.

Arrays stand in lanes, as the kernel's do (model/dynamics/lanes.py): for each block, eight road wheels and eight
imaginary wheels; eight arms.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from model.compiled import compiled, inlined
from model.dynamics.kernel import rates
from model.dynamics.kernel_contact import load_of
from model.dynamics.lanes import HEAD, LANES, SCRATCH_SIZE, STATE_SIZE, C, W, Y, blocks, state_size
from model.dynamics.vehicle import System
from model.simulation.dense import CUBIC, SPARE, Memory, entry_within, state_within

PITCH, RISING = 2, 4  # entries of the flat state: θ and ẏ of the chassis
NEAR_TOP = 0.85  # of the largest so far: a load that rises above this may come to its peak in the next step
LOOKS = 3  # into a step in which a wheel lands or lifts off
SEARCHES = 8  # for a peak, at most …
FOUND = 0.002  # … until one looks no further than this share of it above the one before
BEFORE, HERE, NEXT = range(3)  # the start of the step before, the start and the end of this step


class Extremes(NamedTuple):
    """What was largest so far, and when, s; and what the search needs to remember."""

    load: np.ndarray  # N, of wheels
    load_at: np.ndarray
    depth: np.ndarray  # m, of wheels
    depth_at: np.ndarray
    air: np.ndarray  # s without load, of wheels
    high: np.ndarray  # θ_arm − θ_chassis, rad, of arms
    high_at: np.ndarray
    low: np.ndarray
    low_at: np.ndarray
    hull: np.ndarray  # (2,) |ÿ| of the chassis, m/s², and when
    loads: np.ndarray  # (3, wheels) N at BEFORE, HERE, NEXT
    swing: np.ndarray  # (3,) |ÿ| at the same
    earlier: Memory  # the step before, while it is kept: its y, y_new, k[0] and k[1]
    times: np.ndarray  # (2,) s: when the step before started, and when the one that is kept did


def make_extremes(system: System) -> Extremes:
    """Nothing seen yet."""
    count, size = blocks(system.n) * LANES, state_size(system.n)
    earlier = Memory(np.zeros(size), np.zeros(size), np.zeros(size), np.zeros((2, size)))
    of_wheels = {name: np.zeros(2 * count) for name in ("load", "load_at", "depth", "depth_at", "air")}
    of_arms = {name: np.zeros(count) for name in ("high", "high_at", "low", "low_at")}
    extremes = Extremes(
        **of_wheels,
        **of_arms,
        hull=np.zeros(2),
        loads=np.zeros((3, 2 * count)),
        swing=np.zeros(3),
        earlier=earlier,
        times=np.zeros(2),
    )
    forget(extremes)
    return extremes


def forget(extremes: Extremes) -> None:
    """Begin anew with what is largest."""
    for values in (extremes.load, extremes.depth, extremes.high, extremes.hull):
        values[:] = -np.inf
    extremes.low[:] = np.inf
    extremes.air[:] = 0.0


@inlined
def _wheels(lanes, work, extremes, b, kind):
    """Scratch space of the road wheels (kind 0) or imaginary wheels (1) of a block, and where their lanes begin."""
    at = b * SCRATCH_SIZE + (W.X_w if kind == 0 else W.X_v)
    return work.blocks[at : at + len(C) * LANES], (2 * b + kind) * LANES


@compiled
def note(lanes, work, y, a_y, extremes, t):
    """Take in what is larger in the state y at time t, whose contact forces are in work."""
    for b in range(len(work.blocks) // SCRATCH_SIZE):
        for kind in range(2):
            w, first = _wheels(lanes, work, extremes, b, kind)
            for i in range(lanes.lanes):
                j = first + i
                if w[C.f_n + i] > extremes.load[j]:
                    extremes.load[j], extremes.load_at[j] = w[C.f_n + i], t
                if w[C.z + i] > extremes.depth[j]:
                    extremes.depth[j], extremes.depth_at[j] = w[C.z + i], t
        for i in range(lanes.lanes):
            j = b * LANES + i
            turn = y[HEAD + b * STATE_SIZE + Y.theta_a + i] - y[PITCH]
            if turn > extremes.high[j]:
                extremes.high[j], extremes.high_at[j] = turn, t
            if turn < extremes.low[j]:
                extremes.low[j], extremes.low_at[j] = turn, t
    if abs(a_y) > extremes.hull[0]:
        extremes.hull[0], extremes.hull[1] = abs(a_y), t


@compiled
def begin(lanes, work, memory, extremes, t):
    """Take in the start of a motion, or of its next part: a state that did not come out of a step."""
    a_y = memory.k[0, RISING]
    note(lanes, work, memory.y, a_y, extremes, t)
    for b in range(len(work.blocks) // SCRATCH_SIZE):
        for kind in range(2):
            w, first = _wheels(lanes, work, extremes, b, kind)
            for i in range(lanes.lanes):
                extremes.loads[BEFORE, first + i] = extremes.loads[HERE, first + i] = w[C.f_n + i]
    extremes.swing[BEFORE] = extremes.swing[HERE] = abs(a_y)
    extremes.times[0], extremes.times[1] = t, -1.0


@inlined
def _scan(lanes, work, y, extremes, h):
    """Look at the end y of a step of h s: (something is larger, a peak may have passed, one may come, a wheel lands or
    lifts off), each 0 if nowhere. Without branches, for this comes with every step.
    """
    more, passed, coming, crossed = 0.0, 0.0, 0.0, 0.0
    for b in range(len(work.blocks) // SCRATCH_SIZE):
        for kind in range(2):
            w, first = _wheels(lanes, work, extremes, b, kind)
            loads = extremes.loads[:, first : first + LANES]
            before, here, end = loads[BEFORE], loads[HERE], loads[NEXT]
            top, deepest = extremes.load[first : first + LANES], extremes.depth[first : first + LANES]
            air = extremes.air[first : first + LANES]
            for i in range(lanes.lanes):
                f = w[C.f_n + i]
                bend = 2.0 * here[i] - before[i] - f
                more += 1.0 if (f > top[i]) | (w[C.z + i] > deepest[i]) else 0.0
                passed += 1.0 if (here[i] >= before[i]) & (here[i] > f) & (here[i] + 0.25 * bend > top[i]) else 0.0
                coming += 1.0 if (f > here[i]) & (f > NEAR_TOP * top[i]) else 0.0
                crossed += 1.0 if (here[i] > 0.0) != (f > 0.0) else 0.0
                air[i] += h if (here[i] <= 0.0) & (f <= 0.0) else 0.0
                end[i] = f
        s = y[HEAD + b * STATE_SIZE : HEAD + (b + 1) * STATE_SIZE]
        high, low = extremes.high[b * LANES : (b + 1) * LANES], extremes.low[b * LANES : (b + 1) * LANES]
        for i in range(lanes.lanes):
            turn = s[i + Y.theta_a] - y[PITCH]
            more += 1.0 if (turn > high[i]) | (turn < low[i]) else 0.0
    return more, passed, coming, crossed


@compiled
def follow(dense, last, lanes, road, work, memory, extremes, t, h):
    """Take in an accepted step from memory.y at t to memory.y_new, whose contact forces are in work."""
    a_y = memory.k[last, RISING]
    swing = extremes.swing
    swing[NEXT] = abs(a_y)
    more, passed, coming, crossed = _scan(lanes, work, memory.y_new, extremes, h)
    more += swing[NEXT] > extremes.hull[0]
    bend = 2.0 * swing[HERE] - swing[BEFORE] - swing[NEXT]
    top = extremes.hull[0]
    swung = (swing[HERE] >= swing[BEFORE]) & (swing[HERE] > swing[NEXT]) & (swing[HERE] + 0.25 * bend > top)
    coming += (swing[NEXT] > swing[HERE]) & (swing[NEXT] > NEAR_TOP * top)
    if more > 0.0:
        note(lanes, work, memory.y_new, a_y, extremes, t + h)
    if crossed > 0.0:
        _look_into(dense, last, lanes, road, memory, extremes, t, h)
    if passed > 0.0:
        _seek_loads(dense, last, lanes, road, work, memory, extremes, t, h)
    if swung:
        _seek(-1, dense, last, lanes, road, work, memory, extremes, t, h)
    if coming > 0.0:
        earlier = extremes.earlier
        for i in range(len(memory.y)):
            earlier.y[i], earlier.y_new[i] = memory.y[i], memory.y_new[i]
            earlier.k[0, i], earlier.k[1, i] = memory.k[0, i], memory.k[last, i]
        extremes.times[1] = t
    extremes.times[0] = t
    loads = extremes.loads
    for j in range(loads.shape[1]):
        loads[BEFORE, j], loads[HERE, j] = loads[HERE, j], loads[NEXT, j]
    swing[BEFORE], swing[HERE] = swing[HERE], swing[NEXT]


@compiled
def _look_into(dense, last, lanes, road, memory, extremes, t, h):
    """Share the time of a step in which wheels land or lift off between air and ground."""
    loads = extremes.loads
    for j in range(loads.shape[1]):
        if (loads[HERE, j] > 0.0) != (loads[NEXT, j] > 0.0):
            for look in range(LOOKS):
                at = t + (look + 0.5) / LOOKS * h
                if _load_within(j, dense, last, lanes, road, memory, extremes, t, h, at) <= 0.0:
                    extremes.air[j] += h / LOOKS


@compiled
def _seek_loads(dense, last, lanes, road, work, memory, extremes, t, h):
    """Seek the peaks of all wheels that may have passed one."""
    loads = extremes.loads
    for j in range(loads.shape[1]):
        before, here, end = loads[BEFORE, j], loads[HERE, j], loads[NEXT, j]
        if here >= before and here > end and here + 0.25 * (2.0 * here - before - end) > extremes.load[j]:
            _seek(j, dense, last, lanes, road, work, memory, extremes, t, h)


@compiled
def _seek(j, dense, last, lanes, road, work, memory, extremes, t, h):
    """Seek the peak of wheel j's load near t, or of the hull's acceleration for −1, by parabolas through 3 points.

    Where the step before was not kept, in the present step only.
    """
    kept, start = extremes.times[1] == extremes.times[0], extremes.times[0]
    a, b, c = start, t, t + h
    f_a, f_b, f_c = extremes.swing[BEFORE], extremes.swing[HERE], extremes.swing[NEXT]
    if j >= 0:
        f_a, f_b, f_c = extremes.loads[BEFORE, j], extremes.loads[HERE, j], extremes.loads[NEXT, j]
    for _ in range(SEARCHES):
        # The crest of the parabola, but not where it is known already
        p, q = (b - a) * (f_b - f_c), (b - c) * (f_b - f_a)
        over = p - q
        x = b - 0.5 * ((b - a) * p - (b - c) * q) / over if over != 0.0 else 0.5 * (b + c)
        x = min(max(x, a + 0.02 * (c - a)), c - 0.02 * (c - a))
        if abs(x - b) < 0.02 * (c - a):
            x = b + (0.1 if c - b > b - a else -0.1) * (c - a)
        if x < t and not kept:
            x = t + 0.5 * min(h, c - t)
        if j >= 0:
            if x >= t:
                f_x = _load_within(j, dense, last, lanes, road, memory, extremes, t, h, x)
            else:
                f_x = _load_within(j, CUBIC, 1, lanes, road, extremes.earlier, extremes, start, t - start, x)
        else:
            if x >= t:
                state_within(dense, last, h, (x - t) / h, memory)
                y = memory.between
            else:
                state_within(CUBIC, 1, t - start, (x - start) / (t - start), extremes.earlier)
                y = extremes.earlier.between
            rates(lanes, road, x, y, memory.k[SPARE], work)
            note(lanes, work, y, memory.k[SPARE, RISING], extremes, x)
            f_x = abs(memory.k[SPARE, RISING])
        found = abs(f_x - f_b) < FOUND * f_b
        if f_x > f_b:
            if x > b:
                a, f_a = b, f_b
            else:
                c, f_c = b, f_b
            b, f_b = x, f_x
        elif x > b:
            c, f_c = x, f_x
        else:
            a, f_a = x, f_x
        if found:
            break


@inlined
def place_of(j):
    """Where the flat state has x of the wheel in lane j of Extremes."""
    b, within = j // (2 * LANES), j % (2 * LANES)
    return HEAD + b * STATE_SIZE + (Y.x_w if within < LANES else Y.x_v) + within % LANES


@inlined
def _load_within(j, dense, last, lanes, road, memory, extremes, t, h, at):
    """The load of wheel j at a time in the step of h s from t on, which is taken in where it is the largest."""
    theta, x = (at - t) / h, place_of(j)
    place_x = entry_within(dense, last, h, theta, memory, x)
    place_y = entry_within(dense, last, h, theta, memory, x + LANES)
    v_x = entry_within(dense, last, h, theta, memory, x + 3 * LANES)
    v_y = entry_within(dense, last, h, theta, memory, x + 4 * LANES)
    load, depth = load_of(lanes, road, place_x, place_y, v_x, v_y)
    if load > extremes.load[j]:
        extremes.load[j], extremes.load_at[j] = load, at
    if depth > extremes.depth[j]:
        extremes.depth[j], extremes.depth_at[j] = depth, at
    return load
