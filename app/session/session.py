"""One browser tab from connecting to disconnecting: its threads, and what passes between them.

viser's event loop calls the methods that panels and keys know (change, scrub, set_view …): they leave a request and
return. The runner's thread (app/runs/runner.py) turns the latest request into a run. The view's thread, VIEW_RATE times
a second or as soon as there is a run, does all that is seen (app/session/window.py); it never draws under a lock.
"""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from time import monotonic
from typing import Any

import viser

from app.panels.files_panel import PROJECT
from app.panels.road_parts import with_part, without_last
from app.plots.study_data import Data
from app.runs.examples import EXAMPLE
from app.runs.history import REST
from app.runs.playback import Playback, of_another_kind, time_to_look
from app.runs.project import SUFFIX
from app.runs.request import Driven, Failed, Finished, Outcome, Refused, Request, Simulate, first_request
from app.runs.runner import Runner
from app.runs.study_choice import StudyChoice
from app.runs.tab_place import TabPlace
from app.runs.turns import SHOWING
from app.session.address import Address
from app.session.downloads import Download, Downloads
from app.session.error_log import Seldom, kind_of
from app.session.example_show import ExampleShow, Moment
from app.session.studies import Studies
from app.session.study_work import Record, Situation
from app.session.transfers import Transfers
from app.session.vehicle_view import VehicleView
from app.session.window import Window
from app.session.workspace import Workspace
from app.view3d.view import View3D
from model.config.config import Config, ConfigError
from model.config.config_files import dump_config
from model.config.profile_files import ProfileFile, Reading
from model.simulation.simulate import simulate
from model.simulation.trajectory import Trajectory
from model.study import running as study_running
from model.study.design import DesignError
from model.study.fit import read_record

VIEW_RATE = 30.0  # Hz: the 3-D view
TEXT_RATE = 10.0  # Hz: numbers, time slider, time cursors …
DRAG_TEXT_RATE = 3.0  # Hz: … and while runs follow each other: the page has their curves to draw
DRAG_PAUSE = 0.3  # s without a new run after which a drag is over
REFUSAL_DELAY = 0.4  # s from a bad value to its refusal if no other request comes: a drag goes on meanwhile
SEEN_WITHIN = 2.0  # s that a background job waits for something to be drawn; then it goes on without
IDLE_RATE = 2.0  # Hz: while nothing moves …
STAYS_AWAKE = 5.0  # s … since the user did something or a run came

log = logging.getLogger("trackride")


