"""What the user has done: steps to undo and redo, and the runs that are kept. Pure."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from app.format.parameters import choice_words, shown_text
from app.format.units import METRIC, Units
from app.runs.request import Request, changed_keys, same
from model.config.config import Config
from model.config.parameters import NOTED, PARAMETER, Parameter
from model.simulation.trajectory import Trajectory

REST = 1.0  # s: changes of the same parameters that follow each other faster are one step
STEPS = 200  # that can be undone
RUNS = 20  # that are kept
MEMORY = 200e6  # bytes of their trajectories; the newest run does not count
NAMED_CHANGES = 2  # in the name of a run; the others are counted
NAME_LIMIT = 80  # characters of a name that the user gives
RUN_COLOURS = (
    "#1c6cb2", "#d9480f", "#2b8a3e", "#9c36b5", "#c99700",
    "#0b8494", "#c2255c", "#5c7cfa", "#74a12e", "#846358",
)  # fmt: skip


class Changes:
    """The requests that undo and redo lead to. All changes of a drag are one step."""

    def __init__(self, first: Request) -> None:
        self._steps = [first]
        self._at = 0
        self.count = 0  # how often `present` became another step
        self._noted = float("-inf")  # when, s

    @property
    def present(self) -> Request:
        return self._steps[self._at]

    def note(self, request: Request, now: float) -> None:
        """The run of a request is shown at `now`, s; what had been undone before is forgotten."""
        if same(request, self.present):
            return
        moving = request.touched and now - self._noted < REST
        self._noted = now
        del self._steps[self._at + 1 :]
        before = self._steps[max(self._at - 1, 0)]
        moved = changed_keys(before, self.present)
        if moving and moved and changed_keys(before, request) == moved:
            self._steps[-1] = request
        else:
            self._steps.append(request)
            self.count += 1
        del self._steps[: -STEPS - 1]
        self._at = len(self._steps) - 1

    def go(self, steps: int) -> Request | None:
        """The request that many steps on, or back when negative, as far as there are any; None where there is none."""
        target = min(max(self._at + steps, 0), len(self._steps) - 1)
        if target == self._at:
            return None
        self._at, self._noted = target, float("-inf")
        self.count += 1
        return self.present


@dataclass(frozen=True)
class Kept:
    """A run that is kept."""

    number: int  # unique in its tab, rising
    request: Request
    config: Config  # of the request
    run: Trajectory | None  # None: only its configuration is left, so that it can be made again
    name: str
    colour: str  # CSS
    named: bool  # by the user

    @property
    def given_name(self) -> str:
        """The name that the user gave; empty when the run is named after its changes."""
        return self.name if self.named else ""

    def renamed(self, name: str, units: Units) -> Kept:
        """With a name that the user gave; if that is empty, named after its changes in these units."""
        return replace(self, name=name or run_name(self.request.base, self.config, units), named=bool(name))


class Runs:
    """The runs that are kept. When there are more than RUNS, the oldest that the user has not named goes. When their
    trajectories need more than MEMORY, those of the oldest go."""

    def __init__(self) -> None:
        self._kept: dict[int, Kept] = {}
        self._last_number = 0
        self._units = METRIC

    def __iter__(self) -> Iterator[Kept]:
        """Oldest first."""
        return iter(tuple(self._kept.values()))

    def __len__(self) -> int:
        return len(self._kept)

    def __contains__(self, number: object) -> bool:
        return number in self._kept

    def __getitem__(self, number: int) -> Kept:
        return self._kept[number]

    def find(self, config: Config) -> Kept | None:
        """The run of this configuration."""
        return next((kept for kept in self if kept.config == config), None)

    def keep(self, request: Request, run: Trajectory, name: str = "") -> Kept:
        """Keep a run, unless one of the same configuration is kept already. Returns the one that is kept."""
        self.complete(run)
        return self.find(run.config) or self._add(request, run.config, run, name, self._free_colour())

    def take_back(self, kept: Kept) -> Kept:
        """Keep again what was kept at an earlier visit; otherwise like `keep`."""
        return self.find(kept.config) or self._add(kept.request, kept.config, kept.run, kept.given_name, kept.colour)

    def complete(self, run: Trajectory) -> None:
        """Give a trajectory, made again, to the kept run of its configuration."""
        found = next((kept for kept in self if kept.run is None and kept.config == run.config), None)
        if found is not None:
            self._kept[found.number] = replace(found, run=run)
            self._make_room(self._kept[found.number])

    def _add(self, request: Request, config: Config, run: Trajectory | None, name: str, colour: str) -> Kept:
        self._last_number += 1
        told = name or run_name(request.base, config, self._units)
        kept = Kept(self._last_number, request, config, run, told, colour, named=bool(name))
        self._kept[kept.number] = kept
        self._make_room(kept)
        return kept

    def rename(self, number: int, name: str) -> Kept:
        """Give a run a name; with an empty name it is named after its changes again."""
        self._kept[number] = self._kept[number].renamed(plain_name(name), self._units)
        return self._kept[number]

    def set_units(self, units: Units) -> None:
        """Name runs after their changes in these units."""
        self._units = units
        self._kept = {number: kept.renamed(kept.given_name, units) for number, kept in self._kept.items()}

    def delete(self, number: int) -> None:
        self._kept.pop(number, None)

    def _make_room(self, newest: Kept) -> None:
        others = [kept for kept in self if kept is not newest]
        if len(self._kept) > RUNS:
            oldest = min(others, key=lambda kept: (kept.named, kept.number))
            self.delete(oldest.number)
            others.remove(oldest)
        for kept in others:
            if sum(map(size, self)) > MEMORY:
                self._kept[kept.number] = replace(kept, run=None)

    def _free_colour(self) -> str:
        """The first of the colours that the fewest runs have."""
        used = [kept.colour for kept in self]
        return min(RUN_COLOURS, key=used.count)


def size(kept: Kept) -> int:
    """Bytes of a run's arrays."""
    arrays = () if kept.run is None else vars(kept.run).values()
    return sum(array.nbytes for array in arrays if isinstance(array, np.ndarray))


