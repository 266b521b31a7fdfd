"""The plots of one browser tab and what is read beside them: tabs in a docked panel.

Loads and Ride follow every run. Comfort, Spectrum, Load map and Trust cost more than a drag may take: they follow, one
at a time, when no newer run has come for CALM.
"""

from __future__ import annotations

from collections.abc import Callable
from time import monotonic
from typing import Any

import viser

from app.about import about_html
from app.charts import Charts
from app.colours import wheel_palette
from app.comfort_page import comfort_headline, comfort_page
from app.load_map import load_map
from app.plot_page import now_html, plot_page
from app.plots import load_plots
from app.ride_plots import ride_plots
from app.screen import chart_height
from app.spectrum_panel import Analyst, SpectrumPanel
from app.trust import errata_html, trust_html
from model.trajectory import Trajectory

CALM = 0.3  # s
HEADLINE = 30  # px that the headline above the plots of the ride takes


class PlotPanel:
    """Tabs in a panel of `gui`. `runs_tab` is left empty, for others to fill."""

    def __init__(
        self,
        gui: viser.GuiApi,
        panel: Any,
        page_height: int,
        dark: bool,
        analyst: Analyst,
        flush: Callable[[], None],
    ) -> None:
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
        with ride:
            self._headline = gui.add_html("")
            self._comfort = gui.add_html("", order=float("inf"))
        self._loads, self._ride = Charts(gui, loads), Charts(gui, ride)
        self.spectrum = SpectrumPanel(gui, spectrum, analyst)
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
        self._behind = [self._show_comfort, self._show_spectrum, self._show_map, self._show_trust]
        self._plot()
        self.spectrum.offer_modes(not driving)
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
        self.redraw_spectrum()

    def redraw_spectrum(self) -> None:
        """Show another spectrum, or the same in another way."""
        if self._show_spectrum not in self._behind:
            self._behind.insert(0, self._show_spectrum)

    def set_dark(self, dark: bool) -> None:
        """Change all colours."""
        self._dark = dark
        self._plot()
        self.redraw_spectrum()

    def _plot(self) -> None:
        """What follows every run."""
        if self._run is None:
            return
        run = self._run
        palette = wheel_palette(run.system.n, run.system.m, self._dark)
        wheel = self._wheel if self._wheel is not None and self._wheel < len(palette.wheels) else None
        for charts, plots, height in (
            (self._loads, load_plots(run, palette, self._baseline, wheel), self._page_height),
            (self._ride, ride_plots(run, palette, self._baseline, wheel), self._page_height - HEADLINE),
        ):
            charts.show(plots, chart_height(height, len(plots)))
            self._flush()

    def _show_comfort(self, run: Trajectory) -> None:
        self._headline.content = comfort_headline(run)
        self._comfort.content = comfort_page(run, self._baseline)

    def _show_spectrum(self, run: Trajectory) -> None:
        colour = wheel_palette(1, 0, self._dark).hull
        height = chart_height(self._page_height, 2)
        self.spectrum.show(run, self._baseline, colour, height)

    def _show_map(self, run: Trajectory) -> None:
        self._map.content = load_map(run, self._baseline)

    def _show_trust(self, run: Trajectory) -> None:
        self._trust.content = trust_html(run, self._driving)
