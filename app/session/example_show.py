"""An example that runs in the page: it moves controls as a user would, and is undone by one click.

Only the thread that draws (app/session/session.py) uses it. Times are monotonic, in s.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from app.format.differences import figure_text
from app.format.parameters import value_text
from app.format.units import Units
from app.plots.study_data import FigureUnit
from app.runs.examples import Changes, Example
from app.runs.playback import time_before_obstacle
from app.runs.request import Finished, Request
from app.runs.runner import Runner
from app.session.window import Window
from app.session.workspace import Standing, Workspace
from model.analysis.figures import figure_named
from model.analysis.ride import Summary
from model.config.parameters import PARAMETER
from model.simulation.trajectory import Trajectory

LEAD = 1.5  # s to read what is going to happen
SLOW = 0.25  # times real time, at which an obstacle is crossed
PACE = 0.15  # s from one step to the next, at least
TAKEN_OVER = "You have taken over. “Undo example” leads back to what was shown before it."


class Moment(NamedTuple):
    """Where the player is."""

    time: float  # s
    playing: bool
    speed: float  # times real time


class _Before(NamedTuple):
    """What was shown when an example began."""

    standing: Standing
    moment: Moment
    tab: str


class ExampleShow:
    """Of one tab."""

    def __init__(
        self,
        window: Window,
        workspace: Workspace,
        runner: Runner,
        moment: Callable[[], Moment],
        go_to: Callable[[Moment], None],
    ) -> None:
        """moment, go_to: where the player is, and to move it."""
        self._window, self._workspace, self._runner = window, workspace, runner
        self._moment, self._go_to = moment, go_to
        self._wanted: Example | None = None  # begins once a run stands
        self._before: _Before | None = None  # there is an example, under way or ended
        self._example: Example | None = None  # that is under way
        self._path: list[Changes] = []  # steps to come
        self._tried: list[tuple[float, Changes]] = []  # figure and step of each run so far
        self._steps = 0
        self._asked: Changes = {}  # the step whose run is awaited, or has come last
        self._number = 0  # of its request
        self._awaited = False
        self._due = 0.0  # when the next step may be taken

    def begin(self, example: Example) -> None:
        """Show an example as soon as a run stands; one that is shown is undone before."""
        self.undo()
        self._wanted = example

    def undo(self) -> None:
        """Show what was shown before the example."""
        before = self._before
        self.keep()
        if before is not None:
            self._workspace.go_back(before.standing)
            self._go_to(before.moment)
            self._window.open_tab(before.tab)

    def keep(self) -> None:
        """Leave all as it is, and put the card away."""
        self._wanted = self._example = self._before = None
        self._window.tour.hide_example()

    def tick(self, now: float) -> None:
        """Take the next step when it is time for it. To be called several times a second."""
        standing = self._workspace.standing if self._wanted is not None else None
        if standing is not None:
            self._start(standing, now)
        example = self._example
        if example is None:
            return
        if self._runner.latest.number != self._number:
            self._end(example, TAKEN_OVER)
        elif not self._awaited and now >= self._due:
            if self._path:
                self._ask(self._path.pop(0), now)
            elif example.to_worst and self._tried:
                worst = max(self._tried, key=lambda tried: tried[0])[1]
                self._tried = []
                self._ask(worst, now)
            else:
                self._conclude(example)

    def finished(self, done: Finished, now: float) -> None:
        """A run is shown."""
        if self._example is None or not self._awaited or done.request.number != self._number:
            return
        self._awaited, self._due = False, max(self._due, now)
        if self._example.to_worst and (self._path or self._tried):  # else it is the worst itself
            value = _figure(self._example, done.trajectory)
            if value is not None:
                self._tried.append((value, self._asked))

    def _start(self, standing: Standing, now: float) -> None:
        assert self._wanted is not None
        self._example, self._wanted = self._wanted, None
        self._before = _Before(standing, self._moment(), self._window.tab_in_front)
        self._path = list(self._example.path(standing.done.trajectory.config))
        self._steps, self._tried = len(self._path), []
        self._number, self._awaited, self._due = self._runner.latest.number, False, now + LEAD
        self._workspace.compare_with(standing)
        self._window.tour.show_example(self._example.name, self._example.doing, ended=False)

    def _ask(self, changes: Changes, now: float) -> None:
        """Move controls, as a user who drags them."""

        def changed(request: Request) -> Request:
            for key, value in changes.items():
                request = request.changed(key, value)
            return request

        self._runner.change(changed)
        self._number, self._awaited, self._asked, self._due = self._runner.latest.number, True, changes, now + PACE
        for key, value in changes.items():
            self._window.follow(key, value)

    def _conclude(self, example: Example) -> None:
        """Say what is to be seen, and lead there."""
        standing = self._workspace.standing
        if standing is None or self._before is None:
            return  # the run is shown, and the workspace takes note of it soon
        run, before = standing.done.trajectory, self._before.standing.done.trajectory
        if example.crosses:
            self._go_to(Moment(time_before_obstacle(run), playing=True, speed=SLOW))
        self._window.open_tab(example.tab)
        self._end(example, _seen(example, run, before, self._asked, self._steps, self._window.units))

    def _end(self, example: Example, says: str) -> None:
        self._example = None
        self._window.tour.show_example(example.name, says, ended=True)


def _figure(example: Example, run: Trajectory) -> float | None:
    """Of a run; None: the run is not complete, or has no such figure."""
    return figure_named(example.figure, Summary(run)) if run.complete else None


def _seen(example: Example, run: Trajectory, before: Trajectory, changes: Changes, steps: int, units: Units) -> str:
    """What is to be seen, with the figure of both runs."""
    unit = FigureUnit(example.figure, run.system, units)

    def text(value: float | None) -> str:
        return f"{figure_text(None if value is None else unit.factor * value)} {unit.unit}".strip()

    key, value = next(iter(changes.items()))
    return example.seen.format(
        figure=unit.label,
        before=text(_figure(example, before)),
        now=text(_figure(example, run)),
        value=value_text(units.told(PARAMETER[key]), value),
        count=steps,
    )
