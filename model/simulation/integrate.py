"""`Integration` holds one run: `advance` carries it on by a stretch of simulated time, so that the caller can look up
between stretches. A run that comes to grief keeps its good part, a status and advice; nothing is raised.
"""

from __future__ import annotations

from collections.abc import Callable
from time import perf_counter
from typing import TYPE_CHECKING

import numpy as np

from model.config.config import Simulation
from model.dynamics.kernel import rates
from model.dynamics.lanes import LANES, WORK, coordinates, in_lanes, make_work, places
from model.dynamics.vehicle import System
from model.road.nearest_point import RoadTable
from model.simulation.accuracy import APART_ALLOWED, advice, joints_apart
from model.simulation.dense import STAGES, Memory
from model.simulation.extremes import RISING, Extremes, begin, conclude, forget, make_extremes, note, of_arms, of_wheels
from model.simulation.flanks import make_flanks
from model.simulation.peaks import Peaks
from model.simulation.steppers import (
    STEEP,
    STEEP_CARE,
    STEPS_PER_SECOND,
    Samples,
    Span,
    Status,
    adaptive,
    error_scale,
    make_clock,
    make_samples,
    record,
    runge_kutta_4,
    stiffest_rate,
    trouble,
)
from model.simulation.tableaus import DORMAND_PRINCE, STRETCHED
from model.simulation.trajectory import sample_count

if TYPE_CHECKING:
    from scipy.integrate import OdeSolver

LONGEST_STEP = 0.02  # s
FIRST_STEP = 1e-4  # s, to be tried
STIFF_STEP = 1e-3  # s
STIFFER = 1.05  # than at first, when wheels sink in more deeply
LOOK = 0.05  # s of wall time after which it is asked whether to stop: within a step of SciPy's it may be twice that
SWING = 1.0  # m that wheels may move along the hull
RADII_PER_STEP = 0.5  # no step runs past an obstacle

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
    Status.SOLVER_FAILED: "Try the stretched-rk43 integrator, or other tolerances.",
}


ADAPTIVE = {"stretched-rk43": STRETCHED, "dormand-prince": DORMAND_PRINCE}
SCIPY_METHODS = {
    "scipy-rk45": "RK45",
    "scipy-dop853": "DOP853",
    "scipy-radau": "Radau",
    "scipy-bdf": "BDF",
    "scipy-lsoda": "LSODA",
}


