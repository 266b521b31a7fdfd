"""Errors of the same kind, such as those that a page sends again and again, fill no log: one in a while is enough."""

from __future__ import annotations

import logging
from collections.abc import Callable, Hashable
from time import monotonic

SAME_ERROR = 5.0  # s before an error of the same kind is logged and shown again


def kind_of(error: BaseException) -> Hashable:
    """Errors of the same type from the same line are of one kind, whatever their texts say."""
    trace = error.__traceback__
    while trace is not None and trace.tb_next is not None:
        trace = trace.tb_next
    return type(error), trace and (trace.tb_frame.f_code.co_filename, trace.tb_lineno)


class Seldom:
    """Lets one of each kind pass in SAME_ERROR seconds. For any thread; where two use it at once, both may pass."""

    def __init__(self, clock: Callable[[], float] = monotonic) -> None:
        """clock: s."""
        self._clock = clock
        self._passed: dict[Hashable, tuple[float, int]] = {}  # kind -> when one passed last, how many have not since

    def passes(self, kind: Hashable) -> int | None:
        """How many of this kind were held back before this one; None: this one is held back too."""
        now = self._clock()
        last, held = self._passed.get(kind, (float("-inf"), 0))
        passes = now - last >= SAME_ERROR
        self._passed[kind] = (now, 0) if passes else (last, held + 1)
        return held if passes else None


class Throttle(logging.Filter):
    """For loggers: lets an error of each kind pass once in a while, with the number of those that did not."""

    def __init__(self, clock: Callable[[], float] = monotonic) -> None:
        """clock: s."""
        super().__init__()
        self._seldom = Seldom(clock)

    def filter(self, record: logging.LogRecord) -> bool:
        if record.levelno < logging.WARNING:
            return True
        error = record.exc_info[1] if record.exc_info else None
        held = self._seldom.passes(kind_of(error) if error else (record.pathname, record.lineno))
        if held:
            record.msg, record.args = f"{record.getMessage()} ({held} more of this kind were left out)", None
        return held is not None
