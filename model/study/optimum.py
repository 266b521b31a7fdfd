"""The best values of some keys: for one figure, or the front of two that cannot both be best.

One goal: differential evolution, then Nelder and Mead's simplex from the best point. Two goals: a population whose
trial points are made as in differential evolution, and whose better half is kept by rank and by distance to its
neighbours (GDE3, Kukkonen and Lampinen 2005). All points of a generation are run at once.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from model.config.config import Config, SumRoad
from model.config.config_files import part_values
from model.config.parameters import PARAMETERS, Value
from model.study.design import NUMBER, DesignError, Range, checked_figures, design
from model.study.running import Evaluate, Job, at_once

PER_KEY = 8  # members of the population for each key, …
LEAST, MOST = 16, 64  # … but as many
SCALE, CROSSOVER = 0.3, 0.3  # of trial points for a front
CONVERGED = 0.01  # spread of the population's values, relative to their mean, at which evolution ends
POLISH = 60  # runs of the simplex
IMPOSSIBLE, VIOLATED = 1e12, 1e9  # values of points that cannot be run, and of those that break a bound
BOUND = re.compile(rf"\s*([\w.]+)\s*<=\s*({NUMBER})\s*")

Many = Callable[[np.ndarray], np.ndarray]  # points (N, K), each 0…1 of its range -> values (N, S)


@dataclass(frozen=True)
class Bound:
    """A figure that must not be larger than that."""

    figure: str
    most: float


@dataclass(frozen=True)
class Solution:
    """A point and what it comes to."""

    changes: Mapping[str, Value]
    goals: tuple[float, ...]  # of the figures to be minimised
    bounded: tuple[float, ...]  # of the figures with bounds


@dataclass(frozen=True)
class Optimum:
    """What was found."""

    goals: tuple[str, ...]
    bounds: tuple[Bound, ...]
    before: Solution | None  # the base; None where it cannot be run
    front: tuple[Solution, ...]  # one for one goal; for two none is better in both than another, the first goal rising
    tried: tuple[Solution, ...]  # all that was run and keeps the bounds, in order
    runs: int


def parse_bound(text: str, base: Config) -> Bound:
    """FIGURE<=VALUE. Raises DesignError."""
    found = BOUND.fullmatch(text)
    if found is None:
        raise DesignError(f"{text}: give FIGURE<=VALUE, such as peak_load<=40")
    return Bound(checked_figures([found[1]], base)[0], float(found[2]))


def on_road(base: Config, other: Config) -> Config:
    """The base on the road of another configuration."""
    changes: dict[str, Value] = {"road.type": other.road.type}
    for parameter in PARAMETERS:
        if parameter.key.startswith("road.") and parameter.applies_to(other.road.type):
            value = other.value(parameter.key)
            if value is not None:
                changes[parameter.key] = value
    if isinstance(other.road, SumRoad):
        changes["road.parts"] = tuple(part_values(part) for part in other.road.parts)
    return base.replace(changes)


def members(keys: int) -> int:
    """Of the population of a search over so many keys."""
    return min(max(PER_KEY * keys, LEAST), MOST)


def optimise(
    bases: Sequence[Config],
    over: Sequence[Range],
    goals: tuple[str, ...],
    bounds: Sequence[Bound] = (),
    mean: bool = False,
    generations: int = 30,
    seed: int = 0,
    evaluate: Evaluate = at_once,
) -> Optimum:
    """The least of one goal or the front of two, over ranges of keys.

    bases: the same vehicle on one road or several; of several, the worst road counts, or the mean of all. Raises
    DesignError where no point can be run, or none keeps the bounds.
    """
    if len(goals) not in (1, 2):
        raise DesignError("give one figure to minimise, or two")
    problem = _Problem(bases, over, goals, tuple(bounds), mean, evaluate)
    before = problem.base()
    start = design("latin-hypercube", members(len(over)), len(over), seed)
    random = np.random.default_rng(seed)
    if len(goals) == 1:
        least(lambda points: problem(points)[:, 0], start, generations, random)
    else:
        front(problem, start, generations, random)
    tried = tuple(problem.tried.values())
    if not tried:
        raise DesignError(f"no point can be run and keeps the bounds{problem.complaint}; give wider ranges or bounds")
    kept = [tried[k] for k in best_of(np.array([solution.goals for solution in tried]))]
    if len(goals) == 1:
        kept = kept[:1]
    found = tuple(sorted(kept, key=lambda solution: solution.goals))
    return Optimum(goals, tuple(bounds), before, found, tried, problem.runs)


class _Problem:
    """Values of points: goals where all bounds are kept, else numbers that grow with what is broken."""

    def __init__(
        self,
        bases: Sequence[Config],
        over: Sequence[Range],
        goals: tuple[str, ...],
        bounds: tuple[Bound, ...],
        mean: bool,
        evaluate: Evaluate,
    ) -> None:
        self.bases, self.over, self.goals, self.bounds = bases, over, goals, bounds
        self.combine, self.evaluate = (np.mean if mean else np.max), evaluate
        self.figures = tuple(dict.fromkeys((*goals, *(bound.figure for bound in bounds))))
        self.tried: dict[tuple[Value, ...], Solution] = {}
        self.runs, self.complaint = 0, ""

    def base(self) -> Solution | None:
        """The base as it is."""
        figures = self._figures([{}])[0]
        return None if figures is None else self._solution({}, figures)

    def __call__(self, points: np.ndarray) -> np.ndarray:
        values = [tuple(of.at(float(part)) for of, part in zip(self.over, point, strict=True)) for point in points]
        changes = [dict(zip((of.key for of in self.over), value, strict=True)) for value in values]
        found = np.empty((len(points), len(self.goals)))
        for k, figures in enumerate(self._figures(changes)):
            if figures is None:
                found[k] = IMPOSSIBLE
                continue
            solution = self._solution(changes[k], figures)
            excess = [
                max(value - bound.most, 0.0) / max(abs(bound.most), 1e-9)
                for value, bound in zip(solution.bounded, self.bounds, strict=True)
            ]
            if sum(excess) > 0:
                found[k] = VIOLATED * (1 + min(sum(excess), 100.0))
            else:
                found[k] = solution.goals
                self.tried.setdefault(values[k], solution)
        return found

    def _solution(self, changes: Mapping[str, Value], figures: dict[str, float]) -> Solution:
        goals = tuple(figures[name] for name in self.goals)
        return Solution(changes, goals, tuple(figures[bound.figure] for bound in self.bounds))

    def _figures(self, changes: Sequence[Mapping[str, Value]]) -> list[dict[str, float] | None]:
        """Of each, over all roads."""
        outcomes = self.evaluate([Job(base, change, self.figures) for change in changes for base in self.bases])
        self.runs += len(outcomes)
        found: list[dict[str, float] | None] = []
        for k in range(len(changes)):
            roads = outcomes[k * len(self.bases) : (k + 1) * len(self.bases)]
            values = np.array([outcome.figures for outcome in roads], dtype=float)
            if np.isfinite(values).all():
                found.append(dict(zip(self.figures, map(float, self.combine(values, axis=0)), strict=True)))
            else:
                failed = next((outcome.status for outcome in roads if not outcome.complete), "a figure is missing")
                self.complaint = self.complaint or f" (such as: {failed})"
                found.append(None)
        return found


def least(function: Callable[[np.ndarray], np.ndarray], start: np.ndarray, generations: int,
          random: np.random.Generator) -> np.ndarray:  # fmt: skip
    """Where in the unit cube a function of points (N, K) is least, from a population (N, K)."""
    from scipy.optimize import differential_evolution, minimize

    keys = start.shape[1]
    found = differential_evolution(
        lambda x: function(x.T), [(0.0, 1.0)] * keys, init=start, maxiter=generations, tol=CONVERGED, rng=random,
        polish=False, vectorized=True, updating="deferred",
    )  # fmt: skip
    polished = minimize(
        lambda x: float(function(x[None])[0]), found.x, method="Nelder-Mead", bounds=[(0.0, 1.0)] * keys,
        options={"maxfev": POLISH, "initial_simplex": _simplex(found.x), "xatol": 1e-4, "fatol": 0.0},
    )  # fmt: skip
    return polished.x if polished.fun < found.fun else found.x


def _simplex(x: np.ndarray) -> np.ndarray:
    """(K + 1, K) about a point, within the unit cube."""
    corners = np.tile(x, (len(x) + 1, 1))
    for k in range(len(x)):
        corners[k + 1, k] += 0.03 if x[k] < 0.5 else -0.03
    return corners


def front(function: Many, start: np.ndarray, generations: int, random: np.random.Generator) -> np.ndarray:
    """(N, K) the last population of a search for the front of two values, from a population (N, K)."""
    points, values = start, function(start)
    count, keys = start.shape
    for _ in range(generations):
        a, b, c = (points[random.permutation(count)] for _ in range(3))
        mixed = a + SCALE * (b - c)
        mixed = np.where((mixed < 0) | (mixed > 1), random.random(mixed.shape), mixed)
        taken = random.random(mixed.shape) < CROSSOVER
        taken[np.arange(count), random.integers(keys, size=count)] = True
        trial = np.where(taken, mixed, points)
        points, values = np.concatenate([points, trial]), np.concatenate([values, function(trial)])
        kept = _better_half(values, count)
        points, values = points[kept], values[kept]
    return points


def best_of(values: np.ndarray) -> np.ndarray:
    """Which of values (N, S) none other is better than in all; of equal ones the first."""
    better = (values[:, None] <= values).all(axis=2) & (values[:, None] < values).any(axis=2)
    equal = (values[:, None] == values).all(axis=2)
    return np.flatnonzero(~(better | np.triu(equal, 1)).any(axis=0))


def _better_half(values: np.ndarray, count: int) -> np.ndarray:
    """So many of values (N, 2): front by front, and of the last one those that stand furthest from their neighbours."""
    left, kept = np.arange(len(values)), np.array([], dtype=int)
    while len(kept) < count:
        row = left[best_of(values[left])]
        if len(kept) + len(row) > count:
            row = row[np.argsort(-_distance(values[row]), kind="stable")[: count - len(kept)]]
        kept = np.concatenate([kept, row])
        left = np.setdiff1d(left, row)
    return kept


def _distance(values: np.ndarray) -> np.ndarray:
    """(N,) to the neighbours on a front (N, 2), infinite at its ends."""
    distance = np.zeros(len(values))
    for column in values.T:
        order = np.argsort(column, kind="stable")
        width = max(column[order[-1]] - column[order[0]], 1e-300)
        distance[order[[0, -1]]] = np.inf
        distance[order[1:-1]] += (column[order[2:]] - column[order[:-2]]) / width
    return distance
