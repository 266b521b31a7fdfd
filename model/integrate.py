"""Steppers for the equations of motion: chunk by chunk, with dense output, a status and counters, and no exceptions.

`Integration` holds one run: `advance` carries it on by a stretch of simulated time, so that the caller can look up
between stretches. Samples at the output rate are interpolated inside the steps and never shorten them.
"""

from __future__ import annotations

from enum import IntEnum
from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_ivp

from model.compiled import compiled
from model.kernel import Work, constraint_residual, make_work, multipliers, rates
from model.road_table import RoadTable
from model.vehicle import System

STEPS_PER_SECOND = 50_000  # of simulated time, at most; a hundred times what the paper's vehicle needs
SMALLEST_STEP = 1e-9  # s
LONGEST_STEP = 0.02  # s
FASTEST = 1e3  # m/s: a body faster than this shows that the run has diverged
RADII_PER_STEP = 0.5  # no step runs past an obstacle
STEPS_PER_CHUNK = 5_000  # so that a stop is heeded however stiff the run
SIZE_OF_SPEED = 1.0  # m/s or rad/s, what rtol is measured against: see error_scale
SIZE_OF_POSITION = 0.1  # m or rad
SIZE_OF_DISPLACEMENT = 0.1  # m


class Status(IntEnum):
    """Why a run stands where it stands."""

    RUNNING = 0
    COMPLETE = 1
    STEP_TOO_SMALL = 2
    NOT_FINITE = 3
    TOO_MANY_STEPS = 4
    SOLVER_FAILED = 5
    RUNAWAY = 6


REASON = {
    Status.STEP_TOO_SMALL: "the step became too small",
    Status.NOT_FINITE: "the state is no longer finite",
    Status.TOO_MANY_STEPS: "too many steps",
    Status.SOLVER_FAILED: "the solver gave up",
    Status.RUNAWAY: "a body moves faster than 1000 m/s",
}
ADVICE = {
    Status.STEP_TOO_SMALL: "Loosen rtol and atol, or lower the stiffness and damping of ground and suspension.",
    Status.NOT_FINITE: "Lower speed, road amplitude or stiffness; with a fixed step, shorten the step.",
    Status.TOO_MANY_STEPS: "Loosen rtol and atol, lower the stiffness and damping, or try the scipy-radau integrator.",
    Status.RUNAWAY: "Lower speed, road amplitude or stiffness; with a fixed step, shorten the step.",
    Status.SOLVER_FAILED: "Try the dormand-prince integrator, or other tolerances.",
}


SCIPY_METHODS = {
    "scipy-rk45": "RK45",
    "scipy-dop853": "DOP853",
    "scipy-radau": "Radau",
    "scipy-bdf": "BDF",
    "scipy-lsoda": "LSODA",
}


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
    """Room for that many samples."""
    B, W = len(system.mass), len(system.wheel)
    rows = 2 * len(system.joint_i) + int(system.prescribed)
    per_sample = [(B, 3), (B, 3), (B, 3), (W,), (W,), (W,), (), (rows,), ()]
    return Samples._make(np.empty((count, *shape)) for shape in per_sample)


NOW, STEP, LAST_ERROR, SMALLEST = range(4)  # entries of Clock.time
STEPS, REJECTED, EVALUATIONS, SAMPLES, STATUS, TAKEN, FRESH = range(7)  # entries of Clock.tally


class Clock(NamedTuple):
    """What a stepper carries from step to step; the arrays are its own to change."""

    time: np.ndarray  # (4,) s: t, proposed step, smallest accepted step; and the last step's error
    tally: np.ndarray  # (7,) counters; Status; samples recorded, and of these taken away; 1 when k[0] fits y


def error_scale(system: System, rtol: float, atol: float) -> np.ndarray:
    """What counts as an error of one for each entry of the flat state: atol + rtol · size.

    The sizes are fixed ones for each kind of state, so that the accuracy is the same wherever on the road the vehicle
    is and however far its wheels have turned.
    """
    B, W = len(system.mass), len(system.wheel)
    size = np.concatenate(
        [
            np.full(3 * B, SIZE_OF_POSITION),
            np.full(3 * B, SIZE_OF_SPEED),
            np.full(W + 1, SIZE_OF_DISPLACEMENT),
        ]
    )
    return atol + rtol * size


