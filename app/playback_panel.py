"""The player at the foot of the 3-D view: time slider, buttons, speed."""

from __future__ import annotations

from typing import Any, Protocol

import viser

from app.callbacks import by_user
from app.playback import NORMAL_SPEED, SPEEDS, STEP, Playback

HEIGHT = 148  # px
GAP = 14  # px to the lower edge of the view
START, BACK, PLAY, PAUSE, ON = "|◀", "◀ Step", "▶ Play", "❚❚ Pause", "Step ▶"


class Player(Protocol):
    """What the panel asks of the session."""

    def toggle(self) -> None: ...

    def step(self, steps: int) -> None: ...

    def scrub(self, time: float) -> None: ...

    def set_speed(self, speed: float) -> None: ...

    def fail(self, error: Exception) -> None: ...


class PlaybackPanel:
    """A floating panel that shows a Playback and passes on what the user wants of it."""

    def __init__(self, gui: viser.GuiApi, player: Player) -> None:
        self._panel = gui.add_panel()
        with self._panel.add_tab("Playback"):
            self._time: Any = gui.add_slider("Time, s", 0.0, 1.0, STEP, 0.0, hint="Where in the run we are")
            self._buttons: Any = gui.add_button_group(
                "Playback", _buttons(True), hint="Space plays and pauses, ← and → step, with Shift ten steps"
            )
            speed = gui.add_dropdown(
                "Speed", tuple(SPEEDS), initial_value=NORMAL_SPEED, hint="Of the playback; 1× is real time"
            )
        self._time.on_update(by_user(lambda event: player.scrub(event.target.value), player.fail))
        speed.on_update(by_user(lambda event: player.set_speed(SPEEDS[event.target.value]), player.fail))
        acts = {
            START: lambda: player.scrub(0.0),
            BACK: lambda: player.step(-1),
            PLAY: player.toggle,
            PAUSE: player.toggle,
            ON: lambda: player.step(1),
        }
        self._buttons.on_click(by_user(lambda event: acts[event.target.value](), player.fail))

    def place(self, x: int, width: int) -> None:
        """Float at the foot of the view, px from its left edge."""
        self._panel.float(x=x, y=-GAP, width=width, height=HEIGHT)

    def show(self, playback: Playback) -> None:
        """Say what the playback does."""
        self._time.max = max(playback.duration, STEP)
        self._time.value = round(playback.time, 2)
        self._buttons.options = _buttons(playback.playing)


def _buttons(playing: bool) -> tuple[str, ...]:
    return START, BACK, PAUSE if playing else PLAY, ON
