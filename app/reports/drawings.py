"""Plots for pages: light and dark, as SVG or PNG, with matplotlib but without its global state.

But for one setting, which nothing changes later: in SVG files text is text, that can be searched, copied and edited.
"""

from __future__ import annotations

import io
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from importlib.metadata import version
from typing import Any

import numpy as np
from matplotlib import rcParams
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from app.format.colours import Palette, wheel_palette
from app.plots.curves import Curve, Peak, Plot
from model.dynamics.vehicle import System

rcParams["svg.fonttype"] = "none"
ONE_FONT = re.compile(rb"'DejaVu Sans'(?!,)")  # of formulas; to other texts matplotlib gives fonts to fall back on
FALLBACK = b"'DejaVu Sans', Verdana, sans-serif"  # Verdana is nearly as wide
DPI = 200  # of a PNG
WIDTH, HEIGHT = 9.6, 2.6  # inches, of a plot on a page
LEFT, RIGHT, ABOVE, BELOW = 0.5, 0.12, 0.32, 0.5  # inches around a plot, for its numbers and names
HEADROOM = 0.11  # of a plot's height, for the name of a mark
SMALL = 8.5  # points
NUMBER_ROOM = 0.15  # of a plot's height, above and below its curves, for the number of a peak
LINES: dict[str, tuple[Any, float]] = {"static": ((0, (1, 1.6)), 1.0), "baseline": ((0, (3, 1.5)), 0.5)}  # and opacity
NAMES = 0.6  # of a plot's width that its curves' names may take


@dataclass(frozen=True)
class Look:
    """Colours of a plot, CSS."""

    dark: bool
    ink: str
    grey: str
    grid: str
    accents: tuple[str, str]  # of curves that belong to no wheel

    def palette(self, system: System) -> Palette:
        """The colours of a vehicle's wheels."""
        return wheel_palette(system.n, system.m, self.dark)


LIGHT_LOOK = Look(False, "#1c2024", "#66707a", "#e1e5e9", ("#1864ab", "#c2410c"))
DARK_LOOK = Look(True, "#e6e9ec", "#98a2ad", "#343a41", ("#74b9ff", "#ff9d5c"))
LOOKS = (LIGHT_LOOK, DARK_LOOK)


@dataclass(frozen=True)
class AxesStyle:
    """Sizes of what stands around a plot, points."""

    title: float = 9.5  # of its text
    names: float = SMALL
    numbers: float = SMALL
    above: float = 7.0  # from the axes up to the title
    to_name: float = 4.0  # from the numbers to the name of the axis
    to_number: float = 3.5  # from the ticks to the numbers
    tick: float = 3.0
    line: float = 0.6
    grid: float = 0.7


PAGE_STYLE = AxesStyle()


@dataclass(frozen=True)
class Drawing:
    """A picture that can be drawn in any look."""

    title: str  # what it shows, for those who do not see it
    width: float  # inches
    height: float
    draw: Callable[[Figure, Look], None]

    def bytes(self, suffix: str, look: Look = LIGHT_LOOK, background: str = "none") -> bytes:
        """The content of a .svg or .png file. background: CSS, or none."""
        figure = Figure(figsize=(self.width, self.height), dpi=DPI, facecolor=background)
        self.draw(figure, look)
        return file_of(figure, self.title, suffix)


def stamp() -> str:
    """The name and version of the program."""
    return f"Trackride {version('trackride')}"


def file_of(figure: Figure, title: str, suffix: str) -> bytes:
    """The content of a .svg or .png file with the figure, its title and the stamp."""
    maker = {".png": "Software", ".svg": "Creator"}[suffix]
    file = io.BytesIO()
    figure.savefig(file, format=suffix[1:], metadata={"Title": title, maker: stamp()})
    content = file.getvalue()
    return ONE_FONT.sub(FALLBACK, content) if suffix == ".svg" else content


def panels(figure: Figure, rows: int, columns: int) -> list[Axes]:
    """Axes of one size, from left to right and top to bottom, with the same margins in every figure."""
    width, height = figure.get_size_inches()
    across, down = width / columns, height / rows
    return [
        figure.add_axes((
            (column * across + LEFT) / width,
            1 - ((row + 1) * down - BELOW) / height,
            (across - LEFT - RIGHT) / width,
            (down - BELOW - ABOVE) / height,
        ))
        for row in range(rows)
        for column in range(columns)
    ]  # fmt: skip


