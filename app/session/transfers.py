"""Uploads of one tab, and what its browser stores; the work is done in background jobs."""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Protocol

import viser

from app.files.uploads import ProfileQuestion, configuration, profile, profile_changes, question, run_from, text_in
from app.runs.project import project_from
from app.runs.request import Simulate
from app.runs.storage import State, state_from
from app.session.background import BackgroundJob
from app.session.window import Window
from app.session.workspace import Workspace
from model.config.config import Config, ConfigError, ProfileRoad
from model.config.profile_files import ProfileFile, Reading
from model.simulation.trajectory import Trajectory

STORED = "trackride"  # key in the browser's storage
STORAGE_PATIENCE = 60.0  # s that a browser has to tell what it has stored; after that we overwrite it

log = logging.getLogger("trackride")


class DrawingThread(Protocol):
    """The thread that draws, as any other thread reaches it: app.session.session.Session, or a stand-in."""

    @property
    def shown(self) -> Trajectory | None: ...

    def post(self, kind: str, act: Callable[[], None]) -> None: ...

    def fail(self, error: Exception) -> None: ...


class Transfers:
    """Its public methods are for the thread that draws."""

    def __init__(
        self,
        client: viser.ClientHandle,
        drawing: DrawingThread,
        window: Window,
        workspace: Workspace,
        simulate: Simulate,
    ) -> None:
        self._client, self._drawing, self._window, self._workspace = client, drawing, window, workspace
        self._simulate = simulate
        self._files, self._memory = BackgroundJob(drawing.fail), BackgroundJob(drawing.fail)
        self._profile: tuple[str, bytes] | None = None  # name and content of the last file with a profile

    def take_configuration(self, name: str, content: bytes) -> None:
        """Request the configuration in an uploaded file."""
        try:
            config = configuration(name, content)
        except ConfigError as error:
            self._window.show_faults(f"{name[:60]} cannot be used", error, text_in(content))
        else:
            self._workspace.use_configuration(config)

    def take_profile(self, name: str, content: bytes) -> None:
        """Request the profile in an uploaded file as the road, or ask how the file is to be read."""
        self._begin(partial(self._measure, name, content))

    def ask_about_profile(self) -> None:
        """Ask how the file of the present profile is to be read, if it is one that came by this page."""
        shown = self._drawing.shown
        road = None if shown is None else shown.config.road
        if self._profile is None or not isinstance(road, ProfileRoad) or road.file != self._profile[0]:
            self._window.say(
                "No file here", "Only this profile's points are here. To choose columns, open its file again."
            )
        else:
            self._begin(partial(self._ask, *self._profile, Reading(road.columns, road.units)))

    def use_profile(self, name: str, read: ProfileFile, reading: Reading | None) -> None:
        """Request what was read of a file as the road; reading: how the user wanted it to be read."""
        run = self._drawing.shown
        if run is None:
            return
        try:
            changes = profile_changes(name, read, reading, run.config)
        except ConfigError as error:
            self._window.show_faults(f"{name[:60]} cannot be used", error)
        else:
            self._workspace.change_road(lambda config: changes)
            self._window.say("Another road", f"{name[:60]}: {read.said}.")

    def take_run(self, name: str, content: bytes) -> None:
        """Make the run in an uploaded file the baseline."""
        self._begin(partial(self._unpack, name, content))

    def take_project(self, name: str, content: bytes) -> None:
        """Open the project in an uploaded file."""
        self._begin(partial(self._open, name, content))

    def close(self) -> None:
        """End the jobs."""
        self._files.close()
        self._memory.close()

    def remember(self, state: str) -> None:
        """Have the tab store a text until its page is loaded anew, and the browser until its next visit."""
        self._window.store(state)
        self._client.local_storage.set_item(STORED, state)

    def recollect(self, visit: str) -> None:
        """Let the workspace restore what the tab has stored, or what the browser has if that is nothing."""
        self._memory.start(partial(self._recollect, visit))

    def run_again(self, config: Config) -> None:
        """Make a run of which only the configuration is left, for the workspace. Nothing happens while one is made."""
        self._memory.start(partial(self._run_again, config))

    def _begin(self, job: Callable[[], None]) -> None:
        if not self._files.start(job):
            self._window.say("One at a time", "The last file is still being read. Wait a moment.")

    def _say(self, title: str, body: str) -> None:
        self._drawing.post("said", lambda: self._window.say(title, body))

    # ── On the threads of the jobs ──

    def _recollect(self, visit: str) -> None:
        state, last = _state(visit), self._ask_browser()
        if state is None:
            state = last
        elif last is not None:
            own, others = state.presets, [preset for preset in last.presets if preset not in state.presets]
            state = replace(state, presets=(*others, *own))  # another tab may have saved more presets
        self._drawing.post("restore", lambda: self._workspace.restore(state))

    def _ask_browser(self) -> State | None:
        """What the browser has stored last, from any tab."""
        try:
            stored = self._client.local_storage.get_item(STORED, timeout=STORAGE_PATIENCE)
        except (TimeoutError, RuntimeError) as error:
            log.info("nothing from the browser's storage: %s", error)
            return None
        return None if stored is None else _state(stored)

    def _run_again(self, config: Config) -> None:
        run: Trajectory | None = None
        try:
            run = self._simulate(config, on_progress=lambda part: None, should_stop=self._memory.stopped)
        finally:
            if not self._memory.stopped():
                self._drawing.post("again", lambda: self._workspace.made_again(config, run))

    def _measure(self, name: str, content: bytes) -> None:
        name = " ".join(name.split())
        try:
            found = profile(name, content)
        except ConfigError as error:
            self._refuse(name, error)
            return
        self._profile = name, content
        if isinstance(found, ProfileQuestion):
            self._drawing.post("profile", lambda: self._window.ask_about_profile(found))
        else:
            self._drawing.post("profile", lambda: self.use_profile(name, found, None))

    def _ask(self, name: str, content: bytes, present: Reading) -> None:
        try:
            asked = question(name, content, present)
        except ConfigError as error:
            self._refuse(name, error)
        else:
            self._drawing.post("profile", lambda: self._window.ask_about_profile(asked))

    def _refuse(self, name: str, error: ConfigError) -> None:
        self._drawing.post("faults", lambda: self._window.show_faults(f"{name[:60]} cannot be used", error))

    def _unpack(self, name: str, content: bytes) -> None:
        try:
            run = run_from(name, content)
        except ConfigError as error:
            self._refuse(name, error)
        except ValueError as error:
            self._say("No run", str(error))
        else:
            self._drawing.post("baseline", lambda: self._workspace.take_in(run, name.removesuffix(".npz")))

    def _open(self, name: str, content: bytes) -> None:
        try:
            project = project_from(name, content)
        except ConfigError as error:
            self._refuse(name, error)
            return
        act = partial(self._drawing.post, "project", partial(self._workspace.open_project, project))
        self._drawing.post("ask", lambda: self._ask_or_open(name, act))

    def _ask_or_open(self, name: str, act: Callable[[], None]) -> None:
        """On the thread that draws."""
        lost = self._workspace.at_hand
        if lost:
            self._window.ask(f"Open {name[:60]}?", f"It takes the place of {lost}. Your presets stay.", "Open", act)
        else:
            act()


def _state(text: str) -> State | None:
    """What a stored text says, if it is a state at all."""
    try:
        return state_from(text)
    except ValueError as error:
        log.info("nothing stored can be used: %s", error)
        return None