class Session:
    """All methods may be called on any thread. All return at once, except `close` and those for background jobs."""

    def __init__(
        self,
        client: viser.ClientHandle,
        presets: Mapping[str, Config],
        preset: str,
        config: Config,
        *,
        run: Simulate = simulate,
        make_view: Callable[[viser.ClientHandle, bool], VehicleView] = View3D,
        study: Callable[..., study_running.Outcome] = study_running.outcome,
    ) -> None:
        """presets: name -> configuration, among them `preset`; config: what to run first; study: runs of studies."""
        self._lock = threading.RLock()  # of the next eight
        self._playback = Playback()
        self._driving = False  # on and on, instead of a run
        self._in_view = True  # the page is not in the background
        self._posted: dict[str, Callable[[], None]] = {}  # what the view's thread is to do: the newest of each kind
        self._refused: Refused | None = None  # a bad request that the user has not been told of yet
        self._refuse_at = 0.0  # monotonic s
        self._awake_until = monotonic() + STAYS_AWAKE
        self._rests = False  # nothing moves, and the view's thread waits longer
        self._shown_at = self._told_at = -DRAG_PAUSE  # monotonic s: when a run was shown last; numbers

        self._presets = dict(presets)  # and the user's own, which the workspace adds
        self._good: Finished | Driven | None = None  # what is shown
        self._road_changed = False  # while the user has paused, and may still be changing it
        self._place = TabPlace()
        self._steps = 0  # to be redone, or undone when negative; under the lock
        self._errors = Seldom()
        self._wake = threading.Event()
        self._closed = threading.Event()
        self._runner = Runner(first_request(presets[preset], config), run, self._wake.set, self.fail)
        try:
            self._window = Window(client, presets, preset, config, self, make_view)
        except Exception:
            self._runner.close()
            raise
        self._workspace = Workspace(self._window, self._runner, self._presets)
        self._address = Address(self._window, self._workspace, presets, self._stands_at)
        self._downloads = Downloads(client, self, self._window)
        self._transfers = Transfers(client, self, self._window, self._workspace, run)
        self._examples = ExampleShow(self._window, self._workspace, self._runner, self._moment, self._go_to)
        self._record: Record | None = None  # measured, for studies
        self._studies = Studies(
            presets,
            lambda: self._runner.latest.number,
            lambda: self._playback.playing,
            self._show_study,
            self.fail,
            study,
        )
        self._thread = threading.Thread(target=self._show, name="trackride-view", daemon=True)
        self._thread.start()

    # ── What the user asks for: app/panels/actions.py says what each of these does ──
    # A page can be quicker than __init__: window and workspace are looked up only when the view's thread acts.

    def change(self, key: str, value: Any) -> None:
        self._runner.change(lambda request: request.changed(key, value))
        self._stir()

    def enter(self, key: str, value: Any) -> None:
        self._runner.change(lambda request: request.entered(key, value))
        self._stir()

    def refuse_text(self, text: str) -> None:
        self.post("text", lambda: self._window.refuse_text(text))

    def load(self, preset: str) -> None:
        base = self._presets[preset]
        self._runner.change(lambda request: Request(base))
        self._stir()

    def reset(self) -> None:
        self._runner.change(lambda request: Request(request.base))
        self._stir()

    def reset_one(self, key: str) -> None:
        self._runner.change(lambda request: request.reset(key))
        self._stir()

    def lead_to(self, key: str) -> None:
        self.post("sought", lambda: self._window.lead_to(key))

    def set_first(self, keys: Sequence[str]) -> None:
        self.post("first", lambda: self._window.set_first(keys))

    def open_tab(self, tab: str) -> None:
        self.post("tab", lambda: self._window.open_tab(tab))

    def undo(self) -> None:
        with self._lock:
            self._steps -= 1
        self._stir()

    def redo(self) -> None:
        with self._lock:
            self._steps += 1
        self._stir()

    def mend_yaml(self, text: str, error: ConfigError) -> None:
        self.post("yaml", lambda: self._window.edit_yaml(text, error))

    def use_configuration(self, read: Callable[[], Config | None]) -> None:
        def use() -> None:
            config = read()
            if config is not None:
                self._workspace.use_configuration(config)

        self.post("configuration", use)

    def save_preset(self, name: str) -> None:
        self.post("preset", lambda: self._workspace.save_preset(name))

    def open_link(self, text: str) -> None:
        self.post("link", lambda: self._address.open(text))

    def copy_link(self) -> None:
        self.post("copy", lambda: self._address.copy())

    def pin(self) -> None:
        self.post("baseline", lambda: self._workspace.pin())

    def swap(self) -> None:
        self.post("baseline", lambda: self._workspace.swap())

    def clear_baseline(self) -> None:
        self.post("baseline", lambda: self._workspace.clear_baseline())

    def rename(self, name: str) -> None:
        self.post("name", lambda: self._workspace.rename(name))

    def recall(self, number: int) -> None:
        self.post(f"run {number}", lambda: self._workspace.recall(number))

    def compare(self, number: int) -> None:
        self.post(f"run {number}", lambda: self._workspace.compare(number))

    def tick_run(self, number: int) -> None:
        self.post(f"tick {number}", lambda: self._workspace.tick_run(number))

    def delete(self, number: int) -> None:
        self.post(f"run {number}", lambda: self._workspace.delete(number))

    def toggle(self) -> None:
        with self._lock:
            self._playback.toggle()
            self._pace()

    def step(self, steps: int) -> None:
        with self._lock:
            self._playback.step(steps)
            self._pace()

    def scrub(self, time: float) -> None:
        with self._lock:
            self._playback.scrub(time)
            self._pace()

    def set_speed(self, speed: float) -> None:
        with self._lock:
            self._playback.speed = speed
            self._pace()

    def set_driving(self, on: bool) -> None:
        with self._lock:
            self._driving, self._playback.playing = on, True
            self._playback.look_back(0.0, 0.0)  # the times of what was shown before mean nothing now
            self._pace()

    def toggle_driving(self) -> None:
        self.set_driving(not self._driving)

    def restart_drive(self) -> None:
        with self._lock:
            if self._driving:
                self._playback.playing = True
                self._pace(anew=True)

    def set_in_view(self, in_view: bool) -> None:
        with self._lock:
            self._in_view = in_view
            self._pace()

    def set_in_front(self, tabs: frozenset[str]) -> None:
        self.post("front", lambda: self._window.set_in_front(tabs))
        self._wake.set()

    def _pace(self, anew: bool = False) -> None:
        """Tell the runner how fast to drive, if at all. Under the lock."""
        speed = self._playback.speed if self._playback.playing and self._in_view else 0.0
        self._runner.drive(speed if self._driving else None, anew)
        self._stir()

    def set_view(self, view: str) -> None:
        self.post("view", lambda: self._window.set_view(view))

    def pick_wheel(self, wheel: int | None) -> None:
        self.post("wheel", lambda: self._window.pick_wheel(wheel))

    def redraw_spectrum(self) -> None:
        self.post("spectrum", lambda: self._window.redraw_spectrum())

    def choose_study(self, choice: StudyChoice) -> None:
        def choose() -> None:
            self._studies.choice = choice

        self.post("study", choose)

    def start_tour(self) -> None:
        self.post("tour", lambda: self._window.tour.start())

    def try_example(self, name: str) -> None:
        if self._driving:
            self.set_driving(False)
        self.post("example", lambda: self._examples.begin(EXAMPLE[name]))

    def undo_example(self) -> None:
        self.post("example", lambda: self._examples.undo())

    def keep_example(self) -> None:
        self.post("example", lambda: self._examples.keep())

    def take_record(self, name: str, text: str) -> None:
        def take() -> None:
            try:
                self._record = Record(name, read_record(text))
            except DesignError as error:
                self._window.say("No record", f"{name}: {error}.")

        self.post("record", take)

    def steer(self, key: str, value: Any) -> None:
        self.change(key, value)
        self.post(f"control {key}", lambda: self._window.follow(key, value))

    def show_mode(self) -> None:
        """Pause the run, and show the mode in its place."""
        with self._lock:
            if not self._driving:
                self._playback.playing = False
        self.post("mode", lambda: self._window.show_mode())

    def set_switch(self, switch: str, on: bool) -> None:
        self.post(f"switch {switch}", lambda: self._window.set_switch(switch, on))

    def toggle_switch(self, switch: str) -> None:
        self.post(f"switch {switch}", lambda: self._window.toggle_switch(switch))

    def set_arrow_scale(self, scale: float) -> None:
        self.post("arrow scale", lambda: self._window.set_arrow_scale(scale))

    def set_dark(self, dark: bool) -> None:
        self.post("dark", lambda: self._workspace.set_dark(dark))

    def choose_units(self, chosen: Mapping[str, str]) -> None:
        self.post(f"units {' '.join(chosen)}", lambda: self._workspace.choose_units(chosen))

    def set_page_size(self, width: int, height: int, view: int) -> None:
        self.post("size", lambda: self._window.set_page_size(width, height, view))

    def enlarge_plots(self) -> None:
        self.post("large", lambda: self._window.enlarge_plots())

    def return_to(self, place: str) -> None:
        self.post("place", lambda: self._place.told(place))

    def recollect(self, visit: str) -> None:
        self.post("visit", lambda: self._transfers.recollect(visit))

    def prefer_dark(self, dark: bool) -> None:
        self.post("preference", lambda: self._workspace.prefer_dark(dark))

    def export(self, what: str) -> None:
        self.post(f"export {what}", lambda: self._export(what))

    def cancel_export(self, number: int) -> None:
        self.post(f"cancel {number}", lambda: self._downloads.cancel(number))

    def upload_configuration(self, name: str, content: bytes) -> None:
        self.post("configuration", lambda: self._transfers.take_configuration(name, content))

    def upload_run(self, name: str, content: bytes) -> None:
        self.post("upload", lambda: self._transfers.take_run(name, content))

    def upload_project(self, name: str, content: bytes) -> None:
        self.post("project", lambda: self._transfers.take_project(name, content))

    def upload_profile(self, name: str, content: bytes) -> None:
        self.post("profile", lambda: self._transfers.take_profile(name, content))

    def ask_about_profile(self) -> None:
        self.post("profile", lambda: self._transfers.ask_about_profile())

    def look_at_profile(self, show: Callable[[], None]) -> None:
        self.post("look", show)

    def use_profile(self, read: Callable[[], tuple[str, ProfileFile, Reading] | None]) -> None:
        def use() -> None:
            found = read()
            if found is not None:
                self._transfers.use_profile(*found)

        self.post("profile", use)

    def add_to_road(self, road_type: str) -> None:
        self.post("road", lambda: self._workspace.change_road(lambda config: with_part(config, road_type)))

    def take_from_road(self) -> None:
        self.post("road", lambda: self._workspace.change_road(without_last))

    def edit_yaml(self) -> None:
        self.post("yaml", self._edit_yaml)

    def post(self, kind: str, act: Callable[[], None]) -> None:
        """Have the view's thread do something at its next frame; of each kind the newest counts."""
        with self._lock:
            self._posted[kind] = act
        self._stir()

    def _stir(self) -> None:
        """Something happens: from now on frames follow each other at their full rate."""
        with self._lock:
            self._awake_until = monotonic() + STAYS_AWAKE
            if self._rests:
                self._rests = False
                self._wake.set()

    @property
    def shown(self) -> Trajectory | None:
        """The run, or the latest stretch of the drive, that is shown."""
        match self._good:
            case Finished(_, run):
                return run
            case Driven(_, state):
                return state.past
        return None

    def show_now(self, act: Callable[[], None]) -> None:
        """Have the view do something, and wait until it is done. For background jobs only."""
        done = threading.Event()

        def do() -> None:
            act()
            done.set()

        self.post("now", do)
        self._wake.set()
        done.wait(SEEN_WITHIN)

    def fail(self, error: Exception) -> None:
        log.error("in a session", exc_info=error)
        if self._errors.passes(kind_of(error)) is not None:
            self.post("error", lambda: self._window.report_error(error))

    def close(self) -> None:
        """End all threads. Waits for them, but not long for a browser that still draws a picture."""
        self._closed.set()
        self._wake.set()
        self._runner.close()
        self._transfers.close()
        self._downloads.close()
        self._thread.join()
        self._studies.close()  # now that nobody begins another one

    # ── What is seen: on the view's thread from here on ──

    def _show(self) -> None:
        before = next_text = monotonic()
        while not self._closed.is_set():
            now = monotonic()
            elapsed, before = now - before, now
            with_text = now >= next_text
            if with_text:
                next_text = now + 1 / TEXT_RATE
            with SHOWING.turn():
                for outcome in self._runner.take():
                    self._stir()
                    self._attempt(partial(self._take, outcome))
                self._attempt(partial(self._draw, elapsed, with_text))
            with self._lock:
                rests = self._rests = self._told_at >= self._awake_until and not self._moves
            frame = 1 / (IDLE_RATE if rests else VIEW_RATE)
            self._wake.wait(max(before + frame - monotonic(), 0.0))
            self._wake.clear()
            if rests:
                before = monotonic()  # what begins to move now has not moved while all was at rest

    @property
    def _moves(self) -> bool:
        """Whether there is something to show at the full rate, though the user does nothing. Under the lock."""
        seen = self._in_view and (self._playback.playing or self._window.shows_mode)
        return seen or self._refused is not None or self._runner.under_way() is not None

    def _attempt(self, act: Callable[[], None]) -> None:
        try:
            act()
        except Exception as error:
            self.fail(error)

    def _take(self, outcome: Outcome) -> None:
        """Show a run, or keep a refusal for when a drag is over."""
        match outcome:
            case Finished(request, run):
                with self._lock:
                    self._refused = None
                    self._playback.fit(float(run.t[-1]) if len(run.t) else 0.0)
                    time, playing = self._playback.time, self._playback.playing
                last = self._good.trajectory if isinstance(self._good, Finished) else None
                self._good, self._shown_at = outcome, monotonic()
                self._window.show_run(outcome, time, settled=self._runner.latest.number == request.number)
                if last is not None and not playing and run.config.road != last.config.road:
                    self._road_changed = True
                    if of_another_kind(run, last):
                        self._look_at_the_road(run)
                self._workspace.finished(outcome, monotonic())
                self._examples.finished(outcome, monotonic())
            case Driven(request, state):
                with self._lock:
                    if self._refused is not None and request.number > self._refused.request.number:
                        self._refused = None
                    if self._driving:
                        self._playback.look_back(float(state.past.t[0]), state.time)
                    time = self._playback.time
                self._good = outcome
                self._window.show_drive(outcome, time, settled=self._runner.latest.number == request.number)
                self._workspace.driven(request, monotonic())
            case Refused():
                with self._lock:
                    self._refused, self._refuse_at = outcome, monotonic() + REFUSAL_DELAY
            case Failed():
                self._window.report_failure(outcome)

    def _draw(self, elapsed: float, with_text: bool) -> None:
        with self._lock:
            intents, self._posted = self._posted, {}
            steps, self._steps = self._steps, 0
            driving = self._driving
            if driving or not self._in_view:
                elapsed = 0.0
            if elapsed:
                self._playback.advance(elapsed)
            playback = replace(self._playback)
            refused = self._refused if monotonic() >= self._refuse_at else None
            if refused is not None:
                self._refused = None
        for act in intents.values():
            self._attempt(act)
        if steps:
            self._workspace.go(steps)
        if (
            refused is not None
            and self._good is not None
            and self._runner.withdraw(refused.request, self._good.request)
        ):
            self._window.refuse(refused, self._good.trajectory.config)
        if playback.playing:
            self._road_changed = False
            self._window.view.mark_obstacle(False)
        self._window.draw(playback.time, elapsed)
        if not with_text:
            return
        now = monotonic()
        if now >= self._told_at + 1 / DRAG_TEXT_RATE or now >= self._shown_at + DRAG_PAUSE:
            self._told_at = now
            if not self._rests:
                self._window.show_time(playback, driving)
                self._window.show_status(self._runner.under_way())
        if self._road_changed and isinstance(self._good, Finished) and now >= self._shown_at + REST:
            self._look_at_the_road(self._good.trajectory)
        self._workspace.tick(now)
        self._downloads.tick(now)
        self._examples.tick(now)
        self._address.tick(now)
        self._window.mark_changes(self._workspace.present)
        self._study(now, driving)
        self._mind_the_place(now)
        missing, news = self._workspace.missing_run, self._workspace.news(now)
        if missing is not None:
            self._transfers.run_again(missing)
        if news is not None:
            self._transfers.remember(news)

    def _look_at_the_road(self, run: Trajectory) -> None:
        """Bring the user, who has paused, to just before the run's obstacle if the vehicle has left it behind."""
        self._road_changed = False
        with self._lock:
            before = self._playback.time
            time = self._playback.time = time_to_look(run, before)
        if time < before:
            self._window.say("Another obstacle", f"From {before:.2f} s back to {time:.2f} s, just before it.")
            self._window.view.mark_obstacle(True)

    def _mind_the_place(self, now: float) -> None:
        """Go back to where the tab was, once its run is shown again; after that let the tab store where it is."""
        if not isinstance(self._good, Finished) or not self._workspace.stands or not self._window.shows_run:
            return
        back = self._place.to_return_to()
        if back is not None:
            self._window.look_from(back)
            with self._lock:
                self._playback.scrub(back.time)
                self._playback.playing = back.playing
                self._stir()
        elif (news := self._place.news(self._window.place(self._playback), now)) is not None:
            self._window.store_place(news)

    def _moment(self) -> Moment:
        with self._lock:
            return Moment(self._playback.time, self._playback.playing, self._playback.speed)

    def _stands_at(self) -> float | None:
        """The time of a run that is paused, s; None: it plays, or a drive is shown."""
        with self._lock:
            return None if self._playback.playing or self._driving else self._playback.time

    def _go_to(self, moment: Moment) -> None:
        with self._lock:
            self._playback.scrub(moment.time)
            self._playback.playing, self._playback.speed = moment.playing, moment.speed
            self._pace()
        self._window.show_speed(moment.speed)

    def _study(self, now: float, driving: bool) -> None:
        """Let studies begin or end, as it suits what the user does."""
        latest, good, baseline = self._runner.latest, self._good, self._workspace.baseline
        self._studies.tick(
            now,
            Situation(
                number=latest.number,
                shown=good.request.number if good is not None else -1,
                touched=bool(latest.touched),
                config=good.trajectory.config if isinstance(good, Finished) else None,
                baseline=None if baseline is None else baseline.config,
                front=self._window.study_in_front,
                record=self._record,
                units=self._window.units,
                hurries=driving or not self._in_view or self._runner.under_way() is not None,
            ),
        )

    def _show_study(self, kind: str, data: Data) -> None:
        self.post(f"study {kind}", lambda: self._window.study.show(kind, data))

    def _export(self, what: str) -> None:
        run, files = self.shown, self._window.files
        if self._good is None or run is None or not len(run.t):
            return
        with self._lock:
            time = self._playback.time
        download = Download(
            request=self._good.request,
            run=run,
            baseline=self._workspace.baseline,
            beside=self._window.beside,
            size=files.size,
            transparent=files.transparent,
            background=self._window.background,
            dark=self._window.dark,
            movie=files.movie,
            channels=files.channels,
            time=time,
            drive=self._good.state if isinstance(self._good, Driven) else None,
            mode_shown=self._window.shows_mode,
        )
        if what == PROJECT:
            self._downloads.send_project(download.name("", SUFFIX), self._workspace.project(self._studies.choice))
        else:
            self._downloads.send(what, download)

    def _edit_yaml(self) -> None:
        run = self.shown
        if run is not None:
            self._window.edit_yaml(dump_config(run.config))
