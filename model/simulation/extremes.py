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
from model.dynamics.lanes import HEAD, LANES, SCRATCH_SIZE, STATE_SIZE, C, W, Y, blocks, rows, state_size
from model.dynamics.vehicle import System
from model.simulation.dense import CUBIC, SPARE, Memory, entry_within, state_within
from model.simulation.peaks import FOUND

PITCH, RISING = 2, 4  # entries of the flat state: θ and ẏ of the chassis
LOOKS = 3  # into a step in which a wheel lands or lifts off
LAST_LOOKS = 8  # parts of the last step, between which is looked
SEARCHES = 8  # for a peak, at most: until one look is FOUND, as a share, or less above the one before
BEFORE, HERE, NEXT = range(3)  # the start of the step before, the start and the end of this step
OF_WHEELS = (
    *("before", "here", "next"),  # loads at these, N
    *("load", "depth"),  # largest, N and m
    "air",  # s without load
    *("load_at", "depth_at"),  # s
)
OF_ARMS = ("high", "low", "high_at", "low_at")  # θ_arm − θ_chassis, rad, and s
E, A = rows(OF_WHEELS), rows(OF_ARMS)  # where rows begin
WHEELS_SIZE, ARMS_SIZE = len(OF_WHEELS) * LANES, len(OF_ARMS) * LANES


class Extremes(NamedTuple):
    """What was largest so far, and when; and what the search needs to remember."""

    wheels: np.ndarray  # OF_WHEELS' rows of each block's road wheels, then of its imaginary wheels
    arms: np.ndarray  # OF_ARMS' rows of each block
    hull: np.ndarray  # (2,) |ÿ| of the chassis, m/s², and when, s
    swing: np.ndarray  # (3,) |ÿ| at BEFORE, HERE, NEXT
    earlier: Memory  # the step before: y and k[0] at its start, and at its end while a peak is sought
    start: np.ndarray  # (1,) s: when the step before started


def make_extremes(system: System) -> Extremes:
    """Nothing seen yet."""
    count, size = blocks(system.n), state_size(system.n)
    earlier = Memory(np.zeros(size), np.zeros(size), np.zeros(size), np.zeros((2, size)))
    extremes = Extremes(
        wheels=np.zeros(2 * count * WHEELS_SIZE),
        arms=np.zeros(count * ARMS_SIZE),
        hull=np.zeros(2),
        swing=np.zeros(3),
        earlier=earlier,
        start=np.zeros(1),
    )
    forget(extremes)
    return extremes


def of_wheels(extremes: Extremes, name: str) -> np.ndarray:
    """A row of OF_WHEELS, in all lanes."""
    return extremes.wheels.reshape(-1, len(OF_WHEELS), LANES)[:, OF_WHEELS.index(name)].ravel()


def of_arms(extremes: Extremes, name: str) -> np.ndarray:
    """A row of OF_ARMS, in all lanes."""
    return extremes.arms.reshape(-1, len(OF_ARMS), LANES)[:, OF_ARMS.index(name)].ravel()


def forget(extremes: Extremes) -> None:
    """Begin anew with what is largest."""
    wheels = extremes.wheels.reshape(-1, len(OF_WHEELS), LANES)
    wheels[:, [OF_WHEELS.index("load"), OF_WHEELS.index("depth")]] = -np.inf
    wheels[:, OF_WHEELS.index("air")] = 0.0
    arms = extremes.arms.reshape(-1, len(OF_ARMS), LANES)
    arms[:, OF_ARMS.index("high")], arms[:, OF_ARMS.index("low")] = -np.inf, np.inf
    extremes.hull[:] = -np.inf


@inlined
def _wheels(scratch, wheels, group):
    """Of a block's road wheels (even groups) or imaginary wheels: their scratch space, and their part of `wheels`."""
    at = group // 2 * SCRATCH_SIZE + (W.X_w if group % 2 == 0 else W.X_v)
    return scratch[at : at + len(C) * LANES], wheels[group * WHEELS_SIZE : (group + 1) * WHEELS_SIZE]


@inlined
def _place(j):
    """Where `wheels` has the rows of the wheel in lane j of all."""
    return j // LANES * WHEELS_SIZE + j % LANES


