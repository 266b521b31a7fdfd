"""uPlot charts below each other in a tab. New data leave zoom and hidden curves alone."""

from __future__ import annotations

from typing import Any

import numpy as np
import viser
from viser import _messages as messages

from app.panels.page_layout import AXIS_NAME
from app.panels.plot_page import OTHER_KEY, TIME_KEY, peaks_html
from app.plots.curves import TIME, Curve, Plot

FONT = "system-ui, sans-serif"
LETTERS = 11  # px of usual type (page_layout.py), as the next four
OPACITY = {
    "run": "",
    "beside": "",
    "baseline": "b0",
    "static": "c0",
}  # of curves by kind, as the last byte of their colour
FADED = "38"
WIDTH = 1  # px; the page makes 1.5 of it where a line is not pale (plots.js)
DASH = {"baseline": (4, 3), "static": (1, 3)}
KEY = {"static": "dotted: at rest", "baseline": "dashed: baseline"}
GRID = "#80808030"  # on light ground and on dark
TICKS: viser.uplot.Axis_Ticks = {"size": 4, "width": 1}
NUDGE = 1e-9  # s. A chart overlooks a new size that comes with new data; it lays out its axes when the range changes
ALONG, UPRIGHT, APART = 24, 40, 18  # room of the axes, and between two numbers of the upright one
PADDING = (12, 18, 0, 0)  # less on top would cut the highest tick's label


class Charts:
    """Charts in a container (a tab) of `gui`; the last one has room for the axis's name below the others' height."""

    def __init__(self, gui: viser.GuiApi, container: Any) -> None:
        self._gui, self._container = gui, container
        self._plots: tuple[Plot, ...] = ()
        self._charts: list[viser.GuiUplotHandle] = []
        self._height = 0
        self._scale = 1.0
        self._nudge = 0.0
        with container:
            self._peaks = gui.add_html("")

    def show(self, plots: tuple[Plot, ...], height: int, scale: float) -> None:
        """Show these plots, each of this height, px, with type of so many times its usual size.

        Charts are made anew only when there are other curves, or type of another size.
        """
        shapes, before = _shapes(plots), _shapes(self._plots)
        restyled = [plot.curves for plot in plots] != [plot.curves for plot in self._plots]
        self._plots = plots
        self._peaks.content = peaks_html(plots)  # before the curves: they are drawn with their peaks
        if shapes != before or scale != self._scale:
            self._height, self._scale = height, scale
            self._make()
            return
        resized, self._height = height != self._height, height
        self._nudge = NUDGE - self._nudge
        for chart, plot in zip(self._charts, plots, strict=True):
            if restyled:
                chart.series = _series(plot)
            if resized:
                chart.height = self._with_axis(height) if plot is plots[-1] else height
            x, *values = plot.data
            x = x.copy()
            x[-1] += self._nudge
            _send(chart, (x, *values))

    def _make(self) -> None:
        for chart in self._charts:
            chart.remove()
        with self._container:
            last = len(self._plots) - 1
            self._charts = [self._chart(plot, with_axis=k == last) for k, plot in enumerate(self._plots)]

    def _chart(self, plot: Plot, with_axis: bool) -> viser.GuiUplotHandle:
        low, high = ({"soft": bound, "mode": 1} for bound in plot.least) if plot.least else ({}, {})
        scale = self._scale
        font = f"{LETTERS * scale:g}px {FONT}"
        axis: viser.uplot.Axis = {"font": font, "ticks": TICKS, "grid": {"width": 1, "stroke": GRID}}
        named: viser.uplot.Axis = {"labelFont": font, "labelSize": int(AXIS_NAME * scale), "labelGap": 0}
        along = axis | {"size": int(ALONG * scale)}
        upright = axis | named | {"size": int(UPRIGHT * scale), "space": int(APART * scale), "label": plot.unit}
        kinds = {curve.kind for curve in plot.curves}
        key = [words for kind, words in KEY.items() if kind in kinds] + [plot.note] * bool(plot.note)
        return self._gui.add_uplot(
            plot.data,
            _series(plot),
            title=f"{plot.title} ({', '.join(key)})" if key else plot.title,
            scales={
                "x": {"time": False, "distr": 3} if plot.logarithmic else {"time": False},
                # mode 1: up to the soft limit at least
                "y": {"range": {"min": {"pad": 0.1} | low, "max": {"pad": 0.1} | high}},
            },
            axes=(along | named | {"label": plot.axis} if with_axis else along, upright),
            cursor={
                "sync": {"key": TIME_KEY if plot.axis == TIME else OTHER_KEY},
                "y": False,
                "points": {"size": 5},
            },
            height=self._with_axis(self._height) if with_axis else self._height,
            padding=tuple(int(scale * side) for side in PADDING),  # type: ignore[arg-type]
        )

    def _with_axis(self, height: int) -> int:
        """Height of a chart that names its axis."""
        return height + int(AXIS_NAME * self._scale)


def _shapes(plots: tuple[Plot, ...]) -> list[tuple[object, ...]]:
    """What a chart cannot change once it is made."""
    return [
        (plot.title, plot.unit, plot.note, plot.logarithmic, *((curve.label, curve.kind) for curve in plot.curves))
        for plot in plots
    ]


def _send(chart: viser.GuiUplotHandle, data: tuple[np.ndarray, ...]) -> None:
    """Give a chart new data as they are: viser's own assignment checks and copies each curve, for 0.7 ms a chart."""
    update = messages.GuiUpdateMessage(chart._impl.uuid, {"data": data})
    chart._impl.gui_api._websock_interface.queue_message(update)


def _series(plot: Plot) -> tuple[viser.uplot.Series, ...]:
    return {"label": plot.axis}, *(_line(curve) for curve in plot.curves)


def _line(curve: Curve) -> viser.uplot.Series:
    line: viser.uplot.Series = {
        "label": curve.label,
        "class": curve.kind,
        "stroke": curve.colour + (FADED if curve.faded else OPACITY[curve.kind]),
        "width": WIDTH,
        "points": {"show": False},
    }
    return line | {"dash": DASH[curve.kind]} if curve.kind in DASH else line
