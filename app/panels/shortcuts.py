"""Keys and the entries of the command palette (Ctrl+K). They do nothing while a text box has the focus."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import viser

from app.panels.actions import Actions
from app.panels.callbacks import by_user
from app.panels.files_panel import PICTURE
from app.panels.view_panel import VIEWS

LONG_STEP = 10  # steps


def add_shortcuts(gui: viser.GuiApi, actions: Actions) -> None:
    """Register all commands of a tab."""
    views: list[tuple[str, Any, Any, Any]] = [
        (f"View: {label}", str(number), None, partial(actions.set_view, view))
        for number, (label, view) in enumerate(VIEWS.items(), 1)
    ]
    for label, hotkey, modifier, act in (
        ("Play or pause", "space", None, actions.toggle),
        ("One step on", "arrowright", None, partial(actions.step, 1)),
        ("One step back", "arrowleft", None, partial(actions.step, -1)),
        ("Ten steps on", "arrowright", "shift", partial(actions.step, LONG_STEP)),
        ("Ten steps back", "arrowleft", "shift", partial(actions.step, -LONG_STEP)),
        ("Drive on and on, or back to the run", "D", None, actions.toggle_driving),
        ("Restart the drive", "D", "shift", actions.restart_drive),
        ("Reset all parameters", "R", None, actions.reset),
        ("Undo the last change", "Z", "cmd/ctrl", actions.undo),
        ("Redo the change", "Z", "cmd/ctrl+shift", actions.redo),
        ("Pin this run as the baseline", "B", None, actions.pin),
        ("Follow the vehicle, or not", "F", None, partial(actions.toggle_switch, "follow")),
        ("Plots large, or beside the view", "L", None, actions.enlarge_plots),
        ("Copy a link to what is shown", "C", "shift", actions.copy_link),
        ("Screenshot", "S", None, partial(actions.export, PICTURE)),
        *views,
    ):
        command = gui.add_command(label, hotkey=hotkey, modifier=modifier)
        command.on_trigger(by_user(_without_event(act), actions.fail))


def _without_event(act: Callable[[], None]) -> Callable[[Any], None]:
    return lambda event: act()
