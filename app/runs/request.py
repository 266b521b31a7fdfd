"""What the user asks to be run, and what comes of it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Protocol

from app.runs.drive import DriveState
from model.config.config import Config
from model.config.parameters import PARAMETERS
from model.config.validation import EXCLUSIVE, Fault
from model.simulation.trajectory import Trajectory


@dataclass(frozen=True)
class Request:
    """What is to be run: a configuration, and what the user changed in it (dotted key -> value as in a file)."""

    base: Config
    changes: Mapping[str, Any] = field(default_factory=dict)
    number: int = 0
    touched: frozenset[str] = frozenset()  # what the user has just moved, and may still be moving

    def changed(self, key: str, value: Any) -> Request:
        """The same with one more change; what contradicts it goes."""
        rivals = {key} | _rivals(key)
        if key == "road.type":
            rivals |= {parameter.key for parameter in PARAMETERS if not parameter.applies_to(str(value))}
        changes = {other: given for other, given in self.changes.items() if other not in rivals}
        return replace(self, changes={**changes, key: value}, touched=self.touched | {key})

    def entered(self, key: str, value: Any) -> Request:
        """The same with a value that was typed as text, so that its control may follow."""
        changed = self.changed(key, value)
        return replace(changed, touched=changed.touched - {key})

    def reset(self, key: str) -> Request:
        """The same without a change to this parameter, nor to what goes with it."""
        gone = {key} | _rivals(key)
        if key == "road.type":
            gone |= {parameter.key for parameter in PARAMETERS if parameter.roads}
        changes = {other: given for other, given in self.changes.items() if other not in gone}
        return replace(self, changes=changes, touched=self.touched - gone)

    def config(self) -> Config:
        """The configuration requested. Raises ConfigError."""
        return self.base.replace(dict(self.changes)) if self.changes else self.base


def _rivals(key: str) -> set[str]:
    """Keys that say the same as this one, so that only one of them can be given."""
    found: set[str] = set()
    for one, others in EXCLUSIVE:
        if key == one:
            found |= set(others)
        elif key in others:
            found.add(one)
    return found


def same(one: Request, other: Request) -> bool:
    """Whether two requests are for the same base with the same changes."""
    return one.base == other.base and dict(one.changes) == dict(other.changes)


def changed_keys(one: Request, other: Request) -> frozenset[str] | None:
    """Parameters in which two requests differ; None when they start from different presets."""
    if one.base != other.base:
        return None
    base, absent = one.base.values(), object()
    return frozenset(
        key
        for key in {*one.changes, *other.changes}
        if one.changes.get(key, base.get(key, absent)) != other.changes.get(key, base.get(key, absent))
    )


def first_request(base: Config, config: Config) -> Request:
    """The request of `config` as changes to `base`, so that a reset leads back to that."""
    before, after = base.values(), config.values()
    changes = {key: value for key, value in after.items() if before.get(key) != value}
    request = Request(base, changes)
    return request if request.config() == config else Request(config)


@dataclass(frozen=True)
class Finished:
    request: Request
    trajectory: Trajectory


@dataclass(frozen=True)
class Refused:
    """The request is no valid configuration."""

    request: Request
    faults: tuple[Fault, ...]


@dataclass(frozen=True)
class Failed:
    """The run could not be made, for a reason that the message gives in plain words."""

    request: Request
    message: str


@dataclass(frozen=True)
class Driven:
    """The drive has come so far."""

    request: Request
    state: DriveState

    @property
    def trajectory(self) -> Trajectory:
        """Its last seconds."""
        return self.state.past


Outcome = Finished | Refused | Failed | Driven


class Simulate(Protocol):
    """model.simulate, or a stand-in."""

    def __call__(
        self, config: Config, *, on_progress: Callable[[float], None], should_stop: Callable[[], bool]
    ) -> Trajectory: ...
