"""The player at the foot of the 3-D view: run or drive, time slider or how far the drive has come, buttons, speed."""

from __future__ import annotations

from typing import Any

import viser

from app.format.units import METRIC, Units
from app.panels.actions import Actions
from app.panels.callbacks import by_user
from app.panels.page_layout import PageLayout
from app.runs.drive import DriveState
from app.runs.playback import NORMAL_SPEED, SPEEDS, STEP, Playback

HEIGHT = 172  # px of usual type (page_layout.py), as the next two
ONE_ROW, ROW = 390, 27  # px: on a panel less wide the buttons take a second row, of this height
GAP = 14  # px to the lower edge of the view
START, BACK, PLAY, PAUSE, ON = "|◀", "◀ Step", "▶ Play", "❚❚ Pause", "Step ▶"
ANEW, GO = "|◀ Restart", "▶ Drive on"
RUN, DRIVE = "Run", "Drive"
MARKS = {True: "●", False: "○"}  # before the mode that is on, and the other

# As tall as the box of text that replaces it in a drive, so that the rows below stay where they are.
AS_TALL = '<style>[id="TIME"] { min-height: 1.62rem; }</style>'


class PlaybackPanel:
    """A floating panel that shows a Playback or a drive, and passes on what the user asks for."""

    def __init__(self, gui: viser.GuiApi, actions: Actions) -> None:
        self._panel = gui.add_panel()
        with self._panel.add_tab("Playback"):
            self._mode: Any = gui.add_button_group(
                "Mode",
                _modes(False),
                hint="Run: a fixed stretch of road, computed anew at each change. Drive (D): on and on in real time; "
                "changes act on the moving vehicle, and an obstacle comes again and again.",
            )
            self._time: Any = gui.add_slider(
                "Time, s", 0.0, 1.0, STEP, 0.0, hint="Where in the run, or in the last seconds of the drive, we are"
            )
            self._driven: Any = gui.add_text(
                "Driven",
                "",
                disabled=True,
                visible=False,
                hint="Time and distance since the start, and how fast the drive is compared with real time: what this "
                "machine reaches may be less than what is asked for.",
            )
            self._buttons: Any = gui.add_button_group(
                "Playback",
                _buttons(False, True),
                hint="Space plays and pauses; ← and → step by 0.01 s, with Shift by 0.1 s. When a drive pauses, you "
                "can look back on its last seconds.",
            )
            self._speed: Any = gui.add_dropdown(
                "Time scale",
                tuple(SPEEDS),
                initial_value=NORMAL_SPEED,
                hint="How fast time passes; 1× is real time. A larger one shows more in less time, up to what this "
                "machine can compute.",
            )
            gui.add_html(AS_TALL.replace("TIME", self._time._impl.uuid))
        self._time.on_update(by_user(lambda event: actions.scrub(event.target.value), actions.fail))
        self._speed.on_update(by_user(lambda event: actions.set_speed(SPEEDS[event.target.value]), actions.fail))
        acts = {
            START: lambda: actions.scrub(0.0),
            BACK: lambda: actions.step(-1),
            ON: lambda: actions.step(1),
            ANEW: actions.restart_drive,
        } | dict.fromkeys((PLAY, PAUSE, GO), actions.toggle)
        self._buttons.on_click(by_user(lambda event: acts[event.target.value](), actions.fail))
        self._mode.on_click(
            by_user(lambda event: actions.set_driving(event.target.value.endswith(DRIVE)), actions.fail)
        )

    def place(self, layout: PageLayout) -> None:
        """Float at the foot of the view."""
        self._panel.float(
            x=layout.player_x, y=-GAP - layout.below, width=layout.player_width, height=player_height(layout)
        )

    def show(self, playback: Playback) -> None:
        """Show the playback of a run."""
        self._show_mode(False, playback.playing)
        self._show_time(playback)

    def follow(self, speed: float) -> None:
        """Show a speed, times real time, that the user has not chosen here."""
        self._speed.value = next(name for name, one in SPEEDS.items() if one == speed)

    def show_drive(self, playback: Playback, state: DriveState | None, units: Units = METRIC) -> None:
        """Show how far the drive has come, or where in its past the user is."""
        self._show_mode(True, playback.playing)
        self._driven.value = "starting…" if state is None else driven_text(state, playback, units)
        if state is not None and state.stands:
            self._show_time(playback)

    def _show_time(self, playback: Playback) -> None:
        start, slider = round(playback.start, 2), self._time
        end = max(round(playback.end, 2), start + STEP)
        slider.min, slider.max = min(slider.min, start), max(slider.max, end)
        slider.value = min(max(round(playback.time, 2), start), end)  # never outside: the page would move it back
        slider.min, slider.max = start, end

    def _show_mode(self, driving: bool, playing: bool) -> None:
        self._mode.options = _modes(driving)
        goes_on = driving and playing
        self._time.visible, self._driven.visible = not goes_on, goes_on
        self._buttons.options = _buttons(driving, playing)


def player_height(layout: PageLayout) -> int:
    """px."""
    height = HEIGHT if layout.player_width >= ONE_ROW * layout.scale else HEIGHT + ROW
    return int(height * layout.scale)


def covered(layout: PageLayout) -> float:
    """The share of the view's height, at its foot, that is kept free for the player.

    Beside a view as high as the page there is room for both in any case (app/view3d/camera.py).
    """
    return (player_height(layout) + GAP) / (layout.height - layout.below) if layout.plots == "under" else 0.0


def driven_text(state: DriveState, playback: Playback, units: Units = METRIC) -> str:
    """ "1:23 · 347 m · 0.99× of 1× real time"."""
    minutes, seconds = divmod(int(state.time), 60)
    unit = units.of("m")
    where = f"{minutes}:{seconds:02d} · {state.distance * unit.factor:.0f}{unit.after}"
    asked = f"{playback.speed:g}× real time"
    if state.ended:
        return f"{where} · ended"
    return f"{where} · {asked}" if state.factor is None else f"{where} · {state.factor:.2f}× of {asked}"


def _buttons(driving: bool, playing: bool) -> tuple[str, ...]:
    return ANEW if driving else START, BACK, PAUSE if playing else GO if driving else PLAY, ON


def _modes(driving: bool) -> tuple[str, ...]:
    return f"{MARKS[not driving]} {RUN}", f"{MARKS[driving]} {DRIVE}"
