"""Controls of what is no number in a road: a measured profile, and the parts of a sum.

They are used like app.panels.controls.Control.
"""

from __future__ import annotations

from typing import Any

import viser

from app.format.markup import element
from app.format.parameters import choice_words, hint, shown_text
from app.format.units import METRIC, Units
from app.panels.actions import Actions
from app.panels.callbacks import by_user
from app.panels.road_parts import ADDED, parts_from, parts_text
from model.config.parameters import Parameter

EXTENT = "trackride-extent"


class RoadControl:
    """What both have in common: there is no slider."""

    listed_value = None
    box = ""
    boxes: tuple[str, ...] = ()

    def __init__(self, parameter: Parameter, value: Any) -> None:
        self.parameter, self.value = parameter, value
        self.units = METRIC

    def widen(self, value: Any) -> None:
        """Nothing: there is no range."""

    def show(self, value: Any) -> None:
        """Show this value."""
        raise NotImplementedError

    def describe(self, parameter: Parameter, units: Units) -> None:
        """Show the value in these units."""
        if units != self.units:
            self.units = units
            self.show(self.value)


class ProfileControl(RoadControl):
    """A button that takes the file of a profile, and the extent of the present profile."""

    def __init__(self, gui: viser.GuiApi, parameter: Parameter, value: Any, actions: Actions) -> None:
        super().__init__(parameter, value)
        self._upload = gui.add_upload_button(
            "Open a profile",
            mime_type=".csv,.txt,.tsv,.erd,.crg",
            hint="A table of distance and height (CSV and the like), ERD or OpenCRG; it becomes the road. What its "
            "headings leave open is asked first. If it is not level under the vehicle, it is put 1 m ahead of the "
            "first wheel.",
        )
        self._extent = gui.add_html("")
        self._ask = gui.add_button(
            "Columns and units",
            hint="How the file of this profile is read: which columns hold distance and height, and in which units",
        )
        self._ask.on_click(by_user(lambda event: actions.ask_about_profile(), actions.fail))
        file = self._upload
        file.on_upload(by_user(lambda event: actions.upload_profile(file.value.name, file.value.content), actions.fail))

    def show(self, value: Any) -> None:
        self.value = value
        extent = str(element("div", self.units.reword(shown_text(self.parameter, value)), class_=EXTENT))
        if self._extent.content != extent:
            self._extent.content = extent

    def enable(self, applies: bool) -> None:
        """Only a profile has an extent; but a profile can be opened on any road."""
        self._extent.visible = self._ask.visible = applies


class PartsControl(RoadControl):
    """The list of parts as text, and buttons that add a part to any road or take one away."""

    def __init__(self, gui: viser.GuiApi, parameter: Parameter, value: Any, actions: Actions) -> None:
        super().__init__(parameter, value)
        self._text: Any = gui.add_text(
            parameter.label,
            parts_text(value),
            multiline=True,
            hint=f"{hint(parameter)} Here a line for each: change its numbers, or delete it.",
        )
        self._text.on_update(by_user(lambda event: actions.change(parameter.key, self._meant()), actions.fail))
        types = {choice_words(road_type).capitalize(): road_type for road_type in ADDED}
        adding = gui.add_button_group(
            "Add",
            tuple(types),
            hint="Put an obstacle on this road, behind those that are there, or make it rougher",
        )
        self._taking = gui.add_button("Take the last one away", hint="The last of the parts above")
        adding.on_click(by_user(lambda event: actions.add_to_road(types[event.target.value]), actions.fail))
        self._taking.on_click(by_user(lambda event: actions.take_from_road(), actions.fail))

    def _meant(self) -> Any:
        return parts_from(self._text.value, self.value, self.units)

    def show(self, value: Any) -> None:
        self.value = value
        text = parts_text(value, self.units)
        if self._text.value != text:
            self._text.value = text

    def enable(self, applies: bool) -> None:
        self._text.visible = self._taking.visible = applies
