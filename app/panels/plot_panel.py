"""The plots of one browser tab, and the tabs beside them, in a docked panel.

The curves of a tab in front follow every run. Comfort, Spectrum, Load map and Trust take too long for a drag:
they follow, one at a time, when no newer run has come for CALM; so do the curves of tabs behind, and all of it at once
when its tab comes to the front. While a drive goes on, what is in front follows it once a second, and says which
stretch of it it shows.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from time import monotonic
from typing import Any

import viser

from app.format.colours import Palette, wheel_palette
from app.format.markup import element
from app.format.units import METRIC, Units
from app.panels.actions import Actions
from app.panels.page_layout import PageLayout
from app.panels.plot_charts import Charts
from app.panels.plot_page import now_html, plot_page, tab_html, tools_html, window_html
from app.panels.spectrum_panel import BELOW_CHART, SpectrumPanel
from app.plots.curves import Beside, Plot, load_plots
from app.plots.ride import ride_plots
from app.tabs.about import about_html
from app.tabs.comfort import comfort_headline, comfort_page
from app.tabs.load_map import load_map
from app.tabs.trust import errata_html, trust_html
from model.road.road import Road
from model.simulation.trajectory import Trajectory

CALM = 0.3  # s
DRIVE_EVERY = 1.0  # s
HEADLINE = 30  # px of usual type that the headline above the plots of the ride takes
LOADS, RIDE, SPECTRUM, LOAD_MAP, RUNS, STUDY, TRUST, ABOUT = TABS = (
    "Loads", "Ride", "Spectrum", "Load map", "Runs", "Study", "Trust", "About",
)  # fmt: skip


@dataclass
class Part:
    """Part of a tab that shows a run."""

    tab: str
    show: Callable[[Trajectory], None]
    quick: bool = False  # enough to follow every run of a drag
    version: int = 0  # of what it shows
    shown_at: float = 0.0  # monotonic s


class PlotPanel:
    """Tabs in a panel of a client's interface. `runs_tab` and `study_tab` are left empty, for others to fill."""

    def __init__(
        self, client: viser.ClientHandle, panel: Any, layout: PageLayout, dark: bool, actions: Actions
    ) -> None:
        self._client, self._layout, self._dark, self._units = client, layout, dark, METRIC
        self._run: Trajectory | None = None
        self._baseline: Trajectory | None = None
        self._beside: tuple[Beside, ...] = ()
        self._driving = False
        self._road: Road | None = None  # under the stretch of a drive that stands
        self._wheel: int | None = None
        self._shown_at = 0.0  # monotonic s: when the run came
        self._version = 0  # of what is to be shown: counts runs, baselines and looks
        self.in_front = frozenset([LOADS])  # tabs
        self.time = 0.0  # of the time cursor, s
        gui = client.gui
        tabs = {name: panel.add_tab(name) for name in TABS}
        self.runs_tab, self.study_tab = tabs[RUNS], tabs[STUDY]
        for name, tab in tabs.items():
            with tab:
                gui.add_html(tab_html(name), order=float("-inf"))
        for name in (LOADS, RIDE, SPECTRUM):
            with tabs[name]:
                gui.add_html(tools_html(shapes=name != SPECTRUM), order=-1e9)
        self._stretches: dict[str, Any] = {}
        for name, order in ((SPECTRUM, BELOW_CHART), (LOAD_MAP, -1.0), (TRUST, -1.0)):
            with tabs[name]:
                self._stretches[name] = gui.add_html("", order=order)
        with tabs[RIDE]:
            self._headline = gui.add_html("")
            self._comfort = gui.add_html("", order=float("inf"))
        self._loads, self._ride = Charts(gui, tabs[LOADS]), Charts(gui, tabs[RIDE])
        self.spectrum = SpectrumPanel(gui, tabs[SPECTRUM], actions)
        with tabs[LOAD_MAP]:
            self._map = gui.add_html("")
        with tabs[TRUST]:
            self._trust = gui.add_html("")
            gui.add_html(errata_html())
        with tabs[ABOUT]:
            self._about = gui.add_html(about_html())
        with tabs[LOADS]:
            gui.add_html(plot_page())
            self._now = gui.add_html(now_html(0.0))
            self._window = gui.add_html("")
        self._spectrum_part = Part(SPECTRUM, self._show_spectrum)
        self._parts = (
            Part(LOADS, self._show_loads, quick=True),
            Part(RIDE, self._show_ride, quick=True),
            Part(RIDE, self._show_comfort),
            self._spectrum_part,
            Part(LOAD_MAP, self._show_map),
            Part(TRUST, self._show_trust),
        )

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
        self._run, self._baseline, self._driving, self._road = run, baseline, driving, road
        self._shown_at = monotonic()
        self._follow()
        marked = window_html(run)
        if self._window.content != marked:
            self._window.content = marked
        self.spectrum.offer_modes(not driving)
        self.point_at(time)

    def show_beside(self, beside: tuple[Beside, ...]) -> None:
        """Show curves of these runs, too."""
        self._beside = beside
        self._redraw()

    def settle(self) -> None:
        """Bring one part up to date, if it is time for that. To be called ten times a second."""
        now = monotonic()
        calm = now - self._shown_at > CALM
        for part in sorted(self._behind(), key=self._is_behind):
            seen = part.tab in self.in_front
            if calm or (self._driving and seen and now - part.shown_at > DRIVE_EVERY):
                self._update(part)
                return

    def set_in_front(self, tabs: frozenset[str]) -> None:
        """Say which tabs are seen. What has come to the front is brought up to date."""
        self.in_front = tabs
        for part in self._behind():
            if part.tab in tabs:
                self._update(part)

    def point_at(self, time: float) -> None:
        """Move the time cursor, s."""
        if time != self.time:
            self.time = time
            self._now.content = now_html(time)

    def single_out(self, wheel: int | None) -> None:
        """Fade all curves but those of one wheel, in the model's order; None: fade none."""
        if wheel != self._wheel:
            self._wheel = wheel
            self._redraw()

    def arrange(self, layout: PageLayout) -> None:
        """Make the charts fill their panel."""
        self._layout = layout
        self._redraw()
        self.redraw_spectrum()

    def redraw_spectrum(self) -> None:
        """Show another spectrum, or the same in another way, soon."""
        self._spectrum_part.version, self._spectrum_part.shown_at = -1, 0.0

    def set_dark(self, dark: bool) -> None:
        """Change all colours."""
        self._dark = dark
        self._redraw()
        self.redraw_spectrum()

    def set_units(self, units: Units) -> None:
        """Tell all quantities in these units."""
        self._units = units
        self._about.content = about_html(units)
        self._follow()

    def _behind(self) -> list[Part]:
        """Parts that do not show the newest yet."""
        return [part for part in self._parts if part.version != self._version and self._run is not None]

    def _is_behind(self, part: Part) -> bool:
        return part.tab not in self.in_front

    def _follow(self) -> None:
        """Update the parts that follow every run."""
        self._version += 1
        for part in self._behind():
            if part.quick and part.tab in self.in_front:
                self._update(part)

    def _redraw(self) -> None:
        """Draw the same curves in another way, and leave what takes longer as it is."""
        slow = [part for part in self._parts if not part.quick and part.version == self._version]
        self._follow()
        for part in slow:
            part.version = self._version

    def _update(self, part: Part) -> None:
        assert self._run is not None
        part.version, part.shown_at = self._version, monotonic()
        part.show(self._run)

    def _show_loads(self, run: Trajectory) -> None:
        self._plot(run, load_plots, self._loads)

    def _show_ride(self, run: Trajectory) -> None:
        self._plot(run, ride_plots, self._ride, HEADLINE)

    def _plot(
        self,
        run: Trajectory,
        plots_of: Callable[
            [Trajectory, Palette, Trajectory | None, int | None, Sequence[Beside], Units], tuple[Plot, ...]
        ],
        charts: Charts,
        taken: float = 0.0,
    ) -> None:
        """Show curves, and send them at once: the page draws them before it gets the rest.

        taken: px of usual type for what else is in their tab.
        """
        palette = wheel_palette(run.system.n, run.system.m, self._dark)
        wheel = self._wheel if self._wheel is not None and self._wheel < len(palette.wheels) else None
        plots = plots_of(run, palette, self._baseline, wheel, self._beside, self._units)
        with self._client.atomic():
            charts.show(plots, self._layout.chart_height(len(plots), taken), self._layout.scale)
        self._client.flush()

    def _show_comfort(self, run: Trajectory) -> None:
        self._headline.content = comfort_headline(run, self._driving, self._units)
        self._comfort.content = comfort_page(run, self._baseline, self._driving, self._units)

    def _show_spectrum(self, run: Trajectory) -> None:
        colour = wheel_palette(1, 0, self._dark).hull
        self.spectrum.show(run, self._baseline, colour, self._layout, self._units)
        self._say_stretch(SPECTRUM, run)

    def _show_map(self, run: Trajectory) -> None:
        self._map.content = load_map(run, self._baseline, self._units)
        self._say_stretch(LOAD_MAP, run)

    def _show_trust(self, run: Trajectory) -> None:
        self._trust.content = trust_html(run, self._driving, self._road, self._units)
        self._say_stretch(TRUST, run)

    def _say_stretch(self, tab: str, run: Trajectory) -> None:
        self._stretches[tab].content = stretch_html(run, above=tab == SPECTRUM) if self._driving else ""


def stretch_html(run: Trajectory, *, above: bool) -> str:
    """HTML that says which stretch of a drive a tab shows.

    It stands at the right end of the line above or below, which has room there: nothing moves for it.
    """
    words = f"The drive from {run.t[0]:.1f} s to {run.t[-1]:.1f} s"
    return str(element("div", element("span", words), class_=f"trackride-stretch{' above' if above else ''}"))
