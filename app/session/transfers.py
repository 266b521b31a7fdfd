"""Downloads and uploads of one tab, and what its browser stores; the work is done in background jobs."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import partial
from typing import Protocol

import numpy as np
import viser

from app.files.pictures import FIGURE_SIZE, MOVIE_LENGTH, MOVIE_RATE, NoPictureError, movie_frames, take_picture
from app.files.uploads import ProfileQuestion, configuration, profile, profile_changes, question, run_from, text_in
from app.format.file_names import file_name
from app.panels.files_panel import PICTURE
from app.runs.drive import DriveState
from app.runs.history import run_name
from app.runs.request import Request, Simulate
from app.runs.storage import State, state_from
from app.session.background import BackgroundJob
from app.session.window import Window
from app.session.workspace import Workspace
from model.config.config import Config, ConfigError, ProfileRoad
from model.config.config_files import dump_config
from model.config.profile_files import ProfileFile, Reading
from model.simulation.trajectory import Trajectory

AT_REST = ("figure.png", "figure.svg", "replay", "movie")  # these show one stretch of a drive and take a while to make
PAUSE_FIRST = "Pause the drive first (Space): what is shown then, its last seconds, is what you download."
NO_RUN = "A drive cannot be repeated from a file as a run can. Take CSV, or change from Drive to Run first."
STORED = "trackride"  # key in the browser's storage
STORAGE_PATIENCE = 60.0  # s that a browser has to tell what it has stored; after that we overwrite it

log = logging.getLogger("trackride")


class DrawingThread(Protocol):
    """The thread that draws, as any other thread reaches it: app.session.session.Session, or a stand-in."""

    @property
    def shown(self) -> Trajectory | None: ...

    def post(self, kind: str, act: Callable[[], None]) -> None: ...

    def show_now(self, act: Callable[[], None]) -> None: ...

    def seek(self, time: float) -> None: ...

    def toggle(self) -> None: ...

    def fail(self, error: Exception) -> None: ...


@dataclass(frozen=True)
class Download:
    """What a download is made of, as it was when the user asked for it."""

    request: Request
    run: Trajectory
    baseline: Trajectory | None
    size: tuple[int, int]  # px, of a picture
    transparent: bool
    background: str  # CSS
    dark: bool
    time: float  # where in the run the playback is, s
    playing: bool
    drive: DriveState | None  # `run` is its past

    def name(self, detail: str, suffix: str) -> str:
        """A name for the file."""
        stretch = f"{detail} {self.stretch}".strip()
        return file_name(self.run.config, self.request.base.name, self.request.changes, stretch, suffix)

    @property
    def title(self) -> str:
        """A title for a page: what was run, and what was changed."""
        name = run_name(self.request.base, self.run.config)
        whole = name if name == self.request.base.name else f"{self.request.base.name}: {name}"
        return f"{whole}, {self.stretch}" if self.stretch else whole

    @property
    def stretch(self) -> str:
        """Which part of a drive it is; empty for a run."""
        return "" if self.drive is None else f"drive {self.run.t[0]:.0f}–{self.run.t[-1]:.0f} s"

    @property
    def refusal(self) -> Mapping[str, str]:
        """Which files cannot be made now, and why."""
        if self.drive is None:
            return {}
        return {"run.npz": NO_RUN} | ({} if self.drive.stands else dict.fromkeys(AT_REST, PAUSE_FIRST))


class StoppedError(Exception):
    """No file was made; the message says why."""


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
        self._makers: dict[str, tuple[str, Callable[[Download], tuple[str, bytes]]]] = {
            PICTURE: ("", self._picture),
            "figure.png": ("Drawing the figure…", partial(self._figure, ".png")),
            "figure.svg": ("Drawing the figure…", partial(self._figure, ".svg")),
            "run.csv": ("", partial(self._run, ".csv")),
            "run.npz": ("", partial(self._run, ".npz")),
            "yaml": ("", self._yaml),
            "replay": ("Recording the replay…", self._replay),
            "movie": ("Filming…", self._movie),
        }

    def send(self, what: str, download: Download) -> None:
        """Make a file, and let the browser download it."""
        if what in download.refusal:
            self._window.say("Nothing was downloaded", download.refusal[what])
            return
        doing, make = self._makers[what]
        self._begin(partial(self._deliver, doing, partial(make, download)))

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

    def stop(self) -> None:
        """Stop making the file that is under way."""
        self._files.stop()

    def close(self) -> None:
        """End the jobs; wait for them, but not long for a browser that still draws a picture."""
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
            self._window.say("One at a time", "The last file is still being made. Cancel it, or wait a moment.")

    def _say(self, title: str, body: str) -> None:
        self._drawing.post("said", lambda: self._window.say(title, body))

    def _tell(self, doing: str) -> None:
        self._drawing.post("progress", lambda: self._window.show_progress(doing))

    # ── Out: on the thread of the job ──

    def _deliver(self, doing: str, make: Callable[[], tuple[str, bytes]]) -> None:
        if doing:
            self._tell(doing)
        try:
            self._client.send_file_download(*make(), save_immediately=True)
        except NoPictureError as error:
            log.info("no picture: %s", error)
            self._say("No picture", str(error))
        except StoppedError as error:
            self._say("Nothing was downloaded", str(error))
        finally:
            if doing:
                self._tell("")

    @contextmanager
    def _held(self, download: Download) -> Iterator[None]:
        """Meanwhile a run that plays stands at the time of the download, so that the picture shows that moment."""
        if not download.playing or download.drive is not None:
            yield
            return
        self._drawing.seek(download.time)
        try:
            yield
        finally:
            self._drawing.toggle()

    def _picture(self, download: Download) -> tuple[str, bytes]:
        if download.transparent:
            self._drawing.show_now(lambda: self._window.show_surroundings(False))
        try:
            with self._held(download):
                background = None if download.transparent else download.background
                picture = take_picture(self._client, *download.size, background)
        finally:
            if download.transparent:
                self._drawing.post("surroundings", lambda: self._window.show_surroundings(True))
        return download.name("x".join(map(str, download.size)), ".png"), picture

    def _figure(self, suffix: str, download: Download) -> tuple[str, bytes]:
        from app.reports.sheet import stamped_figure  # here: matplotlib takes a second to load

        try:
            with self._held(download):
                picture = take_picture(self._client, *FIGURE_SIZE, "white")
        except NoPictureError:
            if download.drive is not None:
                raise  # the drawing in its place would show the road of a run, not of the drive
            picture = None
        page = stamped_figure(download.run, download.baseline, picture, download.title, suffix, download.time)
        return download.name("figure", suffix), page

    def _run(self, suffix: str, download: Download) -> tuple[str, bytes]:
        run = download.run if download.drive is None else download.drive.past_from_start
        return download.name("", suffix), run.to_bytes(suffix)

    def _yaml(self, download: Download) -> tuple[str, bytes]:
        return download.name("", ".yaml"), dump_config(download.run.config).encode()

    def _replay(self, download: Download) -> tuple[str, bytes]:
        from app.files.replay import replay_html

        road = None if download.drive is None else download.drive.road
        page = replay_html(
            download.run, download.baseline, download.title, download.dark, should_stop=self._files.stopped, road=road
        )
        if page is None:
            raise StoppedError("The replay was cancelled.")
        return download.name("replay", ".html"), page.encode()

    def _movie(self, download: Download) -> tuple[str, bytes]:
        from app.files.movie import movie

        first, last = float(download.run.t[0]), float(download.run.t[-1])
        start = max(min(download.time, last - MOVIE_LENGTH), first)
        try:
            film, suffix = movie(self._watched(download.run, start, min(start + MOVIE_LENGTH, last)), MOVIE_RATE)
        finally:
            self._drawing.seek(download.time)
            if download.playing:
                self._drawing.toggle()
        return download.name("", suffix), film

    def _watched(self, run: Trajectory, start: float, end: float) -> Iterator[np.ndarray]:
        """The frames of a movie, as long as the run is shown and the user wants them."""
        frames = movie_frames(self._client, self._drawing.seek, start, end)
        for number, frame in enumerate(frames, 1):
            if self._files.stopped():
                raise StoppedError("The movie was cancelled.")
            if self._drawing.shown is not run:
                raise StoppedError("The run changed while it was filmed. Leave it alone until the movie is done.")
            self._tell(f"Filming… {100 * number * (1 / MOVIE_RATE) / (end - start):.0f} %")
            yield frame

    # ── In: on the thread of the job ──

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


def _state(text: str) -> State | None:
    """What a stored text says, if it is a state at all."""
    try:
        return state_from(text)
    except ValueError as error:
        log.info("nothing stored can be used: %s", error)
        return None
