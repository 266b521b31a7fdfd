"""What matters: by how much each of some keys moves the figures of a run over its range, and how sure that is.

Morris's screening goes along trajectories that change one key at a time, a few runs a key. Sobol's indices are shares
of a figure's variance when all keys vary at once, evenly over their ranges: of a key alone, and together with others.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from model.config.config import Config
from model.study.design import DesignError, Range, Sample
from model.study.running import Evaluate, Job, at_once

LEVELS = 4  # of each key in Morris's trajectories
STEP = LEVELS / (2 * (LEVELS - 1))  # from one to the next, of the range
CONFIDENCE = 0.95
RESAMPLES = 999  # of the bootstrap
MOST_LOST = 0.1  # of the runs may come to grief; a figure of these counts as the mean of the others

Function = Callable[[np.ndarray], np.ndarray]  # points (N, K), each 0…1 of its range -> figures (S, N)


@dataclass(frozen=True)
class Screening:
    """Morris's measures of S figures for K keys, in the figure's unit for the key's whole range."""

    strength: np.ndarray  # (S, K) μ*, mean of |change|
    strength_error: np.ndarray  # (S, K) by which it may be off, at CONFIDENCE
    mean: np.ndarray  # (S, K) μ, mean change; its sign says which way
    spread: np.ndarray  # (S, K) σ: how much the change depends on where and on the other keys


@dataclass(frozen=True)
class Indices:
    """Sobol's indices of S figures for K keys: shares of the variance, each with its bounds at CONFIDENCE."""

    first: np.ndarray  # (S, K) of the key alone
    first_low: np.ndarray
    first_high: np.ndarray
    total: np.ndarray  # (S, K) with all that it does together with other keys
    total_low: np.ndarray
    total_high: np.ndarray


@dataclass(frozen=True)
class Sensitivity:
    """Both, of a vehicle's figures."""

    keys: tuple[str, ...]
    figures: tuple[str, ...]
    screening: Screening
    indices: Indices
    runs: int
    lost: int  # runs that came to grief


def morris(function: Function, keys: int, trajectories: int, seed: int) -> Screening:
    """Screen so many keys along so many trajectories of `keys` + 1 points each."""
    random = np.random.default_rng(seed)
    points = np.concatenate([_trajectory(keys, random) for _ in range(trajectories)])
    values = function(points)
    moves = np.diff(points.reshape(trajectories, keys + 1, keys), axis=1)  # (r, K, K), each row with one entry
    effect = np.diff(values.reshape(len(values), trajectories, keys + 1), axis=2) / moves.sum(axis=2)
    moved = np.abs(moves).argmax(axis=2)
    effects = np.empty_like(effect)  # (S, r, K), in the order of the keys
    np.put_along_axis(effects, np.broadcast_to(moved, effect.shape), effect, axis=2)
    size = np.abs(effects)
    error = 1.96 * size.std(axis=1, ddof=1) / np.sqrt(trajectories)
    return Screening(size.mean(axis=1), error, effects.mean(axis=1), effects.std(axis=1, ddof=1))


def _trajectory(keys: int, random: np.random.Generator) -> np.ndarray:
    """(K + 1, K) points; from each to the next another key moves by STEP, up or down."""
    low = random.integers(LEVELS // 2, size=keys) / (LEVELS - 1)
    up = random.random(keys) < 0.5
    points = np.tile(np.where(up, low, low + STEP), (keys + 1, 1))
    for place, key in enumerate(random.permutation(keys)):
        points[place + 1 :, key] += STEP if up[key] else -STEP
    return points


def sobol(function: Function, keys: int, samples: int, seed: int) -> Indices:
    """Indices of so many keys from samples × (keys + 2) points; samples: a power of 2.

    The bounds are bootstrapped here, as those of SciPy's own result cannot be drawn from a seed.
    """
    from scipy.stats import DegenerateDataWarning, bootstrap, sobol_indices, uniform  # a second to load

    random = np.random.default_rng(seed)
    values: list[np.ndarray] = []

    def indices(f_A: np.ndarray, f_B: np.ndarray, f_AB: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        values.extend((f_A, f_B, f_AB))
        return _saltelli(f_A, f_B, f_AB)

    found = sobol_indices(func=lambda x: function(x.T), n=samples, dists=[uniform()] * keys, rng=random, method=indices)
    with warnings.catch_warnings(), np.errstate(invalid="ignore"):
        warnings.simplefilter("ignore", DegenerateDataWarning)  # of shares that are the same in every resample
        bounds = bootstrap(
            [np.arange(samples)],
            lambda chosen: np.stack(_saltelli(*(value[..., chosen] for value in values))),
            n_resamples=RESAMPLES,
            confidence_level=CONFIDENCE,
            rng=random,
        ).confidence_interval
    first, total = np.atleast_2d(found.first_order), np.atleast_2d(found.total_order)
    known = np.isfinite(bounds[0]) & np.isfinite(bounds[1])
    (first_low, total_low), (first_high, total_high) = np.where(known, bounds, np.stack([first, total]))
    return Indices(first, first_low, first_high, total, total_low, total_high)


def _saltelli(at_a: np.ndarray, at_b: np.ndarray, at_ab: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """First and total indices (S, K) by Saltelli et al. 2010, table 2, (b) and (f).

    Of S figures at N points a (S, N), at as many points b, and at each a with one key taken from b (K, S, N).
    """
    variance = np.var(np.concatenate([at_a, at_b], axis=-1), axis=-1)
    variance[variance == 0] = np.inf  # what nothing changes has no shares
    first = np.mean(at_b * (at_ab - at_a), axis=-1) / variance
    total = np.mean((at_a - at_ab) ** 2, axis=-1) / (2 * variance)
    return first.T, total.T


def sensitivity(
    base: Config,
    over: Sequence[Range],
    figures: tuple[str, ...],
    trajectories: int = 10,
    samples: int = 64,
    seed: int = 0,
    evaluate: Evaluate = at_once,
) -> Sensitivity:
    """Both measures of figures of the base. Raises DesignError where too many runs come to grief."""
    if len(over) < 2:
        raise DesignError("give two keys or more: there is nothing to compare one with")
    count = {"runs": 0, "lost": 0}

    def function(points: np.ndarray) -> np.ndarray:
        values = Sample(over, points)
        jobs = [Job(base, dict(zip(keys, value, strict=True)), figures) for value in values]
        outcomes = evaluate(jobs)
        missing = [outcome for outcome in outcomes if not outcome.complete]
        count["runs"] += len(outcomes)
        count["lost"] += len(missing)
        if len(missing) > MOST_LOST * len(outcomes):
            raise DesignError(
                f"incomplete: {len(missing)} of {len(outcomes)} runs, such as: {missing[0].status}; "
                "give narrower ranges"
            )
        found = np.array([outcome.figures for outcome in outcomes], dtype=float).T
        known = np.isfinite(found)
        if not known.any(axis=1).all():
            raise DesignError(f"{figures[int((~known.any(axis=1)).argmax())]}: no run has this figure; leave it out")
        return np.where(known, found, np.nanmean(found, axis=1, keepdims=True))

    keys = tuple(of.key for of in over)
    screening = morris(function, len(keys), trajectories, seed)
    indices = sobol(function, len(keys), samples, seed)
    return Sensitivity(keys, figures, screening, indices, count["runs"], count["lost"])