class _StoppedError(Exception):
    """The caller wants to stop in the middle of a step of one of SciPy's solvers."""


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
        integrator: str = "stretched-rk43",
        rtol: float = 1e-4,
        atol: float = 1e-6,
        step: float = 1e-3,
        capacity: int | None = None,
        figures_only: bool = False,
    ) -> None:
        """figures_only: samples hold what figures are read off, and no more."""
        self.system, self.lanes, self.road = system, in_lanes(system), road
        self.duration, self.rate = duration, rate
        self.integrator, self.rtol, self.atol = integrator, rtol, atol
        self.apart_allowed = APART_ALLOWED
        self.samples = make_samples(system, capacity or sample_count(duration, rate), figures_only)
        self._memory = Memory(y.copy(), np.zeros_like(y), np.zeros_like(y), np.zeros((STAGES, len(y))))
        self._work = make_work(system)
        self._extremes = make_extremes(system)
        self._clock = make_clock(step if integrator == "rk4" else FIRST_STEP)
        self._scale = error_scale(system, rtol, atol)
        self._flanks = make_flanks(system, 1.0 / self._scale)
        self._place = np.append(coordinates(system), WORK)  # of the flat state, what SciPy's solvers see
        self._wheel_x = places(system.n, system.m)[0][system.wheel, 0]
        self._solver: OdeSolver | None = None
        self._should_stop: Callable[[], bool] | None = None
        self._looked = 0.0  # s of wall time, when should_stop was asked
        self._stiffness, self._steep = self._stiffest_rate(), _steep(road)

    @property
    def y(self) -> np.ndarray:
        """The flat state now; not to be changed."""
        return self._memory.y

    t = property(lambda self: float(self._clock.t), doc="Simulated time so far, s.")
    status = property(lambda self: Status(int(self._clock.status)), doc="RUNNING until it ends.")
    steps = property(lambda self: int(self._clock.steps), doc="Accepted steps.")
    rejected_steps = property(lambda self: int(self._clock.rejected), doc="Steps tried again with a shorter step.")
    evaluations = property(lambda self: int(self._clock.evaluations), doc="Right-hand sides computed by the stepper.")
    samples_done = property(lambda self: int(self._clock.recorded), doc="Samples that are filled.")
    smallest_step = property(lambda self: float(self._clock.smallest), doc="Smallest accepted step, s.")

    @classmethod
    def of(
        cls,
        settings: Simulation,
        system: System,
        road: RoadTable,
        y: np.ndarray,
        duration: float,
        capacity: int | None = None,
        figures_only: bool = False,
    ) -> Integration:
        """A run as the configuration wants it integrated."""
        return cls(
            system,
            road,
            y,
            duration,
            settings.output_rate,
            settings.integrator,
            settings.rtol,
            settings.atol,
            settings.step,
            capacity,
            figures_only,
        )

    def ending(self, settings: Simulation) -> tuple[str, str]:
        """For a result: "complete", "running" or how it came to grief; and what to try then, else empty.

        settings: of the run.
        """
        if self.status is Status.JOINTS_APART:
            return f"inaccurate at t = {self.t:.4g} s: {joints_apart(self._clock.apart)}", advice(settings)
        if self.status in REASON:
            return f"diverged at t = {self.t:.4g} s: {REASON[self.status]}", ADVICE[self.status]
        return self.status.name.lower(), ""

    def change(self, system: System, road: RoadTable, y: np.ndarray | None = None) -> None:
        """Carry on with other forces, another road or another state, of the same bodies."""
        self.system, self.lanes, self.road = system, in_lanes(system), road
        if y is not None:
            self.y[:] = y
        self._stiffness, self._steep = self._stiffest_rate(), _steep(road)
        self._clock.fresh, self._solver, self._work.held[0] = 0, None, 0.0

    def peaks(self) -> Peaks:
        """What was largest since the start, or since `take_samples`."""
        return _in_order(self.system, self._extremes)

    def take_samples(self) -> tuple[np.ndarray, Samples, Peaks]:
        """Times (K,), s, and copies of the samples recorded since the last call, which makes room for more; and what
        was largest since then.
        """
        peaks = self.peaks()
        forget(self._extremes)
        first, end = int(self._clock.taken), int(self._clock.recorded)
        self._clock.taken = end
        samples = Samples._make(part[: end - first].copy() for part in self.samples)
        return np.arange(first, end) / self.rate, samples, peaks

    def jammed(self) -> np.ndarray:
        """Wheels that go to and fro between two flanks of the road, as they are numbered among all."""
        return np.flatnonzero(self._flanks.jammed_until[_lanes_of_wheels(self.system)] >= 0.0)

    def give_up(self) -> None:
        """End a run that takes too many steps: an endless one sets no bound itself."""
        self._clock.status = Status.TOO_MANY_STEPS

    def _stiffest_rate(self) -> float:
        """Largest −λ of the system linearised where it is now, 1/s."""
        return stiffest_rate(self.lanes, self.road, self.t, self.y, self._work, self._memory.k, self._memory.between)

    def _longest(self) -> float:
        """No step runs past an obstacle, or leaves the stepper's stability (of a system that is stiffer than its steps
        can be short, the error control takes care).
        """
        longest = min(LONGEST_STEP, RADII_PER_STEP * self.road.radius / max(abs(self.system.v_ref), 1e-3))
        tableau = ADAPTIVE.get(self.integrator)
        return min(longest, max(tableau.reach / (STIFFER * self._stiffness), STIFF_STEP)) if tableau else longest

    def _valleys(self) -> tuple[float, float]:
        """Between which places of the chassis, m, one of its wheels may bridge a valley."""
        start, end = self.road.valleys
        wheels = self.y[self._wheel_x] - self.y[0]
        return start - wheels.max() - SWING, end - wheels.min() + SWING

    def advance(self, t_stop: float, should_stop: Callable[[], bool] | None = None) -> Status:
        """Carry on until t ≥ t_stop, the end, trouble, 1000 steps of a compiled stepper, which leaves the GIL free, or
        0.1 s of wall time of one of SciPy's.

        should_stop: asked where a single step of SciPy's takes longer than that; true ends it where it began.
        """
        t_stop = min(t_stop, self.duration)
        bounds = self._longest(), self.apart_allowed, *self._valleys(), self._steep
        span = Span(float(self.rate), float(self.duration), float(t_stop), *bounds)
        problem = self.lanes, self.road, self._work, self._memory
        kept = self.samples, self._extremes, self._flanks, self._clock
        if self.integrator in ADAPTIVE:
            adaptive(ADAPTIVE[self.integrator], *problem, *kept, span)
        elif self.integrator == "rk4":
            runge_kutta_4(*problem, *kept, span)
        else:
            self._advance_scipy(t_stop, should_stop)
        if self.status is Status.COMPLETE and self.integrator not in SCIPY_METHODS:
            conclude(self.lanes, self.road, self._work, self._memory, self._extremes, self.t)
        if self.status in REASON and self.samples_done == 0 and np.isfinite(self.y).all():
            # The good part of a run has its start at least.
            record(self.lanes, self.road, 0.0, self.y, self._memory.k[0], self._work, self.samples, 0)
            self._clock.recorded = 1
        return self.status

    def _advance_scipy(self, t_stop: float, should_stop: Callable[[], bool] | None) -> None:
        """Some steps of one of SciPy's solvers on the same right-hand side, for comparison."""
        clock = self._clock
        if clock.fresh == 0:
            rates(self.lanes, self.road, self.t, self.y, self._memory.k[0], self._work)
            begin(self.lanes, self._work, self._memory, self._extremes, self.t)
            clock.fresh = 1
        began = self._looked = perf_counter()
        self._should_stop = should_stop
        try:
            solver = self._solver = self._solver or self._make_solver()
            while solver.t < t_stop and clock.status == Status.RUNNING:
                before = solver.t
                solver.step()
                if solver.status == "failed":
                    clock.status = Status.SOLVER_FAILED
                else:
                    self._take_step(solver, before)
                if perf_counter() - began > LOOK:
                    break
        except _StoppedError:
            self._solver = None
        except (ValueError, IndexError, ArithmeticError):  # how they meet a state that is no longer finite
            clock.status = Status.SOLVER_FAILED

    def _make_solver(self) -> OdeSolver:
        """The solver that the run asks for, from where it stands. It is kept from one stretch to the next: so the run
        does not depend on how long a stretch is, in which wall time has a say.
        """
        from scipy import integrate  # half a second that no other stepper needs

        solver: OdeSolver = getattr(integrate, SCIPY_METHODS[self.integrator])(
            self._right_hand_side,
            self.t,
            self.y[self._place],
            self.duration,
            rtol=max(self.rtol, 3e-14),
            atol=self._scale[self._place],
            max_step=self._longest(),
        )
        return solver

    def _right_hand_side(self, t: float, y: np.ndarray) -> np.ndarray:
        """For SciPy's solvers, whose single steps may take long where they fail again and again."""
        if self._should_stop is not None and perf_counter() - self._looked > LOOK:
            self._looked = perf_counter()
            if self._should_stop():
                raise _StoppedError
        self._clock.evaluations += 1
        dy = self._memory.k[0]
        rates(self.lanes, self.road, t, self._whole(y), dy, self._work)
        return dy[self._place]

    def _whole(self, y: np.ndarray) -> np.ndarray:
        """The flat state with its empty lanes, which the solvers do not see: nothing depends on them."""
        self._memory.y_new[self._place] = y
        return self._memory.y_new

    def _take_step(self, solver: OdeSolver, before: float) -> None:
        """Book a step of a SciPy solver, from `before` to where it stands, and record the samples in it."""
        clock, dy = self._clock, self._memory.k[0]
        found = trouble(self.lanes, self._whole(solver.y))
        if found:
            clock.status = found
            return
        room = clock.taken + len(self.samples.residual)
        if clock.recorded < room and clock.recorded / self.rate <= solver.t:
            within = solver.dense_output()
            while clock.recorded < room and clock.recorded / self.rate <= solver.t:
                t = clock.recorded / self.rate
                row = clock.recorded - clock.taken
                record(self.lanes, self.road, t, self._whole(within(t)), dy, self._work, self.samples, row)
                if self.samples.residual[row] > self.apart_allowed:
                    clock.status, clock.apart = Status.JOINTS_APART, self.samples.residual[row]
                    return
                note(self.lanes, self._work, self._whole(within(t)), dy[RISING], self._extremes, t)
                clock.recorded += 1
        clock.t = solver.t
        self.y[:] = self._whole(solver.y)
        rates(self.lanes, self.road, self.t, self.y, self._memory.k[0], self._work)
        note(self.lanes, self._work, self.y, self._memory.k[0, RISING], self._extremes, self.t)
        clock.steps += 1
        clock.smallest = min(clock.smallest, solver.t - before)
        if solver.t >= self.duration:
            clock.status = Status.COMPLETE
        elif clock.steps > self.duration * STEPS_PER_SECOND:
            clock.status = Status.TOO_MANY_STEPS


