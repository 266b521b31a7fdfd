"""Three examples for a beginner: what each changes, step by step, and what there is to see then. Pure.

Each starts from the run that is shown, whatever vehicle and road that has.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from app.runs.study_choice import DAMPING
from model.analysis.figures import LOAD_PEAK, PITCH
from model.config.config import Config

SPEED = "drive.speed_kmh"
DRAG_STEPS, SPEEDS = 8, 18  # requests of a slider that is moved; speeds that are tried

Changes = Mapping[str, Any]  # dotted key -> value as in a file


@dataclass(frozen=True)
class Example:
    """One example. `seen` may name {figure}, {before} and {now}; {value}, of the parameter that was
    changed; and {count}, of the steps."""

    name: str
    doing: str  # what the user is told meanwhile …
    seen: str  # … and at the end
    figure: str  # name of the one that is told, of the run before and of the run at the end
    tab: str  # that comes to the front at the end
    path: Callable[[Config], Sequence[Changes]]  # from the configuration that is shown
    to_worst: bool = False  # ends at the step of the path where the figure is largest; else at the last one
    crosses: bool = False  # in the end the run plays, slowly, from just before its obstacle


def _halved(config: Config) -> list[Changes]:
    damping = config.vehicle.road_suspension.damping
    factors = [1 - 0.5 * step / DRAG_STEPS for step in range(1, DRAG_STEPS + 1)]
    if isinstance(damping, tuple):
        return [{DAMPING: [factor * wheel for wheel in damping]} for factor in factors]
    return [{DAMPING: factor * damping} for factor in factors]


def _speeds(config: Config) -> list[Changes]:
    """Over the range of the slider, on its steps."""
    low, high, step = config.parameter(SPEED).slider(config.drive.speed_kmh)
    return [{SPEED: round(float(speed) / step) * step} for speed in np.linspace(low, high, SPEEDS)]


EXAMPLES = (
    Example(
        "Halve the damping",
        "This run is now the baseline. Watch Suspension damping go down to half, and the curves follow.",
        "The damping is half of what it was. {figure}: {before} before, {now} now. Pale curves are the run before, and "
        "the tab Runs lists every figure of both.",
        PITCH.name,
        "Runs",
        _halved,
    ),
    Example(
        "Find the worst speed",
        "This run is now the baseline. Watch Speed go through its whole range; each speed is a run of its own.",
        "Of {count} speeds, {value} loads a wheel most. {figure}: {before} before, {now} now. The tab Study draws this "
        "figure over the speed, from more runs.",
        LOAD_PEAK.name,
        "Study",
        _speeds,
        to_worst=True,
    ),
    Example(
        "Cross a half-round",
        "This run is now the baseline. The road becomes level ground with a half-round on it.",
        "In slow motion, one wheel after the other climbs the half-round. A wheel without an arrow is in the air. "
        "{figure}: {before} before, {now} now.",
        LOAD_PEAK.name,
        "Loads",
        lambda config: [{"road.type": "half_round"}],
        crosses=True,
    ),
)
EXAMPLE = {example.name: example for example in EXAMPLES}
