"""How fast a vehicle may go: over rough ground until its driver absorbs 6 W, over half-rounds until he feels 2.5 g.

That is how the NATO Reference Mobility Model reports ride. For each ground the figure is computed at a row of speeds;
the limit is where it first exceeds its bound, sought more closely between the speeds next to it. Slow runs take long:
the row is followed downwards only as far as the figure may still come near its bound.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import exp, log

import numpy as np

from model.analysis.comfort import POWER_LIMIT
from model.analysis.figures import POWER, SHOCK
from model.analysis.signals import SETTLING
from model.config.config import Config, RandomRoad
from model.config.parameters import Value
from model.config.profile_points import points
from model.road.random_road import CLASSES, PLACE, heights
from model.road.road import RAMP_AHEAD
from model.study.running import Evaluate, Job, Outcome, at_once

SHOCK_BOUND = 2.5  # g
SPEEDS = (2.0, 3.0, 4.0, 6.0, 8.0, 11.0, 15.0, 20.0, 28.0, 40.0, 56.0, 80.0)  # km/h
FAST = 11.0  # km/h: faster ones are tried at once, and then slower ones, one after the other …
FAR_BELOW = 0.2  # … until the figure is less than this part of its bound
BETWEEN = (62.0, 68.0, 74.0)  # km/h, over half-rounds too: over them the shock rises and falls more quickly with speed
ROUNDS = 2  # of closer search, each with one more run
STRETCH = 80.0  # m of random road that figures are taken from
COURSE = 150.0  # m of a measured profile that is driven over, at most
LEVEL = 0.001  # m: so even is the lead-in of a measured profile, which is left out
SPREAD = (0.25, 0.5, 1.0, 2.0, 3.0, 4.0)  # times the heights of a measured profile
HEIGHTS = (0.05, 0.075, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4)  # m of half-rounds; their radius is their height
AFTER = 2.0  # s that a run goes on behind an obstacle or a profile
APART = 1.0  # m between the first wheel and a half-round at the start


@dataclass(frozen=True)
class Ground:
    """What a vehicle drives over, and how the curve of limits is drawn over it."""

    family: str  # "ISO 8608", the name of a file, or "half-round"
    name: str  # "class C", "class C, heights times 1.5", "times 0.5", "100 mm"
    size: float  # m: rms of its heights, or the height of the half-round
    changes: Mapping[str, Value]
    distance: float  # m from the start to where the run may end, of the first wheel
    seed: int = 0
    as_measured: bool = False  # a profile with its own heights


@dataclass(frozen=True)
class Limit:
    """The fastest speed of a vehicle on a ground, and the figure at all speeds that were tried."""

    vehicle: int  # counted from 0
    ground: Ground
    figure: str
    bound: float
    speeds: tuple[float, ...]  # km/h, rising
    values: tuple[float | None, ...]  # of the figure there
    speed: float | None  # km/h; None: see why
    why: str  # no speed is told: over the bound at the lowest speed, never over it, or a run came to grief
    down_again: float | None  # km/h: the lowest speed tried beyond the limit at which the figure is below its bound

    @property
    def drawn(self) -> float | None:
        """The speed where one can be drawn: the highest tried where the bound is never reached."""
        return self.speeds[-1] if self.why == NEVER else self.speed


AT_ONCE, NEVER, GRIEF = "over it at the lowest speed", "never over it", "a run did not come to its end"


def iso_grounds(base: Config, seeds: Sequence[int]) -> list[Ground]:
    """Random roads of all classes, and half way between those that matter, for each seed.

    Heights half way are those of a class and of the one below it, half as high, with the same seed, added up.
    """
    wheels = base.vehicle.road_wheels
    steps = [(name, 1.0) for name in CLASSES] + [(name, 1.5) for name in CLASSES[2:-1]]
    grounds = []
    for seed in seeds:
        for name, times in sorted(steps, key=lambda step: 2.0 ** CLASSES.index(step[0]) * step[1]):
            road = RandomRoad(roughness_class=name, seed=seed)
            rms = times * float(np.std(heights(road, wheels.radius)[0]))
            parts = [name] if times == 1 else [name, CLASSES[CLASSES.index(name) - 1]]
            changes: dict[str, Value] = {"road.type": "random", "road.roughness_class": name, "road.seed": seed}
            if len(parts) > 1:
                listed = tuple({"type": "random", "roughness_class": part, "seed": seed} for part in parts)
                changes = {"road.type": "sum", "road.parts": listed}
            words = f"class {name}" if times == 1 else f"class {name}, heights times {times:g}"
            distance = RAMP_AHEAD + PLACE + wheels.x[0] - wheels.x[-1] + STRETCH
            grounds.append(Ground("ISO 8608", words, rms, changes, distance, seed))
    return grounds


def profile_grounds(base: Config, name: str, text: str) -> list[Ground]:
    """A measured profile, points as in road.points, without its level lead-in, its heights times SPREAD.

    Its size is the rms of the heights about their straight line, over what is driven.
    """
    x, y = points(text)
    first = max(int((np.abs(y - y[0]) > LEVEL).argmax()) - 1, 0)
    last = int(np.searchsorted(x, x[first] + COURSE, side="right"))
    x, y = x[first:last] - x[first], y[first:last] - y[first]
    even = np.arange(0.0, x[-1], 0.05)
    height = np.interp(even, x, y)
    rms = float(np.std(height - np.polyval(np.polyfit(even, height, 1), even)))
    wheels = base.vehicle.road_wheels
    start = wheels.x[0] + RAMP_AHEAD
    grounds = []
    for times in SPREAD:
        told = ", ".join(f"{a:.6g} {b:.6g}" for a, b in zip(x, times * y, strict=True))
        changes: dict[str, Value] = {"road.type": "profile", "road.points": told, "road.start": start}
        distance = RAMP_AHEAD + x[-1] + wheels.x[0] - wheels.x[-1]
        words = "as measured" if times == 1 else f"heights times {times:g}"
        grounds.append(Ground(name, words, times * rms, changes, float(distance), as_measured=times == 1))
    return grounds


def half_round_grounds(base: Config) -> list[Ground]:
    """Half-rounds of HEIGHTS."""
    wheels = base.vehicle.road_wheels
    grounds = []
    for height in HEIGHTS:
        ahead = APART + wheels.radius + height
        changes: dict[str, Value] = {
            "road.type": "half_round",
            "road.height": height,
            "road.radius": height,
            "road.position": wheels.x[0] + ahead,
        }
        distance = ahead + height + wheels.radius + wheels.x[0] - wheels.x[-1]
        grounds.append(Ground("half-round", f"{1e3 * height:g} mm", height, changes, distance))
    return grounds


def course_of(base: Config, seeds: Sequence[int] = (1, 2, 3)) -> list[list[Ground]]:
    """Random roads and half-rounds in the order in which they tell most: all with the first seed, then other seeds."""
    first, *others = (iso_grounds(base, [seed]) for seed in seeds)
    rounds = half_round_grounds(base)
    coarse = [*rounds[1::3], *(ground for ground in first if ground.changes["road.type"] == "random")]
    fine = [ground for ground in (*rounds, *first) if ground not in coarse]
    return [[*coarse, *fine], *others]


def limits(vehicles: Sequence[tuple[Config, Sequence[Ground]]], evaluate: Evaluate = at_once) -> list[Limit]:
    """The limit of each vehicle on each of its grounds."""
    cases = [
        _Case(number, base.replace(ground.changes), ground)
        for number, (base, grounds) in enumerate(vehicles)
        for ground in grounds
    ]
    while wanted := [(case, speed) for case in cases for speed in case.wanted()]:
        outcomes = evaluate([case.job(speed) for case, speed in wanted])
        for (case, speed), outcome in zip(wanted, outcomes, strict=True):
            case.found[speed] = outcome
    return [case.limit() for case in cases]


@dataclass
class _Case:
    """The search on one ground."""

    vehicle: int
    config: Config
    ground: Ground

    def __post_init__(self) -> None:
        self.found: dict[float, Outcome] = {}
        self.rounds = 0  # of closer search that were made
        self.shock = self.ground.family == "half-round"
        self.figure, self.bound = (SHOCK.name, SHOCK_BOUND) if self.shock else (POWER.name, POWER_LIMIT)

    def job(self, speed: float) -> Job:
        after = SETTLING if self.ground.family == "ISO 8608" else AFTER
        duration = round(self.ground.distance / (speed / 3.6) + after, 2)
        return Job(self.config, {"drive.speed_kmh": speed, "simulation.duration": duration}, (self.figure,))

    def wanted(self) -> list[float]:
        """The speeds to be tried next; none once the limit is known."""
        if not self.found:
            # Half-rounds are short, and over them slow runs take no time
            return sorted({*SPEEDS, *BETWEEN}) if self.shock else [speed for speed in SPEEDS if speed > FAST]
        slowest, value = self._values()[0]
        slower = [speed for speed in SPEEDS if speed < slowest]
        if slower and not (value is not None and value < FAR_BELOW * self.bound):
            return slower[-1:]
        if self.rounds == ROUNDS:
            return []
        self.rounds += 1
        return self._closer()

    def _values(self) -> list[tuple[float, float | None]]:
        return [(speed, self.found[speed].figures[0]) for speed in sorted(self.found)]

    def _crossing(self) -> tuple[tuple[float, float], tuple[float, float]] | str:
        """The speeds before and behind which the figure first exceeds its bound, with its values; or why there is
        none."""
        before: tuple[float, float] | None = None
        for speed, value in self._values():
            if value is None:
                return GRIEF
            if value > self.bound:
                return AT_ONCE if before is None else (before, (speed, value))
            before = speed, value
        return NEVER

    def _between(self) -> float | None:
        """Where the figure is at its bound, if it goes straight in logarithms from one speed to the next."""
        crossing = self._crossing()
        if isinstance(crossing, str):
            return None
        (low, below), (high, above) = crossing
        below = max(below, 1e-6 * self.bound)
        part = log(self.bound / below) / log(above / below)
        return exp(log(low) + part * (log(high) - log(low)))

    def _closer(self) -> list[float]:
        """One more speed to be tried: where the bound should be, but well off either end."""
        between, crossing = self._between(), self._crossing()
        if between is None or isinstance(crossing, str):
            return []
        (low, _), (high, _) = crossing
        margin = 0.15 * (high - low)
        return [round(min(max(between, low + margin), high - margin), 3)]

    def limit(self) -> Limit:
        crossing, speed = self._crossing(), self._between()
        values = self._values()
        again = None
        if not isinstance(crossing, str):
            beyond = crossing[1][0]
            again = next((v for v, value in values if v > beyond and value is not None and value < self.bound), None)
        return Limit(
            self.vehicle,
            replace(self.ground, changes={}),
            self.figure,
            self.bound,
            tuple(v for v, _ in values),
            tuple(value for _, value in values),
            speed,
            crossing if isinstance(crossing, str) else "",
            again,
        )
