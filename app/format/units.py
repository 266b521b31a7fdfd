"""In which units the page tells quantities: the viewer's choice. Pure.

The tables of parameters and figures name metric units. Here stands what becomes of each by choice; a unit without a row
stays as it is. Files, links, reports and the command line know nothing of the choice: a configuration is in SI.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from functools import lru_cache
from itertools import product
from typing import Any, NamedTuple

from model.analysis.comfort import G
from model.config.parameters import NOTED, Parameter

POUND_FORCE, POUND, INCH, FOOT, MILE = 4.4482216152605, 0.45359237, 0.0254, 0.3048, 1609.344  # N, kg, m
# What is chosen (fields of Units), and the units by which both choices are named, the usual one first
CHOICES = {"force": ("kN", "lbf"), "length": ("mm", "in"), "speed": ("km/h", "mph"), "acceleration": ("m/s²", "g")}


class Swap(NamedTuple):
    """Part of a unit that becomes another by choice."""

    choice: str  # a key of CHOICES, whose second unit brings it
    old: str
    new: str
    factor: float  # of a value


_N, _KN, _MN = (Swap("force", name, "lbf", size / POUND_FORCE) for name, size in (("N", 1.0), ("kN", 1e3), ("MN", 1e6)))
_KG = Swap("force", "kg", "lb", 1 / POUND)


def _metre(new: str, size: float, power: int) -> Swap:
    """A metre that stands in a unit with this power; size: m of the new unit."""
    return Swap("length", "m", new, size**-power)


TABLE: dict[str, tuple[Swap, ...]] = {
    "N": (_N,),
    "kN": (_KN,),
    "kg": (_KG,),
    "kg m²": (_KG, _metre("ft", FOOT, 2)),
    "N/m": (_N, _metre("in", INCH, -1)),
    "kN/m": (_KN, _metre("in", INCH, -1)),
    "N s/m": (_N, _metre("in", INCH, -1)),
    "kN s/m": (_KN, _metre("in", INCH, -1)),
    "MN/m²": (_MN, _metre("in", INCH, -2)),
    "MN s/m³": (_MN, _metre("in", INCH, -3)),
    "N m": (_N, _metre("ft", FOOT, 1)),
    "kN m/rad": (_KN, _metre("in", INCH, 1)),
    "kN m s/rad": (_KN, _metre("in", INCH, 1)),
    "1/m²": (_metre("ft", FOOT, -2),),
    "m": (_metre("ft", FOOT, 1),),
    "mm": (Swap("length", "mm", "in", 1e-3 / INCH),),
    "km/h": (Swap("speed", "km/h", "mph", 1e3 / MILE),),
    "m/s": (Swap("speed", "m/s", "ft/s", 1 / FOOT),),
    "m/s²": (Swap("acceleration", "m/s²", "g", 1 / G),),
    "m²/s³": (Swap("acceleration", "m²/s³", "g²/Hz", 1 / G**2),),
}
OF_VEHICLES = (_metre("in", INCH, 1),)  # a vehicle is measured in inches where a road is measured in feet
PROSE = re.compile(r"(?<![\w.])(\d+(?:\.\d+)?)( to (\d+(?:\.\d+)?))?[ \u00a0](km/h|m/s²|m/s|mm|m|kN|N|kg)(?![\w/²³])")


class Unit(NamedTuple):
    """What a unit of the tables is told in."""

    name: str
    factor: float = 1.0  # of a value
    finer: int = 0  # decimals that a value needs more than in the unit of the tables

    @property
    def after(self) -> str:
        """Behind a number."""
        return f" {self.name}" if self.name else ""


@dataclass(frozen=True)
class Units:
    """The units of one page: each is one of the two that CHOICES has for it. Masses go with forces."""

    force: str = CHOICES["force"][0]
    length: str = CHOICES["length"][0]
    speed: str = CHOICES["speed"][0]
    acceleration: str = CHOICES["acceleration"][0]

    def of(self, unit: str) -> Unit:
        """What a unit of the tables is told in."""
        return self._swapped(unit, TABLE.get(unit, ()))

    def told(self, parameter: Parameter) -> Parameter:
        """The same parameter as the page tells it: shown in these units, and so the numbers in its texts."""
        return parameter if self == METRIC else _told(parameter, self)

    def of_parameter(self, parameter: Parameter) -> Unit:
        """What the shown unit of a parameter is told in."""
        unit = parameter.shown_unit
        swaps = OF_VEHICLES if unit == "m" and parameter.key.startswith("vehicle.") else TABLE.get(unit, ())
        return self._swapped(unit, swaps)

    def reword(self, text: str) -> str:
        """A text with its numbers, where a unit follows them, in these units: three digits that count."""
        return text if self == METRIC else PROSE.sub(self._reworded, text)

    def changed(self, chosen: Mapping[str, Any]) -> Units:
        """With other choices, as far as there are such: anybody may have told them."""
        return replace(self, **{name: chosen[name] for name in CHOICES if chosen.get(name) in CHOICES[name]})

    @property
    def chosen(self) -> dict[str, str]:
        """By name, as `changed` takes them."""
        return asdict(self)

    def _swapped(self, unit: str, swaps: tuple[Swap, ...]) -> Unit:
        name, factor = unit, 1.0
        for swap in swaps:
            if getattr(self, swap.choice) == CHOICES[swap.choice][1]:
                name, factor = name.replace(swap.old, swap.new), factor * swap.factor
        return Unit(name, factor, max(round(-math.log10(factor)), 0))

    def _reworded(self, found: re.Match[str]) -> str:
        first, _, second, unit = found.groups()
        told = self.of(unit)
        if told.factor == 1.0:
            return found[0]
        words = [f"{float(f'{float(number) * told.factor:.3g}'):g}" for number in (first, second) if number is not None]
        return f"{' to '.join(words)} {told.name}"


METRIC = Units()
US = Units(**{name: other for name, (_, other) in CHOICES.items()})


@lru_cache(maxsize=1024)
def _told(parameter: Parameter, units: Units) -> Parameter:
    unit = units.of_parameter(parameter)
    return replace(
        parameter,
        shown=(unit.name, parameter.shown_factor * unit.factor),
        description=parameter.description if parameter.kind in NOTED else units.reword(parameter.description),
        growth=units.reword(parameter.growth),
    )


def _names(units: Units) -> set[str]:
    return {units.of(unit).name for unit in TABLE}


# Names of all units that are there by choice only
BY_CHOICE = frozenset().union(*(_names(Units(*chosen)) for chosen in product(*CHOICES.values()))) - TABLE.keys()
# Decimals that plots in such a unit have more than others
FINER = {name: min(told.finer for told in map(US.of, TABLE) if told.name == name) for name in ("in", "g", "g²/Hz")}
