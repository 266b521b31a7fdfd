"""Compiled steppers for the equations of motion, with dense output: samples at the output rate are interpolated inside
the steps and never shorten them.

`adaptive` serves every explicit Runge–Kutta pair that a Tableau describes; `runge_kutta_4` has a fixed step.
"""

from __future__ import annotations

from enum import IntEnum
from math import prod
from typing import NamedTuple

import numpy as np

from model.compiled import compiled, inlined
from model.dynamics.kernel import constraint_residual, loads, multipliers, rates
from model.dynamics.lanes import INT_E, places, state_size
from model.dynamics.vehicle import System

STEPS_PER_SECOND = 50_000  # of simulated time, at most; five hundred times what the paper's vehicle needs
SMALLEST_STEP = 1e-10  # s
FASTEST = 1e3  # m/s: a body faster than this shows that the run has diverged
STEPS_PER_CHUNK = 5_000  # so that a stop is heeded however stiff the run
POWERS = 30  # of the Jacobian, to find its largest eigenvalue to a few per cent
NUDGE = 1e-6  # m, rad, m/s or rad/s: a change small enough for the system to be linear
SIZE_OF_SPEED = 1.0  # m/s or rad/s, what rtol is measured against: see error_scale
SIZE_OF_POSITION = 0.1  # m or rad
SIZE_OF_DISPLACEMENT = 0.1  # m
LIVELY = 0.75  # m/s: where a body rises or falls faster than this, errors may be larger in proportion


class Status(IntEnum):
    """Why a run stands where it stands."""

    RUNNING = 0
    COMPLETE = 1
    STEP_TOO_SMALL = 2
    NOT_FINITE = 3
    TOO_MANY_STEPS = 4
    SOLVER_FAILED = 5
    RUNAWAY = 6


class Samples(NamedTuple):
    """The run at the output rate, N samples: the result file's arrays."""

    q: np.ndarray  # (N, B, 3)
    v: np.ndarray  # (N, B, 3)
    a: np.ndarray  # (N, B, 3)
    f_n: np.ndarray  # (N, W)
    f_t: np.ndarray  # (N, W)
    xi: np.ndarray  # (N, W)
    F: np.ndarray  # (N,)
    lam: np.ndarray  # (N, rows of C)
    residual: np.ndarray  # (N,)


def make_samples(system: System, count: int) -> Samples:
    """Room for that many samples, in one piece: a large one is had from the system in large pages, which is quicker."""
    B, W = len(system.mass), len(system.wheel)
    rows = 2 * len(system.joint_i) + int(system.prescribed)
    shapes = [(count, *shape) for shape in [(B, 3), (B, 3), (B, 3), (W,), (W,), (W,), (), (rows,), ()]]
    ends = np.cumsum([0, *map(prod, shapes)])
    block = np.empty(ends[-1])
    parts = (block[first:end].reshape(shape) for first, end, shape in zip(ends, ends[1:], shapes, strict=False))
    return Samples._make(parts)


NOW, STEP, LAST_ERROR, SMALLEST = range(4)  # entries of Clock.time
STEPS, REJECTED, EVALUATIONS, SAMPLES, STATUS, TAKEN, FRESH = range(7)  # entries of Clock.tally


class Clock(NamedTuple):
    """What a stepper carries from step to step; the arrays are its own to change."""

    time: np.ndarray  # (4,) s: t, proposed step, smallest accepted step; and the last step's error
    tally: np.ndarray  # (7,) counters; Status; samples recorded, and of these taken away; 1 when k[0] fits y


def error_scale(system: System, rtol: float, atol: float) -> np.ndarray:
    """What counts as an error of one for each entry of the flat state: atol + rtol · size.

    The sizes are fixed ones for each kind of state, so that the accuracy is the same wherever on the road the vehicle
    is and however far its wheels have turned. On rough ground all of them grow with `liveliness`.
    """
    body, wheel = places(system.n, system.m)
    size = np.ones(state_size(system.n))
    size[body[:, :3]], size[body[:, 3:]] = SIZE_OF_POSITION, SIZE_OF_SPEED
    size[wheel] = size[INT_E] = SIZE_OF_DISPLACEMENT
    return atol + rtol * size


