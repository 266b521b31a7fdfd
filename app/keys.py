"""Keys and the entries of the command palette (Ctrl+K). They do nothing while a text box has the focus."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any, Protocol

import viser

from app.callbacks import by_user
from app.view_panel import VIEWS

LONG_STEP = 10  # steps


class Keys(Protocol):
    """What the keys ask of the session."""

    def toggle(self) -> None: ...

    def step(self, steps: int) -> None: ...

    def reset(self) -> None: ...

    def toggle_switch(self, switch: str) -> None: ...

    def set_view(self, view: str) -> None: ...

    def take_picture(self) -> None: ...

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
        ("Reset all parameters", "R", None, keys.reset),
        ("Follow the vehicle, or not", "F", None, partial(keys.toggle_switch, "follow")),
        ("Screenshot", "S", None, keys.take_picture),
        *views,
    ):
        command = gui.add_command(label, hotkey=hotkey, modifier=modifier)
        command.on_trigger(by_user(_without_event(act), keys.fail))


def _without_event(act: Callable[[], None]) -> Callable[[Any], None]:
    return lambda event: act()
