"""Runs of a study, on all cores, and what each comes to. Of a run nothing is kept but figures."""

from __future__ import annotations

from collections.abc import Callable, Generator
from dataclasses import dataclass

from model.analysis.figures import figures_by_name
from model.analysis.ride import summary
from model.config.config import Config, ConfigError
from model.config.parameters import Value
from model.dynamics.equilibrium import NoEquilibriumError
from model.simulation.batch import in_order
from model.simulation.simulate import simulate, warm_up
from model.simulation.trajectory import Trajectory
from model.study.design import Point, Study

COMPLETE = "complete"
Keep = Callable[[int, Trajectory], None]  # gets each run, counted from 0, beside others: on any thread


@dataclass(frozen=True)
class Row:
    """One run of a study. A figure that a run does not have is None; one that did not reach its end has none."""

    run: int  # counted from 0
    point: Point
    status: str  # complete | diverged at … | no rest pose: … | not allowed: … | failed: …
    figures: tuple[float | None, ...]

    @property
    def complete(self) -> bool:
        return self.status == COMPLETE


def rows(
    study: Study, first: int = 0, keep: Keep | None = None, workers: int | None = None
) -> Generator[Row, None, None]:
    """The runs of a study from `first` on, in their order. A run that comes to grief is a row like the others.

    workers: as many runs at a time; left out, one for each core.
    """
    warm_up(study.base.simulation.integrator)  # compiled once, not by each worker
    return in_order(lambda run: row(study, run, keep), range(first, len(study.points)), workers)


def row(study: Study, run: int, keep: Keep | None = None) -> Row:
    """One run."""
    point = study.points[run]
    status, figures = outcome(study.base, dict(zip(study.keys, point, strict=True)), study.figures, run, keep)
    return Row(run, point, " ".join(status.split()), figures)


def outcome(
    base: Config, changes: dict[str, Value], figures: tuple[str, ...], run: int = 0, keep: Keep | None = None
) -> tuple[str, tuple[float | None, ...]]:
    """What a configuration with changes comes to: status and figures."""
    nothing = (None,) * len(figures)
    try:
        trajectory = simulate(base.replace(changes))
        if keep is not None:
            keep(run, trajectory)
        if not trajectory.complete:
            return trajectory.status, nothing
        named = figures_by_name(summary(trajectory))
    except ConfigError as error:
        return f"not allowed: {error.faults[0]}", nothing
    except NoEquilibriumError as error:
        return f"no rest pose: {error}", nothing
    except (ValueError, ArithmeticError) as error:  # of thousands one that nobody thought of must not end the others
        return f"failed: {error}", nothing
    return COMPLETE, tuple(named.get(name) for name in figures)
