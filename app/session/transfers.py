"""Uploads of one tab, and what its browser stores; the work is done in background jobs."""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Protocol

import viser

from app.files.uploads import configuration, profile_changes, run_from
from app.runs.project import project_from
from app.runs.request import Simulate
from app.runs.storage import State, state_from
from app.session.background import BackgroundJob
from app.session.window import Window
from app.session.workspace import Workspace
from model.config.config import Config, ConfigError
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

    def take_configuration(self, name: str, content: bytes) -> None:
        """Request the configuration in an uploaded file."""
        try:
            config = configuration(name, content)
        except ConfigError as error:
            self._window.show_faults(f"{name[:60]} cannot be used", error)
        else:
            self._workspace.use_configuration(config)

    def take_profile(self, name: str, content: bytes) -> None:
        """Request the profile in an uploaded file as the road."""
        self._begin(partial(self._measure, name, content))

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
        run = self._drawing.shown
        if run is None:
            return
        try:
            changes, said = profile_changes(name, content, run.config)
        except ConfigError as error:
            faults = error
            self._drawing.post("faults", lambda: self._window.show_faults(f"{name[:60]} cannot be used", faults))
            return
        self._drawing.post("profile", lambda: self._workspace.change_road(lambda config: changes))
        self._say("Another road", f"{name[:60]}: {said}.")

    def _unpack(self, name: str, content: bytes) -> None:
        try:
            run = run_from(name, content)
        except ConfigError as error:
            faults = error
            self._drawing.post("faults", lambda: self._window.show_faults(f"{name[:60]} cannot be used", faults))
        except ValueError as error:
            self._say("No run", str(error))
        else:
            self._drawing.post("baseline", lambda: self._workspace.take_in(run, name.removesuffix(".npz")))

    def _open(self, name: str, content: bytes) -> None:
        try:
            project = project_from(name, content)
        except ConfigError as error:
            faults = error
            self._drawing.post("faults", lambda: self._window.show_faults(f"{name[:60]} cannot be opened", faults))
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