def plain_axes(
    axes: Axes, look: Look, title: str = "", x: str = "", y: str = "", style: AxesStyle = PAGE_STYLE
) -> None:
    """Give axes a look. x, y: names of their axes."""
    axes.set_facecolor("none")
    axes.set_title(title, fontsize=style.title, color=look.ink, loc="left", pad=style.above, weight="bold")
    axes.set_xlabel(x, fontsize=style.names, color=look.ink, labelpad=style.to_name)
    axes.set_ylabel(y, fontsize=style.names, color=look.ink, labelpad=style.to_name)
    axes.grid(color=look.grid, lw=style.grid)
    axes.set_axisbelow(True)
    axes.tick_params(
        labelsize=style.numbers,
        length=style.tick,
        width=style.line,
        pad=style.to_number,
        color=look.grey,
        labelcolor=look.ink,
    )
    for side, spine in axes.spines.items():
        spine.set(lw=style.line, color=look.grey, visible=side in ("left", "bottom"))


def plots_drawing(
    title: str, plots: Callable[[Look], Sequence[Plot]], marks: Mapping[str, float] | None = None
) -> Drawing:
    """Plots of the explorer, one below the other. marks: name -> where on their axis to draw an upright line."""

    def draw(figure: Figure, look: Look) -> None:
        shown = plots(look)
        for axes, plot in zip(panels(figure, len(shown), 1), shown, strict=True):
            draw_plot(axes, plot, look)
            low, high = axes.get_ylim()
            axes.set_ylim(low, high + HEADROOM * (high - low) * len(marks or {}))
            for row, (name, x) in enumerate((marks or {}).items()):
                mark(axes, name, x, look, row)

    return Drawing(title, WIDTH, HEIGHT * len(plots(LIGHT_LOOK)), draw)


def mark(axes: Axes, name: str, x: float, look: Look, row: int = 0) -> None:
    """An upright line with its name at the top, `row` rows down."""
    axes.axvline(x, color=look.grey, lw=0.9, ls=(0, (4, 2)), zorder=1.5)
    axes.annotate(
        name, (x, 1), xycoords=("data", "axes fraction"), xytext=(4, -2 - 12 * row), textcoords="offset points",
        va="top", fontsize=SMALL, color=look.grey, zorder=1.6,
    )  # fmt: skip


def mark_peaks(
    axes: Axes, peaks: Sequence[tuple[Peak, str]], look: Look, dot: float = 4.0, letters: float = SMALL
) -> None:
    """A dot at each curve's peak, of this colour, and the number of the largest; sizes of dot and letters: points."""
    for peak, colour in peaks:
        axes.plot([peak.time], [peak.value], "o", color=colour, ms=dot, mew=0, zorder=3)
    if peaks:
        axes.margins(y=NUMBER_ROOM)
        most = max((peak for peak, _ in peaks), key=lambda peak: abs(peak.value))
        axes.annotate(
            f"{most.value:.1f}".replace("-", "−"), (most.time, most.value), textcoords="offset points",
            xytext=(0, (-0.4 if most.value < 0 else 0.4) * dot), va="top" if most.value < 0 else "bottom", ha="center",
            fontsize=letters, color=look.ink, zorder=3.1,
        )  # fmt: skip


def draw_plot(axes: Axes, plot: Plot, look: Look) -> None:
    """One plot of the explorer: its curves over its axis, their names in their colours beside the title."""
    plain_axes(axes, look, f"{plot.title}, {plot.unit}", plot.axis)
    for curve, values in zip(plot.curves, plot.values.T, strict=True):
        lines, alpha = LINES.get(curve.kind, ("-", 1.0))
        axes.plot(plot.x, values, color=curve.colour, lw=1.1, ls=lines, alpha=alpha)
    mark_peaks(axes, [(peak, plot.curves[peak.curve].colour) for peak in plot.peaks], look)
    if plot.least is not None:
        low, high = axes.get_ylim()
        axes.set_ylim(min(low, plot.least[0]), max(high, plot.least[1]))
    axes.set_xlim(plot.x[0], max(plot.x[-1], plot.x[0] + 1e-3))
    named = tuple(curve for curve in plot.curves if curve.kind != "baseline")
    if len(named) > 1:
        _name_curves(axes, named)


def _name_curves(axes: Axes, curves: tuple[Curve, ...]) -> None:
    """Their names in their colours, in line with the title, from the right."""
    places = np.array([2.9 if curve.kind == "static" else 1.0 for curve in reversed(curves)])
    step = min(0.034, NAMES / places.sum())
    rights = 1 - step * np.concatenate([[0], np.cumsum(places)[:-1]])
    for x, curve in zip(rights, reversed(curves), strict=True):
        label = f"··· {curve.label}" if curve.kind == "static" else curve.label
        size = min(SMALL, 250 * step)
        axes.text(
            x, 1.0, label, transform=axes.transAxes, ha="right", va="bottom", fontsize=size, color=curve.colour,
            weight="bold",
        )  # fmt: skip
