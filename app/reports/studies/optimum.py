"""The results of `trackride optimise`."""

from __future__ import annotations

import shlex
from collections.abc import Iterator, Sequence
from itertools import accumulate

from matplotlib.figure import Figure
from rich.table import Table

from app.format.markup import element
from app.reports.drawings import WIDTH, Drawing, Look, panels, plain_axes
from app.reports.html_page import wide_table
from app.reports.studies.common import (
    csv_bytes,
    figure_label,
    key_label,
    legend,
    number_cell,
    result_files,
    terminal_table,
)
from model.config.config import Config
from model.config.config_files import dump_config
from model.config.parameters import number_text
from model.study.design import Range
from model.study.optimum import Optimum, Solution

ONE = "Left: the least value so far, run by run. Right: all that was tried and keeps the bounds, over the first key."
TWO = "Every point that was tried and keeps the bounds; the line joins those than which none is better in both."


def files(found: Optimum, bases: Sequence[Config], over: Sequence[Range], mean: bool) -> dict[str, bytes]:
    """By name: page, figure, table, and a configuration for each point of the front."""
    heads, shown = _table(found)
    single = len(found.front) == 1
    names = ["best.yaml"] if single else [f"front/{k + 1:03d}.yaml" for k in range(len(found.front))]
    commands = [
        f"trackride explore {name}    # {_assignments(solution)}"
        for name, solution in zip(names, found.front, strict=True)
    ]
    ranges = [[key_label(of.key), of.key, f"{number_text(of.low)} to {number_text(of.high)}"] for of in over]
    roads = f"{'Mean' if mean else 'Worst'} of {len(bases)} roads" if len(bases) > 1 else "One road"
    if len(bases) > 1 and "drive.speed_kmh" not in (of.key for of in over):
        roads += f", all at {number_text(bases[0].drive.speed_kmh)} km/h"
    body = [
        element("h2", "Best" if single else "Front"),
        wide_table(heads, shown),
        element("p", "Bounds: " + (", ".join(f"{b.figure} ≤ {b.most:g}" for b in found.bounds) or "none") + "."),
        element("h2", "To open them"),
        element("pre", "\n".join(commands)),
        element("h2", "Ranges"),
        wide_table(("Key", "Name", "Range"), ranges),
    ]
    configurations = {
        name: dump_config(bases[0].replace(solution.changes)).encode()
        for name, solution in zip(names, found.front, strict=True)
    }
    table = {"front.csv": csv_bytes(*_csv(found))}
    subtitle = f"{bases[0].name}: {found.runs} runs. {roads}."
    return result_files(
        "The best values", subtitle, drawing(found), ONE if len(found.goals) == 1 else TWO, body, bases,
        table | configurations,
    )  # fmt: skip


def table(found: Optimum) -> Table:
    """For the terminal."""
    heads, rows = _table(found)
    if len(found.front) == 1:  # few columns: values stand below each other
        heads, *rows = [list(line) for line in zip(heads, *rows, strict=True)]
    return terminal_table(heads, rows)


def _assignments(solution: Solution) -> str:
    return shlex.join(f"{key}={number_cell(value)}" for key, value in solution.changes.items())


def _solutions(found: Optimum) -> Iterator[tuple[str, Solution]]:
    if found.before is not None:
        yield "as it is", found.before
    for k, solution in enumerate(found.front):
        yield "best" if len(found.front) == 1 else f"{k + 1}", solution


def _table(found: Optimum) -> tuple[list[str], list[list[str]]]:
    keys = list(found.front[0].changes)
    heads = ["", *keys, *map(figure_label, (*found.goals, *(bound.figure for bound in found.bounds)))]
    rows = [
        [name, *(f"{value:.4g}" for value in _values(solution, keys))]
        if solution.changes
        else [name, *("" for _ in keys), *(f"{value:.4g}" for value in (*solution.goals, *solution.bounded))]
        for name, solution in _solutions(found)
    ]
    return heads, rows


def _values(solution: Solution, keys: Sequence[str]) -> list[float]:
    return [*(float(str(solution.changes[key])) for key in keys), *solution.goals, *solution.bounded]


def _csv(found: Optimum) -> tuple[list[str], list[list[float]]]:
    keys = list(found.front[0].changes)
    heads = [*keys, *found.goals, *(f"bound {bound.figure}" for bound in found.bounds)]
    return heads, [_values(solution, keys) for solution in found.front]


def drawing(found: Optimum) -> Drawing:
    """How the search went, or the front."""

    def one(figure: Figure, look: Look) -> None:
        left, right = panels(figure, 1, 2)
        (goal,), key = found.goals, next(iter(found.front[0].changes))
        values = [solution.goals[0] for solution in found.tried]
        plain_axes(left, look, figure_label(goal), "Runs that keep the bounds")
        left.plot(range(1, len(values) + 1), values, ".", color=look.grey, ms=3, alpha=0.5)
        left.plot(range(1, len(values) + 1), list(accumulate(values, min)), color=look.accents[0], lw=1.4)
        plain_axes(right, look, figure_label(goal), key_label(key))
        right.plot([float(str(s.changes[key])) for s in found.tried], values, ".", color=look.grey, ms=3, alpha=0.5)
        best = found.front[0]
        right.plot(float(str(best.changes[key])), best.goals[0], "o", color=look.accents[1], label="best")
        if found.before is not None:
            for axes in (left, right):
                axes.axhline(found.before.goals[0], color=look.grey, lw=0.9, ls=(0, (4, 2)), label="as it is")
        legend(right, look)

    def two(figure: Figure, look: Look) -> None:
        (axes,) = panels(figure, 1, 1)
        plain_axes(axes, look, figure_label(found.goals[1]), figure_label(found.goals[0]))
        x, y = zip(*(solution.goals for solution in found.tried), strict=True)
        axes.plot(x, y, ".", color=look.grey, ms=3, alpha=0.5, label="tried")
        x, y = zip(*(solution.goals for solution in found.front), strict=True)
        axes.plot(x, y, "o-", color=look.accents[0], ms=4, lw=1, label="front")
        if found.before is not None:
            axes.plot(*found.before.goals, "s", color=look.accents[1], label="as it is")
        legend(axes, look)

    title = f"Search for the least of {' and '.join(found.goals)}"
    return Drawing(title, WIDTH, 4.0, one if len(found.goals) == 1 else two)
