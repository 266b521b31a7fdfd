"""Whether given values make a configuration: every fault at once, in words, from the parameter table."""

from __future__ import annotations

import math
import numbers
import reprlib
from collections.abc import Callable, Iterator, Sequence, Set
from dataclasses import dataclass, field
from difflib import SequenceMatcher, get_close_matches
from itertools import pairwise
from typing import Any

import numpy as np

from model.config.parameters import (
    PARAMETER,
    PART_LIMIT,
    SECTIONS,
    STEEPEST,
    UNITS,
    WHEEL_COUNT,
    Parameter,
    Value,
    number_text,
)
from model.config.profile_points import STATIONED, PointsError, points

SAMPLE_LIMIT = 100_000  # stored samples of one run
STEP_LIMIT = 5_000_000  # fixed steps of one run
LEVEL = 0.001  # m: a profile under the vehicle may be this uneven
FAULT_LIMIT = 50  # more than a reader can use; bounds the work on hostile files

WHEELS, IMAGINARY = "vehicle.road_wheels", "vehicle.imaginary_suspension"
# Either the first key or the others describe the same thing.
EXCLUSIVE: tuple[tuple[str, tuple[str, ...]], ...] = (
    (f"{WHEELS}.positions", (f"{WHEELS}.count", f"{WHEELS}.spacing", f"{WHEELS}.offset")),
    (f"{IMAGINARY}.preload_force", (f"{IMAGINARY}.preload_deflection",)),
)


@dataclass(frozen=True)
class Fault:
    """One thing wrong with a configuration."""

    path: str  # dotted key; empty: the text as a whole
    value: str  # what was given, shortened
    message: str  # what is wrong and what is allowed, with the unit
    line: int = field(default=0, compare=False)  # of the text that says it, from 1; 0: not known

    def __str__(self) -> str:
        return f"{self.path}: {self.message}" if self.path else self.message


class ConfigError(Exception):
    """A configuration that cannot be used; `faults` says all that is wrong with it."""

    def __init__(self, faults: Sequence[Fault], source: str = "") -> None:
        super().__init__(faults, source)
        self.faults = tuple(faults)
        self.source = source

    def __str__(self) -> str:
        prefix = f"{self.source}: " if self.source else ""
        return "\n".join(f"{prefix}{fault}" for fault in self.faults)


def check_values(given: Any) -> dict[str, Value]:
    """Values by dotted path, converted to the table's kinds, from nested mappings; keys left out stay out.

    Raises ConfigError with all faults: unknown keys, kinds, ranges, choices, contradictions.
    """
    faults: list[Fault] = []
    values = _converted(given, faults)
    faults += _contradictions(values, {fault.path for fault in faults})
    parts = values.get("road.parts")
    if isinstance(parts, tuple):
        values["road.parts"] = tuple(_checked_part(part, number, values, faults) for number, part in enumerate(parts))
    if len(faults) > FAULT_LIMIT:
        faults[FAULT_LIMIT:] = [Fault("", "", "there are more faults")]
    if faults:
        raise ConfigError(faults)
    return values


def _converted(given: Any, faults: list[Fault]) -> dict[str, Value]:
    """The sound ones of given values by dotted path, converted to the table's kinds; the others go to the faults."""
    values: dict[str, Value] = {}
    for path, value in _flatten(given, "", faults):
        parameter = PARAMETER[path]
        if value is None and parameter.optional:
            continue
        try:
            values[path] = convert(parameter, value)
        except PointsError as error:
            faults.append(Fault(path, shorten(value), str(error)))
        except (ValueError, OverflowError):
            faults.append(_not_allowed(parameter, value))
    return values


def _checked_part(part: Any, number: int, values: dict[str, Value], faults: list[Fault]) -> dict[str, Value]:
    """The values of a road that is part of a sum, checked like a road of its own under the same vehicle."""
    own: list[Fault] = []
    if not isinstance(part, dict):
        own.append(Fault("road", shorten(part), f"{shorten(part)} is not allowed; a road holds keys and values"))
        part = {}
    road = _converted({"road": part}, own)
    if road.get("road.type") == "sum":
        own.append(Fault("road.type", "sum", "a sum cannot be part of a sum; name its parts here"))
        road = {}
    others = {path: value for path, value in values.items() if not path.startswith("road.")}
    own += _contradictions(others | road, {fault.path for fault in own})
    name = f"road.parts[{number}]"
    for fault in own:
        if fault.path.partition(".")[0] == "road":
            faults.append(Fault(name + fault.path[4:], fault.value, fault.message.replace("road.", f"{name}.")))
        elif fault not in faults:
            faults.append(Fault(name, fault.value, fault.message))
    return {"type": PARAMETER["road.type"].default} | {path[5:]: value for path, value in road.items()}


