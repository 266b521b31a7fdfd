"""What makes a run need more steps than it may take: which keys of its configuration, and values that would do.

A stiff spring or damper on a light body moves it at a rate of k/c or c/m, and no step may be much longer than one over
that. So the motion is linearised where the run stands, with one key after the other made smaller. A wheel that is
pushed into a corner of the road changes from one side to the other without end, whatever the stiffness.
"""

from __future__ import annotations

import numpy as np

from model.config.config import Config
from model.config.parameters import Value
from model.config.validation import ConfigError
from model.dynamics.lanes import in_lanes, make_work, wheel_positions
from model.dynamics.vehicle import build_system
from model.simulation.integrate import Integration
from model.simulation.steppers import stiffest_rate
from model.simulation.trajectory import wheel_names

BEARABLE = 1e4  # 1/s: the stiffest rate for which steps of half a millisecond are short enough
LEAST = 1e-5
PARTS = (0.3, 0.1, 0.03, 0.01, 3e-3, 1e-3, 3e-4, 1e-4, LEAST)  # of a key's value, the mildest first
MOST_KEYS = 3  # that are changed together
KEYS = (
    "vehicle.imaginary_suspension.damping",
    "vehicle.imaginary_suspension.stiffness",
    "contact.normal_damping",
    "contact.normal_stiffness",
    "contact.tangential_damping",
    "contact.tangential_stiffness",
    "vehicle.road_suspension.damping",
    "vehicle.road_suspension.rebound_ratio",
    "vehicle.road_suspension.stop_damping",
    "vehicle.road_suspension.stop_stiffness",
    "vehicle.road_suspension.progression",
    "vehicle.road_suspension.stiffness",
)


def relief(config: Config, run: Integration) -> dict[str, Value]:
    """Keys and smaller values with which the motion, where the run stands, is no longer stiff; none if it is not stiff,
    or if these keys do not help.
    """
    rate, relieved = _rate(config, run), config
    keys: list[str] = []
    while rate > BEARABLE and len(keys) < MOST_KEYS:
        lowest = {key: _rate(_smaller(relieved, key, LEAST), run) for key in KEYS}
        key = min(lowest, key=lambda key: lowest[key])
        if lowest[key] > 0.5 * rate:
            return {}
        enough = max(BEARABLE, 1.2 * lowest[key])
        found = (_smaller(relieved, key, part) for part in PARTS)
        relieved = next(smaller for smaller in found if smaller is not None and _rate(smaller, run) <= enough)
        rate = _rate(relieved, run)
        keys.append(key)
    return {key: relieved.value(key) for key in keys} if rate <= BEARABLE else {}


def advice(config: Config, run: Integration) -> str:
    """What to set, in words; empty if that would not help."""
    if len(run.jammed()):
        return _out_of_the_corner(config, run)
    changes = relief(config, run)
    if not changes:
        return ""
    settings = " and ".join(f"{key} to {_shown(value)}" for key, value in changes.items())
    return f"Set {settings}: it is so stiff here that no step may be much longer than {1 / _rate(config, run):.1g} s."


def _out_of_the_corner(config: Config, run: Integration) -> str:
    """What to do about a wheel that is jammed."""
    wheel = int(run.jammed()[0])
    name, x = wheel_names(run.system)[wheel], wheel_positions(run.system, run.y)[wheel]
    jam = f"Wheel {name} is jammed in a corner of the road at x = {x:.2f} m and goes to and fro between its two sides."
    if config.drive.mode == "prescribed":
        return f"{jam} Set drive.mode to cruise, so that the vehicle is not pushed on, or make the road lower there."
    return f"{jam} Make the road lower or smoother there, or the wheels larger."


def _smaller(config: Config, key: str, part: float) -> Config | None:
    """The configuration with that part of a key's value; None where there is none, or it is not allowed."""
    value = config.value(key)
    try:
        if isinstance(value, tuple | list):
            return config.replace({key: [_rounded(part * one) for one in value]})
        return config.replace({key: _rounded(part * float(value))}) if value else None
    except ConfigError:
        return None


def _rounded(value: float) -> float:
    return float(f"{value:.3g}")


def _shown(value: Value) -> str:
    return f"[{', '.join(f'{one:g}' for one in value)}]" if isinstance(value, tuple | list) else f"{value:g}"


def _rate(config: Config | None, run: Integration) -> float:
    """The stiffest rate that the configuration would have where the run stands, 1/s; infinite without one."""
    if config is None:
        return np.inf
    system, k = build_system(config), np.empty((3, len(run.y)))
    rate = stiffest_rate(in_lanes(system), run.road, run.t, run.y, make_work(system), k, np.empty_like(run.y))
    return float(rate)
