"""The tab "Spectrum": at which frequencies the hull moves, and the vehicle's modes, to be shown in the 3-D view."""

from __future__ import annotations

from contextlib import suppress
from typing import Any

import viser

from app.format.units import METRIC, Units
from app.panels.actions import Actions
from app.panels.callbacks import by_user
from app.panels.page_layout import PageLayout
from app.panels.plot_charts import Charts
from app.panels.plot_page import marks_html
from app.plots.spectrum import named, spectrum_plot
from app.tabs.modes import mode_titles, modes_page
from model.analysis.modes import Mode, Modes, vehicle_modes
from model.analysis.spectrum import excitation
from model.config.config import FlatRoad
from model.dynamics.equilibrium import NoEquilibriumError
from model.simulation.trajectory import Trajectory

AMPLITUDE, DENSITY = "Amplitude", "Power density"
HULL, SEAT = "Centre of mass", "Driver's seat"
NO_MODE = "– the run –"
BELOW_CHART = 1e9  # order of what stands there; a chart that is made anew would otherwise come after it


class SpectrumPanel:
    """Fills a container (a tab) of `gui`."""

    def __init__(self, gui: viser.GuiApi, container: Any, actions: Actions) -> None:
        self._modes: Modes | None = None
        with container:
            self._marks = gui.add_html("")
            self._kind: Any = gui.add_dropdown(
                "Spectrum",
                (AMPLITUDE, DENSITY),
                hint="Amplitude: a wave of height a shows a peak as high as a. Power density (Welch): how much is in "
                "each hertz; the area under it is the square of the rms. Both of the stretch that figures come from.",
            )
            self._place: Any = gui.add_dropdown(
                "Felt at", (HULL, SEAT), hint="Where the driver sits is set under Vehicle: Seat, forward and up"
            )
            self._logarithmic: Any = gui.add_checkbox(
                "Logarithmic axis",
                False,
                hint="Each decade of the frequency as wide as the next: more room for low ones",
            )
            self._choice: Any = gui.add_dropdown(
                "Show in 3-D",
                (NO_MODE,),
                order=BELOW_CHART + 1,
                hint="A mode of the vehicle, much enlarged and at one swing a second; the ghost stands at rest. "
                "Play, or any change, leads back to the run.",
            )
            self._table = gui.add_html("", order=float("inf"))
        self._charts = Charts(gui, container)
        for box in (self._kind, self._place, self._logarithmic):
            box.on_update(by_user(lambda event: actions.redraw_spectrum(), actions.fail))
        self._choice.on_update(by_user(lambda event: actions.show_mode(), actions.fail))

    def show(
        self,
        run: Trajectory,
        baseline: Trajectory | None,
        colour: str,
        layout: PageLayout,
        units: Units = METRIC,
    ) -> None:
        """Show a run, beside its baseline, in a CSS colour."""
        self._modes = None
        with suppress(NoEquilibriumError):
            self._modes = vehicle_modes(run.config)
        waves = excitation(run.config)
        marks = named(waves, self._modes)
        plot = spectrum_plot(
            run,
            colour,
            marks,
            baseline,
            density=self._kind.value == DENSITY,
            at_seat=self._place.value == SEAT,
            logarithmic=self._logarithmic.value,
            units=units,
        )
        self._charts.show((plot,), layout.spectrum_height(), layout.scale)
        self._marks.content = marks_html(marks)
        self._table.content = modes_page(waves, self._modes, flat=isinstance(run.config.road, FlatRoad))
        titles = (NO_MODE, *mode_titles(self._modes))
        if self._choice.options != titles:
            self._choice.options = titles

    def offer_modes(self, on: bool) -> None:
        """Let modes be chosen, or not: during a drive there is no run that a mode could replace."""
        if self._choice.disabled is on:
            self._choice.disabled = not on

    @property
    def chosen(self) -> Mode | None:
        """The mode that is chosen; None: the run."""
        titles = mode_titles(self._modes)
        value = self._choice.value
        return self._modes.swinging[titles.index(value)] if self._modes is not None and value in titles else None

    def choose_run(self) -> None:
        """Say that no mode is shown."""
        if self._choice.value != NO_MODE:
            self._choice.value = NO_MODE