@compiled
def record(lanes, road, t, y, dy, work, samples, k):
    """Sample k: everything that the state y at time t tells."""
    rates(lanes, road, t, y, dy, work)
    multipliers(lanes, dy, work, samples.lam[k])
    for b in range(len(lanes.place)):
        for axis in range(3):
            position, speed = lanes.place[b, axis], lanes.place[b, axis + 3]
            samples.q[k, b, axis] = y[position]
            samples.v[k, b, axis] = y[speed]
            samples.a[k, b, axis] = dy[speed]
    loads(lanes, work, samples.f_n[k], samples.f_t[k])
    for wheel in range(len(lanes.xi_place)):
        samples.xi[k, wheel] = y[lanes.xi_place[wheel]]
    samples.F[k] = work.F[0]
    samples.residual[k] = constraint_residual(lanes, t, y, work)


@compiled
def trouble(lanes, y):
    """Status.NOT_FINITE or RUNAWAY for a state that no vehicle can be in, else 0."""
    fastest = 0.0
    for b in range(len(lanes.place)):
        fastest = max(fastest, abs(y[lanes.place[b, 3]]), abs(y[lanes.place[b, 4]]))
    total = 0.0
    for i in range(len(y)):
        total += y[i]
    if not np.isfinite(total):
        return Status.NOT_FINITE.value
    return Status.RUNAWAY.value if fastest > FASTEST else Status.RUNNING.value


@inlined
def liveliness(lanes, y):
    """How much larger errors may be where wheels are thrown about, since the loads are: 1 on gentle roads."""
    fastest = LIVELY
    for b in range(len(lanes.place)):
        fastest = max(fastest, abs(y[lanes.place[b, 4]]))
    return fastest / LIVELY


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


class Tableau(NamedTuple):
    """An embedded explicit Runge–Kutta pair whose last stage is the first of the next step ("first same as last")."""

    order: int
    stages: int  # with the last, at the new state
    reach: float  # stable for h λ from −reach to 0
    time: np.ndarray  # (7,) of the stages, in steps
    stage: np.ndarray  # (7, 6) what the stages before weigh in the state of each; the last of them is the new state
    error: np.ndarray  # (7,) weights of the estimated error
    dense: np.ndarray  # (7,) weights of the quartic part of the dense output; without it, cubic Hermite


