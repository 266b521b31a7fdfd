"""The plots of one browser tab and what is read beside them: tabs in a docked panel.

Loads and Ride follow every run. Comfort, Spectrum, Load map and Trust cost more than a drag may take: they follow, one
at a time, when no newer run has come for CALM. While a drive goes on they follow it once a second, and say which
stretch of it they show.
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
from model.road import Road
from model.trajectory import Trajectory

CALM = 0.3  # s
DRIVE_EVERY = 1.0  # s
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
        self._road: Road | None = None  # under the stretch of a drive that stands
        self._wheel: int | None = None
        self._shown_at = self._followed_at = 0.0  # monotonic s: the run, and when the tabs began to follow one
        self._followed: Trajectory | None = None  # the run that they then began to follow
        self._behind: list[Callable[[Trajectory], None]] = []  # tabs that do not show it yet
        self.time = 0.0  # of the time cursor, s
        loads, ride, spectrum = (panel.add_tab(name) for name in ("Loads", "Ride", "Spectrum"))
        load_tab, self.runs_tab, trust, about = (panel.add_tab(name) for name in ("Load map", "Runs", "Trust", "About"))
        self._stretches: dict[str, Any] = {}
        for name, tab in (("Spectrum", spectrum), ("Load map", load_tab), ("Trust", trust)):
            with tab:
                self._stretches[name] = gui.add_html("", order=-1.0)
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

    def show(
        self,
        run: Trajectory,
        baseline: Trajectory | None,
        time: float,
        *,
        driving: bool = False,
        road: Road | None = None,
    ) -> None:
        """Show a run, beside its baseline, with the time cursor at `time`, s.

        driving: the run is the latest stretch of an endless drive; road: under it, when the drive stands.
        """
        if not driving or not self._driving or baseline is not self._baseline:
            self._followed, self._behind = None, []
        self._run, self._baseline, self._driving, self._road = run, baseline, driving, road
        self._shown_at = monotonic()
        self._plot()
        self.spectrum.offer_modes(not driving)
        self.point_at(time)

    def settle(self) -> None:
        """Bring one more tab up to date when it is time for that. To be called ten times a second."""
        now, run = monotonic(), self._run
        if run is None:
            return
        due = now - self._shown_at > CALM or (self._driving and now - self._followed_at > DRIVE_EVERY)
        if run is not self._followed and due and not self._behind:
            self._followed, self._followed_at = run, now
            self._behind = [self._show_comfort, self._show_spectrum, self._show_map, self._show_trust]
        if self._behind:
            self._behind.pop(0)(run)

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
        self._say_stretch("Spectrum", run)

    def _show_map(self, run: Trajectory) -> None:
        self._map.content = load_map(run, self._baseline)
        self._say_stretch("Load map", run)

    def _show_trust(self, run: Trajectory) -> None:
        self._trust.content = trust_html(run, self._driving, self._road)
        self._say_stretch("Trust", run)

    def _say_stretch(self, tab: str, run: Trajectory) -> None:
        self._stretches[tab].content = stretch_html(run) if self._driving else ""


def stretch_html(run: Trajectory) -> str:
    """HTML that says which stretch of a drive a tab shows; what comes below does not move for it."""
    words = f"The drive from {run.t[0]:.1f} s to {run.t[-1]:.1f} s"
    return f'<div class="trackride-stretch"><span>{words}</span></div>'
