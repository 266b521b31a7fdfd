"""The plots of one browser tab and what is read beside them: tabs in a docked panel.

Loads and Ride follow every run. Spectrum, Load map and Trust cost more than a drag may take: they follow, one at a
time, when no newer run has come for CALM.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from time import monotonic
from typing import Any

import viser

from app.about import about_html
from app.charts import Charts
from app.colours import wheel_palette
from app.load_map import load_map
from app.plot_page import marks_html, now_html, plot_page
from app.plots import load_plots
from app.ride_plots import ride_plots
from app.screen import chart_height
from app.spectrum_plot import Mark, marks_table, named, spectrum_plot
from app.trust import errata_html, trust_html
from model.equilibrium import NoEquilibriumError
from model.spectrum import marks
from model.trajectory import Trajectory

CALM = 0.3  # s


class PlotPanel:
    """Tabs in a panel of `gui`. `runs_tab` is left empty, for others to fill."""

    def __init__(self, gui: viser.GuiApi, panel: Any, page_height: int, dark: bool, flush: Callable[[], None]) -> None:
        """flush: sends at once what has been changed, so that the page draws the loads before it gets the rest."""
        self._page_height, self._dark, self._flush = page_height, dark, flush
        self._run: Trajectory | None = None
        self._baseline: Trajectory | None = None
        self._driving = False
        self._wheel: int | None = None
        self._shown_at = 0.0  # monotonic s
        self._behind: list[Callable[[Trajectory], None]] = []  # tabs that do not show the present run yet
        self.time = 0.0  # of the time cursor, s
        loads, ride, spectrum = (panel.add_tab(name) for name in ("Loads", "Ride", "Spectrum"))
        load_tab, self.runs_tab, trust, about = (panel.add_tab(name) for name in ("Load map", "Runs", "Trust", "About"))
        self._loads, self._ride, self._spectrum = Charts(gui, loads), Charts(gui, ride), Charts(gui, spectrum)
        with spectrum:
            self._marks = gui.add_html("")
            self._marks_table = gui.add_html("", order=float("inf"))
        with load_tab:
            self._map = gui.add_html("")
        with trust:
            self._trust = gui.add_html("")
            gui.add_html(errata_html())
        with about:
            gui.add_html(about_html())
        with loads:
            gui.add_html(plot_page())
            self._now = gui.add_html(now_html(0.0))

    def show(self, run: Trajectory, baseline: Trajectory | None, time: float, *, driving: bool = False) -> None:
        """Show a run, beside its baseline, with the time cursor at `time`, s.

        driving: the run is the latest stretch of an endless drive.
        """
        self._run, self._baseline, self._driving = run, baseline, driving
        self._shown_at = monotonic()
        self._behind = [self._show_spectrum, self._show_map, self._show_trust]
        self._plot()
        self.point_at(time)

    def settle(self) -> None:
        """Bring one more tab up to date when the run has been shown for a while. To be called every now and then."""
        if self._run is not None and self._behind and monotonic() - self._shown_at > CALM:
            self._behind.pop(0)(self._run)

    def point_at(self, time: float) -> None:
        """Move the time cursor, s."""
        if time != self.time:
            self.time = time
            self._now.content = now_html(time)

    def single_out(self, wheel: int | None) -> None:
        """Let a wheel, in the model's order, stand alone among faded ones; None: all of them as they are."""
        if wheel != self._wheel:
            self._wheel = wheel
            self._plot()

    def set_page_height(self, page_height: int) -> None:
        """Make the charts fill a page of this height, px."""
        self._page_height = page_height
        self._plot()
        self._behind = self._behind or [self._show_spectrum]

    def set_dark(self, dark: bool) -> None:
        """Change all colours."""
        self._dark = dark
        self._plot()
        self._behind = self._behind or [self._show_spectrum]

    def _plot(self) -> None:
        """What follows every run."""
        if self._run is None:
            return
        run = self._run
        palette = wheel_palette(run.system.n, run.system.m, self._dark)
        wheel = self._wheel if self._wheel is not None and self._wheel < len(palette.wheels) else None
        for charts, plots in (
            (self._loads, load_plots(run, palette, self._baseline, wheel)),
            (self._ride, ride_plots(run, palette, self._baseline, wheel)),
        ):
            charts.show(plots, chart_height(self._page_height, len(plots)))
            self._flush()

    def _show_spectrum(self, run: Trajectory) -> None:
        found: tuple[Mark, ...] = ()
        with suppress(NoEquilibriumError):
            found = named(marks(run.config))
        colour = wheel_palette(1, 0, self._dark).hull
        plot = spectrum_plot(run, colour, found, self._baseline)
        self._spectrum.show((plot,), chart_height(self._page_height, 2))
        self._marks.content, self._marks_table.content = marks_html(found), marks_table(found)

    def _show_map(self, run: Trajectory) -> None:
        self._map.content = load_map(run, self._baseline)

    def _show_trust(self, run: Trajectory) -> None:
        self._trust.content = trust_html(run, self._driving)
