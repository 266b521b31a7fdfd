"""What one browser tab shows. No locks: only the thread that draws (app/session.py) changes anything here."""

from __future__ import annotations

import html
from collections.abc import Callable, Mapping
from typing import Any, Protocol

import viser

from app.colours import wheel_palette
from app.controls import ControlPanel, Wishes, refusal
from app.keys import Keys, add_keys
from app.playback import Playback
from app.playback_panel import PlaybackPanel, Player
from app.plot_panel import PlotPanel
from app.plots import load_plots
from app.runner import Failed, Finished, Refused
from app.screen import LEFT, Layout, Screen
from app.style import PAGE, apply_theme
from app.view_panel import Viewer, ViewPanel
from model.config import Config
from model.trajectory import Trajectory

BUSY_DELAY = 0.2  # s before a run is called under way: quick ones are not worth a flicker
SLOW_START = 1.5  # s without progress: the model is being compiled
FIRST_START = "compiling the model, for half a minute…"
NOTICE_TIME = 10.0  # s that a notification stays


class Scene(Protocol):
    """The 3-D view: app.stage.Stage, or a stand-in."""

    follow: bool
    show_arrows: bool
    show_labels: bool

    def show(self, trajectory: Trajectory) -> None: ...

    def draw(self, time: float) -> None: ...

    def set_view(self, name: Any) -> None: ...

    def set_dark(self, dark: bool) -> None: ...


class Actions(Wishes, Player, Viewer, Keys, Protocol):
    """What the panels ask of the session."""


