"""Keys and the entries of the command palette (Ctrl+K). They do nothing while a text box has the focus."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any, Protocol

import viser

from app.panels.callbacks import by_user
from app.panels.files_panel import PICTURE
from app.panels.view_panel import VIEWS

if TYPE_CHECKING:
    from app.session.workspace import Desk

LONG_STEP = 10  # steps


class Keys(Protocol):
    """What the keys ask of the session."""

    def toggle(self) -> None: ...

    def step(self, steps: int) -> None: ...

    def toggle_driving(self) -> None: ...

    def restart_drive(self) -> None: ...

    def reset(self) -> None: ...

    def undo(self) -> None: ...

    def redo(self) -> None: ...

    def ask(self, kind: str, act: Callable[[Desk], None]) -> None: ...

    def toggle_switch(self, switch: str) -> None: ...

    def set_view(self, view: str) -> None: ...

    def export(self, what: str) -> None: ...

    def fail(self, error: Exception) -> None: ...


def add_keys(gui: viser.GuiApi, keys: Keys) -> None:
    """Register all commands of a tab."""
    views: list[tuple[str, Any, Any, Any]] = [
        (f"View: {label}", str(number), None, partial(keys.set_view, view))
        for number, (label, view) in enumerate(VIEWS.items(), 1)
    ]
    for label, hotkey, modifier, act in (
        ("Play or pause", "space", None, keys.toggle),
        ("One step on", "arrowright", None, partial(keys.step, 1)),
        ("One step back", "arrowleft", None, partial(keys.step, -1)),
        ("Ten steps on", "arrowright", "shift", partial(keys.step, LONG_STEP)),
        ("Ten steps back", "arrowleft", "shift", partial(keys.step, -LONG_STEP)),
        ("Drive on and on, or back to the run", "D", None, keys.toggle_driving),
        ("Restart the drive", "D", "shift", keys.restart_drive),
        ("Reset all parameters", "R", None, keys.reset),
        ("Undo the last change", "Z", "cmd/ctrl", keys.undo),
        ("Redo the change", "Z", "cmd/ctrl+shift", keys.redo),
        ("Pin this run as the baseline", "B", None, partial(keys.ask, "baseline", lambda desk: desk.pin())),
        ("Follow the vehicle, or not", "F", None, partial(keys.toggle_switch, "follow")),
        ("Screenshot", "S", None, partial(keys.export, PICTURE)),
        *views,
    ):
        command = gui.add_command(label, hotkey=hotkey, modifier=modifier)
        command.on_trigger(by_user(_without_event(act), keys.fail))


def _without_event(act: Callable[[], None]) -> Callable[[Any], None]:
    return lambda event: act()
