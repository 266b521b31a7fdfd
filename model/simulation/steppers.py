"""Compiled steppers for the equations of motion, with dense output: samples at the output rate are interpolated inside
the steps and never shorten them.

`adaptive` serves every explicit Runge–Kutta pair that a Tableau describes; `runge_kutta_4` has a fixed step.
"""

from __future__ import annotations

from enum import IntEnum
from math import prod
from typing import Any, NamedTuple

import numpy as np

from model.compiled import compiled, inlined
from model.dynamics.kernel import constraint_residual, loads, multipliers, rates
from model.dynamics.lanes import INT_E, SPEED, WORK, places, state_size
from model.dynamics.vehicle import System
from model.simulation.dense import CUBIC, SPARE, entry_within, state_within
from model.simulation.extremes import begin, follow
from model.simulation.flanks import NOBODY, before_change, changed, keep, look, release

STEPS_PER_SECOND = 50_000  # of simulated time, at most; five hundred times what the paper's vehicle needs
SMALLEST_STEP = 1e-10  # s
MOST_FORCED = 100  # steps of this length until one is longer again
OVER = 2e-7  # s that take an arm over the beginning of a stop, a wheel to another flank
FASTEST = 1e3  # m/s: a body faster than this shows that the run has diverged
FURTHEST = 1e20  # of the sum of a state: far above any vehicle's, and forces and accelerations are still finite
STEPS_PER_CHUNK = 1_000  # so that a stop is heeded however stiff the run: 0.05 s at worst
POWERS = 30  # of the Jacobian, to find its largest eigenvalue to a few per cent
NUDGE = 1e-6  # m, rad, m/s or rad/s: a change small enough for the system to be linear
SIZE_OF_SPEED = 1.0  # m/s or rad/s, what rtol is measured against: see error_scale
SIZE_OF_POSITION = 0.1  # m or rad
SIZE_OF_DISPLACEMENT = 0.1  # m
NO_LIMIT = 1e30
LEAST_INTEGRAL = (
    1e-5  # m: error of ∫e that is allowed whatever rtol is; its rate jumps where the drive force is limited
)
LIVELY = 1.5  # m/s: where a body rises or falls faster than this, errors must be smaller in proportion …
MOST_CARE = 4.0  # … down to this part
VALLEYS = 30.0  # m: where valleys go on for longer, errors must be smaller yet
RESTLESS = 0.9  # m/s: from this on …
MOST_THERE = 5.0  # … with the third power, down to this part
STEEP = 0.38  # root of the mean square slope, between those of classes G and H: where such ground is steeper …
STEEP_CARE = 5.0  # … errors must be smaller by this
DRIVE = -2  # stands for a wheel that changes flanks: the drive comes to its limit, or off it


class Status(IntEnum):
    """Why a run stands where it stands."""

    RUNNING = 0
    COMPLETE = 1
    STEP_TOO_SMALL = 2
    NOT_FINITE = 3
    TOO_MANY_STEPS = 4
    SOLVER_FAILED = 5
    RUNAWAY = 6
    JOINTS_APART = 7


class Samples(NamedTuple):
    """The run at the output rate, N samples: the result file's arrays."""

    q: np.ndarray  # (N, B, 3)
    v: np.ndarray  # (N, B, 3)
    a: np.ndarray  # (N, B, 3); of the chassis only (N, 1, 3) where only figures are wanted
    f_n: np.ndarray  # (N, W)
    f_t: np.ndarray  # (N, W)
    xi: np.ndarray  # (N, W)
    F: np.ndarray  # (N,)
    lam: np.ndarray  # (N, rows of C); (N, 0) where only figures are wanted
    residual: np.ndarray  # (N,)
    work: np.ndarray  # (N,) J