@compiled
def record(system, road, t, y, dy, work, samples, k):
    """Sample k: everything that the state y at time t tells."""
    B, W = len(system.mass), len(system.wheel)
    rates(system, road, t, y, dy, work)
    multipliers(system, dy, work, samples.lam[k])
    for b in range(B):
        for axis in range(3):
            samples.q[k, b, axis] = y[axis * B + b]
            samples.v[k, b, axis] = y[(3 + axis) * B + b]
            samples.a[k, b, axis] = dy[(3 + axis) * B + b]
    for w in range(W):
        samples.f_n[k, w] = work.f_n[w]
        samples.f_t[k, w] = work.f_t[w]
        samples.xi[k, w] = y[6 * B + w]
    samples.F[k] = work.F[0]
    samples.residual[k] = constraint_residual(system, t, y)


@compiled
def _trouble(y, bodies):
    """Status.NOT_FINITE or RUNAWAY for a state that no vehicle can be in, else 0."""
    fastest = 0.0
    for i in range(3 * bodies, 5 * bodies):
        fastest = max(fastest, abs(y[i]))
    total = 0.0
    for i in range(len(y)):
        total += y[i]
    if not np.isfinite(total):
        return Status.NOT_FINITE.value
    return Status.RUNAWAY.value if fastest > FASTEST else Status.RUNNING.value


