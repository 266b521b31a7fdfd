"""Work beside the runs, on threads that live as long as there is some: files to send, files that came in, studies."""

from __future__ import annotations

import threading
from collections.abc import Callable
from itertools import count
from time import monotonic

PATIENCE = 1.0  # s to wait at closing for a browser that still draws; viser ends that when the tab is gone


class BackgroundJob:
    """At most one job. Its methods are for one thread; `stopped` may be asked on any."""

    def __init__(self, on_error: Callable[[Exception], None]) -> None:
        """on_error: called, on the job's thread, with an exception that a job did not catch."""
        self._on_error = on_error
        self._thread: threading.Thread | None = None
        self._stop = threading.Event()

    @property
    def busy(self) -> bool:
        return self._thread is not None and self._thread.is_alive()

    def start(self, job: Callable[[], None]) -> bool:
        """Begin a job; False, and nothing is begun, while there is another one."""
        if self.busy:
            return False
        self._stop.clear()
        thread = threading.Thread(target=self._do, args=(job,), name="trackride-job", daemon=True)
        thread.start()
        self._thread = thread  # not before: a tab may be closed, on another thread, at any moment
        return True

    def stop(self) -> None:
        """Ask the job to end early."""
        self._stop.set()

    def stopped(self) -> bool:
        """Whether the job is to end early."""
        return self._stop.is_set()

    def pause(self, seconds: float) -> None:
        """In a job: wait so long, s, or until it is to end early."""
        self._stop.wait(seconds)

    def close(self) -> None:
        """Stop the job and wait for its end, but not long."""
        self.stop()
        if self._thread is not None:
            self._thread.join(PATIENCE)

    def _do(self, job: Callable[[], None]) -> None:
        try:
            job()
        except Exception as error:
            self._on_error(error)


class Job:
    """Work that may wait for its turn in a JobQueue. Whoever does it tells how far it has come."""

    _numbers = count(1)

    def __init__(self, title: str, work: Callable[[Job], None]) -> None:
        """title: what is made, as the user reads it; work: gets this job, is called on the queue's thread."""
        self.number, self.title, self._work = next(self._numbers), title, work
        self.since = monotonic()  # s, when it was asked for
        self.begun = False
        self.part: float | None = None  # 0…1 that is done; None: nobody knows
        self.note = ""  # more that the user may want to know of it
        self._stop = threading.Event()

    def stop(self) -> None:
        """Ask for its early end."""
        self._stop.set()

    def stopped(self) -> bool:
        """Whether it is to end early."""
        return self._stop.is_set()

    def tell(self, part: float, note: str = "") -> None:
        """Say how much of it is done, 0…1."""
        self.part, self.note = part, note

    def do(self) -> None:
        self.begun = True
        self._work(self)


class JobQueue:
    """Jobs one after the other. Its methods may be called on any thread."""

    def __init__(self, on_error: Callable[[Exception], None]) -> None:
        """on_error: called, on the queue's thread, with an exception that a job did not catch."""
        self._on_error = on_error
        self._lock = threading.Lock()  # of the next two
        self._jobs: list[Job] = []  # the first one is under way
        self._thread: threading.Thread | None = None  # None: there is nothing to do

    @property
    def jobs(self) -> tuple[Job, ...]:
        """Those that are not done, the one that is under way first."""
        with self._lock:
            return tuple(self._jobs)

    def add(self, job: Job) -> None:
        """Do this after all others."""
        with self._lock:
            self._jobs.append(job)
            if self._thread is None:
                self._thread = threading.Thread(target=self._do, name="trackride-job", daemon=True)
                self._thread.start()

    def stop(self, number: int) -> None:
        """Take the job of this number out of the queue, or ask for its end if it is under way."""
        with self._lock:
            for job in self._jobs:
                if job.number == number:
                    job.stop()
            self._jobs[1:] = [job for job in self._jobs[1:] if not job.stopped()]

    def close(self) -> None:
        """Stop all jobs and wait for the end of the one that is under way, but not long."""
        with self._lock:
            for job in self._jobs:
                job.stop()
            del self._jobs[1:]
            thread = self._thread
        if thread is not None:
            thread.join(PATIENCE)

    def _do(self) -> None:
        while True:
            with self._lock:
                if not self._jobs:
                    self._thread = None
                    return
                job = self._jobs[0]
            try:
                if not job.stopped():
                    job.do()
            except Exception as error:
                self._on_error(error)
            with self._lock:
                del self._jobs[0]
