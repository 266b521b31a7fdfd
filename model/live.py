"""A drive without end: the vehicle rolls on in steps of simulated time, and parameters may change under way.

What changes forces or speed acts from the next step. Another road shape begins a metre ahead of the first wheel and
takes the old one's place over a few metres, with continuous slope and curvature. What changes the vehicle's bodies
starts it anew from rest.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from time import perf_counter

import numpy as np

from model.config import Config, HalfRoundRoad
from model.integrate import ADVICE, REASON, Integration, Samples, Status
from model.road import Derivatives, Piece, Profile, Road, build_road
from model.road_table import CELLS_PER_RADIUS
from model.simulate import starting_state, warm_up
from model.trajectory import RunStatistics, Trajectory
from model.vehicle import build_system

JOIN_AHEAD = 1.0  # m from the first wheel to where a new road shape begins
BLEND = 3.0  # m over which it takes the old one's place
BEHIND, AHEAD = 25.0, 60.0  # m of road that are kept behind and laid ready ahead of the chassis
SPARE = 30.0  # m of the road ahead that are left when more is laid
REBASE = 1000.0  # m: driven further than this, the origin moves along, so that no digits are lost
OBSTACLE_EVERY = 20.0  # m between half-rounds, of which a drive without end would soon have passed one
CHANGEABLE = ("road_suspension", "imaginary_suspension", "seat")  # of the vehicle: what may change under way
SAME = 1e-7  # m: nodes as close as this are one
CAPACITY = 4000  # samples between two calls of advance


@dataclass(frozen=True)
class _Shape:
    """A road shape from `start` on, blended in; its own x is the drive's x + shift."""

    road: Road
    start: float
    shift: float
    every: float  # m after which it repeats itself, for roads that do not do so by themselves; 0: never

    def derivatives(self, x: np.ndarray) -> Derivatives:
        own = x + self.shift
        if self.every:
            first = self.road.profile.pieces[0].nodes[0]
            own = np.where(own > first, first + np.mod(own - first, self.every), own)
        return self.road.derivatives(own)

    def repeated(self, x: np.ndarray, low: float, high: float) -> np.ndarray:
        """Places x of the shape's own, wherever they come up between two x of the drive."""
        period = self.road.profile.period or self.every
        x = x - self.shift
        if period:
            x = x + period * np.arange(max(int((high - x[0]) / period) + 1, 1))[:, None]
        x = x.ravel()
        return x[(x > low) & (x < high)]

    def weight(self, x: np.ndarray) -> Derivatives:
        """0 before the start, 1 from BLEND behind it on, with two continuous derivatives."""
        u = np.clip((x - self.start) / BLEND, 0.0, 1.0)
        return (
            u**3 * (10 - 15 * u + 6 * u**2),
            30 * u**2 * (1 - u) ** 2 / BLEND,
            60 * u * (1 - u) * (1 - 2 * u) / BLEND**2,
        )

    def moved(self, by: float) -> _Shape:
        return _Shape(self.road, self.start - by, self.shift + by, self.every)


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
        self.config = config
        self.distance = 0.0  # m from where it started to the present origin
        system = build_system(config)
        y, self._static_load = starting_state(system)
        every = OBSTACLE_EVERY if isinstance(config.road, HalfRoundRoad) else 0.0
        self._shapes = [_Shape(build_road(config), -np.inf, 0.0, every)]
        self._past: deque[tuple[np.ndarray, Samples]] = deque()
        self._seconds = 0.0
        settings = config.simulation
        self._run = Integration(
            system,
            self._laid(0.0).table,
            y,
            np.inf,
            settings.output_rate,
            settings.integrator,
            settings.rtol,
            settings.atol,
            settings.step,
            capacity=CAPACITY,
        )

    @property
    def time(self) -> float:
        """Driven since the start, s."""
        return self._run.t

    @property
    def status(self) -> Status:
        """RUNNING, or why the drive came to an end."""
        return self._run.status

    def change(self, config: Config) -> bool:
        """Drive on with another configuration; False where that meant to start anew from rest."""
        old = self.config
        parts = [name for name in type(old.vehicle).model_fields if name not in CHANGEABLE]
        same_bodies = all(getattr(old.vehicle, name) == getattr(config.vehicle, name) for name in parts)
        if not same_bodies or old.simulation != config.simulation or self.status is not Status.RUNNING:
            self._start(config)
            return False
        self.config = config
        system = build_system(config)
        x = float(self._run.y[0])
        table = self._run.road
        if config.road != old.road:
            self._join(config)
            table = self._laid(x).table
        self._run.change(system._replace(x_0=x - system.v_ref * self._run.t), table)
        return True

    def _join(self, config: Config) -> None:
        """The configuration's road from a metre ahead of the first wheel on, where it is fully risen."""
        wheels = self._run.system.road_wheels
        start = float(self._run.y[: len(self._run.system.mass)][wheels].max()) + JOIN_AHEAD
        road = build_road(config)
        last = road.profile.pieces[-1].nodes[0]
        if road.profile.period:
            self._shapes.append(_Shape(road, start, last - start, 0.0))
        else:  # an obstacle, well behind the blend
            first = road.profile.pieces[0].nodes[0]
            every = OBSTACLE_EVERY if isinstance(config.road, HalfRoundRoad) else 0.0
            self._shapes.append(_Shape(road, start, first - start - 2 * BLEND, every))

    def _laid(self, x: float) -> Road:
        """The road about the chassis at x, as one profile; shapes that nobody sees any more are dropped."""
        low, high = x - BEHIND, x + AHEAD
        past = [k for k, shape in enumerate(self._shapes) if shape.start + BLEND < low]
        self._shapes = self._shapes[past[-1] :] if past else self._shapes
        shapes = tuple(self._shapes)

        def derivatives(x: np.ndarray) -> Derivatives:
            h, h1, h2 = shapes[0].derivatives(x)
            for shape in shapes[1:]:
                w, w1, w2 = shape.weight(x)
                g, g1, g2 = (new - old for new, old in zip(shape.derivatives(x), (h, h1, h2), strict=True))
                h, h1, h2 = h + w * g, h1 + w * g1 + w1 * g, h2 + w * g2 + 2 * w1 * g1 + w2 * g
            return h, h1, h2

        radius = self.config.vehicle.road_wheels.radius
        own = [shape.repeated(piece.nodes, low, high) for shape in shapes for piece in shape.road.profile.pieces]
        nodes = np.unique(np.concatenate([np.arange(low, high, radius / CELLS_PER_RADIUS), [high], *own]))
        nodes = nodes[np.append(True, np.diff(nodes) > SAME)]
        corners = [
            shape.repeated(piece.nodes[[0, -1]], low, high)
            for shape in shapes
            for piece in shape.road.profile.pieces
            if not shape.road.profile.period
        ]
        splits = np.searchsorted(nodes, np.unique(np.concatenate([[], *corners])) - SAME)
        ends = np.unique(np.concatenate([[0], splits, [len(nodes) - 1]]))
        pieces = [_inside(nodes[i : k + 1], derivatives) for i, k in pairwise(ends)]
        self._laid_to = high
        self._road = Road(Profile(pieces), radius)
        return self._road

    def advance(self, until: float) -> None:
        """Drive on to a time, s, at most CAPACITY samples away. A drive that diverged stands still."""
        if self.status is not Status.RUNNING:
            return
        began = perf_counter()
        run = self._run
        x = float(run.y[0])
        if x > REBASE:
            self._move_origin(REBASE)
        if x + SPARE > self._laid_to:
            run.change(run.system, self._laid(float(run.y[0])).table)
        while run.t < until and run.advance(until) is Status.RUNNING:
            pass
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
        past = [part for part in self._past if part[0][-1] >= self.time - seconds] or [self._past[-1]]
        t = np.concatenate([times for times, _ in past])
        samples = Samples._make(np.concatenate(parts) for parts in zip(*(kept for _, kept in past), strict=True))
        status, advice = "complete", ""
        if self.status is not Status.RUNNING:
            status, advice = f"diverged at t = {self.time:.4g} s: {REASON[self.status]}", ADVICE[self.status]
        run = self._run
        counts = RunStatistics(run.steps, run.rejected_steps, run.evaluations, run.smallest_step, self._seconds)
        return Trajectory(t, *samples, self._static_load, self.config, status, advice, counts)

    def road(self) -> Road:
        """The road about the vehicle, as far as it is laid, in the frame of `recent`; the same until more is laid."""
        return self._road

    def _move_origin(self, by: float) -> None:
        run = self._run
        y = run.y.copy()
        y[: len(run.system.mass)] -= by
        self._shapes = [shape.moved(by) for shape in self._shapes]
        self.distance += by
        for _, samples in self._past:
            samples.q[..., 0] -= by
        run.change(run.system._replace(x_0=run.system.x_0 - by), self._laid(float(y[0])).table, y)


def _inside(nodes: np.ndarray, derivatives: Callable[[np.ndarray], Derivatives]) -> Piece:
    """A piece between two corners: at its ends, the slopes just inside."""
    first, last = nodes[0] + SAME, nodes[-1] - SAME
    return Piece(nodes, lambda x: derivatives(np.clip(x, first, last)))