# Dormand & Prince 5(4) and its dense output, from Hairer, Nørsett & Wanner, "Solving ODEs I", tables II.5.2 and II.6
STAGE_TIME = np.array([0.0, 1 / 5, 3 / 10, 4 / 5, 8 / 9, 1.0, 1.0])
STAGE = np.array(  # row s: what the stages before s weigh in the state at which stage s is computed; the last is y_new
    [
        [0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        [1 / 5, 0.0, 0.0, 0.0, 0.0, 0.0],
        [3 / 40, 9 / 40, 0.0, 0.0, 0.0, 0.0],
        [44 / 45, -56 / 15, 32 / 9, 0.0, 0.0, 0.0],
        [19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729, 0.0, 0.0],
        [9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656, 0.0],
        [35 / 384, 0.0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84],
    ]
)
E1, E3, E4, E5, E6, E7 = 71 / 57600, -71 / 16695, 71 / 1920, -17253 / 339200, 22 / 525, -1 / 40
D1, D3, D4 = -12715105075 / 11282082432, 87487479700 / 32700410799, -10690763975 / 1880347072
D5, D6, D7 = 701980252875 / 199316789632, -1453857185 / 822651844, 69997945 / 29380423


@compiled
def dormand_prince(system, road, work, samples, clock, rate, t_end, t_stop, scale, longest, k, y, y_new, sample):
    """Steps until t ≥ t_stop; k (7, size) holds the stages, k[0] the derivative at y (first same as last)."""
    size = len(y)
    time, count = clock.time, clock.tally
    t, h, last_error = time[NOW], time[STEP], time[LAST_ERROR]
    samples_count = len(samples.residual)
    most_steps = count[STEPS] + count[REJECTED] + STEPS_PER_CHUNK
    k1, k2, k3, k4, k5, k6, k7 = k[0], k[1], k[2], k[3], k[4], k[5], k[6]
    if count[FRESH] == 0:
        rates(system, road, t, y, k1, work)
        count[EVALUATIONS] += 1
        count[FRESH] = 1
    rejected = False
    while t < t_stop and count[STEPS] + count[REJECTED] < most_steps:
        h = min(h, longest)
        for stage in range(1, 7):
            w1, w2, w3, w4, w5, w6 = STAGE[stage]
            for i in range(size):
                y_new[i] = y[i] + h * (w1 * k1[i] + w2 * k2[i] + w3 * k3[i] + w4 * k4[i] + w5 * k5[i] + w6 * k6[i])
            rates(system, road, t + STAGE_TIME[stage] * h, y_new, k[stage], work)
        count[EVALUATIONS] += 6
        error = 0.0
        for i in range(size):
            e = E1 * k1[i] + E3 * k3[i] + E4 * k4[i] + E5 * k5[i] + E6 * k6[i] + E7 * k7[i]
            error += (e / scale[i]) ** 2
        error = h * np.sqrt(error / size)

        if error <= 1.0:
            count[STATUS] = _trouble(y_new, len(system.mass))
            if count[STATUS] != Status.RUNNING.value:
                break
            t_new = t + h
            while count[SAMPLES] - count[TAKEN] < samples_count and count[SAMPLES] / rate <= t_new:
                theta = (count[SAMPLES] / rate - t) / h
                for i in range(size):
                    rise = y_new[i] - y[i]
                    bend = h * k1[i] - rise
                    dense = h * (D1 * k1[i] + D3 * k3[i] + D4 * k4[i] + D5 * k5[i] + D6 * k6[i] + D7 * k7[i])
                    sample[i] = y[i] + theta * (
                        rise + (1 - theta) * (bend + theta * (rise - h * k7[i] - bend + (1 - theta) * dense))
                    )
                record(system, road, count[SAMPLES] / rate, sample, k2, work, samples, count[SAMPLES] - count[TAKEN])
                count[SAMPLES] += 1
            t = t_new
            for i in range(size):
                y[i], k1[i] = y_new[i], k7[i]
            count[STEPS] += 1
            time[SMALLEST] = min(time[SMALLEST], h)
            # Proportional-integral step control
            factor = 0.9 * max(error, 1e-10) ** -0.17 * last_error**0.04
            h *= min(max(factor, 0.2), 1.0 if rejected else 5.0)
            last_error = max(error, 1e-4)
            rejected = False
        else:
            count[REJECTED] += 1
            rejected = True
            h *= max(0.9 * error**-0.2, 0.2) if np.isfinite(error) else 0.2
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
def runge_kutta_4(system, road, work, samples, clock, rate, t_end, t_stop, k, y, y_new, trial):
    """The classic fixed-step method until t ≥ t_stop; cubic Hermite between steps. k (7, size): k[0] as above."""
    size = len(y)
    time, count = clock.time, clock.tally
    t, h = time[NOW], time[STEP]
    samples_count = len(samples.residual)
    most_steps = count[STEPS] + STEPS_PER_CHUNK
    k1, k2, k3, k4 = k[0], k[1], k[2], k[3]
    if count[FRESH] == 0:
        rates(system, road, t, y, k1, work)
        count[EVALUATIONS] += 1
        count[FRESH] = 1
    while t < t_stop and count[STEPS] < most_steps:
        for i in range(size):
            trial[i] = y[i] + h / 2 * k1[i]
        rates(system, road, t + h / 2, trial, k2, work)
        for i in range(size):
            trial[i] = y[i] + h / 2 * k2[i]
        rates(system, road, t + h / 2, trial, k3, work)
        for i in range(size):
            trial[i] = y[i] + h * k3[i]
        rates(system, road, t + h, trial, k4, work)
        for i in range(size):
            y_new[i] = y[i] + h / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i])
        count[STEPS] += 1
        t_new = count[STEPS] * h
        rates(system, road, t_new, y_new, k2, work)
        count[EVALUATIONS] += 4
        count[STATUS] = _trouble(y_new, len(system.mass))
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
            record(system, road, count[SAMPLES] / rate, trial, k3, work, samples, count[SAMPLES] - count[TAKEN])
            count[SAMPLES] += 1
        t = t_new
        for i in range(size):
            y[i], k1[i] = y_new[i], k2[i]
    if count[STATUS] == Status.RUNNING.value and t >= t_end:
        count[STATUS] = Status.COMPLETE.value
    time[NOW], time[SMALLEST] = t, h


