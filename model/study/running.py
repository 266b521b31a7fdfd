"""Runs of a study, on all cores or elsewhere, and what each comes to. Of a run nothing is kept but figures."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from itertools import islice
from typing import Any, NamedTuple, Protocol

from model.analysis.figures import figure_named
from model.analysis.ride import Summary
from model.config.config import Config, ConfigError
from model.config.parameters import Value
from model.dynamics.equilibrium import NoEquilibriumError
from model.simulation.batch import in_order
from model.simulation.simulate import simulate, simulate_motion, warm_up
from model.simulation.trajectory import Motion, Trajectory
from model.study.design import Point, Study

COMPLETE = "complete"
Keep = Callable[[int, Trajectory], None]  # gets each run, counted from 0, beside others: on any thread


class Spread(Protocol):
    """What work makes of each item, in their order, on threads here or elsewhere."""

    def __call__(self, work: Callable[[Any], Any], items: Iterable[Any]) -> Generator[Any, None, None]: ...


class Outcome(NamedTuple):
    """What a run came to. A figure that it does not have is None; one that did not reach its end has none."""

    status: str  # complete | diverged at … | inaccurate… | no rest pose: … | not allowed: … | failed: …
    figures: tuple[float | None, ...]

    @property
    def complete(self) -> bool:
        return self.status == COMPLETE


@dataclass(frozen=True)
class Row:
    """One run of a study."""

    run: int  # counted from 0
    point: Point
    outcome: Outcome


def rows(
    study: Study, first: int = 0, keep: Keep | None = None, spread: Spread = in_order
) -> Generator[Row, None, None]:
    """The runs of a study from `first` on, in their order. A run that comes to grief is a row like the others."""
    warm_up(study.base.simulation.integrator)  # compiled once, not by each worker
    return spread(partial(_row, study.base, study.keys, study.figures, keep), _Numbered(study, first))


@dataclass(frozen=True)
class _Numbered:
    """The points of a study from one on, each with its number, made as they are needed."""

    study: Study
    first: int

    def __len__(self) -> int:
        return len(self.study.points) - self.first

    def __iter__(self) -> Iterator[tuple[int, Point]]:
        return ((run, self.study.points[run]) for run in range(self.first, len(self.study.points)))


def _row(
    base: Config, keys: tuple[str, ...], figures: tuple[str, ...], keep: Keep | None, item: tuple[int, Point]
) -> Row:
    run, point = item
    seen = None if keep is None else partial(keep, run)
    return Row(run, point, outcome(base, dict(zip(keys, point, strict=True)), figures, seen))


def outcome(
    base: Config,
    changes: Mapping[str, Value],
    figures: tuple[str, ...],
    keep: Callable[[Trajectory], None] | None = None,
    should_stop: Callable[[], bool] | None = None,
) -> Outcome:
    """What a configuration with changes comes to; keep: gets the run; should_stop: as for `simulate`."""
    nothing = (None,) * len(figures)
    try:
        config = base.replace(changes)
        motion: Motion
        if keep is None:
            motion = simulate_motion(config, should_stop)
        else:
            keep(motion := simulate(config, should_stop=should_stop))
        if not motion.complete:
            return Outcome(motion.status, nothing)
        of = Summary(motion)
        return Outcome(COMPLETE, tuple(figure_named(name, of) for name in figures))
    except ConfigError as error:
        return Outcome(_line(f"not allowed: {error.faults[0]}"), nothing)
    except NoEquilibriumError as error:
        return Outcome(_line(f"no rest pose: {error}"), nothing)
    except (ValueError, ArithmeticError) as error:  # of thousands one that nobody thought of must not end the others
        return Outcome(_line(f"failed: {error}"), nothing)


def _line(text: str) -> str:
    return " ".join(text.split())


class Job(NamedTuple):
    """A run that an analysis asks for."""

    base: Config
    changes: Mapping[str, Value]
    figures: tuple[str, ...]


def done(job: Job) -> Outcome:
    """What a job comes to."""
    return outcome(*job)


class Evaluate(Protocol):
    """Does jobs, and gives what each came to, in their order. May raise to end the analysis."""

    def __call__(self, jobs: list[Job]) -> list[Outcome]: ...


def at_once(jobs: list[Job]) -> list[Outcome]:
    """On all cores."""
    warm_up()
    return list(in_order(done, jobs))


def blocks(items: Iterable[Any], size: int) -> Iterator[list[Any]]:
    """Items in lists of that many, the last one shorter."""
    rest = iter(items)
    while block := list(islice(rest, size)):
        yield block