# Dormand & Prince 5(4) and its dense output, from Hairer, Nørsett & Wanner, "Solving ODEs I", tables II.5.2 and II.6
DORMAND_PRINCE = Tableau(
    order=5,
    stages=7,
    reach=3.3,
    time=np.array([0.0, 1 / 5, 3 / 10, 4 / 5, 8 / 9, 1.0, 1.0]),
    stage=np.array(
        [
            [0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            [1 / 5, 0.0, 0.0, 0.0, 0.0, 0.0],
            [3 / 40, 9 / 40, 0.0, 0.0, 0.0, 0.0],
            [44 / 45, -56 / 15, 32 / 9, 0.0, 0.0, 0.0],
            [19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729, 0.0, 0.0],
            [9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656, 0.0],
            [35 / 384, 0.0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84],
        ]
    ),
    error=np.array([71 / 57600, 0.0, -71 / 16695, 71 / 1920, -17253 / 339200, 22 / 525, -1 / 40]),
    dense=np.array(
        [
            -12715105075 / 11282082432,
            0.0,
            87487479700 / 32700410799,
            -10690763975 / 1880347072,
            701980252875 / 199316789632,
            -1453857185 / 822651844,
            69997945 / 29380423,
        ]
    ),
)

# Order 4(3) in five evaluations a step, found for this project: the contacts' and dampers' eigenvalues lie along the
# negative real axis (to about −370 1/s for the paper's vehicle) and, not accuracy, bound the steps of Dormand–Prince,
# which is stable to h λ = −3.3 in six evaluations. Here the stability polynomial's fifth coefficient is 1/218, which
# makes it stable to −5.1 (|R| below 0.33 from −2 to −4.6) and to ±3.2 along the imaginary axis; what this leaves free
# makes the other coefficients of the leading error small. The error's weights satisfy the conditions of order three,
# respond least to stiff modes, and are scaled so that a tolerance gives loads about as exact as it did before.
STRETCHED = Tableau(
    order=4,
    stages=6,
    reach=5.1,
    time=np.array([0.0, 0.2546496372109527, 0.6296352738329648, 0.03315519741332701, 0.9633427116723224, 1.0, 0.0]),
    stage=np.array(
        [
            [0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            [0.2546496372109527, 0.0, 0.0, 0.0, 0.0, 0.0],
            [-0.2500617678616517, 0.8796970416946165, 0.0, 0.0, 0.0, 0.0],
            [0.21742414625252235, -0.3543772189168813, 0.17010827007768595, 0.0, 0.0, 0.0],
            [0.006012796028761913, -0.8004980680593213, 0.9659101866749482, 0.7919177970279336, 0.0, 0.0],
            [-0.04870703601476091, 0.28117718804499864, 0.438499645274781, 0.17702383478384145, 0.15200636791113986, 0],
            [0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        ]
    ),
    error=1.4
    * np.array(
        [
            -0.0017162295794239991,
            0.007941195768782132,
            -0.004320763869619826,
            -0.0022320638515292745,
            -0.012123802026682326,
            0.012451663558473288,
            0.0,
        ]
    ),
    dense=np.zeros(7),
)


@compiled
def adaptive(tableau, lanes, road, work, samples, clock, rate, t_end, t_stop, over_scale, longest, k, y, y_new, sample):
    """Steps until t ≥ t_stop; k (7, size) holds the stages, k[0] the derivative at y (first same as last)."""
    size, states = len(y), 6 * len(lanes.place) + len(lanes.xi_place) + 1  # the latter without empty lanes
    time, count = clock.time, clock.tally
    t, h, last_error = time[NOW], time[STEP], time[LAST_ERROR]
    samples_count = len(samples.residual)
    most_steps = count[STEPS] + count[REJECTED] + STEPS_PER_CHUNK
    k1, k2, k3, k4, k5, k6, k7 = k[0], k[1], k[2], k[3], k[4], k[5], k[6]
    last = tableau.stages - 1
    k_last = k[last]
    e1, e2, e3, e4, e5, e6, e7 = tableau.error
    d1, _, d3, d4, d5, d6, d7 = tableau.dense  # k2 is lent to the samples
    usual, after_rejection = 0.85 / tableau.order, 1.0 / tableau.order
    if count[FRESH] == 0:
        rates(lanes, road, t, y, k1, work)
        count[EVALUATIONS] += 1
        count[FRESH] = 1
    rejected = False
    while t < t_stop and count[STEPS] + count[REJECTED] < most_steps:
        h = min(h, longest)
        for stage in range(1, tableau.stages):
            w1, w2, w3, w4, w5, w6 = tableau.stage[stage]
            if stage == 1:
                for i in range(size):
                    y_new[i] = y[i] + h * (w1 * k1[i])
            elif stage == 2:
                for i in range(size):
                    y_new[i] = y[i] + h * (w1 * k1[i] + w2 * k2[i])
            elif stage == 3:
                for i in range(size):
                    y_new[i] = y[i] + h * (w1 * k1[i] + w2 * k2[i] + w3 * k3[i])
            elif stage == 4:
                for i in range(size):
                    y_new[i] = y[i] + h * (w1 * k1[i] + w2 * k2[i] + w3 * k3[i] + w4 * k4[i])
            elif stage == 5:
                for i in range(size):
                    y_new[i] = y[i] + h * (w1 * k1[i] + w2 * k2[i] + w3 * k3[i] + w4 * k4[i] + w5 * k5[i])
            else:
                for i in range(size):
                    y_new[i] = y[i] + h * (w1 * k1[i] + w2 * k2[i] + w3 * k3[i] + w4 * k4[i] + w5 * k5[i] + w6 * k6[i])
            rates(lanes, road, t + tableau.time[stage] * h, y_new, k[stage], work)
        count[EVALUATIONS] += last
        error = 0.0
        for i in range(size):
            e = e1 * k1[i] + e2 * k2[i] + e3 * k3[i] + e4 * k4[i] + e5 * k5[i] + e6 * k6[i] + e7 * k7[i]
            square = (e * over_scale[i]) ** 2
            error += square * square
        error = h * np.sqrt(np.sqrt(error / states)) / liveliness(lanes, y)

        if error <= 1.0:
            count[STATUS] = trouble(lanes, y_new)
            if count[STATUS] != Status.RUNNING.value:
                break
            t_new = t + h
            while count[SAMPLES] - count[TAKEN] < samples_count and count[SAMPLES] / rate <= t_new:
                # Cubic Hermite, and what the tableau adds to it; of few arrays at a time, so that it is done in lanes
                theta = (count[SAMPLES] / rate - t) / h
                rest = 1.0 - theta
                new, first, final = (
                    theta * theta * (3.0 - 2.0 * theta),
                    h * theta * rest * rest,
                    h * theta * theta * rest,
                )
                for i in range(size):
                    sample[i] = y[i] + new * (y_new[i] - y[i]) + first * k1[i] - final * k_last[i]
                if d1 != 0.0:
                    for i in range(size):
                        sample[i] += (
                            final * rest * (d1 * k1[i] + d3 * k3[i] + d4 * k4[i] + d5 * k5[i] + d6 * k6[i] + d7 * k7[i])
                        )
                record(lanes, road, count[SAMPLES] / rate, sample, k2, work, samples, count[SAMPLES] - count[TAKEN])
                count[SAMPLES] += 1
            t = t_new
            for i in range(size):
                y[i], k1[i] = y_new[i], k_last[i]
            count[STEPS] += 1
            time[SMALLEST] = min(time[SMALLEST], h)
            # Proportional-integral step control
            factor = 0.9 * max(error, 1e-10) ** -usual * last_error**0.04
            h *= min(max(factor, 0.2), 1.0 if rejected else 5.0)
            last_error = max(error, 1e-4)
            rejected = False
        else:
            count[REJECTED] += 1
            rejected = True
            h *= max(0.9 * error**-after_rejection, 0.2) if np.isfinite(error) else 0.2
            if not np.isfinite(error):
                k[1:] = 0.0  # a stage's zero weights must not meet a NaN
            if h < SMALLEST_STEP:
                count[STATUS] = Status.STEP_TOO_SMALL.value if np.isfinite(error) else Status.NOT_FINITE.value
                break
    if count[STATUS] == Status.RUNNING.value:
        if t >= t_end:
            count[STATUS] = Status.COMPLETE.value
        elif count[STEPS] + count[REJECTED] > t_end * STEPS_PER_SECOND:
            count[STATUS] = Status.TOO_MANY_STEPS.value
    time[NOW], time[STEP], time[LAST_ERROR] = t, h, last_error


@compiled
def runge_kutta_4(lanes, road, work, samples, clock, rate, t_end, t_stop, k, y, y_new, trial):
    """The classic fixed-step method until t ≥ t_stop; cubic Hermite between steps. k (7, size): k[0] as above."""
    size = len(y)
    time, count = clock.time, clock.tally
    t, h = time[NOW], time[STEP]
    samples_count = len(samples.residual)
    most_steps = count[STEPS] + STEPS_PER_CHUNK
    k1, k2, k3, k4 = k[0], k[1], k[2], k[3]
    if count[FRESH] == 0:
        rates(lanes, road, t, y, k1, work)
        count[EVALUATIONS] += 1
        count[FRESH] = 1
    while t < t_stop and count[STEPS] < most_steps:
        for i in range(size):
            trial[i] = y[i] + h / 2 * k1[i]
        rates(lanes, road, t + h / 2, trial, k2, work)
        for i in range(size):
            trial[i] = y[i] + h / 2 * k2[i]
        rates(lanes, road, t + h / 2, trial, k3, work)
        for i in range(size):
            trial[i] = y[i] + h * k3[i]
        rates(lanes, road, t + h, trial, k4, work)
        for i in range(size):
            y_new[i] = y[i] + h / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i])
        count[STEPS] += 1
        t_new = count[STEPS] * h
        rates(lanes, road, t_new, y_new, k2, work)
        count[EVALUATIONS] += 4
        count[STATUS] = trouble(lanes, y_new)
        if count[STATUS] != Status.RUNNING.value:
            break
        while count[SAMPLES] - count[TAKEN] < samples_count and count[SAMPLES] / rate <= t_new:
            theta = (count[SAMPLES] / rate - t) / h
            for i in range(size):
                rise = y_new[i] - y[i]
                trial[i] = (
                    y[i]
                    + theta * rise
                    + theta * (theta - 1) * ((1 - 2 * theta) * rise + h * ((theta - 1) * k1[i] + theta * k2[i]))
                )
            record(lanes, road, count[SAMPLES] / rate, trial, k3, work, samples, count[SAMPLES] - count[TAKEN])
            count[SAMPLES] += 1
        t = t_new
        for i in range(size):
            y[i], k1[i] = y_new[i], k2[i]
    if count[STATUS] == Status.RUNNING.value and t >= t_end:
        count[STATUS] = Status.COMPLETE.value
    time[NOW], time[SMALLEST] = t, h
