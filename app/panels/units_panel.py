"""The units in which the page tells quantities: both systems by a click, and each choice by itself."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import viser

from app.format.units import CHOICES, METRIC, US, Units
from app.panels.actions import Actions
from app.panels.callbacks import by_user

SYSTEMS = {"Metric": METRIC, "US": US}
LABELS = {
    "force": ("Forces", "Of forces and loads; masses go with it (kg or lb), stiffness and damping with it and Lengths"),
    "length": ("Lengths", "Inches for vehicle, travel and heights of roads, feet along roads, instead of mm and m"),
    "speed": ("Speeds", "Of the vehicle; slip in m/s or ft/s"),
    "acceleration": ("Accelerations", "Also of comfort and spectrum; the vibration dose stays in m/s¹·⁷⁵"),
}


class UnitsPanel:
    """Fills the present container of `gui`."""

    def __init__(self, gui: viser.GuiApi, units: Units, actions: Actions) -> None:
        systems = gui.add_button_group(
            "Units",
            tuple(SYSTEMS),
            hint="Of all this page, in this browser. Files, links, figures, reports and commands stay metric.",
        )
        systems.on_click(by_user(lambda event: actions.choose_units(SYSTEMS[event.target.value].chosen), actions.fail))
        self._boxes: dict[str, Any] = {}
        for name, (label, hint) in LABELS.items():
            box = gui.add_dropdown(label, CHOICES[name], initial_value=units.chosen[name], hint=hint)
            box.on_update(by_user(partial(_choose, actions.choose_units, name), actions.fail))
            self._boxes[name] = box

    def show(self, units: Units) -> None:
        """Say which units are chosen."""
        for name, unit in units.chosen.items():
            if self._boxes[name].value != unit:
                self._boxes[name].value = unit


def _choose(choose: Callable[[dict[str, str]], None], name: str, event: Any) -> None:
    choose({name: event.target.value})
