"""A drive without end: the vehicle rolls on in steps of simulated time, and parameters may change under way.

What changes forces or speed acts from the next step. Another road shape begins a metre or two ahead of the first wheel
and takes the old one's place over a few metres, with continuous slope and curvature (model/road/endless.py). What
changes the vehicle's bodies starts it anew from rest.
"""

from __future__ import annotations

from collections import deque
from time import perf_counter

import numpy as np

from model.config.config import Config
from model.dynamics.lanes import SPEED, places, wheel_positions
from model.dynamics.vehicle import System, build_system
from model.road.endless import LaidRoad, Shapes
from model.road.nearest_point import RoadTable
from model.road.road import build_road
from model.road.table import REACH
from model.simulation.integrate import Integration, Samples, Status
from model.simulation.peaks import Peaks
from model.simulation.simulate import sampled_arrays, starting_state, warm_up
from model.simulation.steppers import STEPS_PER_SECOND
from model.simulation.trajectory import RunStatistics, Trajectory

JOIN_AHEAD = 1.0  # m from the first wheel, at least, to where a new road shape begins …
JOIN_EVERY = 1.0  # … at a multiple of this: what is changed again before that takes the same place
BEHIND, AHEAD = 25.0, 60.0  # m of road behind and ahead of the chassis that can be seen
SPARE = 30.0  # m of it ahead that are left when there is more to be seen
LAID = 4.0  # m ahead of the first wheel's reach for which the road is laid at once
STRIDE = 0.05  # s driven at most until it is looked at whether there is road enough
REBASE = 1000.0  # m: driven further than this, the origin moves along, so that no digits are lost
CHANGEABLE = ("hull", "road_suspension", "imaginary_suspension", "seat")  # of the vehicle: what may change under way
GRACE = 1.0  # s: an advance may take as many steps as a run of its length and this may
CAPACITY = 4000  # samples between two calls of advance


