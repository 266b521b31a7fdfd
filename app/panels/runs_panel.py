"""The tab "Runs": the figures of the run beside its baseline, and the runs that are kept."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from typing import Any

import viser

from app.format.assets import asset
from app.format.load_unit import comparison_rows
from app.format.markup import Content, Html, element, joined, running, style
from app.format.units import METRIC, Units
from app.panels.actions import Actions
from app.panels.callbacks import by_user
from app.plots.curves import Beside
from app.runs.history import Kept
from app.tabs.comparison import Other, comparison_table
from model.simulation.trajectory import Trajectory

PIN, SWAP, CLEAR = "Pin", "Swap", "Clear"
SHOW, COMPARE, DELETE = "Show", "Compare", "✕"
TICK = {True: "● Beside", False: "○ Beside"}  # shown beside the present run, or not
HOW_TO = "No baseline. Pin a run (B) and change something: its curves stay, pale, and its figures stand here too."


class RunsPanel:
    """Fills a container (a tab) of `gui`."""

    def __init__(self, gui: viser.GuiApi, container: Any, actions: Actions) -> None:
        self._gui, self._actions = gui, actions
        self._rows: dict[int, viser.GuiButtonGroupHandle] = {}
        with container:
            gui.add_html(str(running(asset("runs.js"))))
            self._style = gui.add_html("")
            self._heading = gui.add_html("")
            self._name: Any = gui.add_text(
                "Name", "", hint="The name of the run that is shown; a run that you name is kept"
            )
            baseline = gui.add_button_group(
                "Baseline",
                (PIN, SWAP, CLEAR),
                hint="Pin: compare with the run that is shown from now on (B). Swap: show the baseline, and compare "
                "with what is shown now. Clear: no comparison.",
            )
            self._figures = gui.add_html("")
            self._folder = gui.add_folder("Kept runs")
        self._name.on_update(by_user(lambda event: actions.rename(event.target.value), actions.fail))
        acts = {PIN: actions.pin, SWAP: actions.swap, CLEAR: actions.clear_baseline}
        baseline.on_click(by_user(lambda event: acts[event.target.value](), actions.fail))

    def compare(
        self, now: Trajectory, baseline: Trajectory | None, beside: Sequence[Beside] = (), units: Units = METRIC
    ) -> None:
        """Show the figures of a run of at least one sample, and those of the baseline and of the runs beside."""
        rows = comparison_rows(now, baseline, units)
        others = [Other(other.name, other.colour, comparison_rows(now, other.run, units)) for other in beside]
        self._figures.content = comparison_table(rows, baseline is not None, others)

    def show(
        self,
        runs: Iterable[Kept],
        name: str,
        now: Kept | None,
        baseline: Kept | None,
        before_drive: str,
        ticked: Collection[int] = (),
    ) -> None:
        """Show which runs are kept, which of them is shown (under this name), and which one is the baseline.

        ticked: numbers of those that are shown beside.

        before_drive: name of the run that came last, while a drive is shown that has no figures of its own here.
        """
        kept = {run.number: run for run in runs}
        for number in self._rows.keys() - kept.keys():
            self._rows.pop(number).remove()
        for number, run in kept.items():
            if number not in self._rows:
                self._rows[number] = self._row(run)
            elif self._rows[number].label != run.name:
                self._rows[number].label = run.name
            options = _options(number in ticked)
            if self._rows[number].options != options:
                self._rows[number].options = options
        self._heading.content = str(_heading(name, now, baseline, before_drive))
        self._style.content = str(self._rules(kept.values(), now))

    def show_name(self, name: str) -> None:
        """Put another run's name into its box."""
        if self._name.value != name:
            self._name.value = name

    def _row(self, run: Kept) -> viser.GuiButtonGroupHandle:
        """A row with the name and the buttons of a run; the newest is on top."""
        actions, number = self._actions, run.number
        acts = {SHOW: actions.recall, COMPARE: actions.compare, DELETE: actions.delete}
        acts |= dict.fromkeys(TICK.values(), actions.tick_run)
        with self._folder:
            row = self._gui.add_button_group(
                run.name,
                _options(False),
                order=-number,
                hint="Show: all parameters as in this run. Beside: its curves, figures and ghost in its colour; of "
                "all wheels the largest load. Compare: make it the baseline. ✕: forget it.",
            )
        row.on_click(by_user(lambda event: acts[event.target.value](number), actions.fail))
        return row

    def _rules(self, runs: Iterable[Kept], now: Kept | None) -> Html:
        """Style of the tab: each row in its colour, that of the run that is shown in bold."""
        rules = [asset("runs.css")]
        rules += [f'label[for="{self._rows[run.number]._impl.uuid}"]::before {{ color: {run.colour} }}' for run in runs]
        if now is not None and now.number in self._rows:
            rules.append(f'label[for="{self._rows[now.number]._impl.uuid}"] {{ font-weight: 650 }}')
        return style(" ".join(rules), class_="trackride-runs")


def _options(ticked: bool) -> tuple[str, ...]:
    """The buttons of a row."""
    return SHOW, TICK[ticked], COMPARE, DELETE


def _heading(name: str, now: Kept | None, baseline: Kept | None, before_drive: str) -> Html:
    """Which run is compared with which."""
    when, shown = ("Last run", before_drive) if before_drive else ("Now", name)
    compared: list[Content] = (
        [HOW_TO] if baseline is None else [element("b", "Baseline"), " ", _named(baseline.name, baseline)]
    )
    now_line = element("b", when), " ", _named(shown, now)
    return element("div", *now_line, element("br"), *compared, class_="trackride-compared")


def _named(name: str, run: Kept | None) -> Html:
    dot = "" if run is None else joined((element("span", "●", style=f"color: {run.colour}"), " "))
    return joined((dot, name))