def make_samples(system: System, count: int, figures_only: bool = False) -> Samples:
    """Room for that many samples, in one piece: the system gives a large one in large pages, which is quicker.

    figures_only: without what no figure is read off.
    """
    B, W = len(system.mass), len(system.wheel)
    rows = 2 * len(system.joint_i) + int(system.prescribed)
    accelerated, rows = (1, 0) if figures_only else (B, rows)
    shapes = [(count, *shape) for shape in [(B, 3), (B, 3), (accelerated, 3), (W,), (W,), (W,), (), (rows,), (), ()]]
    ends = np.cumsum([0, *map(prod, shapes)])
    block = np.empty(ends[-1])
    parts = (block[first:end].reshape(shape) for first, end, shape in zip(ends, ends[1:], shapes, strict=False))
    return Samples._make(parts)


CLOCK = np.dtype(
    [
        ("t", "f8"),  # simulated time so far, s
        ("step", "f8"),  # proposed next, s
        ("smallest", "f8"),  # accepted step so far, s
        ("last_error", "f8"),  # of the last step, 1 is what is allowed
        ("steps", "i8"),  # accepted
        ("rejected", "i8"),  # tried again with a shorter step
        ("evaluations", "i8"),  # of the right-hand side
        ("recorded", "i8"),  # samples
        ("taken", "i8"),  # of these, taken away to make room
        ("status", "i8"),  # a Status
        ("apart", "f8"),  # of the joints where that ended the run, m
        ("forced", "i8"),  # steps accepted though their error was too large, since the last of a usual length
        ("fresh", "i8"),  # 1 when the derivative at y is known
    ]
)


def make_clock(step: float) -> Any:
    """What a stepper carries from step to step: a record of CLOCK's fields at t = 0. step: the first to be tried, s."""
    clock = np.recarray(1, CLOCK)
    clock[0] = (0.0, step, np.inf, 1e-4, 0, 0, 0, 0, 0, Status.RUNNING, 0.0, 0, 0)
    return clock[0]


class Span(NamedTuple):
    """How far a stepper goes, s."""

    rate: float  # samples a second
    end: float  # of the run
    stop: float  # of this call
    longest: float  # step
    apart: float  # m that joints may be apart
    valleys_from: float  # m, of the chassis: from here …
    valleys_to: float  # … to here a wheel may bridge a valley
    steep: float  # errors must be smaller by this there; 1 where they need not


def error_scale(system: System, rtol: float, atol: float) -> np.ndarray:
    """What counts as an error of one for each entry of the flat state: atol + rtol · size.

    The sizes are fixed ones for each kind of state, so that the accuracy is the same wherever on the road the vehicle
    is and however far its wheels have turned. On rough ground `care` makes all of them smaller.
    """
    body, wheel = places(system.n, system.m)
    size = np.ones(state_size(system.n))
    size[body[:, :3]], size[body[:, 3:]] = SIZE_OF_POSITION, SIZE_OF_SPEED
    size[wheel] = size[INT_E] = SIZE_OF_DISPLACEMENT
    scale = atol + rtol * size
    scale[INT_E] = max(scale[INT_E], LEAST_INTEGRAL)
    scale[WORK] = NO_LIMIT  # a check of the motion, which it must not change
    return scale


@compiled
def record(lanes, road, t, y, dy, work, samples, k):
    """Sample k: everything that the state y at time t tells, as far as samples have room for it."""
    rates(lanes, road, t, y, dy, work)
    if samples.lam.shape[1] > 0:
        multipliers(lanes, dy, work, samples.lam[k])
    for b in range(len(lanes.place)):
        for axis in range(3):
            samples.q[k, b, axis] = y[lanes.place[b, axis]]
            samples.v[k, b, axis] = y[lanes.place[b, axis + 3]]
    for b in range(samples.a.shape[1]):
        for axis in range(3):
            samples.a[k, b, axis] = dy[lanes.place[b, axis + 3]]
    loads(lanes, work, samples.f_n[k], samples.f_t[k])
    for wheel in range(len(lanes.xi_place)):
        samples.xi[k, wheel] = y[lanes.xi_place[wheel]]
    samples.F[k] = work.F[0]
    samples.residual[k] = constraint_residual(lanes, t, y, work)
    samples.work[k] = y[WORK]