class LiveDrive:
    """One endless drive; its origin x = 0 moves along (`distance`). One thread at a time; frees the GIL.

    Raises NoEquilibriumError when the vehicle has no rest pose to start from.
    """

    def __init__(self, config: Config, remembered: float = 10.0) -> None:
        """remembered: how much of the past `recent` gives, s."""
        warm_up(config.simulation.integrator)
        self._remembered = remembered
        self._start(config)

    def _start(self, config: Config) -> None:
        system = build_system(config)
        y, self._static_load = starting_state(system)
        self.config = config
        self.distance = 0.0  # m from where it started to the present origin
        self._shapes = Shapes.of(build_road(config))
        self._past: deque[tuple[np.ndarray, Samples, Peaks]] = deque()
        self._seconds = 0.0
        self._seen_to = -np.inf  # m: as far as the road can be seen
        self._run = Integration.of(config.simulation, system, self._lay(system, y), y, np.inf, CAPACITY)

    @property
    def time(self) -> float:
        """Driven since the start, s."""
        return self._run.t

    @property
    def status(self) -> Status:
        """RUNNING, or why the drive came to an end."""
        return self._run.status

    def change(self, config: Config) -> bool:
        """Drive on with another configuration; False where that meant to start anew from rest.

        Raises NoEquilibriumError for a vehicle that cannot, and drives on as before.
        """
        old = self.config
        parts = [name for name in type(old.vehicle).model_fields if name not in CHANGEABLE]
        same_bodies = all(getattr(old.vehicle, name) == getattr(config.vehicle, name) for name in parts)
        if not same_bodies or old.simulation != config.simulation or self.status is not Status.RUNNING:
            self._start(config)
            return False
        self.config = config
        system = build_system(config)
        table = self._run.road
        if config.road != old.road:
            self._shapes = self._shapes.joined(build_road(config), self._join(), config.road.type == old.road.type)
            table = self._lay(system, self._run.y)
        x = float(self._run.y[0])
        self._run.change(system._replace(x_0=x - system.v_ref * self._run.t), table)
        return True

    def _join(self) -> float:
        """Where a new road shape begins, m."""
        system = self._run.system
        front = float(wheel_positions(system, self._run.y).max())
        ahead = max(JOIN_AHEAD, REACH * self.config.vehicle.road_wheels.radius)
        return float(np.ceil((front + ahead) / JOIN_EVERY)) * JOIN_EVERY

    def _lay(self, system: System, y: np.ndarray, *, anew: bool = True) -> RoadTable:
        """The road about a vehicle in this state: to be seen from far, laid under its wheels and a little ahead.

        anew: its shapes are not those that were laid before, or the origin has moved.
        """
        x, wheels = float(y[0]), wheel_positions(system, y)
        radius = self.config.vehicle.road_wheels.radius
        if anew or x + SPARE > self._seen_to:
            oldest = float(self._past[0][1].q[0, system.chassis, 0]) if self._past else x
            self._shapes = self._shapes.seen_from(oldest - BEHIND)
            self._seen, self._seen_to = self._shapes.to_see(x - BEHIND, x + AHEAD), x + AHEAD
        spare = 2 * REACH * radius + self._stride(system, y)
        near = self._shapes.laid(float(wheels.min()) - spare, float(wheels.max()) + spare + LAID)
        self._road = LaidRoad(self._seen, radius, near=near)
        return self._road.table

    def _runs_out(self) -> bool:
        """Whether a wheel could come to an end of what is laid within a stride."""
        run, pieces = self._run, self._road.near.pieces
        wheels = wheel_positions(run.system, run.y)
        spare = REACH * self._road.radius + self._stride(run.system, run.y)
        return bool(wheels.max() + spare > pieces[-1].nodes[-1] or wheels.min() - spare < pieces[0].nodes[0])

    @staticmethod
    def _stride(system: System, y: np.ndarray) -> float:
        """How far the vehicle goes in two strides, m: one, and what the last step runs over."""
        return 2 * STRIDE * max(abs(float(y[SPEED])), abs(system.v_ref))

    def advance(self, until: float) -> None:
        """Drive on to a time, s, at most CAPACITY samples away. A drive that diverged stands still."""
        if self.status is not Status.RUNNING:
            return
        began = perf_counter()
        run = self._run
        if run.y[0] > REBASE:
            self._move_origin(REBASE)
        most_steps = run.steps + run.rejected_steps + STEPS_PER_SECOND * (until - run.t + GRACE)
        while run.t < until and run.status is Status.RUNNING:
            if self._runs_out():
                run.change(run.system, self._lay(run.system, run.y, anew=False))
            run.advance(min(until, run.t + STRIDE))
            if run.steps + run.rejected_steps > most_steps:
                run.give_up()
        taken = run.take_samples()
        if len(taken[0]):
            self._past.append(taken)
        while len(self._past) > 1 and self._past[1][0][0] < run.t - self._remembered:
            self._past.popleft()
        self._seconds += perf_counter() - began

    def recent(self, seconds: float = np.inf) -> Trajectory:
        """The remembered past as a run, or its last so many seconds: a little more, and cheaper than all.

        Its times go on from the start, its x from the present origin.
        """
        since = self.time - seconds
        past = [part for part in self._past if part[0][-1] >= since] or [self._past[-1]]
        t = np.concatenate([times for times, _, _ in past])
        samples = Samples._make(np.concatenate(parts) for parts in zip(*(kept for _, kept, _ in past), strict=True))
        run = self._run
        status, advice = ("complete", "") if run.status is Status.RUNNING else run.ending(self.config.simulation)
        counts = RunStatistics(run.steps, run.rejected_steps, run.evaluations, run.smallest_step, self._seconds)
        return Trajectory(
            t=t,
            **sampled_arrays(samples),
            static_load=self._static_load,
            config=self.config,
            status=status,
            advice=advice,
            statistics=counts,
            tracked=Peaks.over([peaks for _, _, peaks in past]),
        )

    def road(self) -> LaidRoad:
        """The road about the vehicle, in the frame of `recent`: to be seen as far as it reaches, to be touched under
        the wheels. What is seen of it stays the same until there is more.
        """
        return self._road

    def road_under(self, run: Trajectory) -> LaidRoad:
        """The road about a whole run that `recent` has just given, to be touched all along it."""
        radius, x = self._road.radius, run.q[..., 0]
        low, high = float(x.min()) - 2 * REACH * radius, float(x.max()) + 2 * REACH * radius
        return LaidRoad(self._shapes.to_see(low - BEHIND, high + AHEAD), radius, near=self._shapes.laid(low, high))

    def _move_origin(self, by: float) -> None:
        run = self._run
        y = run.y.copy()
        y[places(run.system.n, run.system.m)[0][:, 0]] -= by
        self._shapes = self._shapes.moved(by)
        self.distance += by
        for _, samples, _ in self._past:
            samples.q[..., 0] -= by
        run.change(run.system._replace(x_0=run.system.x_0 - by), self._lay(run.system, y), y)
