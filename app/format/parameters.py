"""Parameters and their values as people read and type them, in plain text.

A value is shown in the friendlier unit of the parameter table (`shown_unit`), or in the one of the viewer's choice when
the parameter comes from `Units.told`; a configuration and a file hold it in SI. A number that is shown with few digits
and left alone still means the value that it stands for.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from typing import Any

import numpy as np

from app.format.units import BY_CHOICE, METRIC, Units
from model.config.config import Config
from model.config.parameters import PARAMETER, Parameter, Value, number_text
from model.config.profile_points import points
from model.config.validation import Fault

NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?", re.ASCII | re.IGNORECASE)  # float() also takes 1_0
LARGE = 1e6  # from there on a number's text has six digits (number_text)
TYPED, COUNTED = 6, 4  # digits in a unit of choice: of a number that people type, and of one that comes of another unit


def shown_label(parameter: Parameter) -> str:
    """Name and unit: "Suspension stiffness, kN/m", the unit in one piece."""
    unit = parameter.shown_unit.replace(" ", "\u00a0")
    return f"{parameter.label}, {unit}" if unit else parameter.label


def hint(parameter: Parameter) -> str:
    """What it is, what happens when it grows, and where it stands in the paper."""
    parts = [_in_words(parameter)]
    if parameter.growth:
        parts.append(f"When it grows: {parameter.growth[0].lower()}{parameter.growth[1:]}")
    if parameter.per_wheel:
        parts.append("One value for all road wheels, or one for each with commas or blanks between, front first.")
    facts = [f"Symbol {parameter.symbol}"] if parameter.symbol else []
    facts += [f"unit {parameter.shown_unit}"] if parameter.shown_unit else []
    facts += [f"from {parameter.source}"] if parameter.source.startswith(("Table", "section")) else []
    return " ".join(parts) + (f" ({', '.join(facts)})" if facts else "")


def _in_words(parameter: Parameter) -> str:
    """The description as it reads beside a box: what is left out of a file is an empty box, choices are words."""
    text = parameter.description.replace("Left out:", "Empty:").replace("left out:", "empty:")
    for choice in parameter.choices:
        text = text.replace(choice, choice_words(choice))
    return text


def allowed(parameter: Parameter) -> str:
    """Range and unit as shown: "0.5 to 100 km/h"."""
    if parameter.kind == "choice":
        return "one of " + ", ".join(map(choice_words, parameter.choices))
    if parameter.kind in ("points", "parts"):
        return parameter.allowed
    low, high = (number_text(shown_number(parameter, bound)) for bound in (parameter.low, parameter.high))
    return f"{low} to {high} {parameter.shown_unit}".strip()


def shown_number(parameter: Parameter, value: float) -> float:
    """A file's value in the shown unit, free of rounding noise; in a unit of choice with few digits."""
    exact = float(f"{value * parameter.shown_factor:.10g}")
    if parameter.shown_unit not in BY_CHOICE or exact == 0 or not math.isfinite(exact):
        return exact
    short = float(f"{exact:.{TYPED}g}")
    if float(f"{short / parameter.shown_factor:.10g}") == value or abs(exact) >= LARGE:
        return short
    return round(exact, max(COUNTED - 1 - math.floor(math.log10(abs(exact))), 0))


def file_number(parameter: Parameter, shown: float, present: Sequence[float] = ()) -> float | int:
    """A shown value in the file's unit, free of rounding noise; whole where the parameter is.

    What one of the present values, or an end of what is allowed, is shown as means that value.
    """
    known = (*present, parameter.low, parameter.high)
    exact = next((value for value in known if shown_number(parameter, value) == shown), None)
    value = float(f"{shown / parameter.shown_factor:.10g}") if exact is None else float(exact)
    return int(value) if parameter.kind == "integer" and value.is_integer() else value


def slider_numbers(parameter: Parameter, value: float) -> tuple[float, float, float]:
    """Ends and step, as shown, of a slider for vehicles like the one with this value; round ones in all units."""
    low, high, step = (float(shown_number(parameter, number)) for number in parameter.slider(value))
    if parameter.shown_unit not in BY_CHOICE:
        return low, high, step
    step = round_step(step)
    low, high = math.ceil(low / step - 1e-9) * step, math.floor(high / step + 1e-9) * step
    return float(f"{low:.10g}"), float(f"{high:.10g}"), step


