"""A sheet of A4, landscape, to write and draw on in inches from its lower left corner; and a few colours of print."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from app.reports.drawings import LIGHT_LOOK

WIDTH, HEIGHT = 11.69, 8.27
MARGIN = 0.45
DPI = 220  # of a PNG
LOOK = replace(LIGHT_LOOK, grid="#e4e7ea")
INK, GREY = LOOK.ink, LOOK.grey
PALE, BAND, MARKED, ALARM = "#c9ced4", "#f1f3f5", "#e3eefa", "#b3261e"


class Sheet:
    """Wraps a matplotlib Figure, without pyplot and its global state."""

    def __init__(self) -> None:
        self.figure = Figure(figsize=(WIDTH, HEIGHT), dpi=DPI, facecolor="white")

    def write(self, x: float, y: float, text: str, size: float, color: str = INK, **style: Any) -> None:
        """Text with its baseline at (x, y), in points; what stands between dollars is a formula: see `plain`."""
        self.figure.text(x / WIDTH, y / HEIGHT, text, fontsize=size, color=color, va="baseline", **style)

    def bar(self, x: float, y: float, width: float, height: float, colour: str) -> None:
        """A filled rectangle behind the text."""
        corner = (x / WIDTH, y / HEIGHT)
        self.figure.add_artist(Rectangle(corner, width / WIDTH, height / HEIGHT, fc=colour, lw=0, zorder=0))

    def rule(self, x: float, y: float, width: float, colour: str = PALE, weight: float = 0.006) -> None:
        """A thin line."""
        self.bar(x, y, width, weight, colour)

    def axes(self, x: float, y: float, width: float, height: float) -> Axes:
        return self.figure.add_axes((x / WIDTH, y / HEIGHT, width / WIDTH, height / HEIGHT))


def plain(text: str, most: int) -> str:
    """Any text, on one line, cut to so many characters, its dollars no formula."""
    text = " ".join(text.split())
    return (text if len(text) <= most else text[: most - 1].rstrip() + "…").replace("$", r"\$")
