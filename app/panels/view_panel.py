"""The folder for the 3-D view."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import viser

from app.format.load_colours import RAMP
from app.format.load_unit import LoadUnit
from app.format.markup import element
from app.panels.actions import Actions
from app.panels.callbacks import by_user
from app.plots.ticks import ticks
from app.view3d.camera import Standpoint
from app.view3d.overlays import SWITCHES

VIEWS: dict[str, Standpoint] = {
    "Side": "side",
    "¾": "three-quarter",
    "Front": "front",
    "Wheel": "wheel",
}  # as shown
LOOK = (
    "Side, front corner, ahead, or close to the front wheels (keys 1, 2, 3, 4). In the view itself drag to turn, with "
    "the right button to shift; the mouse's wheel zooms."
)
ARROW_SCALE = 0.25, 4.0, 0.25  # least, most, step


class ViewPanel:
    """Fills a folder of `gui`."""

    def __init__(self, gui: viser.GuiApi, folder: viser.GuiFolderHandle, dark: bool, actions: Actions) -> None:
        with folder:
            views = gui.add_button_group("Look from", tuple(VIEWS), hint=LOOK)
            self._switches: dict[str, Any] = {
                name: gui.add_checkbox(switch.label, switch.on, hint=switch.hint) for name, switch in SWITCHES.items()
            }
            scale = gui.add_slider(
                "Arrow length",
                *ARROW_SCALE,
                initial_value=1.0,
                hint="Of all force arrows; at 1 an even share of the weight is as high as a road wheel, at 2 as two",
            )
            self._night: Any = gui.add_checkbox(
                "Dark", dark, hint="Dark colours for page, plots and view; at first as the browser is set"
            )
            self._load_scale = gui.add_html("", visible=False)
        views.on_click(by_user(lambda event: actions.set_view(VIEWS[event.target.value]), actions.fail))
        for name, box in self._switches.items():
            box.on_update(by_user(_switching(actions, name), actions.fail))
        scale.on_update(by_user(lambda event: actions.set_arrow_scale(event.target.value), actions.fail))
        self._night.on_update(by_user(lambda event: actions.set_dark(event.target.value), actions.fail))

    def show_dark(self, dark: bool) -> None:
        """Say which look the page has."""
        self._night.value = dark

    def show_load_scale(self, top: float | None, unit: LoadUnit) -> None:
        """What the wheels' colours mean, from 0 to `top`, N, told in that unit; None: they mean nothing."""
        self._load_scale.visible = top is not None
        if top is not None:
            self._load_scale.content = load_scale(top, unit)

    def toggle(self, switch: str) -> bool:
        """Turn a switch on if it is off, and off if it is on; its new state."""
        box = self._switches[switch]
        box.value = not box.value
        return box.value


def load_scale(top: float, unit: LoadUnit) -> str:
    """HTML of the ramp of load colours up to `top`, N, with its ticks in that unit."""
    highest = top / unit.newtons
    ramp = f"height: 0.8em; background: linear-gradient(to right, {', '.join(RAMP)})"
    numbers = (
        element("span", f"{tick:g}", style=f"position: absolute; left: {100 * tick / highest:.2f}%; translate: -50%")
        for tick in ticks(0.0, highest, 4)
    )
    parts = element("div", style=ramp), element("div", *numbers, style="position: relative; height: 1.6em")
    return str(element("div", f"Normal load, {unit.name}", *parts, style="padding: 0 0.8em 0.5em; font-size: 0.8em"))


def _switching(actions: Actions, switch: str) -> Callable[[Any], None]:
    return lambda event: actions.set_switch(switch, event.target.value)
