"""Random configurations, each made again by its number: near a preset, coherent as vehicles are, or wide."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from model.config.config import Config
from model.config.config_files import load_config, preset_names
from model.config.parameters import PARAMETERS, Parameter
from model.config.validation import ConfigError

KINDS = ("near", "coherent", "wide")
LONGEST = 3.0  # s of simulated time
FASTEST = 500.0  # samples a second
DRAWN = ("number", "integer", "choice", "flag")
TRIES = 30
MASSES = (
    "mass",
    "inertia",
    "stiffness",
    "damping",
    "force_limit",
    "integral_gain",
    "proportional_gain",
)  # grow together


def drawn(number: int) -> Config:
    """The configuration of a number, of its kind in turn. Raises ConfigError where no try of it was allowed."""
    rng, kind = np.random.default_rng(number), KINDS[number % len(KINDS)]
    base = load_config(preset_names()[int(rng.integers(len(preset_names())))])
    changes = {"near": _near, "coherent": _coherent, "wide": _wide}[kind](base, rng)
    changes |= {
        "simulation.duration": float(rng.uniform(0.5, LONGEST)),
        "simulation.output_rate": float(rng.uniform(20, FASTEST)),
    }
    for _ in range(TRIES):
        try:
            return base.replace(changes)
        except ConfigError as error:
            for fault in error.faults:  # what contradicts the rest is left as it was
                changes.pop(fault.path.partition("[")[0], None)
            last = error
    raise last


def _near(base: Config, rng: np.random.Generator) -> dict[str, Any]:
    """Half of the numbers a fifth higher or lower."""
    return {
        parameter.key: _within(parameter, value * rng.uniform(0.8, 1.2))
        for parameter in PARAMETERS
        if isinstance(value := base.values().get(parameter.key), float) and rng.random() < 0.5
    }


def _coherent(base: Config, rng: np.random.Generator) -> dict[str, Any]:
    """A vehicle of another size, somewhat unlike its kind, on a road and at a speed that sliders offer."""
    size = math.exp(rng.uniform(-3.0, 1.5))
    changes: dict[str, Any] = {}
    for parameter in PARAMETERS:
        value = base.values().get(parameter.key)
        if parameter.key.startswith(("vehicle.", "contact.", "drive.")) and isinstance(value, float):
            scale = size if parameter.key.endswith(MASSES) else 1.0
            changes[parameter.key] = _within(parameter, value * scale * rng.lognormal(0.0, 0.3))
    return changes | _road(rng, sliders=True)


def _wide(base: Config, rng: np.random.Generator) -> dict[str, Any]:
    """A third of all keys anywhere in what is allowed."""
    keys = (p for p in PARAMETERS if not p.key.startswith(("road.", "simulation.duration", "simulation.output_rate")))
    changes = {p.key: _anything(p, rng) for p in keys if p.kind in DRAWN and rng.random() < 0.33}
    return changes | _road(rng, sliders=False)


def _road(rng: np.random.Generator, sliders: bool) -> dict[str, Any]:
    kinds = ("flat", "sine", "half_round", "trapezoid", "step", "random")
    kind = kinds[int(rng.integers(len(kinds)))]
    keys = (p for p in PARAMETERS if p.key.startswith("road.") and p.applies_to(kind) and p.kind in DRAWN)
    return {"road.type": kind} | {p.key: _anything(p, rng, sliders) for p in keys if p.key != "road.type"}


def _anything(parameter: Parameter, rng: np.random.Generator, sliders: bool = False) -> Any:
    """A value that is allowed, or that the slider offers."""
    low, high = (parameter.slider_low, parameter.slider_high) if sliders else (parameter.low, parameter.high)
    if parameter.kind == "choice":
        return parameter.choices[int(rng.integers(len(parameter.choices)))]
    if parameter.kind == "flag":
        return bool(rng.random() < 0.5)
    if parameter.kind == "integer":
        return int(rng.integers(int(low), int(min(high, 2**31)) + 1))
    if low >= 0 and high > 100 * max(low, 1e-9):
        return float(math.exp(rng.uniform(math.log(max(low, high * 1e-6)), math.log(high))))
    return float(rng.uniform(low, high))


def _within(parameter: Parameter, value: float) -> float:
    return float(min(max(value, parameter.low), parameter.high))