@compiled
def trouble(lanes, y):
    """Status.NOT_FINITE or RUNAWAY for a state that no vehicle can be in, else 0."""
    fastest = 0.0
    for b in range(len(lanes.place)):
        fastest = max(fastest, abs(y[lanes.place[b, 3]]), abs(y[lanes.place[b, 4]]))
    total = 0.0
    for i in range(len(y)):
        total += y[i]
    if not abs(total) < FURTHEST:
        return Status.NOT_FINITE.value
    return Status.RUNAWAY.value if fastest > FASTEST else Status.RUNNING.value


@inlined
def care(lanes, y, among_valleys, steep):
    """How much smaller errors must be where wheels are thrown about, since what follows magnifies them: 1 on gentle
    roads.
    """
    fastest = 0.0
    for b in range(len(lanes.place)):
        fastest = max(fastest, abs(y[lanes.place[b, 4]]))
    smaller = min(max(fastest / LIVELY, 1.0), MOST_CARE)
    if among_valleys:
        smaller *= steep * min(max((fastest / RESTLESS) ** 3, 1.0), MOST_THERE)
    return smaller


@compiled
def stiffest_rate(lanes, road, t, y, work, k, y_near):
    """About the largest −λ, 1/s, of the right-hand side linearised at y, by power iteration; k: (3, size) or more.

    Contacts and dampers make it stiff, and their eigenvalues are real.
    """
    size = len(y)
    here, near, direction = k[0], k[1], k[2]
    rates(lanes, road, t, y, here, work)
    for i in range(size):
        direction[i] = 1.0 + 0.1 * np.sin(7.0 * i)  # as good as any that no symmetry keeps from the one sought
    stretch = 0.0
    for _ in range(POWERS):
        square = 0.0
        for i in range(size):
            square += direction[i] * direction[i]
        shrink = NUDGE / np.sqrt(square)
        for i in range(size):
            direction[i] *= shrink
            y_near[i] = y[i] + direction[i]
        rates(lanes, road, t, y_near, near, work)
        along = 0.0
        for i in range(size):
            change = near[i] - here[i]
            along += direction[i] * change
            direction[i] = change
        stretch = -along / NUDGE**2
    return max(stretch, 1.0)


@inlined
def _stage_state(weights, stage, h, memory):
    """The state of a stage: y + h Σ w_j k_j over the stages before it. Written out, each needs one pass."""
    size = len(memory.y)
    y, out, k = memory.y, memory.y_new, memory.k
    k1, k2, k3, k4, k5, k6 = k[0], k[1], k[2], k[3], k[4], k[5]
    w1, w2, w3, w4, w5, w6 = weights
    if stage == 1:
        for i in range(size):
            out[i] = y[i] + h * (w1 * k1[i])
    elif stage == 2:
        for i in range(size):
            out[i] = y[i] + h * (w1 * k1[i] + w2 * k2[i])
    elif stage == 3:
        for i in range(size):
            out[i] = y[i] + h * (w1 * k1[i] + w2 * k2[i] + w3 * k3[i])
    elif stage == 4:
        for i in range(size):
            out[i] = y[i] + h * (w1 * k1[i] + w2 * k2[i] + w3 * k3[i] + w4 * k4[i])
    elif stage == 5:
        for i in range(size):
            out[i] = y[i] + h * (w1 * k1[i] + w2 * k2[i] + w3 * k3[i] + w4 * k4[i] + w5 * k5[i])
    else:
        for i in range(size):
            out[i] = y[i] + h * (w1 * k1[i] + w2 * k2[i] + w3 * k3[i] + w4 * k4[i] + w5 * k5[i] + w6 * k6[i])


@inlined
def _error_of(weights, h, memory, over_scale, states):
    """The estimated error of a step: the fourth root of the mean fourth power over all states; 1 is allowed."""
    k = memory.k
    k1, k2, k3, k4, k5, k6, k7 = k[0], k[1], k[2], k[3], k[4], k[5], k[6]
    e1, e2, e3, e4, e5, e6, e7 = weights
    total = 0.0
    for i in range(len(memory.y)):
        e = e1 * k1[i] + e2 * k2[i] + e3 * k3[i] + e4 * k4[i] + e5 * k5[i] + e6 * k6[i] + e7 * k7[i]
        square = (e * over_scale[i]) ** 2
        total += square * square
    return h * np.sqrt(np.sqrt(total / states))


