"""What the user wants to see in the tab "Study", as the page tells it. Pure."""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import dataclass, fields
from typing import Any

from model.analysis.figures import FIGURE, RIDE_FIGURES
from model.config.config import Config
from model.config.parameters import PARAMETERS
from model.study.design import DesignError, checked_figures
from model.study.profiler import axis_of

PROFILER, MAP, LIMITS, MEASURED = VIEWS = ("profiler", "map", "limits", "measured")
WHAT_IF = tuple(parameter.key for parameter in PARAMETERS if parameter.what_if)
DAMPING = "vehicle.road_suspension.damping"
COLUMNS = tuple(parameter.key for parameter in PARAMETERS if parameter.what_if or parameter.key == DAMPING)
ROWS = ("absorbed_power", "peak_load", "imaginary_share", "air_time")
MOST_COLUMNS, MOST_ROWS, MOST_FITTED = 10, 6, 4
VARIABLE = frozenset(p.key for p in PARAMETERS if p.kind in ("number", "integer") and p.slider_low != p.slider_high)


@dataclass(frozen=True)
class StudyChoice:
    """View, and what each of them shows. A key or figure that a vehicle does not have is left out when it is run."""

    view: str = PROFILER
    columns: tuple[str, ...] = COLUMNS  # keys
    rows: tuple[str, ...] = ROWS  # names of figures
    figure: str = "absorbed_power"  # of the line under the sliders, and of the strips on them
    strips: bool = True  # the line and the strips are shown
    x: str = "drive.speed_kmh"  # keys of the map …
    y: str = DAMPING
    of: str = "absorbed_power"  # … and its figure
    low_pass: float | None = None  # Hz, above which a record and a run are not compared
    fitted: tuple[str, ...] = ()  # keys to be fitted to the record …
    fit: int = 0  # … by the fit with this number; 0: none was asked for


def choice_from(text: str) -> StudyChoice:
    """What a page has told, as far as it makes sense: anybody may have written it."""
    try:
        given = json.loads(text)
    except ValueError:
        return StudyChoice()
    if not isinstance(given, dict):
        return StudyChoice()
    default = StudyChoice()
    told: dict[str, Any] = {}
    for field in fields(StudyChoice):
        value = given.get(field.name)
        usual = getattr(default, field.name)
        if field.name == "columns":
            told["columns"] = _some(value, VARIABLE, MOST_COLUMNS, usual)
        elif field.name == "rows":
            told["rows"] = _some(value, None, MOST_ROWS, usual)
        elif field.name == "strips":
            told["strips"] = value if isinstance(value, bool) else usual
        elif field.name == "fitted":
            told["fitted"] = _some(value, VARIABLE, MOST_FITTED, usual)
        elif field.name == "fit":
            told["fit"] = value if isinstance(value, int) and 0 <= value < 10**6 else usual
        elif field.name == "low_pass":
            told["low_pass"] = float(value) if isinstance(value, int | float) and 0.1 <= value <= 1000 else usual
        elif field.name == "view":
            told["view"] = value if value in VIEWS else usual
        elif field.name in ("x", "y"):
            told[field.name] = value if value in VARIABLE else usual
        else:
            told[field.name] = value if _is_figure(value) else usual
    return StudyChoice(**told)


def _some(given: object, allowed: Iterable[str] | None, most: int, usual: tuple[str, ...]) -> tuple[str, ...]:
    """Those of a list that are allowed, each once; the usual ones where none is left. allowed: None: figures."""
    if not isinstance(given, list):
        return usual
    good = [one for one in given if (_is_figure(one) if allowed is None else one in allowed)]
    return tuple(dict.fromkeys(good))[:most] or usual


def _is_figure(name: object) -> bool:
    return isinstance(name, str) and len(name) < 60 and name.partition(".")[0] in FIGURE


def figures_of(names: Iterable[str], config: Config) -> tuple[str, ...]:
    """Those figures that the vehicle has."""
    found = []
    for name in dict.fromkeys(names):
        try:
            checked_figures([name], config)
        except DesignError:
            continue
        if config.vehicle.imaginary_wheels.enabled or name != "imaginary_share":
            found.append(name)
    return tuple(found) or ("absorbed_power",)


def keys_of(names: Iterable[str], config: Config) -> tuple[str, ...]:
    """Those parameters that a profile of the configuration can have, each once."""
    return tuple(key for key in dict.fromkeys(names) if _effective(key, config))


def _effective(key: str, config: Config) -> bool:
    without = not config.vehicle.imaginary_wheels.enabled and key.startswith("vehicle.imaginary_")
    return not without and axis_of(config, key) is not None


def variable_keys(config: Config) -> tuple[str, ...]:
    """All parameters that a profile of the configuration can have, in the table's order."""
    return keys_of((parameter.key for parameter in PARAMETERS if not parameter.key.startswith("simulation.")), config)


def figure_names() -> tuple[str, ...]:
    """All that a page offers."""
    return tuple(figure.name for figure in RIDE_FIGURES)