def rules_hold(changed: Set[str], value: Callable[[str], Value], road_type: str) -> bool:
    """Whether values fit each other after some of a sound configuration's have changed; value: of a key now.

    Parts of a sum are not looked into: false where a changed key may matter to one.
    """
    for keys, rule in _RULES:
        if changed.isdisjoint(keys):
            continue
        if road_type == "sum":
            return False
        if all(PARAMETER[key].applies_to(road_type) for key in keys) and rule(*map(value, keys)):
            return False
    return True


def unknown_fault(path: str, value: Any) -> Fault:
    """The fault of a key that does not exist, with the nearest one that does."""
    if path in SECTIONS:
        first = next(key for key in PARAMETER if key.startswith(f"{path}."))
        return Fault(path, shorten(value), f"is a section; name one of its keys, such as {first}")
    known = [*PARAMETER, *SECTIONS]
    parent, _, leaf = path[:200].rpartition(".")
    siblings = {key.rpartition(".")[2]: key for key in known if key.rpartition(".")[0] == parent}
    near = [siblings[name] for name in get_close_matches(leaf, siblings, n=1)]
    if not near:
        score = {key: SequenceMatcher(None, leaf, key.rpartition(".")[2]).ratio() for key in known}
        near = [max(known, key=lambda key: score[key])]
    shown = path if path.isprintable() else ascii(path)[1:-1]
    return Fault(shown[:100], shorten(value), f"unknown key; the nearest known one is {near[0]}")


def shorten(value: Any) -> str:
    """A value as it was given, at most some 60 characters."""
    if value is None:
        return "nothing"
    if isinstance(value, str):
        try:
            float(value)
        except ValueError:
            pass
        else:
            text = value.strip()
            return text if len(text) <= 40 else f"{text[:30]}… ({len(text)} characters)"
    try:
        return _shortener.repr(value)
    except Exception:  # a hostile __repr__, or an integer of more digits than Python prints
        return f"a value of type {type(value).__name__}"


_shortener = reprlib.Repr()
_shortener.maxstring = _shortener.maxother = 60
_shortener.maxlevel = 3


def _flatten(given: Any, section: str, faults: list[Fault]) -> Iterator[tuple[str, Any]]:
    """(path, value) of every known key; unknown keys and sections that are none go to the faults."""
    if given is None:
        return
    if not isinstance(given, dict):
        message = f"{shorten(given)} is not allowed; {section or 'a configuration'} holds keys and values"
        faults.append(Fault(section, shorten(given), message))
        return
    for key, value in given.items():
        word = key if isinstance(key, str) and key else shorten(key)
        path = f"{section}.{word}" if section else word
        if path in PARAMETER:
            yield path, value
        elif path in SECTIONS:
            yield from _flatten(value, path, faults)
        elif len(faults) <= FAULT_LIMIT:
            faults.append(unknown_fault(path, value))


def convert(parameter: Parameter, value: Any) -> Value:
    """The value in the parameter's kind. Raises ValueError or OverflowError when it is not allowed."""
    match parameter.kind:
        case "number":
            if parameter.per_wheel and isinstance(value, list | tuple):
                return _numbers(parameter, value)
            return _number(parameter, value)
        case "integer":
            number = _number(parameter, value)
            if number.is_integer():
                return int(number)
        case "list":
            if isinstance(value, list | tuple):
                return _numbers(parameter, value)
        case "choice":
            if isinstance(value, str) and value in parameter.choices:
                return value
        case "flag":
            if isinstance(value, bool):
                return value
            if isinstance(value, str) and value.lower() in _FLAG_WORDS:
                return _FLAG_WORDS[value.lower()]
        case "text":
            if isinstance(value, str):
                text = " ".join(value.split())
                if text.isprintable() and len(text) <= parameter.high:
                    return text
        case "columns":
            return _columns(value)
        case "units":
            return _units(value)
        case "points":
            if isinstance(value, str):
                text = value if value.isprintable() else " ".join(value.split())
                points(text)
                return text
        case "parts":
            if isinstance(value, list | tuple) and len(value) <= PART_LIMIT:
                return tuple(value)
    raise ValueError


def _columns(value: Any) -> tuple[str, ...]:
    """Names or numbers of columns."""
    names = value.split(",") if isinstance(value, str) else [value] if isinstance(value, int) else value
    if not isinstance(names, list | tuple) or len(names) > 2:
        raise ValueError
    if not all(isinstance(name, str | int) and not isinstance(name, bool) for name in names):
        raise ValueError
    texts = tuple(" ".join(str(name).split()) for name in names)
    if not all(text and text.isprintable() and len(text) <= 100 for text in texts):
        raise ValueError
    return texts