class Integration:
    """One run under way: from a flat state at t = 0 to `duration` (which may be infinite), sampled at `rate`.

    There is room for all samples of a finite run. An endless one keeps up to `capacity` until `take_samples`.
    """

    def __init__(
        self,
        system: System,
        road: RoadTable,
        y: np.ndarray,
        duration: float,
        rate: float,
        integrator: str = "dormand-prince",
        rtol: float = 1e-4,
        atol: float = 1e-6,
        step: float = 1e-3,
        capacity: int | None = None,
    ) -> None:
        self.system, self.road = system, road
        self.duration, self.rate = duration, rate
        self.integrator, self.rtol, self.atol = integrator, rtol, atol
        self.samples = make_samples(system, capacity or int(np.floor(duration * rate + 1e-9)) + 1)
        self.y = y.copy()
        self._work: Work = make_work(system)
        first_step = step if integrator == "rk4" else 1e-4
        self._clock = Clock(np.array([0.0, first_step, 1e-4, np.inf]), np.zeros(7, dtype=np.int64))
        self._scale = error_scale(system, rtol, atol)
        self._stages = np.zeros((7, len(y)))
        self._spare = np.zeros((2, len(y)))

    t = property(lambda self: float(self._clock.time[NOW]), doc="Simulated time so far, s.")
    status = property(lambda self: Status(int(self._clock.tally[STATUS])), doc="RUNNING until it ends.")
    steps = property(lambda self: int(self._clock.tally[STEPS]), doc="Accepted steps.")
    rejected_steps = property(
        lambda self: int(self._clock.tally[REJECTED]), doc="Steps tried again with a shorter step."
    )
    evaluations = property(
        lambda self: int(self._clock.tally[EVALUATIONS]), doc="Right-hand sides computed by the stepper."
    )
    samples_done = property(lambda self: int(self._clock.tally[SAMPLES]), doc="Samples that are filled.")
    smallest_step = property(lambda self: float(self._clock.time[SMALLEST]), doc="Smallest accepted step, s.")

    def change(self, system: System, road: RoadTable, y: np.ndarray | None = None) -> None:
        """Carry on with other forces, another road or another state, of the same bodies."""
        self.system, self.road = system, road
        if y is not None:
            self.y = y.copy()
        self._clock.tally[FRESH] = 0

    def take_samples(self) -> tuple[np.ndarray, Samples]:
        """Times (K,), s, and copies of the samples recorded since the last call, which makes room for more."""
        first, end = int(self._clock.tally[TAKEN]), int(self._clock.tally[SAMPLES])
        self._clock.tally[TAKEN] = end
        return np.arange(first, end) / self.rate, Samples._make(part[: end - first].copy() for part in self.samples)

    def _longest(self) -> float:
        return min(LONGEST_STEP, RADII_PER_STEP * self.road.radius / max(abs(self.system.v_ref), 1e-3))

    def advance(self, t_stop: float) -> Status:
        """Carry on until t ≥ t_stop, the end, trouble, or 5000 steps; the GIL is free meanwhile."""
        t_stop = min(t_stop, self.duration)
        common = (
            self.system,
            self.road,
            self._work,
            self.samples,
            self._clock,
            self.rate,
            self.duration,
            t_stop,
        )
        if self.integrator == "dormand-prince":
            dormand_prince(*common, self._scale, self._longest(), self._stages, self.y, *self._spare)
        elif self.integrator == "rk4":
            runge_kutta_4(*common, self._stages, self.y, *self._spare)
        else:
            self._advance_scipy(t_stop)
        return self.status

    def _advance_scipy(self, t_stop: float) -> None:
        """One of SciPy's solvers on the same right-hand side, for comparison."""
        time, count = self._clock
        dy = self._stages[0]

        def right_hand_side(t: float, y: np.ndarray) -> np.ndarray:
            rates(self.system, self.road, t, y, dy, self._work)
            return dy.copy()

        wanted = np.arange(count[SAMPLES], count[TAKEN] + len(self.samples.residual)) / self.rate
        wanted = wanted[wanted <= t_stop + 1e-12]
        try:
            solution = solve_ivp(
                right_hand_side,
                (time[NOW], t_stop),
                self.y,
                method=SCIPY_METHODS[self.integrator],
                rtol=max(self.rtol, 3e-14),
                atol=self._scale,
                max_step=self._longest(),
                dense_output=True,
            )
        except (ValueError, IndexError, ArithmeticError):  # how they meet a state that is no longer finite
            count[STATUS] = Status.SOLVER_FAILED
            return
        reached = solution.t[-1]
        for t in wanted[wanted <= reached + 1e-12]:
            record(
                self.system,
                self.road,
                t,
                solution.sol(min(t, reached)),
                dy,
                self._work,
                self.samples,
                count[SAMPLES] - count[TAKEN],
            )
            count[SAMPLES] += 1
        time[NOW] = reached
        self.y = solution.y[:, -1].copy()
        count[STEPS] += len(solution.t) - 1
        count[EVALUATIONS] += solution.nfev
        if len(solution.t) > 1:
            time[SMALLEST] = min(time[SMALLEST], np.diff(solution.t).min())
        trouble = _trouble(self.y, len(self.system.mass))
        if trouble:
            count[STATUS] = trouble
        elif not solution.success:
            count[STATUS] = Status.SOLVER_FAILED
        elif reached >= self.duration:
            count[STATUS] = Status.COMPLETE