@inlined
def _record_step(dense, last, lanes, road, work, memory, samples, clock, span, t_new):
    """Record the samples of the step from clock.t to t_new, as far as there is room and joints hold."""
    room = len(samples.residual) + clock.taken
    h = t_new - clock.t
    while clock.recorded < room and clock.recorded / span.rate <= t_new:
        t = clock.recorded / span.rate
        state_within(dense, last, h, (t - clock.t) / h, memory)
        row = clock.recorded - clock.taken
        record(lanes, road, t, memory.between, memory.k[SPARE], work, samples, row)
        if samples.residual[row] > span.apart:
            clock.status, clock.apart = Status.JOINTS_APART.value, samples.residual[row]
            break
        clock.recorded += 1


@inlined
def _move_on(memory, last, clock, h, t_new, end):
    """Take over the end of a step."""
    for i in range(len(memory.y)):
        memory.y[i], memory.k[0, i] = memory.y_new[i], memory.k[last, i]
    clock.t = t_new
    clock.steps += 1
    if t_new < end:  # the last step is as short as is left
        clock.smallest = min(clock.smallest, h)


@inlined
def _begin(lanes, road, work, memory, extremes, flanks, clock):
    """Make sure that k[0] is the derivative at y."""
    if clock.fresh == 0:
        rates(lanes, road, clock.t, memory.y, memory.k[0], work)
        begin(lanes, work, memory, extremes, clock.t)
        look(lanes, work, memory, flanks)
        keep(flanks, True)
        clock.evaluations += 1
        clock.fresh = 1


@inlined
def _before_stop(lanes, memory, h):
    """How long a step from y to y_new of h s may be so that no arm meets a stop in it, s; h where none does.

    The force of a stop begins with a jump where its damper takes hold, which no step may contain.
    """
    y, y_new = memory.y, memory.y_new
    soonest = h
    for arm in range(lanes.n):
        angle, rate = lanes.place[1 + arm, 2], lanes.place[1 + arm, 5]
        u, u_new, u_dot, u_dot_new = y[2] - y[angle], y_new[2] - y_new[angle], y[5] - y[rate], y_new[5] - y_new[rate]
        stop = 0.0
        if u <= lanes.stops.bump < u_new:
            stop = lanes.stops.bump
        elif u >= lanes.stops.rebound > u_new:
            stop = lanes.stops.rebound
        else:
            continue
        low, high = 0.0, 1.0
        for _ in range(30):  # bisection on the cubic between the ends
            theta = 0.5 * (low + high)
            rest = 1.0 - theta
            between = u + theta * theta * (3.0 - 2.0 * theta) * (u_new - u)
            between += h * theta * rest * (rest * u_dot - theta * u_dot_new)
            if (between > stop) == (u_new > stop):
                high = theta
            else:
                low = theta
        soonest = min(soonest, low * h)
    return soonest


@inlined
def _limited(lanes, v_x, int_e):
    """1 or −1 where the drive asks for more force than its limit that way, else 0."""
    demand = lanes.K_p * (lanes.v_ref - v_x) + lanes.K_i * int_e
    return 1.0 if demand > lanes.F_max else (-1.0 if demand < -lanes.F_max else 0.0)


@inlined
def _before_limit(dense, last, lanes, memory, h):
    """How long a step from y to y_new of h s may be so that the drive neither comes to its limit nor off it, s; h where
    it does not: there the rate of ∫e jumps.
    """
    before = _limited(lanes, memory.y[SPEED], memory.y[INT_E])
    if _limited(lanes, memory.y_new[SPEED], memory.y_new[INT_E]) == before:
        return h
    low, high = 0.0, 1.0
    for _ in range(40):  # bisection on the dense output
        theta = 0.5 * (low + high)
        v_x = entry_within(dense, last, h, theta, memory, SPEED)
        if _limited(lanes, v_x, entry_within(dense, last, h, theta, memory, INT_E)) == before:
            low = theta
        else:
            high = theta
    return low * h


