"""Command lines that repeat what the page shows."""

from __future__ import annotations

import shlex
from collections.abc import Mapping
from typing import Any

from model.config.config import Config
from model.config.parameters import number_text


class Source:
    """How a command line names a configuration: a preset and what differs from it, or a file."""

    def __init__(self, config: Config, presets: Mapping[str, Config]) -> None:
        """presets: those that come with the program."""
        self.note = ""
        named = [(self._changes(config, preset), name) for name, preset in presets.items()]
        fitting = [(len(changes), name, changes) for changes, name in named if changes is not None]
        if fitting:
            _, self.name, self.changes = min(fitting, key=lambda one: one[0])
        else:
            self.name, self.changes = "vehicle.yaml", {}
            self.note = "Save the present configuration as vehicle.yaml first: Export, YAML."

    @staticmethod
    def _changes(config: Config, preset: Config) -> dict[str, Any] | None:
        """What differs from a preset, as far as --set can say it."""
        before, after = preset.values(), config.values()
        changes = {
            key: value
            for key, value in after.items()
            if before.get(key) != value and key not in ("name", "description")
        }
        plain = all(isinstance(value, int | float | str | bool) for value in changes.values())
        if not plain or "road.points" in changes or preset.vehicle.hull != config.vehicle.hull:
            return None
        gone = [key for key in before if key not in after and preset.road.type == config.road.type]
        return None if gone else changes

    def command(self, name: str, *options: str) -> str:
        """`trackride NAME CONFIG --set … OPTIONS`, as a shell takes it."""
        sets: list[str] = []
        for key, value in self.changes.items():
            sets += ["--set", f"{key}={_text(value)}"]
        return shlex.join(["trackride", name, self.name, *sets, *options])


def _text(value: float | str | bool) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    return value if isinstance(value, str) else number_text(value)
