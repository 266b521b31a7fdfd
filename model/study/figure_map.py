"""A figure over the ranges of two parameters: true runs on a grid, coarse to fine."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from model.config.config import Config
from model.config.parameters import Value
from model.study.design import Range
from model.study.profiler import LEVELS, steps
from model.study.running import Evaluate, Job, Outcome

GRIDS = LEVELS[:2]  # values along each range: each time those of the grid before and the ones between


@dataclass(frozen=True, eq=False)
class FigureMap:
    """A figure on a grid."""

    base: Config
    x: Range
    y: Range
    figure: str
    columns: np.ndarray  # (M,) values of x's parameter, rising, in the unit of the file
    rows: np.ndarray  # (N,) of y's
    values: np.ndarray  # (N, M) of the figure; NaN where a run did not come to its end
    level: int  # of GRIDS

    @property
    def done(self) -> bool:
        return self.level == GRIDS[-1]


def figure_maps(
    base: Config,
    x: Range,
    y: Range,
    figure: str,
    evaluate: Evaluate,
    known: dict[tuple[Value, Value], Outcome],
) -> Iterator[FigureMap]:
    """The map of a figure, each time finer; known: outcomes by both values, which it adds to.

    What it takes no run for comes at once. `evaluate` may raise to give it up.
    """
    for level in GRIDS:
        columns, rows = steps(x, level), steps(y, level)
        missing = [(a, b) for b in rows for a in columns if (a, b) not in known]
        if not missing and level != GRIDS[-1] and (steps(x, GRIDS[-1])[1], steps(y, GRIDS[-1])[1]) in known:
            continue  # a finer one is known as well
        outcomes = evaluate([Job(base, {x.key: a, y.key: b}, (figure,)) for a, b in missing])
        known.update(zip(missing, outcomes, strict=True))
        values = [[known[a, b].figures[0] for a in columns] for b in rows]
        yield FigureMap(
            base,
            x,
            y,
            figure,
            np.array(columns, dtype=float),
            np.array(rows, dtype=float),
            np.array(values, dtype=float),
            level,
        )
