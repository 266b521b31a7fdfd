"""One job at a time beside the runs, on a thread that lives as long as the job: files to send, files that came in."""

from __future__ import annotations

import threading
from collections.abc import Callable

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
