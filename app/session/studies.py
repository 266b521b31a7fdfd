"""The runs behind the tab "Study", by idle time: when the user rests, beside nothing that hurries.

A study is given up at once when a newer request has come. While a run plays, its runs are made one at a time, with as
long a pause behind each; in a drive, in a page in the background, and while nobody looks, there are none.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from functools import partial
from time import perf_counter
from typing import Any

from app.plots.study_data import Data
from app.runs.study_choice import StudyChoice
from app.runs.turns import COMPUTING, STUDYING
from app.session.background import BackgroundJob
from app.session.study_work import Means, Situation, StudyWork
from model.config.config import Config
from model.simulation.batch import in_order
from model.study.running import Job, Outcome, outcome

REST = 0.3  # s without a change after which the user rests
BLOCK = 4  # runs for each core between two looks at who else wants to compute
HELD_BACK = 0.02  # s between two looks while somebody else computes


class GivenUpError(Exception):
    """What was computed is not wanted any more."""


Show = Callable[[str, Data], None]  # kind of data, and the data: to be called on any thread


class Studies:
    """`tick` is for the thread that draws; it alone begins and stops studies."""

    def __init__(
        self,
        presets: Mapping[str, Config],
        newest: Callable[[], int],
        plays: Callable[[], bool],
        show: Show,
        on_error: Callable[[Exception], None],
        run: Callable[..., Outcome] = outcome,
    ) -> None:
        """presets: those that come with the program, for command lines; newest: number of the newest request; plays:
        whether a run plays. Both are asked on any thread."""
        self._newest, self._plays, self._show, self._run = newest, plays, show, run
        self._work = StudyWork(presets)
        self._job = BackgroundJob(on_error)
        self._seen = -1  # number of the newest request, as it was seen last …
        self._since = 0.0  # … and since when, monotonic s
        self._studied: tuple[object, ...] | None = None  # what the last study is, or was, about
        self._ended = True  # it came to its end
        self.choice = StudyChoice()

    def tick(self, now: float, situation: Situation) -> None:
        """Begin a study, or give one up; `now`, s. To be called several times a second."""
        if situation.number != self._seen:
            self._seen, self._since = situation.number, now
            self._begin_anew()  # also when it leads to what is shown: the page may have gone ahead
        if situation.hurries and not self._ended:
            self._begin_anew()
        about = self._about(situation)
        if about != self._studied:
            self._begin_anew()
        rested = not situation.touched or now - self._since >= REST
        settled = situation.number == situation.shown and not situation.hurries
        if about is None or about == self._studied or not (rested and settled) or self._job.busy:
            return
        self._studied, self._ended = about, False
        self._job.start(partial(self._do, situation, self.choice))

    @property
    def busy(self) -> bool:
        """Whether a study is under way."""
        return self._job.busy

    def close(self) -> None:
        self._job.close()

    def _begin_anew(self) -> None:
        """Give up what is under way, and study again when it is time for that."""
        self._job.stop()
        self._studied = None

    def _about(self, situation: Situation) -> tuple[object, ...] | None:
        """What is to be studied; None: nothing."""
        if situation.config is None or not (situation.front or self.choice.strips):
            return None
        shown = self.choice if situation.front else replace(self.choice, view="")
        return situation.config, situation.baseline, situation.front, situation.record, situation.units, shown

    # ── On the thread of the job ──

    def _do(self, situation: Situation, choice: StudyChoice) -> None:
        assert situation.config is not None
        given_up = lambda: self._job.stopped() or self._newest() != situation.number  # noqa: E731
        try:
            spread = partial(self._spread, given_up)
            means = Means(lambda jobs: list(spread(partial(self._one, given_up), jobs)), spread, self._show)
            for kind, data in self._work.of(situation, choice, means):
                if given_up():
                    return
                self._show(kind, data)
            self._ended = True
        except GivenUpError:
            pass

    def _spread(self, given_up: Callable[[], bool], work: Callable[[Any], Any], items: Iterable[Any]) -> list[Any]:
        """What work makes of each item, with room for all who hurry. Raises GivenUpError."""
        waiting: list[Any] = list(items)
        found: list[Any] = []
        while waiting:
            while COMPUTING.busy and not given_up():
                self._job.pause(HELD_BACK)
            if given_up():
                raise GivenUpError
            calm = not self._plays()
            cores = (os.cpu_count() or 1) if calm else 1
            block = waiting[: BLOCK * cores if calm else 1]
            began = perf_counter()
            with STUDYING.turn():
                found += in_order(work, block, cores)
            del waiting[: len(block)]
            if not calm:
                self._job.pause(perf_counter() - began)
        return found

    def _one(self, given_up: Callable[[], bool], job: Job) -> Outcome:
        if given_up():
            raise GivenUpError
        found = self._run(*job, should_stop=given_up)
        if given_up():
            raise GivenUpError
        return found