@compiled
def note(lanes, work, y, a_y, extremes, t):
    """Take in what is larger in the state y at time t, whose contact forces are in work."""
    for group in range(len(extremes.wheels) // WHEELS_SIZE):
        w, e = _wheels(work.blocks, extremes.wheels, group)
        for i in range(lanes.lanes):
            if w[C.f_n + i] > e[E.load + i]:
                e[E.load + i], e[E.load_at + i] = w[C.f_n + i], t
            if w[C.z + i] > e[E.depth + i]:
                e[E.depth + i], e[E.depth_at + i] = w[C.z + i], t
    for b in range(len(extremes.arms) // ARMS_SIZE):
        arms = extremes.arms[b * ARMS_SIZE : (b + 1) * ARMS_SIZE]
        for i in range(lanes.lanes):
            turn = y[HEAD + b * STATE_SIZE + Y.theta_a + i] - y[PITCH]
            if turn > arms[A.high + i]:
                arms[A.high + i], arms[A.high_at + i] = turn, t
            if turn < arms[A.low + i]:
                arms[A.low + i], arms[A.low_at + i] = turn, t
    if abs(a_y) > extremes.hull[0]:
        extremes.hull[0], extremes.hull[1] = abs(a_y), t


@compiled
def begin(lanes, work, memory, extremes, t):
    """Take in the start of a motion, or of its next part: a state that did not come out of a step."""
    a_y = memory.k[0, RISING]
    note(lanes, work, memory.y, a_y, extremes, t)
    for group in range(len(extremes.wheels) // WHEELS_SIZE):
        w, e = _wheels(work.blocks, extremes.wheels, group)
        for i in range(lanes.lanes):
            e[E.here + i] = e[E.next + i] = w[C.f_n + i]
    extremes.swing[HERE] = extremes.swing[NEXT] = abs(a_y)
    extremes.start[0] = t


@compiled
def _scan(used, scratch, y, wheels, arms, h):
    """Look at the end y of a step of h s: (something is larger, a peak may have passed, a wheel lands or lifts off),
    each 0 if nowhere. Without branches, and of few arrays: it comes with every step. used: lanes.
    """
    more, passed, crossed = 0.0, 0.0, 0.0
    for group in range(len(wheels) // WHEELS_SIZE):
        w, e = _wheels(scratch, wheels, group)
        for i in range(used):
            before, here, f, top = e[E.here + i], e[E.next + i], w[C.f_n + i], e[E.load + i]
            crest = here + 0.25 * (2.0 * here - before - f)
            more += 1.0 if (f > top) | (w[C.z + i] > e[E.depth + i]) else 0.0
            passed += 1.0 if (here >= before) & (here > f) & (crest > (1.0 + FOUND) * top) else 0.0
            crossed += 1.0 if (here > 0.0) != (f > 0.0) else 0.0
            e[E.air + i] += h if (here <= 0.0) & (f <= 0.0) else 0.0
            e[E.before + i], e[E.here + i], e[E.next + i] = before, here, f
    for b in range(len(arms) // ARMS_SIZE):
        s = y[HEAD + b * STATE_SIZE : HEAD + (b + 1) * STATE_SIZE]
        a = arms[b * ARMS_SIZE : (b + 1) * ARMS_SIZE]
        for i in range(used):
            turn = s[Y.theta_a + i] - y[PITCH]
            more += 1.0 if (turn > a[A.high + i]) | (turn < a[A.low + i]) else 0.0
    return more, passed, crossed


@inlined
def follow(dense, last, lanes, road, work, memory, extremes, t, h):
    """Take in an accepted step from memory.y at t to memory.y_new, whose contact forces are in work."""
    swing, earlier = extremes.swing, extremes.earlier
    swing[BEFORE], swing[HERE], swing[NEXT] = swing[HERE], swing[NEXT], abs(memory.k[last, RISING])
    more, passed, crossed = _scan(lanes.lanes, work.blocks, memory.y_new, extremes.wheels, extremes.arms, h)
    crest = swing[HERE] + 0.25 * (2.0 * swing[HERE] - swing[BEFORE] - swing[NEXT])
    swung = (swing[HERE] >= swing[BEFORE]) & (swing[HERE] > swing[NEXT]) & (crest > (1.0 + FOUND) * extremes.hull[0])
    more += swing[NEXT] > extremes.hull[0]
    if (more > 0.0) | (passed > 0.0) | (crossed > 0.0) | swung:
        _take_in(more, passed, crossed, swung, dense, last, lanes, road, work, memory, extremes, t, h)
    for i in range(len(memory.y)):
        earlier.y[i], earlier.k[0, i] = memory.y[i], memory.k[0, i]
    extremes.start[0] = t


@compiled
def _take_in(more, passed, crossed, swung, dense, last, lanes, road, work, memory, extremes, t, h):
    """What `follow` does where there is something to take in."""
    if more > 0.0:
        note(lanes, work, memory.y_new, memory.k[last, RISING], extremes, t + h)
    if crossed > 0.0:
        _look_into(dense, last, lanes, road, memory, extremes, t, h)
    if (passed > 0.0) | swung:
        earlier = extremes.earlier
        for i in range(len(memory.y)):
            earlier.y_new[i], earlier.k[1, i] = memory.y[i], memory.k[0, i]
    if passed > 0.0:
        _seek_loads(dense, last, lanes, road, work, memory, extremes, t, h)
    if swung:
        _seek(-1, dense, last, lanes, road, work, memory, extremes, t, h)


@compiled
def conclude(lanes, road, work, memory, extremes, t):
    """Look into the last step, which ended at t in memory.y: no step after it tells whether a peak passed."""
    earlier, start = extremes.earlier, extremes.start[0]
    for i in range(len(memory.y)):
        earlier.y_new[i], earlier.k[1, i] = memory.y[i], memory.k[0, i]
    for look in range(1, LAST_LOOKS):
        share = look / LAST_LOOKS
        at = start + share * (t - start)
        state_within(CUBIC, 1, t - start, share, earlier)
        rates(lanes, road, at, earlier.between, memory.k[SPARE], work)
        note(lanes, work, earlier.between, memory.k[SPARE, RISING], extremes, at)


@compiled
def _look_into(dense, last, lanes, road, memory, extremes, t, h):
    """Share the time of a step in which wheels land or lift off between air and ground."""
    wheels = extremes.wheels
    for j in range(len(wheels) // len(OF_WHEELS)):
        e = _place(j)
        if (wheels[e + E.here] > 0.0) != (wheels[e + E.next] > 0.0):
            for look in range(LOOKS):
                at = t + (look + 0.5) / LOOKS * h
                if _load_within(j, dense, last, lanes, road, memory, extremes, t, h, at) <= 0.0:
                    wheels[e + E.air] += h / LOOKS


@compiled
def _seek_loads(dense, last, lanes, road, work, memory, extremes, t, h):
    """Seek the peaks of all wheels that may have passed one."""
    wheels = extremes.wheels
    for j in range(len(wheels) // len(OF_WHEELS)):
        e = _place(j)
        before, here, end = wheels[e + E.before], wheels[e + E.here], wheels[e + E.next]
        crest = here + 0.25 * (2.0 * here - before - end)
        if here >= before and here > end and crest > (1.0 + FOUND) * wheels[e + E.load]:
            _seek(j, dense, last, lanes, road, work, memory, extremes, t, h)


@compiled
def _seek(j, dense, last, lanes, road, work, memory, extremes, t, h):
    """Seek the peak of wheel j's load near t, or of the hull's acceleration for −1, by parabolas through 3 points."""
    start = extremes.start[0]
    a, b, c = start, t, t + h
    f_a, f_b, f_c = extremes.swing[BEFORE], extremes.swing[HERE], extremes.swing[NEXT]
    if j >= 0:
        wheels, e = extremes.wheels, _place(j)
        f_a, f_b, f_c = wheels[e + E.before], wheels[e + E.here], wheels[e + E.next]
    for _ in range(SEARCHES):
        # The crest of the parabola, but not where it is known already
        p, q = (b - a) * (f_b - f_c), (b - c) * (f_b - f_a)
        over = p - q
        x = b - 0.5 * ((b - a) * p - (b - c) * q) / over if over != 0.0 else 0.5 * (b + c)
        x = min(max(x, a + 0.02 * (c - a)), c - 0.02 * (c - a))
        if abs(x - b) < 0.02 * (c - a):
            x = b + (0.1 if c - b > b - a else -0.1) * (c - a)
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
    """Where the flat state has x of the wheel in lane j of all."""
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
    wheels, e = extremes.wheels, _place(j)
    if load > wheels[e + E.load]:
        wheels[e + E.load], wheels[e + E.load_at] = load, at
    if depth > wheels[e + E.depth]:
        wheels[e + E.depth], wheels[e + E.depth_at] = depth, at
    return load
