"""Downloads of one tab: files made of what is shown, one after the other, in jobs beside the runs.

There are two queues, so that what the browser has to draw (pictures, movies), which can take minutes, holds up nothing
that the server makes alone.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from time import monotonic
from typing import NamedTuple, Protocol

import numpy as np
import viser

from app.files.movie_frames import RATE, MovieChoice, movie_frames, movie_times, stamp_text, stamped
from app.files.pictures import FIGURE_SIZE, NoPictureError, take_picture
from app.format.file_names import file_name
from app.panels.export_list import ExportLine
from app.panels.files_panel import PICTURE
from app.plots.curves import Beside
from app.runs.drive import DriveState
from app.runs.history import run_name
from app.runs.project import Project, project_text
from app.runs.request import Request
from app.session.background import Job, JobQueue
from app.session.window import InView, Window
from model.analysis.channels import run_csv
from model.config.config_files import dump_config
from model.simulation.trajectory import Trajectory

AT_REST = ("figure.png", "figure.svg", "replay", "movie")  # these show one stretch of a drive and take a while to make
PAUSE_FIRST = "Pause the drive first (Space): what is shown then, its last seconds, is what you download."
NO_REPORT = "A report is of a run from its start. Change from Drive to Run first."
NO_RUN = "A drive cannot be repeated from a file as a run can. Take CSV, or change from Drive to Run first."
MOST = 20  # exports that are not done, at most
MEASURED = 5  # frames of a movie after which it is said how long the others will take
SHOWN_AFTER = 0.4  # s from asking for an export until it gets a line: most are done by then

log = logging.getLogger("trackride")


class DrawingThread(Protocol):
    """The thread that draws, as any other thread reaches it: app.session.session.Session, or a stand-in."""

    def post(self, kind: str, act: Callable[[], None]) -> None: ...

    def show_now(self, act: Callable[[], None]) -> None: ...

    def fail(self, error: Exception) -> None: ...


@dataclass(frozen=True)
class Download:
    """What a download is made of, as it was when the user asked for it."""

    request: Request
    run: Trajectory
    baseline: Trajectory | None
    beside: tuple[Beside, ...]
    size: tuple[int, int]  # px, of a picture or a movie
    transparent: bool
    background: str  # CSS
    dark: bool
    movie: MovieChoice
    channels: tuple[str, ...]  # of a CSV file
    time: float  # where in the run the playback is, s
    drive: DriveState | None  # `run` is its past
    mode_shown: bool  # a mode swings in the place of the run

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
    def baseline_title(self) -> str:
        """What was changed in it; empty without one."""
        return "" if self.baseline is None else run_name(self.request.base, self.baseline.config)

    @property
    def in_view(self) -> InView:
        """What the 3-D view shows."""
        drive = self.drive
        run, road = (self.run, None) if drive is None else (drive.recent, drive.road)
        return InView(run, road, self.baseline, self.beside)

    @property
    def stretch(self) -> str:
        """Which part of a drive it is; empty for a run."""
        return "" if self.drive is None else f"drive {self.run.t[0]:.0f}–{self.run.t[-1]:.0f} s"

    @property
    def refusal(self) -> Mapping[str, str]:
        """Which files cannot be made now, and why."""
        if self.drive is None:
            return {}
        return {"run.npz": NO_RUN, "report": NO_REPORT} | (
            {} if self.drive.stands else dict.fromkeys(AT_REST, PAUSE_FIRST)
        )


class StoppedError(Exception):
    """No file was made, since the user wants it no longer."""


class Export(NamedTuple):
    """A kind of file."""

    title: str  # as its line in the list of exports says
    queue: JobQueue
    make: Callable[[Download, Job], tuple[str, bytes]]  # name and content


class Downloads:
    """Its public methods are for the thread that draws."""

    def __init__(self, client: viser.ClientHandle, drawing: DrawingThread, window: Window) -> None:
        self._client, self._drawing, self._window = client, drawing, window
        drawn, made = self._queues = JobQueue(drawing.fail), JobQueue(drawing.fail)
        self._exports = {  # by what the panels ask for
            PICTURE: Export("Screenshot", drawn, self._picture),
            "figure.png": Export("Figure (PNG)", drawn, partial(self._figure, ".png")),
            "figure.svg": Export("Figure (SVG)", drawn, partial(self._figure, ".svg")),
            "movie": Export("Movie", drawn, self._movie),
            "run.csv": Export("CSV", made, self._csv),
            "run.npz": Export("NPZ", made, self._npz),
            "yaml": Export("YAML", made, self._yaml),
            "replay": Export("Replay", made, self._replay),
            "report": Export("Report", made, self._report),
        }

    def send(self, what: str, download: Download) -> None:
        """Make a file, once those before it are made, and let the browser download it."""
        if what in download.refusal:
            self._window.say("Nothing was downloaded", download.refusal[what])
        else:
            title, queue, make = self._exports[what]
            self._add(queue, title, partial(make, download))

    def send_project(self, name: str, project: Project) -> None:
        """Let the browser download a project."""
        self._add(self._queues[1], "Project", lambda job: (name, project_text(project).encode()))

    def _add(self, queue: JobQueue, title: str, make: Callable[[Job], tuple[str, bytes]]) -> None:
        if sum(len(queue.jobs) for queue in self._queues) >= MOST:
            self._window.say("Enough for now", f"{MOST} files are being made. Cancel some, or wait a moment.")
        else:
            queue.add(Job(title, partial(self._deliver, make)))

    def cancel(self, number: int) -> None:
        """Make the file of this job no more."""
        for queue in self._queues:
            queue.stop(number)

    def tick(self, now: float) -> None:
        """Show how far each file has come; `now`, monotonic s. To be called several times a second."""
        jobs = sorted((job for queue in self._queues for job in queue.jobs), key=lambda job: job.number)
        self._window.exports.show([_line(job) for job in jobs if now - job.since >= SHOWN_AFTER])

    def close(self) -> None:
        """End the jobs; wait for them, but not long for a browser that still draws a picture."""
        for queue in self._queues:
            queue.close()

    # ── On the threads of the queues ──

    def _deliver(self, make: Callable[[Job], tuple[str, bytes]], job: Job) -> None:
        try:
            name, content = make(job)
            if job.stopped():
                raise StoppedError
            self._client.send_file_download(name, content, save_immediately=True)
        except NoPictureError as error:
            log.info("no picture: %s", error)
            self._say("No picture", str(error))
        except StoppedError:
            self._say("Nothing was downloaded", f"{job.title} was cancelled.")

    def _say(self, title: str, body: str) -> None:
        self._drawing.post("said", lambda: self._window.say(title, body))

    @contextmanager
    def _held(self, download: Download) -> Iterator[None]:
        """Meanwhile the 3-D view stands where it stood when the user asked for the download."""
        if download.mode_shown and self._window.shows_mode:
            yield
            return
        self._drawing.show_now(partial(self._window.hold_view, download.in_view, download.time))
        try:
            yield
        finally:
            self._drawing.post("release", self._window.release_view)

    def _picture(self, download: Download, job: Job) -> tuple[str, bytes]:
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

    def _figure(self, suffix: str, download: Download, job: Job) -> tuple[str, bytes]:
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

    def _csv(self, download: Download, job: Job) -> tuple[str, bytes]:
        run = download.run if download.drive is None else download.drive.past_from_start
        return download.name("", ".csv"), run_csv(run, download.channels)

    def _npz(self, download: Download, job: Job) -> tuple[str, bytes]:
        return download.name("", ".npz"), download.run.to_bytes(".npz")

    def _yaml(self, download: Download, job: Job) -> tuple[str, bytes]:
        return download.name("", ".yaml"), dump_config(download.run.config).encode()

    def _replay(self, download: Download, job: Job) -> tuple[str, bytes]:
        from app.files.replay import replay_html

        road = None if download.drive is None else download.drive.road
        page = replay_html(
            download.run,
            download.baseline,
            download.title,
            download.dark,
            should_stop=job.stopped,
            road=road,
            baseline_title=download.baseline_title,
        )
        if page is None:
            raise StoppedError
        return download.name("replay", ".html"), page.encode()

    def _report(self, download: Download, job: Job) -> tuple[str, bytes]:
        from app.reports.run_report import report_page  # here: matplotlib takes a second to load

        def go_on(part: float) -> None:
            if job.stopped():
                raise StoppedError
            job.tell(part)

        page = report_page(download.run, download.title, download.baseline, go_on)
        return download.name("report", ".html"), page.encode()

    def _movie(self, download: Download, job: Job) -> tuple[str, bytes]:
        from app.files.movie import movie

        with self._held(download):
            film, suffix = movie(self._watched(download, job), RATE)
        return download.name("", suffix), film

    def _watched(self, download: Download, job: Job) -> Iterator[np.ndarray]:
        """The frames of a movie, as long as the user wants them."""
        times = movie_times(*download.movie.stretch(download.run, download.time))

        def show(time: float) -> None:
            self._drawing.show_now(lambda: self._window.film(time))

        began = monotonic()
        for number, frame in enumerate(movie_frames(self._client, show, times, download.size), 1):
            if job.stopped():
                raise StoppedError
            left = (len(times) - number) * (monotonic() - began) / number
            job.tell(number / len(times), duration_words(left) if MEASURED <= number < len(times) else "")
            title = download.run.config.name
            yield (
                stamped(frame, stamp_text(download.run, times[number - 1], title)) if download.movie.stamped else frame
            )


def _line(job: Job) -> ExportLine:
    if not job.begun:
        how = "waits for its turn"
    elif job.stopped():
        how = "ends"
    elif job.part is None:
        how = "under way"
    else:
        how = f"{100 * job.part:.0f} %" + (f", {job.note}" if job.note else "")
    return ExportLine(job.number, f"{job.title}: {how}")


def duration_words(seconds: float) -> str:
    """ "about 3 min left"."""
    return f"about {seconds / 60:.0f} min left" if seconds >= 90 else f"about {max(round(seconds), 1)} s left"
