"""The tab "Study", the line under the sliders and the strips on them. assets/study.js draws them of data from here."""

from __future__ import annotations

import json
from typing import Any

import viser

from app.format.assets import asset
from app.format.markup import element, joined, running, style
from app.format.parameters import file_number
from app.format.units import METRIC, Units
from app.panels.actions import Actions
from app.panels.callbacks import by_user
from app.panels.parameter_panel import ParameterPanel
from app.plots.study_data import Data
from app.runs.study_choice import PROFILER, VARIABLE, VIEWS, StudyChoice, choice_from, figure_names
from model.analysis.figures import FIGURE
from model.config.parameters import PARAMETER, PARAMETERS

SAYS = "Study says"  # label of the box by which the page tells something; nobody sees it


class StudyPanel:
    """Fills a container (a tab) of `gui`, and the place below the sliders.

    viser puts in what a tab holds only while it is in front. What the sliders need stands beside them, and so does
    another hidden box: whichever of both panels is open, the page can tell something.
    """

    def __init__(self, gui: viser.GuiApi, container: Any, controls: ParameterPanel, actions: Actions) -> None:
        self._actions, self._units = actions, METRIC
        with container:
            page = gui.add_html("")
            says = self._add_box(gui)
            self._data = {view: gui.add_html("") for view in VIEWS}
        self._strips = gui.add_html("")
        self._choice, self._choices = gui.add_html(""), 0
        offer = {
            "choice": StudyChoice().__dict__,
            "figures": [{"name": name, "label": FIGURE[name].label} for name in figure_names()],
            "keys": [[p.key, p.label, p.group] for p in PARAMETERS if p.key in VARIABLE],
        }
        page.content = str(element("trackride-study", data_says=says))
        matters = element(
            "trackride-matters",
            data_says=self._add_box(gui),
            data_sliders=json.dumps(controls.sliders),
            data_offer=json.dumps(offer, ensure_ascii=False),
        )
        controls.matters.content = str(joined((running(asset("study.js")), style(asset("study.css")), matters)))

    def _add_box(self, gui: viser.GuiApi) -> str:
        """A box by which the page tells something: viser's name of it."""
        box: Any = gui.add_text(SAYS, "")
        box.on_update(by_user(lambda event: self._take(event.target.value), self._actions.fail))
        return box._impl.uuid

    def show(self, kind: str, data: Data) -> None:
        """Draw this; kind: one of VIEWS."""
        told = element("trackride-study-data", of=kind, at=json.dumps(data, ensure_ascii=False, allow_nan=False))
        for place in (self._data[kind], *((self._strips,) if kind == PROFILER else ())):
            place.content = str(told)

    def choose(self, choice: StudyChoice) -> None:
        """Have the page take this choice, which it tells then."""
        self._choices += 1
        at = json.dumps(choice.__dict__, ensure_ascii=False)
        self._choice.content = str(element("trackride-study-choice", at=at, count=str(self._choices)))

    def set_units(self, units: Units) -> None:
        """Take the page's numbers in these units; what is drawn follows with the next data."""
        self._units = units

    def _take(self, text: str) -> None:
        """What the page tells: a choice, or the value of a parameter, as shown."""
        try:
            told = json.loads(text)
            kind, content = told["kind"], told["content"]
        except (ValueError, KeyError, TypeError):
            return  # a page that is being built, or anybody
        if kind == "choice":
            self._actions.choose_study(choice_from(json.dumps(content)))
        elif kind == "record" and isinstance(content, dict):
            self._actions.take_record(str(content.get("name"))[:80], str(content.get("text")))
        elif kind == "set" and isinstance(content, dict):
            for key, shown in content.items():
                if key in VARIABLE and isinstance(shown, int | float):
                    self._actions.steer(key, file_number(self._units.told(PARAMETER[key]), shown))