def step_number(parameter: Parameter) -> float:
    """The step of a box for numbers, as shown."""
    step = float(shown_number(parameter, parameter.step))
    return round_step(step) if parameter.shown_unit in BY_CHOICE else step


def round_step(step: float) -> float:
    """The largest of 1, 2 and 5 times a power of ten that is not above a step."""
    power = 10.0 ** math.floor(math.log10(step))
    return float(f"{max(factor for factor in (1, 2, 5) if factor * power <= step * (1 + 1e-9)) * power:.10g}")


def shown_text(parameter: Parameter, value: Any) -> str:
    """A value, a list of values or nothing as text in the shown unit; of a profile and of a sum, what they hold."""
    if value is None:
        return ""
    if parameter.kind == "points":
        x, y = points(value)
        return f"{len(x)} points, {x[-1] - x[0]:.4g} m long, {np.ptp(y):.3g} m high"
    if parameter.kind == "parts":
        return " + ".join(choice_words(road.type) for road in value) or "none"
    if isinstance(value, str):
        return value
    if parameter.kind in ("columns", "units"):
        return ", ".join(value)
    if isinstance(value, tuple):
        return ", ".join(number_text(shown_number(parameter, number)) for number in value)
    return number_text(shown_number(parameter, value))


def file_value(parameter: Parameter, text: str, present: Any = None) -> Any:
    """What a typed text means; the text itself where it means nothing, for the configuration to refuse.

    present: value, or values, that the text stood for before: see `file_number`.
    """
    if not text.strip():
        return None
    bare = text.strip(" ,;[]()")
    parts = [part.strip() for part in bare.replace(";", ",").split(",")]
    if len(parts) == 1 and (parameter.per_wheel or parameter.kind == "list"):
        parts = bare.split()
    if not all(NUMBER.fullmatch(part) for part in parts):
        return text
    before = present if isinstance(present, tuple) else () if present is None else (present,)
    values = tuple(file_number(parameter, float(part), before) for part in parts)
    return values if parameter.kind == "list" or len(values) > 1 else values[0]


def choice_words(choice: str) -> str:
    """A choice as people write it: "half round"."""
    return choice.replace("_", " ")


def value_text(parameter: Parameter, value: Value) -> str:
    """A value with its unit: "75.53 kN/m"; "left out" for one that follows from others or is not there."""
    if value is None:
        return "left out"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if parameter.kind == "choice":
        return choice_words(str(value))
    return f"{shown_text(parameter, value)} {parameter.shown_unit}".strip()


def refusal(fault: Fault, given: Any, config: Config, units: Units = METRIC) -> str:
    """A fault in the words of the panel, in the units that the configuration and the viewer give it."""
    if fault.path not in PARAMETER:
        return f"{units.reword(str(fault))}."
    parameter, message = units.told(config.parameter(fault.path)), units.reword(fault.message)
    out_of_range = fault.message.startswith(f"{fault.value} is not allowed")
    if parameter.kind in ("points", "parts") or not out_of_range:
        return f"{parameter.label}: {message}."
    if fault.value == "nothing":
        return f"{parameter.label}: a value is needed. Give {allowed(parameter)}."
    if isinstance(given, tuple) and not parameter.per_wheel and parameter.kind != "list":
        return f"{parameter.label}: one number is needed, with a point: 1.5, not 1,5. Give {allowed(parameter)}."
    if isinstance(given, tuple) and all(isinstance(one, int | float) and math.isfinite(one) for one in given):
        what = f"{shown_text(parameter, given)} {parameter.shown_unit}".strip()
        return f"{parameter.label}: {what} is not allowed. Give {allowed(parameter)}, for each road wheel."
    if not isinstance(given, int | float) or not math.isfinite(given):
        return f"{parameter.label}: {fault.value} is not allowed. Give {allowed(parameter)}."
    if parameter.low <= given <= parameter.high:
        return f"{parameter.label}: {message}."
    what = f"{shown_text(parameter, given)} {parameter.shown_unit}".strip()
    return f"{parameter.label}: {what} is not allowed. Give {allowed(parameter)}."
