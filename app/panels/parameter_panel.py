"""The panel of parameters, generated from the parameter table: sliders for what-if, boxes in folders for the rest."""

from __future__ import annotations

import json
from collections.abc import Collection, Iterable, Mapping
from operator import attrgetter
from typing import Any

import viser

from app.format.assets import asset
from app.format.markup import element, joined, running, style
from app.format.parameters import file_value, value_text
from app.format.units import METRIC, Units
from app.panels.actions import Actions
from app.panels.callbacks import by_user
from app.panels.controls import IMAGINARY, IMAGINARY_SWITCH, Control
from app.panels.road_controls import PartsControl, ProfileControl
from app.runs.request import Request
from model.config.config import Config
from model.config.parameters import GROUPS, NOTED, NOTES, PARAMETER, PARAMETERS, ROAD, Parameter

SECTION_OF = {parameter.key: parameter.key.rpartition(".")[0] for parameter in PARAMETERS}
SECTIONS = {name: attrgetter(name) for name in SECTION_OF.values() if name}
BOXED = tuple(p for p in PARAMETERS if not p.what_if and p.group != NOTES and p.kind not in NOTED)  # in folders
PINNABLE = frozenset(p.key for p in BOXED if p.kind in ("number", "integer", "choice", "flag", "list"))
MOST_FIRST = 12  # parameters that the user can have among the first sliders
KINDS: dict[str, Any] = {"points": ProfileControl, "parts": PartsControl}  # that have controls of their own