def _units(value: Any) -> tuple[str, ...]:
    """The unit of x and that of y, empty where the heading says it; one for both may be given alone."""
    if isinstance(value, dict):
        if not set(value) <= {"x", "y"}:
            raise ValueError
        value = (value.get("x", ""), value.get("y", "")) if value else ()
    elif isinstance(value, str):
        value = (value, value)
    if not isinstance(value, list | tuple) or len(value) not in (0, 2):
        raise ValueError
    if not all(isinstance(unit, str) and (unit in UNITS or not unit) for unit in value):
        raise ValueError
    return tuple(value)


_FLAG_WORDS = {"true": True, "yes": True, "on": True, "false": False, "no": False, "off": False}


def _number(parameter: Parameter, value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, numbers.Real | str):
        raise ValueError
    number = float(value)
    if not parameter.low <= number <= parameter.high:  # NaN is outside as well
        raise ValueError
    return number


def _numbers(parameter: Parameter, values: list[Any] | tuple[Any, ...]) -> tuple[float, ...]:
    if not WHEEL_COUNT[0] <= len(values) <= WHEEL_COUNT[1]:
        raise ValueError
    return tuple(_number(parameter, value) for value in values)


def _not_allowed(parameter: Parameter, value: Any) -> Fault:
    given = shorten(value)
    return Fault(parameter.key, given, f"{given} is not allowed; give {parameter.allowed}")


# Values that must fit each other


def wheel_positions(
    positions: tuple[float, ...] | None, count: int, spacing: float, offset: float
) -> tuple[float, ...]:
    """x of each road wheel's centre in the design pose, front first, m (model/MODEL.md, "Design pose")."""
    if positions is not None:
        return positions
    front = (count - 1) * spacing / 2 + offset
    return tuple(front - i * spacing for i in range(count))


def _contradictions(values: dict[str, Value], faulty: set[str]) -> Iterator[Fault]:
    """Faults of values that are sound each for itself; rules that need a faulty one are left out."""

    def fault(key: str, message: str) -> Fault:
        return Fault(key, shorten(values.get(key, PARAMETER[key].default)), message)

    for one, others in EXCLUSIVE:
        for other in others:
            if one in values and other in values:
                yield fault(other, f"{one} says the same; leave one of them out")

    def sound(key: str) -> bool:
        return not faulty or not any(key == path or key.startswith(f"{path}.") or not path for path in faulty)

    road_type = values.get("road.type", PARAMETER["road.type"].default)
    for key in values:
        if sound("road.type") and not PARAMETER[key].applies_to(str(road_type)):
            roads = " and ".join(PARAMETER[key].roads)
            yield fault(key, f"a road of type {road_type} has no such key; it belongs to {roads}")

    if values.get("road.file") and "road.points" not in values and road_type == "profile":
        yield fault("road.file", "only the file of a configuration can name another; give the points, or upload it")

    for keys, rule in _RULES:
        if all(sound(key) and PARAMETER[key].applies_to(str(road_type)) for key in keys):
            message = rule(*(values.get(key, PARAMETER[key].default) for key in keys))
            if message:
                yield fault(next((key for key in keys if key in values), keys[0]), message)


def _positions_fall(positions: tuple[float, ...] | None) -> str | None:
    spacing = PARAMETER[f"{WHEELS}.spacing"]
    for front, rear in pairwise(positions or ()):
        if not spacing.low - 1e-9 <= front - rear <= spacing.high + 1e-9:
            reach = f"{number_text(spacing.low)} to {number_text(spacing.high)} m"
            return f"must fall from front to rear, each wheel {reach} behind the one before"
    return None


def _stands_on_wheels(*layout: Any) -> str | None:
    front, *_, rear = wheel_positions(*layout)
    if front > 0 > rear:
        return None
    reach = f"{front:.4g} to {rear:.4g} m"
    return f"the wheels stand at {reach}; the centre of mass, at 0, must lie between the first and the last"


def _one_for_each_wheel(value: Any, positions: tuple[float, ...] | None, count: int) -> str | None:
    wheels = count if positions is None else len(positions)
    if isinstance(value, tuple) and len(value) != wheels:
        return f"{len(value)} values for {wheels} road wheels; give {wheels}, or one number for all"
    return None


def _arm_can_rise(travel: float | None, length: float, angle_deg: float) -> str | None:
    return _within_reach(travel, length * (1 + math.sin(math.radians(angle_deg))))


def _arm_can_fall(travel: float | None, length: float, angle_deg: float) -> str | None:
    return _within_reach(travel, length * (1 - math.sin(math.radians(angle_deg))))


def _within_reach(travel: float | None, furthest: float) -> str | None:
    if travel is None or travel < furthest:
        return None
    return f"the road arm turns upright before; give less than {furthest:.4g} m"


