"""Stand-ins for what a workspace and transfers meet in a session: no thread, no server."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace
from typing import Any

import pytest

from app.files.uploads import ProfileQuestion
from app.format.units import METRIC, Units
from app.panels.export_list import ExportLine
from app.plots.curves import Beside
from app.runs.history import Kept, Runs
from app.runs.request import Request
from app.session.window import InView
from model.config.config import Config, ConfigError
from model.simulation.trajectory import Trajectory
from tests.app.conftest import Tab, wait_for


class FakeRunsPanel:
    """The tab of the runs, as the workspace has left it."""

    def __init__(self) -> None:
        self.kept: list[Kept] = []  # newest first
        self.heading = self.name = self.before_drive = ""
        self.now: Kept | None = None
        self.baseline: Kept | None = None
        self.compared: list[tuple[Trajectory, Trajectory | None]] = []

    @property
    def rows(self) -> list[str]:
        return [kept.name for kept in self.kept]

    def numbered(self, name: str) -> int:
        return next(kept.number for kept in self.kept if kept.name == name)

    def show(
        self,
        runs: Runs,
        name: str,
        now: Kept | None,
        baseline: Kept | None,
        before_drive: str,
        ticked: Collection[int] = (),
    ) -> None:
        self.ticked = list(ticked)
        self.kept = list(runs)[::-1]
        self.heading, self.now, self.baseline, self.before_drive = name, now, baseline, before_drive

    def show_name(self, name: str) -> None:
        self.name = name

    def compare(
        self, now: Trajectory, baseline: Trajectory | None, beside: Sequence[Beside] = (), units: Units = METRIC
    ) -> None:
        self.units = units
        self.compared_beside = [other.name for other in beside]
        self.compared.append((now, baseline))


class FakeExportList:
    """The list of exports, as it was left."""

    lines: Sequence[ExportLine] = ()

    def show(self, lines: Sequence[ExportLine]) -> None:
        self.lines = lines


class FakeWindow:
    """A window that remembers what it was told."""

    def __init__(self) -> None:
        self.runs = FakeRunsPanel()
        self.runs_in_front = False
        self.dark = False
        self.units = METRIC
        self.said: list[tuple[str, str]] = []  # title and body
        self.faults: list[tuple[str, ConfigError]] = []
        self.profiles: list[ProfileQuestion] = []  # how a profile is to be read
        self.presets: dict[str, Config] = {}
        self.chosen = ""
        self.ghosts: list[Trajectory | None] = []
        self.exports = FakeExportList()
        self.study = Called()
        self.asked: list[tuple[str, str, str, Callable[[], None]]] = []
        self.held: InView | None = None  # what the 3-D view shows for a picture
        self.times: list[float] = []  # that it showed for pictures
        self.shows_mode = False
        self.surroundings: list[bool] = []
        self.stored: list[str] = []  # by the tab

    @property
    def titles(self) -> list[str]:
        """Of what was said."""
        return [title for title, _ in self.said]

    def say(self, title: str, body: str) -> None:
        self.said.append((title, body))

    def ask(self, title: str, words: str, yes: str, act: Callable[[], None]) -> None:
        self.asked.append((title, words, yes, act))

    def show_faults(self, title: str, faults: ConfigError, text: str | None = None) -> None:
        self.faults.append((title, faults))
        self.to_mend = text

    def ask_about_profile(self, question: ProfileQuestion) -> None:
        self.profiles.append(question)

    def show_presets(self, presets: Mapping[str, Config], chosen: str) -> None:
        self.presets, self.chosen = dict(presets), chosen

    def show_baseline(self, baseline: Trajectory | None) -> None:
        self.ghosts.append(baseline)

    def show_beside(self, beside: tuple[Beside, ...]) -> None:
        self.beside = beside

    def set_dark(self, dark: bool) -> None:
        self.dark = dark

    def hold_view(self, shown: InView, time: float) -> None:
        self.held = shown
        self.times.append(time)

    def film(self, time: float) -> None:
        assert self.held is not None
        self.times.append(time)

    def release_view(self) -> None:
        self.held = None

    def set_units(self, units: Units) -> None:
        self.units = units

    def store(self, state: str) -> None:
        self.stored.append(state)

    def show_surroundings(self, on: bool) -> None:
        self.surroundings.append(on)


class FakeRunner:
    """A runner that runs nothing: it knows the latest request."""

    def __init__(self, first: Request) -> None:
        self.latest = replace(first, number=1)

    def change(self, update: Callable[[Request], Request]) -> None:
        self.latest = replace(update(self.latest), number=self.latest.number + 1)


class Called:
    """Notes the calls of all its methods: name and arguments."""

    def __init__(self) -> None:
        self.calls: list[tuple[Any, ...]] = []

    def __getattr__(self, name: str) -> Callable[..., None]:
        return lambda *arguments: self.calls.append((name, *arguments))


@pytest.fixture
def tab(explore: Any, open_tab: Any) -> Tab:
    opened: Tab = open_tab(explore())
    wait_for(lambda: opened.shows_run(1), "run 1")
    opened.use("Speed, km/h", 22)
    wait_for(lambda: opened.shows_run(2), "run 2")
    return opened
