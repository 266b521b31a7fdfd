"""Stand-ins for what a workspace and transfers meet in a session: no thread, no server."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace
from typing import Any

from app.format.units import METRIC, Units
from app.plots.curves import Beside
from app.runs.history import Kept, Runs
from app.runs.request import Request
from model.config.config import Config, ConfigError
from model.simulation.trajectory import Trajectory


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


class FakeWindow:
    """A window that remembers what it was told."""

    def __init__(self) -> None:
        self.runs = FakeRunsPanel()
        self.runs_in_front = False
        self.dark = False
        self.units = METRIC
        self.said: list[tuple[str, str]] = []  # title and body
        self.faults: list[tuple[str, ConfigError]] = []
        self.presets: dict[str, Config] = {}
        self.chosen = ""
        self.ghosts: list[Trajectory | None] = []
        self.progress: list[str] = []
        self.surroundings: list[bool] = []
        self.stored: list[str] = []  # by the tab

    @property
    def titles(self) -> list[str]:
        """Of what was said."""
        return [title for title, _ in self.said]

    def say(self, title: str, body: str) -> None:
        self.said.append((title, body))

    def show_faults(self, title: str, faults: ConfigError) -> None:
        self.faults.append((title, faults))

    def show_presets(self, presets: Mapping[str, Config], chosen: str) -> None:
        self.presets, self.chosen = dict(presets), chosen

    def show_baseline(self, baseline: Trajectory | None) -> None:
        self.ghosts.append(baseline)

    def show_beside(self, beside: tuple[Beside, ...]) -> None:
        self.beside = beside

    def set_dark(self, dark: bool) -> None:
        self.dark = dark

    def set_units(self, units: Units) -> None:
        self.units = units

    def show_progress(self, doing: str) -> None:
        self.progress.append(doing)

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