class ParameterPanel:
    """All controls of one browser tab, in the present container of `gui`; those in folders once `fill` is called."""

    def __init__(
        self, gui: viser.GuiApi, presets: Mapping[str, Config], preset: str, config: Config, actions: Actions
    ) -> None:
        """presets: name -> configuration; `preset` is shown as the chosen one, `config` in the controls."""
        self._gui, self._actions = gui, actions
        self._units = METRIC
        self._titles = _unique_titles(presets)
        self._preset: Any = gui.add_dropdown(
            "Preset",
            tuple(self._titles.values()),
            initial_value=self._titles[preset],
            hint="A vehicle on a road to start from; all parameters follow",
        )
        self._preset.on_update(by_user(lambda event: actions.load(self._named(event.target.value)), actions.fail))
        self.status = gui.add_html("")
        self._controls: dict[str, Control] = {}
        for parameter in PARAMETERS:
            if parameter.what_if:
                self._controls[parameter.key] = Control(gui, parameter, _value(config, parameter), actions)
        self._first_place = gui.add_folder(None)
        self._first: dict[str, Control] = {}  # that the user wants to have there, too
        gui.add_html(str(joined((running(asset("parameters.js")), style(asset("parameters.css"))))))
        self._rows, self._changes, self._sought = (gui.add_html("") for _ in range(3))
        self._searches = 0
        self._marked: Request | None = None  # whose changes are marked
        self.matters = gui.add_html("")  # for others to fill
        steps = gui.add_button_group(
            "Changes",
            ("Undo", "Redo", "Reset"),
            hint="Undo the last change (Ctrl+Z), redo it (Ctrl+Shift+Z), or all parameters as in the preset (R)",
        )
        acts = {"Undo": actions.undo, "Redo": actions.redo, "Reset": actions.reset}
        steps.on_click(by_user(lambda event: acts[event.target.value](), actions.fail))
        self._shown = config
        self.middle = gui.add_folder(None)  # for other controls, between the sliders and the folders
        groups = {parameter.group for parameter in BOXED}
        self._folders = {group: gui.add_folder(group, expand_by_default=False) for group in GROUPS if group in groups}
        with self._folders[ROAD]:
            self.road_view = gui.add_html("")  # for others to fill
        self.show(config)

    def fill(self) -> None:
        """Fill the folders, which are closed at first. The sliders stay as they are: the user may have moved them."""
        for parameter in BOXED:
            make, value = KINDS.get(parameter.kind, Control), _value(self._shown, parameter)
            with self._folders[parameter.group]:
                self._controls[parameter.key] = control = make(self._gui, parameter, value, self._actions)
            self._say(control, self._shown)
        self._tell_rows()

    def set_first(self, keys: Iterable[str]) -> None:
        """Have these parameters, too, among the first sliders, and no others but those that always are."""
        wanted = [key for key in dict.fromkeys(keys) if key in PINNABLE][:MOST_FIRST]
        for key in self._first.keys() - set(wanted):
            self._first.pop(key).remove()
        for key in wanted:
            if key not in self._first:
                value = _value(self._shown, PARAMETER[key])
                with self._first_place:
                    control = Control(self._gui, PARAMETER[key], value, self._actions, slider=True)
                self._first[key] = control
                self._say(control, self._shown)
        self._tell_rows()

    def mark(self, request: Request) -> None:
        """Mark the parameters that this request, a valid one, changes in its preset."""
        if request is self._marked:
            return
        self._marked = request
        before, after = request.base, request.config()
        old, new = before.values(), after.values()
        was = {}
        for key in self._controls:
            parameter = after.parameter(key)
            if parameter.applies_to(after.road.type):
                usual = old.get(key) if parameter.applies_to(before.road.type) else parameter.default
                if usual != new.get(key):
                    was[key] = value_text(self._units.told(parameter), usual)
        self._changes.content = str(element("trackride-changes", of=json.dumps(was, ensure_ascii=False)))

    def set_units(self, units: Units) -> None:
        """Show all values in these units."""
        self._units, self._marked = units, None
        for key, control in (*self._controls.items(), *self._first.items()):
            control.describe(self._shown.parameter(key), units)

    def lead_to(self, key: str) -> None:
        """Open the folder of a parameter's control, and give it the keys."""
        self._searches += 1
        control = self._first.get(key) or self._controls[key]
        listed = control.boxes and isinstance(_value(self._shown, control.parameter), tuple)
        shown = control.boxes[-1] if listed else control.box
        self._sought.content = str(element("trackride-sought", box=shown, count=str(self._searches)))

    def _tell_rows(self) -> None:
        """Say which box is which parameter's, and which of them the user may put among the first sliders."""
        rows = {
            box: [key, key in PINNABLE, key in self._first]
            for controls in (self._controls, self._first)
            for key, control in controls.items()
            for box in control.boxes
        }
        self._rows.content = str(element("trackride-rows", of=json.dumps(rows)))

    def offer(self, presets: Mapping[str, Config], chosen: str) -> None:
        """Offer these presets, `chosen` as the one that is used."""
        titles = _unique_titles(presets)
        if titles != self._titles:
            self._titles = titles
            self._preset.options = tuple(titles.values())
        if self._preset.value != titles[chosen]:
            self._preset.value = titles[chosen]

    def _named(self, title: str) -> str:
        """The name of the preset with this title. Raises KeyError."""
        names = {title: name for name, title in self._titles.items()}
        return names[title]

    def enter(self, box: str, text: str) -> None:
        """Take a text that was typed into a box for numbers, by viser's name of the box."""
        every = (*self._controls.values(), *self._first.values())
        control = next((control for control in every if control.box == box), None)
        if control is None:
            self._actions.refuse_text(text)
        else:
            self._actions.enter(control.parameter.key, file_value(control.parameter, text))

    @property
    def sliders(self) -> dict[str, str]:
        """viser's names of the sliders, by key."""
        return {key: control.box for key, control in self._controls.items() if control.parameter.what_if}

    def __getitem__(self, key: str) -> Control:
        return self._controls[key]

    def show(self, config: Config, touched: Collection[str] = ()) -> None:
        """Say what the configuration says, but leave controls alone that the user has touched and may still move.

        While the user moves some, only sections of the configuration are looked at in which something has changed: no
        other control can say anything else.
        """
        before, self._shown = self._shown, config
        others = {name for name, section in SECTIONS.items() if section(before) == section(config)} if touched else ()
        if before.vehicle.imaginary_wheels.enabled != config.vehicle.imaginary_wheels.enabled:
            others = ()
        for key, control in (*self._controls.items(), *self._first.items()):
            if SECTION_OF[key] not in others:
                self._say(control, config, touched=key in touched)

    def _say(self, control: Control, config: Config, *, touched: bool = False) -> None:
        """Let a control show what the configuration says; not its value where the user may still move it."""
        key = control.parameter.key
        applies = control.parameter.applies_to(config.road.type)
        control.describe(config.parameter(key), self._units)
        if applies:
            (control.widen if touched else control.show)(config.value(key))
        with_track = config.vehicle.imaginary_wheels.enabled
        control.enable(applies and (with_track or not key.startswith(IMAGINARY) or key == IMAGINARY_SWITCH))


def _value(config: Config, parameter: Parameter) -> Any:
    return config.value(parameter.key) if parameter.applies_to(config.road.type) else parameter.default


def _unique_titles(presets: Mapping[str, Config]) -> dict[str, str]:
    """Preset's name -> its title, with the name where two have the same title."""
    titles = [config.name for config in presets.values()]
    return {
        name: config.name if titles.count(config.name) == 1 else f"{config.name} ({name})"
        for name, config in presets.items()
    }