def plain_name(name: str) -> str:
    """A name from the user, on one line and not too long."""
    return " ".join(name.split())[:NAME_LIMIT]


def run_name(base: Config, config: Config, units: Units = METRIC) -> str:
    """What was changed in a preset: "Speed 15 → 22 km/h"; without changes the preset's name."""
    changes = differences(base, config, units)
    if not changes:
        return base.name
    more = len(changes) - NAMED_CHANGES
    return ", ".join(changes[:NAMED_CHANGES]) + (f" and {more} more" if more > 0 else "")


def differences(before: Config, after: Config, units: Units = METRIC) -> list[str]:
    """Each parameter that differs, in words: "Speed 15 → 22 km/h"; names and descriptions left out."""
    old, new = before.values(), after.values()
    changed = [
        key
        for key, parameter in PARAMETER.items()
        if parameter.kind not in NOTED and parameter.applies_to(after.road.type) and old.get(key) != new.get(key)
    ]
    return [
        _difference(units.told(before.parameter(key)), old.get(key), units.told(after.parameter(key)), new.get(key))
        if PARAMETER[key].applies_to(before.road.type)
        else _named(units.told(after.parameter(key)), new.get(key))
        for key in changed
    ]


def _named(parameter: Parameter, value: Any) -> str:
    """A value that only the new type of road has."""
    return f"{parameter.label} {_words(parameter, value)} {parameter.shown_unit}".rstrip()


def _difference(before: Parameter, old: Any, after: Parameter, new: Any) -> str:
    """Both values with the unit, once; twice where the unit has changed with the basis of the rates."""
    unit = f" {before.shown_unit}" if before.shown_unit != after.shown_unit and old is not None else ""
    return f"{after.label} {_words(before, old)}{unit} → {_words(after, new)} {after.shown_unit}".rstrip()


def _words(parameter: Parameter, value: Any) -> str:
    if value is None:
        return "left out"
    if isinstance(value, bool):
        return "on" if value else "off"
    return choice_words(value) if parameter.kind == "choice" else shown_text(parameter, value)
