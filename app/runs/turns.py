"""Who works when there are many tabs: a few at a time, each for a short while, in the order in which they came.

All at once they would hinder each other: threads that compute take the processor from the one that holds Python's lock.
"""

from __future__ import annotations

import os
import threading
from collections import deque
from collections.abc import Iterator
from contextlib import contextmanager

LONGEST_WAIT = 1.0  # s; then there is one more at work, so that one who takes long does not stop all others


class Turns:
    """For any thread."""

    def __init__(self, places: int, longest_wait: float = LONGEST_WAIT) -> None:
        """places: how many work at a time; longest_wait: s."""
        self._places, self._longest_wait = places, longest_wait
        self._lock = threading.Lock()  # of the next two
        self._free = places  # negative: that many more are at work
        self._waiting: deque[threading.Lock] = deque()  # each is released when its turn has come

    @contextmanager
    def turn(self) -> Iterator[None]:
        """Wait for a place, and have it meanwhile."""
        self._enter()
        try:
            yield
        finally:
            self._leave()

    @property
    def busy(self) -> bool:
        """Whether anybody is at work."""
        return self._free < self._places

    def pass_on(self) -> None:
        """In a turn: let those who wait go first."""
        if self._waiting:
            self._leave()
            self._enter()

    def _enter(self) -> None:
        with self._lock:
            if self._free > 0:
                self._free -= 1
                return
            mine = threading.Lock()
            mine.acquire()
            self._waiting.append(mine)
        if not mine.acquire(timeout=self._longest_wait):
            with self._lock:
                if mine in self._waiting:
                    self._waiting.remove(mine)
                    self._free -= 1

    def _leave(self) -> None:
        with self._lock:
            if self._free < 0 or not self._waiting:
                self._free += 1
            else:
                self._waiting.popleft().release()


COMPUTING = Turns(max((os.cpu_count() or 1) - 1, 1))  # runs; one core is left to those who show them
STUDYING = Turns(1)  # to do some runs of a study, on all cores, while nobody else computes
SHOWING = Turns(1)  # to put a run, or an instant of it, onto a page is work in Python, which does one thing at a time
