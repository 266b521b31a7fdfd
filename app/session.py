"""One browser tab from connecting to disconnecting: its threads, and what passes between them.

viser's event loop calls the methods that panels and keys know (change, scrub, set_view …): they leave a wish and
return. The runner's thread (app/runner.py) turns the latest wish into a run. The view's thread, VIEW_RATE times a
second or as soon as there is a run, does all that is seen (app/window.py); it never draws under a lock.
"""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from time import monotonic
from typing import Any

import viser

from app.export import SIZES, NoPictureError, file_name, take_picture
from app.playback import Playback
from app.runner import Failed, Finished, Outcome, Refused, Runner, Simulate, Wish
from app.stage import Stage
from app.window import Scene, Window
from model.config import Config
from model.simulate import simulate

VIEW_RATE = 30.0  # Hz: the 3-D view
TEXT_RATE = 10.0  # Hz: numbers, time slider, time cursors
REFUSAL_DELAY = 1.2  # s without another wish until a bad value is refused: time to finish typing
PICTURE_PATIENCE = 1.0  # s to wait at closing for a picture; viser ends it when the tab is gone
SAME_ERROR = 5.0  # s before the same error is logged and shown again

log = logging.getLogger("trackride")


class Session:
    """The methods may be called on any thread and return at once, but for close."""

    def __init__(
        self,
        client: viser.ClientHandle,
        presets: Mapping[str, Config],
        preset: str,
        config: Config,
        *,
        dark: bool = False,
        run: Simulate = simulate,
        make_scene: Callable[[viser.ClientHandle, bool], Scene] = Stage,
    ) -> None:
        """presets: name -> configuration, among them `preset`; config: what to run first."""
        self._client, self._presets = client, presets
        self._lock = threading.Lock()  # of the next four
        self._playback = Playback()
        self._intents: dict[str, Callable[[], None]] = {}  # what the view is to do: the newest of each kind
        self._refused: Refused | None = None  # a bad wish that is not yet spoken of
        self._refuse_at = 0.0  # monotonic s

        self._good: Finished | None = None  # the run that is shown
        self._picture: threading.Thread | None = None
        self._last_error: tuple[str, float] = ("", 0.0)
        self._wake = threading.Event()
        self._closed = threading.Event()
        self._runner = Runner(first_wish(presets[preset], config), run, self._wake.set, self.fail)
        try:
            self._window = Window(client, presets, preset, config, self, make_scene, dark)
        except Exception:
            self._runner.close()
            raise
        self._thread = threading.Thread(target=self._show, name="trackride-view", daemon=True)
        self._thread.start()

    # ── What the user wishes for ──

    def change(self, key: str, value: Any) -> None:
        """Wish for another value of a parameter (as in a file)."""
        wished = self._runner.latest.changes.get(key)
        if self._window.was_moved_to_end(key, wished):
            with self._lock:
                bad = self._refused is not None
                self._refuse_at = 0.0  # typing has ended
            if not bad:
                self._intend(key, lambda: self._window.show_value(key, wished))
        else:
            self._runner.change(lambda wish: wish.changed(key, value))

    def load(self, preset: str) -> None:
        """Wish for a preset."""
        base = self._presets[preset]
        self._runner.change(lambda wish: Wish(base))

    def reset(self) -> None:
        """Wish for the preset without any change."""
        self._runner.change(lambda wish: Wish(wish.base))

    def toggle(self) -> None:
        with self._lock:
            self._playback.toggle()

    def step(self, steps: int) -> None:
        with self._lock:
            self._playback.step(steps)

    def scrub(self, time: float) -> None:
        with self._lock:
            self._playback.scrub(time)

    def set_speed(self, speed: float) -> None:
        with self._lock:
            self._playback.speed = speed

    def set_view(self, view: str) -> None:
        self._intend("view", lambda: self._window.scene.set_view(view))

    def set_switch(self, switch: str, on: bool) -> None:
        self._intend(switch, lambda: self._window.set_switch(switch, on))

    def toggle_switch(self, switch: str) -> None:
        self._intend(switch, lambda: self._window.toggle_switch(switch))

    def set_dark(self, dark: bool) -> None:
        self._intend("dark", lambda: self._window.set_dark(dark))

    def take_picture(self) -> None:
        self._intend("picture", self._start_picture)

    def fail(self, error: Exception) -> None:
        """Log an error and tell the user."""
        text, now = f"{type(error).__name__}: {error}", monotonic()
        if self._last_error[0] != text or now - self._last_error[1] > SAME_ERROR:
            self._last_error = (text, now)
            log.error("in a session", exc_info=error)
            self._intend("error", lambda: self._window.report_error(error))

    def close(self) -> None:
        """End all threads. Waits for them, but not for a browser that still draws a picture."""
        self._closed.set()
        self._wake.set()
        self._runner.close()
        self._thread.join()
        if self._picture is not None:
            self._picture.join(PICTURE_PATIENCE)

    def _intend(self, kind: str, act: Callable[[], None]) -> None:
        with self._lock:
            self._intents[kind] = act

    # ── What is seen: on the view's thread from here on ──

    def _show(self) -> None:
        frame, text = 1 / VIEW_RATE, 1 / TEXT_RATE
        before = next_text = monotonic()
        while not self._closed.is_set():
            now = monotonic()
            elapsed, before = now - before, now
            with_text = now >= next_text
            if with_text:
                next_text = now + text
            for outcome in self._runner.take():
                self._attempt(partial(self._take, outcome))
            self._attempt(partial(self._draw, elapsed, with_text))
            self._wake.wait(max(before + frame - monotonic(), 0.0))
            self._wake.clear()

    def _attempt(self, act: Callable[[], None]) -> None:
        try:
            act()
        except Exception as error:
            self.fail(error)

    def _take(self, outcome: Outcome) -> None:
        """Show a run, or keep a refusal for when the user has finished typing."""
        match outcome:
            case Finished(wish, run):
                with self._lock:
                    self._refused = None
                    self._playback.fit(float(run.t[-1]) if len(run.t) else 0.0)
                    time = self._playback.time
                self._good = outcome
                self._window.show_run(outcome, time, settled=self._runner.latest.number == wish.number)
            case Refused():
                with self._lock:
                    self._refused, self._refuse_at = outcome, monotonic() + REFUSAL_DELAY
            case Failed():
                self._window.report_failure(outcome)

    def _draw(self, elapsed: float, with_text: bool) -> None:
        with self._lock:
            intents, self._intents = self._intents, {}
            self._playback.advance(elapsed)
            playback = replace(self._playback)
            refused = self._refused if monotonic() >= self._refuse_at else None
            if refused is not None:
                self._refused = None
        for act in intents.values():
            self._attempt(act)
        if refused is not None and self._good is not None and self._runner.withdraw(refused.wish, self._good.wish):
            self._window.refuse(refused, self._good.trajectory.config)
        self._window.draw(playback.time)
        if with_text:
            self._window.show_time(playback)
            self._window.show_status(self._runner.under_way())
            self._window.fit_page()

    def _start_picture(self) -> None:
        if self._picture is not None and self._picture.is_alive():
            self._window.say("One at a time", "The browser is still drawing the last picture.")
        elif self._good is not None:
            size, good, background = self._window.picture_size, self._good, self._window.background
            name = file_name(good.wish.base.name, good.wish.changes, "x".join(map(str, SIZES[size])), ".png")
            self._picture = threading.Thread(
                target=self._send_picture,
                args=(*SIZES[size], background, name),
                name="trackride-picture",
                daemon=True,
            )
            self._picture.start()

    def _send_picture(self, width: int, height: int, background: str, name: str) -> None:
        try:
            picture = take_picture(self._client, width, height, background)
            self._client.send_file_download(name, picture, save_immediately=True)
        except NoPictureError as error:
            log.info("no picture: %s", error)
            message = str(error)
            self._intend("said", lambda: self._window.say("No picture", message))
        except Exception as error:
            self.fail(error)


def first_wish(base: Config, config: Config) -> Wish:
    """The wish for `config` as changes to `base`, so that a reset leads back to that."""
    before, after = base.values(), config.values()
    changes = {key: value for key, value in after.items() if before.get(key) != value}
    wish = Wish(base, changes)
    return wish if wish.config() == config else Wish(config)
