"""The results of `trackride limits`."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, NullFormatter
from rich.table import Table

from app.format.markup import element
from app.reports.drawings import WIDTH, Drawing, Look, panels, plain_axes
from app.reports.html_page import wide_table
from app.reports.studies.common import csv_bytes, figure_label, legend, result_files, terminal_table
from model.config.config import Config
from model.study.limits import AT_ONCE, NEVER, SPEEDS, Limit

COLOURS = ("#1864ab", "#c2410c", "#2b8a3e", "#862e9c", "#b08900", "#0b7285", "#a61e4d", "#495057")
DARK_COLOURS = ("#74b9ff", "#ff9d5c", "#69db7c", "#da9cf0", "#f2cc4d", "#66d9e8", "#f783ac", "#ced4da")
HEADS = ("vehicle", "figure", "bound", "ground", "name", "size_m", "seed", "speed_kmh", "note", "down_again_kmh")
SHOWN = ("Vehicle", "Ground", "rms or height, mm", "Speed, km/h")
RIDE, SHOCK = "Ride-limited speed (6 W), km/h", "Shock-limited speed (2.5 g), km/h"
CAPTION = (
    "Left: fastest speed with an absorbed power of at most 6 W at the seat, over the rms of the ground's heights; the "
    "line is the median of the random roads of ISO 8608, the band reaches from the slowest to the fastest; dashed: "
    "measured profiles with their heights scaled, a dot as measured. Right: fastest speed with at most 2.5 g at the "
    "seat over half-rounds whose radius is their height. Triangles: never over the bound up to the highest speed "
    "tried; rings: beyond the limit there is a speed at which the figure is below its bound again."
)
COMPARED = (
    "What is compared: vehicles of this model with each other, by the two bounds that the NATO Reference Mobility "
    "Model uses. Published curves of these vehicles could not be had, and nothing is claimed of them. ISO 8608 "
    "counts waves from 0.1 to 20 m here; a measured profile's rms is that about a straight line. The same rms is not "
    "the same ride: measured courses have other spectra, and so other curves."
)


def files(found: Sequence[Limit], bases: Sequence[Config]) -> dict[str, bytes]:
    """By name: page, figure, tables."""
    body = [
        element("p", COMPARED),
        element("h2", "Speeds"),
        wide_table(SHOWN, list(_shown(found, bases))),
        element("h2", "Over all speeds"),
        element("p", "In curves.csv each limit is with the figure at every speed that was tried."),
    ]
    tables = {
        "table.csv": csv_bytes(HEADS, (_row(limit, bases) for limit in found)),
        "curves.csv": csv_bytes(
            ("vehicle", "figure", "ground", "name", "size_m", "seed", "speed_kmh", "value"), _curves(found, bases)
        ),
    }
    words = ", ".join(base.name for base in bases)
    return result_files("How fast over rough ground", words, drawing(found, bases), CAPTION, body, bases, tables)


def table(found: Sequence[Limit], bases: Sequence[Config]) -> Table:
    """For the terminal."""
    return terminal_table(SHOWN, list(_shown(found, bases)))


def _row(limit: Limit, bases: Sequence[Config]) -> tuple[object, ...]:
    ground = limit.ground
    return (
        bases[limit.vehicle].name, limit.figure, limit.bound, ground.family, ground.name, ground.size, ground.seed,
        limit.speed, limit.why, limit.down_again,
    )  # fmt: skip


def _curves(found: Sequence[Limit], bases: Sequence[Config]) -> Iterator[tuple[object, ...]]:
    for limit in found:
        ground = limit.ground
        for speed, value in zip(limit.speeds, limit.values, strict=True):
            yield (
                bases[limit.vehicle].name, limit.figure, ground.family, ground.name, ground.size, ground.seed, speed,
                value,
            )  # fmt: skip


def _grouped(found: Sequence[Limit]) -> dict[tuple[int, str], dict[str, list[Limit]]]:
    """By vehicle and family of grounds, and there by the ground's name: limits of all seeds."""
    groups: dict[tuple[int, str], dict[str, list[Limit]]] = {}
    for limit in found:
        of = groups.setdefault((limit.vehicle, limit.ground.family), {})
        of.setdefault(limit.ground.name, []).append(limit)
    return groups