def _few_samples(output_rate: float, duration: float) -> str | None:
    if output_rate * duration <= SAMPLE_LIMIT:
        return None
    samples = f"{number_text(duration)} s at {number_text(output_rate)} samples a second"
    fits = f"{SAMPLE_LIMIT // duration:.0f} a second, or {SAMPLE_LIMIT // output_rate:.0f} s, would do"
    return f"{samples} are more than the {SAMPLE_LIMIT} samples that are allowed; {fits}"


def _few_steps(step: float, duration: float, integrator: str) -> str | None:
    if integrator != "rk4" or duration / step <= STEP_LIMIT:
        return None
    return f"{number_text(duration)} s in steps of {number_text(step)} s are more than {STEP_LIMIT} steps"


def _not_too_steep(amplitude: float, wavelength: float) -> str | None:
    if amplitude <= wavelength:
        return None
    return f"must not be greater than the wavelength, {number_text(wavelength)} m"


def _waves_ahead(start: float | None, *layout: Any) -> str | None:
    front = wheel_positions(*layout)[0]
    if start is None or start >= front:
        return None
    return f"the first wheel stands at {front:.4g} m; the waves must begin there or further ahead"


def _round_below_radius(height: float, radius: float) -> str | None:
    return None if height <= radius else f"must not be greater than the radius, {number_text(radius)} m"


def _top_within_base(top: float, base: float) -> str | None:
    return None if top <= base else f"must not be greater than the base, {number_text(base)} m"


def _half_round_ahead(position: float, height: float, radius: float, *vehicle: Any) -> str | None:
    if height > radius:
        return None
    return _obstacle_ahead(position, math.sqrt(height * (2 * radius - height)), *vehicle)


def _trapezoid_ahead(position: float, height: float, top: float, base: float, *vehicle: Any) -> str | None:
    return _obstacle_ahead(position, max(base / 2, top / 2 + height / STEEPEST), *vehicle)


def _step_ahead(position: float, ramp: float | None, *vehicle: Any) -> str | None:
    return _obstacle_ahead(position, 0.0, *vehicle)


def _obstacle_ahead(position: float, half_length: float, wheel_radius: float, *layout: Any) -> str | None:
    nearest = wheel_positions(*layout)[0] + wheel_radius + half_length
    if position >= nearest:
        return None
    return f"the obstacle reaches under the vehicle; give at least {nearest:.4g} m"


def _profile_ahead(text: str, start: float | None, wheel_radius: float, *layout: Any) -> str | None:
    if start is not None:
        return None
    x, y = points(text)
    if x[0] > STATIONED:
        return None
    front = wheel_positions(*layout)[0]
    under = np.append(y[x <= front + wheel_radius], [y[0], np.interp(front + wheel_radius, x, y)])
    if np.abs(under).max() <= LEVEL:
        return None
    return (
        f"is not level under the vehicle, as it must be up to x = {front + wheel_radius:.4g} m; or give road.start, "
        f"such as {front + 1:.4g} m, where its first point is then put at ground level"
    )


_LAYOUT = tuple(f"{WHEELS}.{key}" for key in ("positions", "count", "spacing", "offset"))
_VEHICLE = (f"{WHEELS}.radius", *_LAYOUT)
_ARM = ("vehicle.road_arms.length", "vehicle.road_arms.angle_deg")
_ROUND = ("road.height", "road.radius")

# The keys a rule needs, and the rule: their values -> what is wrong, or None. The first given gets the fault.
_RULES: tuple[tuple[tuple[str, ...], Callable[..., str | None]], ...] = (
    (_LAYOUT[:1], _positions_fall),
    (_LAYOUT, _stands_on_wheels),
    (("vehicle.road_suspension.stiffness", *_LAYOUT[:2]), _one_for_each_wheel),
    (("vehicle.road_suspension.damping", *_LAYOUT[:2]), _one_for_each_wheel),
    (("vehicle.road_suspension.bump_travel", *_ARM), _arm_can_rise),
    (("vehicle.road_suspension.rebound_travel", *_ARM), _arm_can_fall),
    (("simulation.output_rate", "simulation.duration"), _few_samples),
    (("simulation.step", "simulation.duration", "simulation.integrator"), _few_steps),
    (("road.amplitude", "road.wavelength"), _not_too_steep),
    (("road.start", *_LAYOUT), _waves_ahead),
    (_ROUND, _round_below_radius),
    (("road.position", *_ROUND, *_VEHICLE), _half_round_ahead),
    (("road.top", "road.base"), _top_within_base),
    (("road.position", "road.height", "road.top", "road.base", *_VEHICLE), _trapezoid_ahead),
    (("road.position", "road.ramp", *_VEHICLE), _step_ahead),
    (("road.points", "road.start", *_VEHICLE), _profile_ahead),
)
