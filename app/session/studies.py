"""The runs behind the tab "Study", by idle time: when the user rests, beside nothing that hurries.

A study is given up at once when a newer request has come. While a run plays, its runs are made one at a time, with as
long a pause behind each; in a drive, in a page in the background, and while nobody looks, there are none.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from time import perf_counter

from app.format.command_line import Source
from app.format.load_unit import load_unit
from app.plots.study_data import Data, map_command, map_data, profile_commands, profile_data
from app.runs.study_choice import COLUMNS, MAP, PROFILER, WHAT_IF, StudyChoice, figures_of, keys_of
from app.runs.turns import COMPUTING, STUDYING
from app.session.background import BackgroundJob
from model.config.config import Config
from model.config.parameters import Value
from model.dynamics.vehicle import build_system
from model.simulation.batch import in_order
from model.study.figure_map import figure_maps
from model.study.profiler import LEVELS, Found, Profile, axis_of, profiles
from model.study.running import Evaluate, Job, Outcome, outcome

REST = 0.3  # s without a change after which the user rests
BLOCK = 4  # runs for each core between two looks at who else wants to compute
HELD_BACK = 0.02  # s between two looks while somebody else computes


class GivenUpError(Exception):
    """What was computed is not wanted any more."""


@dataclass(frozen=True)
class Situation:
    """What decides whether there may be a study, and of what."""

    number: int  # of the newest request
    shown: int  # of the request whose run is shown
    touched: bool  # the user has moved a control and may still move it
    config: Config | None  # of the run that is shown; None: no run
    baseline: Config | None
    front: bool  # the tab "Study" is seen
    hurries: bool  # a drive, a page in the background, or a run under way


Show = Callable[[str, Data], None]  # kind of data, and the data: to be called on any thread
Work = Iterator[tuple[str, Data]]


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
        self._presets, self._newest, self._plays, self._show, self._run = presets, newest, plays, show, run
        self._job = BackgroundJob(on_error)
        self._found = Found()
        self._seen = -1  # number of the newest request, as it was seen last …
        self._since = 0.0  # … and since when, monotonic s
        self._studied: tuple[object, ...] | None = None  # what the last study is, or was, about
        self._ended = True  # it came to its end
        self._mapped: tuple[object, ...] = ()  # what the last map is of …
        self._map_known: dict[tuple[Value, Value], Outcome] = {}  # … and its outcomes
        self.choice = StudyChoice()

    def tick(self, now: float, situation: Situation) -> None:
        """Begin a study, or give one up; `now`, s. To be called several times a second."""
        if situation.number != self._seen:
            self._seen, self._since = situation.number, now
            self._give_up()
        if situation.hurries:
            self._give_up()
        about = self._about(situation)
        if about != self._studied:
            self._job.stop()
            self._studied = None
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

    def _give_up(self) -> None:
        """What is under way; it may begin again."""
        if not self._ended:
            self._job.stop()
            self._studied = None

    def _about(self, situation: Situation) -> tuple[object, ...] | None:
        """What is to be studied; None: nothing."""
        if situation.config is None or not (situation.front or self.choice.strips):
            return None
        shown = self.choice if situation.front else replace(self.choice, view="")
        return situation.config, situation.baseline, situation.front, shown

    # ── On the thread of the job ──

    def _do(self, situation: Situation, choice: StudyChoice) -> None:
        assert situation.config is not None
        given_up = lambda: self._job.stopped() or self._newest() != situation.number  # noqa: E731
        try:
            for kind, data in self._work(situation, choice, partial(self._evaluate, given_up)):
                if given_up():
                    return
                self._show(kind, data)
            self._ended = True
        except GivenUpError:
            pass

    def _work(self, situation: Situation, choice: StudyChoice, evaluate: Evaluate) -> Work:
        """What is to be shown, one after the other."""
        assert situation.config is not None
        base, baseline, view = situation.config, situation.baseline, choice.view if situation.front else ""
        if view == PROFILER or choice.strips:
            yield from self._profile(base, baseline, choice, view == PROFILER, evaluate)
        if view == MAP:
            yield from self._map(base, choice, evaluate)

    def _profile(
        self,
        base: Config,
        baseline: Config | None,
        choice: StudyChoice,
        whole: bool,
        evaluate: Evaluate,
    ) -> Work:
        """The profile, and that of the baseline; whole: finer than the strips on the sliders need it."""
        columns, rows = keys_of(choice.columns, base), figures_of(choice.rows, base)
        strips = keys_of(WHAT_IF, base)
        axes = [axis for key in dict.fromkeys((*columns, *strips)) if (axis := axis_of(base, key)) is not None]
        figures = figures_of((*choice.rows, choice.figure), base)
        (chosen,) = figures_of([choice.figure], base)
        source, loads = Source(base, self._presets), load_unit(build_system(base))

        def told(profile: Profile, other: Profile | None) -> tuple[str, Data]:
            data = profile_data(profile, other, loads, rows, columns)
            commands = profile_commands(profile, source, rows, columns)
            return PROFILER, data | {"commands": commands, "note": source.note, "figure": chosen}

        latest: Profile | None = None
        other: Profile | None = None
        for latest in profiles(base, axes, figures, evaluate, self._found, LEVELS if whole else LEVELS[:1]):
            yield told(latest, other)
        if not whole or baseline is None or baseline == base or latest is None:
            return
        axes = [axis for axis in axes if axis.key in keys_of([axis.key], baseline)]
        if not axes:
            return
        for other in profiles(baseline, axes, figures, evaluate, self._found):
            yield told(latest, other)

    def _map(self, base: Config, choice: StudyChoice, evaluate: Evaluate) -> Work:
        """The map; the one that was shown last is kept while only its own two parameters change."""
        keys = keys_of((choice.x, choice.y, *COLUMNS), base)[:2]
        (figure,) = figures_of([choice.of], base)
        x, y = (axis_of(base, key) for key in keys)
        assert x is not None
        assert y is not None
        about = (base.replace({x.key: x.low, y.key: y.low}), x, y, figure)
        if about != self._mapped:
            self._mapped, self._map_known = about, {}
        source, loads = Source(base, self._presets), load_unit(build_system(base))
        for of in figure_maps(base, x, y, figure, evaluate, self._map_known):
            yield MAP, map_data(of, loads) | {"commands": [map_command(of, source)], "note": source.note}

    def _evaluate(self, given_up: Callable[[], bool], jobs: list[Job]) -> list[Outcome]:
        """What jobs come to, with room for all who hurry. Raises GivenUpError."""
        found: list[Outcome] = []
        at = 0
        while at < len(jobs):
            while COMPUTING.busy and not given_up():
                self._job.pause(HELD_BACK)
            if given_up():
                raise GivenUpError
            calm = not self._plays()
            cores = (os.cpu_count() or 1) if calm else 1
            block = jobs[at : at + (BLOCK * cores if calm else 1)]
            began = perf_counter()
            with STUDYING.turn():
                found += in_order(partial(self._one, given_up), block, cores)
            at += len(block)
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
