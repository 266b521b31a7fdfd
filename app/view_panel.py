"""Folders for the 3-D view and for pictures of it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol

import viser

from app.callbacks import by_user
from app.export import SIZES

VIEWS = {
    "Side": "side",
    "¾": "three-quarter",
    "Front": "front",
    "Wheel": "wheel",
}  # shown -> the stage's name
SWITCHES = {  # attribute of the stage -> label, hint
    "follow": ("Follow vehicle", "The camera moves along with the vehicle (F)"),
    "show_arrows": ("Load arrows", "Normal load of each wheel, as long as it is large"),
    "show_labels": ("Wheel names", "R1… road wheels, I1… imaginary wheels, front first"),
}


class Viewer(Protocol):
    """What the panel asks of the session."""

    def set_view(self, view: str) -> None: ...

    def set_switch(self, attribute: str, on: bool) -> None: ...

    def set_dark(self, dark: bool) -> None: ...

    def take_picture(self) -> None: ...

    def fail(self, error: Exception) -> None: ...


class ViewPanel:
    """Two folders in the present container of `gui`."""

    def __init__(self, gui: viser.GuiApi, dark: bool, viewer: Viewer) -> None:
        with gui.add_folder("View", expand_by_default=False):
            views = gui.add_button_group("Look from", tuple(VIEWS), hint="Keys 1, 2, 3, 4")
            self._switches: dict[str, Any] = {
                attribute: gui.add_checkbox(label, True, hint=hint) for attribute, (label, hint) in SWITCHES.items()
            }
            night = gui.add_checkbox("Dark", dark, hint="Dark colours for the whole page")
        with gui.add_folder("Picture", expand_by_default=False):
            self._size = gui.add_dropdown("Size", tuple(SIZES), hint="Pixels, width × height")
            picture = gui.add_button("Screenshot", hint="The 3-D view as a PNG file (S)", icon=viser.Icon.CAMERA)
        views.on_click(by_user(lambda event: viewer.set_view(VIEWS[event.target.value]), viewer.fail))
        for attribute, box in self._switches.items():
            box.on_update(by_user(_switching(viewer, attribute), viewer.fail))
        night.on_update(by_user(lambda event: viewer.set_dark(event.target.value), viewer.fail))
        picture.on_click(by_user(lambda event: viewer.take_picture(), viewer.fail))

    @property
    def size(self) -> str:
        """The chosen size of pictures, a key of SIZES."""
        return self._size.value

    def toggle(self, attribute: str) -> bool:
        """Turn a switch over; its new state."""
        box = self._switches[attribute]
        box.value = not box.value
        return box.value


def _switching(viewer: Viewer, attribute: str) -> Callable[[Any], None]:
    return lambda event: viewer.set_switch(attribute, event.target.value)
