"""Roads made of parts: obstacles put on a road, and the list of parts as text, a line for each. Pure."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from app.format.parameters import NUMBER, choice_words, file_number, shown_number
from app.format.units import METRIC, Units
from model.config.config import Config, FlatRoad, ProfileRoad, SimpleRoad, SumRoad
from model.config.config_files import part_values
from model.config.parameters import PARAMETER, ROADS, number_text

ADDED = (*(kind for kind in ROADS if PARAMETER["road.position"].applies_to(kind)), "random")  # by a button
AHEAD, APART = 3.0, 6.0  # m from the first wheel to the first obstacle, and from one to the next


def with_part(config: Config, road_type: str) -> dict[str, Any]:
    """Changes (dotted key -> value) that add a road to the present one, an obstacle behind those that are there."""
    road = config.road
    parts: list[Any] = list(road.parts) if isinstance(road, SumRoad) else [road]
    parts = [part for part in parts if not isinstance(part, FlatRoad)]
    part: dict[str, Any] = {"type": road_type}
    if PARAMETER["road.position"].applies_to(road_type):
        places = [part.position for part in parts if hasattr(part, "position")]
        first = config.vehicle.road_wheels.x[0] + config.vehicle.road_wheels.radius + AHEAD
        part["position"] = round(max([first, *(place + APART for place in places)]), 1)
    elif road_type == "random":
        seeds = [part.seed for part in parts if hasattr(part, "seed")]
        part["seed"] = max(seeds, default=0) + 1
    return {"road.type": "sum", "road.parts": (*parts, part)}


def without_last(config: Config) -> dict[str, Any]:
    """Changes that take the last part away; of two parts, the first becomes the road."""
    road = config.road
    if not isinstance(road, SumRoad):
        return {}
    parts = road.parts[:-1]
    if len(parts) > 1:
        return {"road.parts": parts}
    left = parts[0] if parts else FlatRoad()
    return {f"road.{name}": value for name, value in part_values(left).items()}


def parts_text(parts: Sequence[SimpleRoad], units: Units = METRIC) -> str:
    """A line for each part: "half round: position 8 m, height 100 mm"; numbers in the units of the panel."""
    return "\n".join(_line(part, units) for part in parts)


def _line(part: SimpleRoad, units: Units) -> str:
    if isinstance(part, ProfileRoad):
        return f"profile: {part.file or 'points'}"
    values = part_values(part)
    del values["type"]
    words = [f"{name.replace('_', ' ')} {_shown(name, value, units)}" for name, value in values.items()]
    return f"{choice_words(part.type)}: {', '.join(words)}".rstrip(": ")


def _shown(name: str, value: Any, units: Units) -> str:
    if isinstance(value, str):
        return value
    parameter = units.told(PARAMETER[f"road.{name}"])
    return f"{number_text(shown_number(parameter, value))} {parameter.shown_unit}".rstrip()


def parts_from(text: str, present: Sequence[SimpleRoad], units: Units = METRIC) -> tuple[Any, ...]:
    """The parts that a text names, with units or without. They are not checked: the configuration does that.

    A profile is the one of the present parts, and a number that stands as one of theirs is shown means theirs.
    """
    profiles = iter([part for part in present if isinstance(part, ProfileRoad)])
    known = [part_values(part) for part in present if not isinstance(part, ProfileRoad)]
    return tuple(_part(line, profiles, known, units) for line in text.splitlines() if line.strip())


def _part(line: str, profiles: Any, known: Sequence[Mapping[str, Any]], units: Units) -> Any:
    head, _, rest = line.partition(":")
    road_type = head.strip().replace(" ", "_")
    if road_type == "profile":
        return next(profiles, {"type": "profile"})
    part: dict[str, Any] = {"type": road_type}
    for item in filter(str.strip, rest.split(",")):
        *words, value = _without_unit(item.split(), units) if len(item.split()) > 1 else [item.strip(), ""]
        name = "_".join(words)
        part[name] = _file_value(name, value, [other[name] for other in known if name in other], units)
    return part


def _without_unit(words: list[str], units: Units) -> list[str]:
    """Name and value, without the unit of the panel if it follows them."""
    parameter = PARAMETER.get(f"road.{'_'.join(words[:-2])}")
    return words[:-1] if parameter is not None and words[-1] == units.told(parameter).shown_unit else words


def _file_value(name: str, value: str, present: Sequence[Any], units: Units) -> Any:
    parameter = PARAMETER.get(f"road.{name}")
    if parameter is None or parameter.kind == "choice" or not NUMBER.fullmatch(value):
        return value
    numbers = [number for number in present if isinstance(number, int | float)]
    return float(file_number(units.told(parameter), float(value), numbers))