def _steep(road: RoadTable) -> float:
    """How much smaller errors must be for the road's steepness."""
    return STEEP_CARE if road.steepness > STEEP else 1.0


def _lanes_of_wheels(system: System) -> np.ndarray:
    """(W,) the lane of each wheel, of those that road and imaginary wheels of all blocks have."""
    arm = np.arange(system.n)
    road = arm + arm // LANES * LANES
    return np.concatenate([road, road[: system.m] + LANES])


def _in_order(system: System, extremes: Extremes) -> Peaks:
    """What was followed in lanes, in the model's order of wheels and arms."""
    arm, wheel = np.arange(system.n), _lanes_of_wheels(system)
    return Peaks(
        load=of_wheels(extremes, "load")[wheel],
        load_time=of_wheels(extremes, "load_at")[wheel],
        depth=of_wheels(extremes, "depth")[wheel],
        depth_time=of_wheels(extremes, "depth_at")[wheel],
        air_time=of_wheels(extremes, "air")[wheel],
        arm_high=of_arms(extremes, "high")[arm],
        arm_high_time=of_arms(extremes, "high_at")[arm],
        arm_low=of_arms(extremes, "low")[arm],
        arm_low_time=of_arms(extremes, "low_at")[arm],
        acceleration=np.array(extremes.hull[0]),
        acceleration_time=np.array(extremes.hull[1]),
    )