@inlined
def _holds(lanes, side, y, dy):
    """Whether the demand would come back to the limit from both sides: with ∫e running freely it would rise above,
    with ∫e at a stand it would fall below. So it stays there, and the rate of ∫e lies between.
    """
    falls = side * lanes.K_p * dy[SPEED]
    return (falls >= 0.0) & (falls <= side * lanes.K_i * (lanes.v_ref - y[SPEED])) & (lanes.K_i > 0.0)


@inlined
def _hold(lanes, work, memory):
    """Hold the drive at the limit that it has just come to, or off, if it would chatter there."""
    y, dy = memory.y, memory.k[0]
    side = 1.0 if lanes.K_p * (lanes.v_ref - y[SPEED]) + lanes.K_i * y[INT_E] > 0.0 else -1.0
    if _holds(lanes, side, y, dy):
        work.held[0] = side
        dy[INT_E] = lanes.K_p * dy[SPEED] / lanes.K_i


@inlined
def _step_over(lanes, road, work, memory, extremes, flanks, clock):
    """Move on by so short a time that nothing changes but on which side of a stop an arm is, or a wheel's flank."""
    for i in range(len(memory.y)):
        memory.y[i] += OVER * memory.k[0, i]
    clock.t += OVER
    clock.fresh = 0
    _begin(lanes, road, work, memory, extremes, flanks, clock)


@compiled
def adaptive(tableau, lanes, road, work, memory, samples, extremes, flanks, clock, span):
    """Steps of a Runge–Kutta pair until t ≥ span.stop, the run's end, trouble or STEPS_PER_CHUNK tries."""
    states = 6 * len(lanes.place) + len(lanes.xi_place) + 1  # without empty lanes
    last = tableau.stages - 1
    usual, after_rejection = 0.85 / tableau.order, 1.0 / tableau.order
    most_tries = clock.steps + clock.rejected + STEPS_PER_CHUNK
    most_growth = 5.0
    stopped = lanes.stops.bump < np.inf or lanes.stops.rebound > -np.inf
    planned = 0.0  # step before it was cut short at a stop
    many_valleys = span.valleys_to - span.valleys_from > VALLEYS
    _begin(lanes, road, work, memory, extremes, flanks, clock)
    while clock.t < span.stop and clock.steps + clock.rejected < most_tries:
        h = min(min(clock.step, span.longest), span.end - clock.t)
        for stage in range(1, tableau.stages):
            _stage_state(tableau.stage[stage], stage, h, memory)
            rates(lanes, road, clock.t + tableau.time[stage] * h, memory.y_new, memory.k[stage], work)
        clock.evaluations += last
        watching = (memory.y[0] > span.valleys_from) & (memory.y[0] < span.valleys_to)
        error = _error_of(tableau.error, h, memory, flanks.over_scale, states)
        error *= care(lanes, memory.y, watching & many_valleys, span.steep)

        # At a jump of the forces no step is short enough; one of SMALLEST_STEP is too short to matter
        good = error <= 1.0 or (h <= SMALLEST_STEP and clock.forced < MOST_FORCED and np.isfinite(error))
        if good:
            clock.status = trouble(lanes, memory.y_new)
            if clock.status != Status.RUNNING.value:
                break
        free, wheel = h, NOBODY  # of jumps that are known
        if watching and look(lanes, work, memory, flanks) > 0.0 and np.isfinite(error):
            free, wheel = before_change(tableau.dense, last, lanes, road, memory, flanks, clock.t, h)
        if good and stopped:
            free_of_stops = _before_stop(lanes, memory, h)
            if free_of_stops < free:
                free, wheel = free_of_stops, NOBODY
        if good and work.held[0] == 0.0 and not lanes.prescribed:
            free_of_limit = _before_limit(tableau.dense, last, lanes, memory, h)
            if free_of_limit < free:
                free, wheel = free_of_limit, DRIVE
        if free < h and clock.t + OVER < span.end:
            planned = max(planned, h)
            clock.rejected += 1
            if free > OVER:
                clock.step = free - 0.5 * OVER
            else:
                _step_over(lanes, road, work, memory, extremes, flanks, clock)
                if wheel == DRIVE:
                    _hold(lanes, work, memory)
                elif wheel != NOBODY:
                    changed(flanks, wheel, clock.t)
                clock.step, planned = planned, 0.0
        elif good:
            clock.forced = 0 if h > 1e3 * SMALLEST_STEP else clock.forced + (error > 1.0)
            keep(flanks, watching)
            if flanks.jammed[0] > 0.0:
                release(flanks, clock.t)
            if work.held[0] != 0.0 and not _holds(lanes, work.held[0], memory.y_new, memory.k[last]):
                work.held[0] = 0.0
            t_new = clock.t + h
            follow(tableau.dense, last, lanes, road, work, memory, extremes, clock.t, h)
            _record_step(tableau.dense, last, lanes, road, work, memory, samples, clock, span, t_new)
            _move_on(memory, last, clock, h, t_new, span.end)
            if clock.status != Status.RUNNING.value:
                break
            # Proportional-integral step control
            factor = 0.9 * max(error, 1e-10) ** -usual * clock.last_error**0.04
            clock.step = max(h * min(max(factor, 0.2), most_growth), planned)
            clock.last_error = max(error, 1e-4)
            most_growth = 5.0
        else:
            clock.rejected += 1
            most_growth, planned = 1.0, 0.0
            clock.step = h * (max(0.9 * error**-after_rejection, 0.2) if np.isfinite(error) else 0.2)
            if not np.isfinite(error):
                memory.k[1:] = 0.0  # a stage's zero weights must not meet a NaN
            if clock.step < SMALLEST_STEP and (h <= SMALLEST_STEP or not np.isfinite(error)):
                clock.status = Status.STEP_TOO_SMALL.value if np.isfinite(error) else Status.NOT_FINITE.value
                break
            clock.step = max(clock.step, SMALLEST_STEP)
    if clock.status == Status.RUNNING.value:
        if clock.t >= span.end:
            clock.status = Status.COMPLETE.value
        elif clock.steps + clock.rejected > span.end * STEPS_PER_SECOND:
            clock.status = Status.TOO_MANY_STEPS.value


