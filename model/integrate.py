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


REASON = {
    Status.STEP_TOO_SMALL: "the step became too small",
    Status.NOT_FINITE: "the state is no longer finite",
    Status.TOO_MANY_STEPS: "too many steps",
    Status.SOLVER_FAILED: "the solver gave up",
}
ADVICE = {
    Status.STEP_TOO_SMALL: "Loosen rtol and atol, or lower the stiffness and damping of ground and suspension.",
    Status.NOT_FINITE: "Lower speed, road amplitude or stiffness; with a fixed step, shorten the step.",
    Status.TOO_MANY_STEPS: "Loosen rtol and atol, lower the stiffness and damping, or try the scipy-radau integrator.",
    Status.SOLVER_FAILED: "Try the dormand-prince integrator, or other tolerances.",
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


class Clock(NamedTuple):
    """What a stepper carries from step to step; the arrays are its own to change."""

    time: np.ndarray  # (4,) t, proposed step h, last error, smallest accepted step
    tally: np.ndarray  # (5,) steps, rejected, evaluations, next sample, status


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
    t, h, last_error = time[0], time[1], time[2]
    samples_count = len(samples.residual)
    most_steps = count[0] + count[1] + STEPS_PER_CHUNK
    k1, k2, k3, k4, k5, k6, k7 = k[0], k[1], k[2], k[3], k[4], k[5], k[6]
    if count[2] == 0:
        rates(system, road, t, y, k1, work)
        count[2] = 1
    rejected = False
    while t < t_stop and count[0] + count[1] < most_steps:
        h = min(h, longest)
        for stage in range(1, 7):
            w1, w2, w3, w4, w5, w6 = STAGE[stage]
            for i in range(size):
                y_new[i] = y[i] + h * (w1 * k1[i] + w2 * k2[i] + w3 * k3[i] + w4 * k4[i] + w5 * k5[i] + w6 * k6[i])
            rates(system, road, t + STAGE_TIME[stage] * h, y_new, k[stage], work)
        count[2] += 6
        error = 0.0
        for i in range(size):
            e = E1 * k1[i] + E3 * k3[i] + E4 * k4[i] + E5 * k5[i] + E6 * k6[i] + E7 * k7[i]
            error += (e / scale[i]) ** 2
        error = h * np.sqrt(error / size)

        if error <= 1.0:
            t_new = t + h
            while count[3] < samples_count and count[3] / rate <= t_new:
                theta = (count[3] / rate - t) / h
                for i in range(size):
                    rise = y_new[i] - y[i]
                    bend = h * k1[i] - rise
                    dense = h * (D1 * k1[i] + D3 * k3[i] + D4 * k4[i] + D5 * k5[i] + D6 * k6[i] + D7 * k7[i])
                    sample[i] = y[i] + theta * (
                        rise + (1 - theta) * (bend + theta * (rise - h * k7[i] - bend + (1 - theta) * dense))
                    )
                record(system, road, count[3] / rate, sample, k2, work, samples, count[3])
                count[3] += 1
            t = t_new
            for i in range(size):
                y[i], k1[i] = y_new[i], k7[i]
            count[0] += 1
            time[3] = min(time[3], h)
            # Proportional-integral step control
            factor = 0.9 * max(error, 1e-10) ** -0.17 * last_error**0.04
            h *= min(max(factor, 0.2), 1.0 if rejected else 5.0)
            last_error = max(error, 1e-4)
            rejected = False
        else:
            count[1] += 1
            rejected = True
            h *= max(0.9 * error**-0.2, 0.2) if np.isfinite(error) else 0.2
            if not np.isfinite(error):
                k[1:] = 0.0  # a stage's zero weights must not meet a NaN
            if h < SMALLEST_STEP:
                count[4] = 2 if np.isfinite(error) else 3
                break
    if count[4] == 0:
        if t >= t_end:
            count[4] = 1
        elif count[0] + count[1] > t_end * STEPS_PER_SECOND:
            count[4] = 4
    time[0], time[1], time[2] = t, h, last_error


@compiled
def runge_kutta_4(system, road, work, samples, clock, rate, t_end, t_stop, k, y, y_new, trial):
    """The classic fixed-step method until t ≥ t_stop; cubic Hermite between steps. k (7, size): k[0] as above."""
    size = len(y)
    time, count = clock.time, clock.tally
    t, h = time[0], time[1]
    samples_count = len(samples.residual)
    most_steps = count[0] + STEPS_PER_CHUNK
    k1, k2, k3, k4 = k[0], k[1], k[2], k[3]
    if count[2] == 0:
        rates(system, road, t, y, k1, work)
        count[2] = 1
    while t < t_stop and count[0] < most_steps:
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
        count[0] += 1
        t_new = count[0] * h
        rates(system, road, t_new, y_new, k2, work)
        count[2] += 4
        finite = True
        for i in range(size):
            finite = finite and np.isfinite(k2[i]) and np.isfinite(y_new[i])
        if not finite:
            count[4] = 3
            break
        while count[3] < samples_count and count[3] / rate <= t_new:
            theta = (count[3] / rate - t) / h
            for i in range(size):
                rise = y_new[i] - y[i]
                trial[i] = (
                    y[i]
                    + theta * rise
                    + theta * (theta - 1) * ((1 - 2 * theta) * rise + h * ((theta - 1) * k1[i] + theta * k2[i]))
                )
            record(system, road, count[3] / rate, trial, k3, work, samples, count[3])
            count[3] += 1
        t = t_new
        for i in range(size):
            y[i], k1[i] = y_new[i], k2[i]
    if count[4] == 0 and t >= t_end:
        count[4] = 1
    time[0], time[3] = t, h


class Integration:
    """One run under way: from a flat state at t = 0 to `duration`, sampled at `rate`."""

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
    ) -> None:
        self.system, self.road = system, road
        self.duration, self.rate = duration, rate
        self.integrator, self.rtol, self.atol = integrator, rtol, atol
        self.samples = make_samples(system, int(np.floor(duration * rate + 1e-9)) + 1)
        self.y = y.copy()
        self._work: Work = make_work(system)
        first_step = step if integrator == "rk4" else 1e-4
        self._clock = Clock(np.array([0.0, first_step, 1e-4, np.inf]), np.zeros(5, dtype=np.int64))
        self._scale = error_scale(system, rtol, atol)
        self._longest = min(LONGEST_STEP, RADII_PER_STEP * road.radius / max(abs(system.v_ref), 1e-3))
        self._stages = np.zeros((7, len(y)))
        self._spare = np.zeros((2, len(y)))

    t = property(lambda self: float(self._clock.time[0]), doc="Simulated time so far, s.")
    status = property(lambda self: Status(int(self._clock.tally[4])), doc="RUNNING until it ends.")
    steps = property(lambda self: int(self._clock.tally[0]), doc="Accepted steps.")
    rejected_steps = property(lambda self: int(self._clock.tally[1]), doc="Steps tried again with a shorter step.")
    evaluations = property(lambda self: int(self._clock.tally[2]), doc="Right-hand sides computed by the stepper.")
    samples_done = property(lambda self: int(self._clock.tally[3]), doc="Samples that are filled.")
    smallest_step = property(lambda self: float(self._clock.time[3]), doc="Smallest accepted step, s.")

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
            dormand_prince(*common, self._scale, self._longest, self._stages, self.y, *self._spare)
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

        wanted = np.arange(count[3], len(self.samples.residual)) / self.rate
        wanted = wanted[wanted <= t_stop + 1e-12]
        solution = solve_ivp(
            right_hand_side,
            (time[0], t_stop),
            self.y,
            method={"rk45": "RK45", "dop853": "DOP853", "radau": "Radau", "bdf": "BDF", "lsoda": "LSODA"}[
                self.integrator.removeprefix("scipy-")
            ],
            rtol=max(self.rtol, 3e-14),
            atol=self._scale,
            max_step=self._longest,
            dense_output=True,
        )
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
                count[3],
            )
            count[3] += 1
        time[0] = reached
        self.y = solution.y[:, -1].copy()
        count[0] += len(solution.t) - 1
        count[2] += solution.nfev
        if len(solution.t) > 1:
            time[3] = min(time[3], np.diff(solution.t).min())
        if not np.all(np.isfinite(self.y)):
            count[4] = Status.NOT_FINITE
        elif not solution.success:
            count[4] = Status.SOLVER_FAILED
        elif reached >= self.duration:
            count[4] = Status.COMPLETE