def _shown(found: Sequence[Limit], bases: Sequence[Config]) -> Iterator[list[str]]:
    """Rows for people: the median over seeds, with the slowest and the fastest."""
    for (vehicle, family), of in _grouped(found).items():
        for name, group in of.items():
            size = 1e3 * float(np.median([limit.ground.size for limit in group]))
            yield [bases[vehicle].name, f"{family}, {name}", f"{size:.3g}", _speed_words(group)]


def _speed_words(group: Sequence[Limit]) -> str:
    """Of all seeds."""
    again = " (down again beyond)" if any(limit.down_again for limit in group) else ""
    reasons = {limit.why for limit in group}
    if reasons == {NEVER}:
        return f"over {SPEEDS[-1]:g}"
    if reasons == {AT_ONCE}:
        return f"below {SPEEDS[0]:g}"
    drawn = [limit.drawn for limit in group if limit.drawn is not None]
    if not drawn:
        return ", ".join(sorted(reasons))
    middle, low, high = np.median(drawn), min(drawn), max(drawn)
    return f"{middle:.1f}" + (f" ({low:.1f} … {high:.1f})" if len(drawn) > 1 else "") + again


def drawing(found: Sequence[Limit], bases: Sequence[Config]) -> Drawing:
    """Both kinds of limits, all vehicles."""

    def draw(figure: Figure, look: Look) -> None:
        left, right = panels(figure, 1, 2)
        figures = [next((limit.figure for limit in found if (limit.ground.family == "half-round") == shock), "")
                   for shock in (False, True)]  # fmt: skip
        for axes, title, figure_name in ((left, RIDE, figures[0]), (right, SHOCK, figures[1])):
            plain_axes(axes, look, title, "")
            axes.set_xlabel("rms of the ground's heights, mm" if axes is left else "Height of the half-round, mm")
            axes.set_label(figure_label(figure_name) if figure_name else "")
            axes.xaxis.label.set(fontsize=8.5, color=look.ink)
            axes.set_ylim(0, SPEEDS[-1] * 1.05)
        for (vehicle, family), of in _grouped(found).items():
            colours = DARK_COLOURS if look.dark else COLOURS
            colour = colours[vehicle % len(colours)]
            _curve(right if family == "half-round" else left, family, of, colour, bases[vehicle].name)
        left.set_xscale("log")
        left.set_xticks([2, 5, 10, 20, 50, 100, 200])
        left.xaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
        left.xaxis.set_minor_formatter(NullFormatter())
        right.set_xlim(0)
        if right.get_legend_handles_labels()[0]:
            legend(right, look, loc="upper right")

    return Drawing("Ride-limited and shock-limited speeds", WIDTH, 4.2, draw)


def _curve(axes: Axes, family: str, of: dict[str, list[Limit]], colour: str, vehicle: str) -> None:
    """Median, band, and marks of one vehicle on one family of grounds."""
    points = []
    for group in of.values():
        drawn = [limit.drawn for limit in group if limit.drawn is not None]
        if drawn:
            size = 1e3 * np.median([limit.ground.size for limit in group])
            points.append((size, np.median(drawn), min(drawn), max(drawn), group))
    if not points:
        return
    points.sort(key=lambda point: point[0])
    x, middle, low, high = (np.array([point[k] for point in points]) for k in range(4))
    profile = family not in ("ISO 8608", "half-round")
    axes.plot(x, middle, color=colour, lw=1.4, ls=(0, (4, 2)) if profile else "-", label="" if profile else vehicle)
    axes.fill_between(x, low, high, color=colour, alpha=0.18, lw=0)
    for size, speed, _, _, group in points:
        if all(limit.why == NEVER for limit in group):
            axes.plot(size, speed, "^", color=colour, ms=4)
        if any(limit.down_again for limit in group):
            axes.plot(size, speed, "o", color=colour, ms=6, mfc="none", mew=1)
        if any(limit.ground.as_measured for limit in group):
            axes.plot(size, speed, "o", color=colour, ms=4)