@compiled
def runge_kutta_4(lanes, road, work, memory, samples, extremes, flanks, clock, span):
    """Steps of the classic method, all equally long, until t ≥ span.stop, the run's end, trouble or STEPS_PER_CHUNK."""
    size, h = len(memory.y), clock.step
    y, y_new, between, k = memory.y, memory.y_new, memory.between, memory.k
    k1, k2, k3, k4 = k[0], k[1], k[2], k[3]
    last = 4  # where the derivative at y_new stands
    most_steps = clock.steps + STEPS_PER_CHUNK
    _begin(lanes, road, work, memory, extremes, flanks, clock)
    while clock.t < span.stop and clock.steps < most_steps:
        t = clock.t
        for i in range(size):
            between[i] = y[i] + h / 2 * k1[i]
        rates(lanes, road, t + h / 2, between, k2, work)
        for i in range(size):
            between[i] = y[i] + h / 2 * k2[i]
        rates(lanes, road, t + h / 2, between, k3, work)
        for i in range(size):
            between[i] = y[i] + h * k3[i]
        rates(lanes, road, t + h, between, k4, work)
        for i in range(size):
            y_new[i] = y[i] + h / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i])
        t_new = (clock.steps + 1) * h
        rates(lanes, road, t_new, y_new, k[last], work)
        clock.evaluations += 4
        clock.status = trouble(lanes, y_new)
        if clock.status != Status.RUNNING.value:
            break
        follow(CUBIC, last, lanes, road, work, memory, extremes, t, h)
        _record_step(CUBIC, last, lanes, road, work, memory, samples, clock, span, t_new)
        _move_on(memory, last, clock, h, t_new, span.end)
        if clock.status != Status.RUNNING.value:
            break
    if clock.status == Status.RUNNING.value and clock.t >= span.end:
        clock.status = Status.COMPLETE.value