class Window:
    """Panels, plots and 3-D view of one tab."""

    def __init__(
        self,
        client: viser.ClientHandle,
        presets: Mapping[str, Config],
        preset: str,
        config: Config,
        actions: Actions,
        make_scene: Callable[[viser.ClientHandle, bool], Scene],
        dark: bool,
    ) -> None:
        self._client, self._dark = client, dark
        self._run: Trajectory | None = None
        self._drawn: tuple[int, float] | None = None  # run and time that the 3-D view shows
        self._run_number = 0
        self._notices: dict[str, viser.NotificationHandle] = {}
        self._screen = Screen(client.camera.image_width, client.camera.image_height)
        layout = self._screen.first()
        gui = client.gui
        with client.atomic():
            apply_theme(gui, dark)
            gui.set_panel_label("Trackride")
            gui.main_panel.dock_left()
            gui.main_panel.set_width(LEFT)
            gui.add_html(PAGE)
            self._controls = ControlPanel(gui, presets, preset, config, actions)
            with self._controls.middle:
                self._view = ViewPanel(gui, dark, actions)
            self._plots_panel = gui.add_panel()
            self._plots = PlotPanel(gui, self._plots_panel.add_tab("Loads"), layout.page_height, dark)
            self._plots_panel.dock_right()
            self._player = PlaybackPanel(gui, actions)
            self._resize(layout)
            add_keys(gui, actions)
        self.scene = make_scene(client, dark)

    # ── Runs ──

    def show_run(self, done: Finished, time: float, *, settled: bool) -> None:
        """Show a finished run at `time`, s. settled: no newer wish is on its way, so that the controls may follow."""
        run = done.trajectory
        self._run, self._run_number = run, done.wish.number
        self._plot(time)
        self._client.flush()
        self.scene.show(run)
        self._drawn = None
        if settled:
            self._controls.show(run.config, touched=done.wish.changes)
        if run.complete:
            self._forget("diverged")
        else:
            body = f"{run.status[0].upper()}{run.status[1:]}. The plots show the run up to there. {run.advice}"
            self._notify("diverged", "The run did not come to its end", body, "orange", stays=True)
        self._forget("refused")

    def refuse(self, refused: Refused, instead: Config) -> None:
        """Say what is wrong with a wish, and go back to the configuration that was good."""
        body = " ".join(refusal(fault, refused.wish.changes.get(fault.path)) for fault in refused.faults)
        self._notify("refused", "Not possible", body, "red")
        self._controls.show(instead)

    def show_value(self, key: str, value: Any) -> None:
        """Move a control."""
        self._controls[key].show(value)

    def was_moved_to_end(self, key: str, wished: Any) -> bool:
        """Whether a slider stands at its end because the page moved it there from the value wished for, beyond it."""
        return self._controls[key].was_moved_to_end(wished)

    def report_failure(self, failed: Failed) -> None:
        self._notify("refused", "No run", failed.message, "red")

    def show_status(self, under_way: tuple[int, float, float] | None) -> None:
        """Say which run is shown, or how far the next is (number, part done, seconds so far)."""
        if under_way is not None and (under_way[2] > BUSY_DELAY or self._run is None):
            number, part, seconds = under_way
            doing = FIRST_START if part == 0 and seconds > SLOW_START else f"computing… {100 * part:.0f} %"
            self._controls.status.content = status_line(f"Run {number}", doing)
        elif self._run is not None:
            run, took = self._run, self._run.statistics.seconds
            reached = float(run.t[-1]) if len(run.t) else 0.0
            speed = f"{reached / took:.0f}× real time" if took > 0 else ""
            facts = f"{reached:.3g} s in {1e3 * took:.0f} ms · {speed}"
            self._controls.status.content = status_line(
                f"Run {self._run_number}", facts, "" if run.complete else "stopped early"
            )

    # ── Time ──

    def draw(self, time: float) -> None:
        """The 3-D view at a time, s."""
        if self._run is not None and self._drawn != (self._run_number, time):
            self.scene.draw(time)
            self._drawn = (self._run_number, time)

    def show_time(self, playback: Playback) -> None:
        """Player and time cursors."""
        self._player.show(playback)
        self._plots.point_at(playback.time)

    # ── Looks ──

    def fit_page(self) -> None:
        """Sizes of the panels, when the page's has changed."""
        camera = self._client.camera
        layout = self._screen.update(camera.image_width, camera.image_height)
        if layout is not None:
            self._resize(layout)

    def set_dark(self, dark: bool) -> None:
        self._dark = dark
        apply_theme(self._client.gui, dark)
        self._plots.set_dark(dark)
        if self._run is not None:
            self._plot(self._plots.time)
        self.scene.set_dark(dark)

    def set_switch(self, switch: str, on: bool) -> None:
        """Turn something of the 3-D view on or off."""
        setattr(self.scene, switch, on)
        self._drawn = None

    def toggle_switch(self, switch: str) -> None:
        """Turn a switch of the 3-D view over, and its checkbox."""
        self.set_switch(switch, self._view.toggle(switch))

    @property
    def picture_size(self) -> str:
        return self._view.size

    @property
    def background(self) -> str:
        """Colour behind the scene in pictures."""
        return "#1a1b1e" if self._dark else "#ffffff"

    def report_error(self, error: Exception) -> None:
        text = str(error) or type(error).__name__
        self._notify("error", "Something went wrong", f"{text} (details are in the terminal).", "red")

    def say(self, title: str, body: str) -> None:
        self._notify("said", title, body, "blue")

    def _resize(self, layout: Layout) -> None:
        self._plots_panel.set_width(layout.right)
        self._plots.set_page_height(layout.page_height)
        self._player.place(layout.player_x, layout.player_width)

    def _plot(self, time: float) -> None:
        assert self._run is not None
        palette = wheel_palette(self._run.system.n, self._run.system.m, self._dark)
        self._plots.show(load_plots(self._run, palette.wheels, palette.hull), time)

    def _notify(self, kind: str, title: str, body: str, color: Any, stays: bool = False) -> None:
        """One notification of each kind: a newer one takes the older one's place."""
        notice = self._notices.get(kind)
        if notice is not None and (notice.title, notice.body) == (title, body) and stays:
            return
        self._forget(kind)
        self._notices[kind] = self._client.add_notification(
            title, body, color=color, auto_close_seconds=None if stays else NOTICE_TIME
        )

    def _forget(self, kind: str) -> None:
        notice = self._notices.pop(kind, None)
        if notice is not None:
            notice.remove()


def status_line(name: str, facts: str, trouble: str = "") -> str:
    """HTML of the line that says which run this is."""
    bad = f' · <span class="bad">{html.escape(trouble)}</span>' if trouble else ""
    return f'<div class="trackride-status"><b>{html.escape(name)}</b> · {html.escape(facts)}{bad}</div>'
