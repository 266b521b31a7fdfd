"""The plots of one browser tab: uPlot charts in a docked panel. New data leave zoom and hidden curves alone."""

from __future__ import annotations

from typing import Any

import viser

from app.plots import Plot, with_cursor
from app.screen import chart_height

FONT = "11px system-ui, sans-serif"
PALE = "80"  # opacity of a baseline's curve, as the last byte of its colour
CURSOR_COLOUR = {False: "#0008", True: "#fff9"}
TICKS: viser.uplot.Axis_Ticks = {"size": 4, "width": 1}
NUDGE = 1e-9  # s. A chart misses a new size that comes with new data, and works out its axes when the range changes.
PADDING = (14, 18, 0, 0)  # px; less on top would cut the highest tick's label


class PlotPanel:
    """Charts below each other in a container (a tab) of `gui`."""

    def __init__(self, gui: viser.GuiApi, container: Any, page_height: int, dark: bool) -> None:
        self._gui, self._container, self._dark = gui, container, dark
        self._plots: tuple[Plot, ...] = ()
        self._charts: list[viser.GuiUplotHandle] = []
        self._page_height = page_height
        self._nudge = 0.0
        self.time = 0.0  # of the time cursor, s

    def show(self, plots: tuple[Plot, ...], time: float) -> None:
        """Show these plots with the time cursor at `time`, s. Charts are made anew only when their curves change."""
        same = [plot.layout for plot in plots] == [plot.layout for plot in self._plots]
        self._plots, self.time = plots, time
        if same:
            self._send()
        else:
            self._make()

    def point_at(self, time: float) -> None:
        """Move the time cursor, s."""
        if time != self.time:
            self.time = time
            self._send()

    def set_page_height(self, page_height: int) -> None:
        """Make the charts fill a page of this height, px."""
        self._page_height = page_height
        for chart in self._charts:
            chart.height = self._height

    def set_dark(self, dark: bool) -> None:
        """Colours of the next plots that are shown."""
        self._dark = dark
        self._plots = ()

    @property
    def _height(self) -> int:
        return chart_height(self._page_height, len(self._plots))

    def _send(self) -> None:
        self._nudge = NUDGE - self._nudge
        for chart, plot in zip(self._charts, self._plots, strict=True):
            times, *values = with_cursor(plot, self.time)
            times[-1] += self._nudge
            chart.data = (times, *values)

    def _make(self) -> None:
        for chart in self._charts:
            chart.remove()
        with self._container:
            self._charts = [self._chart(plot) for plot in self._plots]

    def _chart(self, plot: Plot) -> viser.GuiUplotHandle:
        times: viser.uplot.Series = {"label": "Time"}
        curves: list[viser.uplot.Series] = []
        for curve in plot.curves:
            if curve.baseline:
                curves.append({"label": f"{curve.label} base", "stroke": curve.colour + PALE, "dash": (4, 3)})
            else:
                curves.append({"label": curve.label, "stroke": curve.colour})
            curves[-1] |= {"width": 1.5, "points": {"show": False}}
        cursor: viser.uplot.Series = {
            "label": "Now",
            "class": "now",
            "scale": "now",
            "stroke": CURSOR_COLOUR[self._dark],
            "width": 1.5,
            "points": {"show": False},
        }
        low, high = plot.least
        margin = {"pad": 0.1, "mode": 1}  # mode 1: up to the soft limit at least
        upright: viser.uplot.Axis = {"size": 40, "font": FONT, "ticks": TICKS, "grid": {"width": 1}}
        along: viser.uplot.Axis = {"size": 24, "font": FONT, "ticks": TICKS, "grid": {"width": 1}}
        named: viser.uplot.Axis = {"labelFont": FONT, "labelSize": 16, "labelGap": 0}
        return self._gui.add_uplot(
            with_cursor(plot, self.time),
            (times, *curves, cursor),
            title=plot.title,
            scales={
                "x": {"time": False},
                "y": {"range": {"min": margin | {"soft": low}, "max": margin | {"soft": high}}},
                "now": {"range": (0.0, 1.0)},
            },
            axes=(along | named | {"label": "Time, s"}, upright | named | {"label": plot.unit}),
            cursor={"sync": {"key": "trackride"}, "y": False, "points": {"size": 5}},
            height=self._height,
            padding=PADDING,
        )
