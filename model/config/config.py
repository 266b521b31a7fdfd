"""The configuration of one run: frozen, typed, validated once where it enters; from YAML and back.

Defaults, ranges and descriptions are in parameters.py, what may stand together in validation.py.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from importlib import resources
from operator import attrgetter
from pathlib import Path
from typing import Annotated, Any, Literal, TypeVar

import yaml
from pydantic import BaseModel, ConfigDict, Field, model_validator

from model.config.parameters import PARAMETER, PARAMETERS, PART_LIMIT, Parameter, Value
from model.config.profile_files import ProfileFile, read_profile_file
from model.config.profile_points import FILE_LIMIT, PointsError
from model.config.strict_yaml import dump_yaml, parse_yaml
from model.config.validation import (
    EXCLUSIVE,
    ConfigError,
    Fault,
    check_values,
    convert,
    rules_hold,
    shorten,
    unknown_fault,
    wheel_positions,
)
from model.files import read_file

__all__ = [
    "Config",
    "ConfigError",
    "Fault",
    "config_from_dict",
    "dump_config",
    "load_config",
    "parse_config",
    "parse_value",
    "preset_names",
    "preset_title",
    "read_profile",
]

SIZE_LIMIT = 8_000_000  # bytes of a configuration file; 10 km of profile take 5 million
_PRESETS = resources.files("configs")
_DERIVING = {key for one, others in EXCLUSIVE for key in (one, *others)} | {"road.type"}  # others follow from these
_SINGLE = {key for key in PARAMETER if PARAMETER[key].kind in ("number", "integer", "choice", "flag")} - _DERIVING
_FIELDS = {key: attrgetter(key) for key in PARAMETER}


def _field(key: str) -> Any:
    """A field with the default and the description of the parameter table."""
    return Field(default=PARAMETER[key].default, description=PARAMETER[key].description)


class Section(BaseModel):
    """Part of a configuration. Its values are checked when a Config is made of it."""

    model_config = ConfigDict(frozen=True, extra="forbid")


class Chassis(Section):
    mass: float = _field("vehicle.chassis.mass")
    pitch_inertia: float = _field("vehicle.chassis.pitch_inertia")
    cg_height: float = _field("vehicle.chassis.cg_height")
    belly_height: float | None = _field("vehicle.chassis.belly_height")


class Seat(Section):
    """The driver's, from the hull's centre of mass, in the hull's frame."""

    x: float = _field("vehicle.seat.x")
    y: float = _field("vehicle.seat.y")


class RoadWheels(Section):
    """With `positions`, the other three are derived: number of wheels, mean spacing, middle."""

    count: int = _field("vehicle.road_wheels.count")
    spacing: float = _field("vehicle.road_wheels.spacing")
    offset: float = _field("vehicle.road_wheels.offset")
    positions: tuple[float, ...] | None = _field("vehicle.road_wheels.positions")
    radius: float = _field("vehicle.road_wheels.radius")
    mass: float = _field("vehicle.road_wheels.mass")
    inertia: float | None = _field("vehicle.road_wheels.inertia")

    @property
    def x(self) -> tuple[float, ...]:
        """x of each road wheel's centre in the design pose, front first, m."""
        return wheel_positions(self.positions, self.count, self.spacing, self.offset)


class RoadArms(Section):
    length: float = _field("vehicle.road_arms.length")
    angle_deg: float = _field("vehicle.road_arms.angle_deg")
    mass: float = _field("vehicle.road_arms.mass")
    inertia: float | None = _field("vehicle.road_arms.inertia")


class RoadSuspension(Section):
    basis: str = _field("vehicle.road_suspension.basis")
    stiffness: float | tuple[float, ...] = _field("vehicle.road_suspension.stiffness")
    damping: float | tuple[float, ...] = _field("vehicle.road_suspension.damping")
    progression: float = _field("vehicle.road_suspension.progression")
    rebound_ratio: float = _field("vehicle.road_suspension.rebound_ratio")
    bump_travel: float | None = _field("vehicle.road_suspension.bump_travel")
    rebound_travel: float | None = _field("vehicle.road_suspension.rebound_travel")
    stop_stiffness: float = _field("vehicle.road_suspension.stop_stiffness")
    stop_damping: float = _field("vehicle.road_suspension.stop_damping")


class ImaginaryWheels(Section):
    enabled: bool = _field("vehicle.imaginary_wheels.enabled")
    mass: float = _field("vehicle.imaginary_wheels.mass")
    inertia: float | None = _field("vehicle.imaginary_wheels.inertia")


class ImaginaryArms(Section):
    mass: float = _field("vehicle.imaginary_arms.mass")


class ImaginarySuspension(Section):
    """With `preload_force`, `preload_deflection` means nothing."""

    basis: str = _field("vehicle.imaginary_suspension.basis")
    stiffness: float = _field("vehicle.imaginary_suspension.stiffness")
    damping: float = _field("vehicle.imaginary_suspension.damping")
    preload_deflection: float = _field("vehicle.imaginary_suspension.preload_deflection")
    preload_force: float | None = _field("vehicle.imaginary_suspension.preload_force")
    reacts_on: str = _field("vehicle.imaginary_suspension.reacts_on")


class Vehicle(Section):
    chassis: Chassis = Chassis()
    seat: Seat = Seat()
    road_wheels: RoadWheels = RoadWheels()
    road_arms: RoadArms = RoadArms()
    road_suspension: RoadSuspension = RoadSuspension()
    imaginary_wheels: ImaginaryWheels = ImaginaryWheels()
    imaginary_arms: ImaginaryArms = ImaginaryArms()
    imaginary_suspension: ImaginarySuspension = ImaginarySuspension()
    hull: str = _field("vehicle.hull")


class Contact(Section):
    normal_stiffness: float = _field("contact.normal_stiffness")
    normal_damping: float = _field("contact.normal_damping")
    tangential_stiffness: float = _field("contact.tangential_stiffness")
    tangential_damping: float = _field("contact.tangential_damping")
    friction: float = _field("contact.friction")


class Drive(Section):
    mode: str = _field("drive.mode")
    speed_kmh: float = _field("drive.speed_kmh")
    proportional_gain: float = _field("drive.proportional_gain")
    integral_gain: float = _field("drive.integral_gain")
    force_limit: float = _field("drive.force_limit")


class FlatRoad(Section):
    type: Literal["flat"] = "flat"


class SineRoad(Section):
    type: Literal["sine"] = "sine"
    amplitude: float = _field("road.amplitude")
    wavelength: float = _field("road.wavelength")
    start: float | None = _field("road.start")
    ramp: float | None = _field("road.ramp")


class HalfRoundRoad(Section):
    type: Literal["half_round"] = "half_round"
    position: float = _field("road.position")
    height: float = _field("road.height")
    radius: float = _field("road.radius")


class TrapezoidRoad(Section):
    type: Literal["trapezoid"] = "trapezoid"
    position: float = _field("road.position")
    height: float = _field("road.height")
    top: float = _field("road.top")
    base: float = _field("road.base")


class StepRoad(Section):
    type: Literal["step"] = "step"
    position: float = _field("road.position")
    height: float = _field("road.height")
    ramp: float | None = _field("road.ramp")


class RandomRoad(Section):
    type: Literal["random"] = "random"
    roughness_class: str = _field("road.roughness_class")
    seed: int = _field("road.seed")
    length: float = _field("road.length")
    longest_wave: float = _field("road.longest_wave")


class ProfileRoad(Section):
    """`file`, `columns` and `units` only say where the points came from: they were read when it was loaded."""

    type: Literal["profile"] = "profile"
    file: str = _field("road.file")
    columns: tuple[str, ...] = _field("road.columns")
    units: tuple[str, ...] = _field("road.units")
    points: str = _field("road.points")
    start: float | None = _field("road.start")


SimpleRoad = FlatRoad | SineRoad | HalfRoundRoad | TrapezoidRoad | StepRoad | RandomRoad | ProfileRoad


class SumRoad(Section):
    type: Literal["sum"] = "sum"
    parts: tuple[Annotated[SimpleRoad, Field(discriminator="type")], ...] = _field("road.parts")


Road = Annotated[SimpleRoad | SumRoad, Field(discriminator="type")]


class Simulation(Section):
    duration: float = _field("simulation.duration")
    output_rate: float = _field("simulation.output_rate")
    integrator: str = _field("simulation.integrator")
    step: float = _field("simulation.step")
    rtol: float = _field("simulation.rtol")
    atol: float = _field("simulation.atol")
    baumgarte_alpha: float = _field("simulation.baumgarte_alpha")
    baumgarte_beta: float = _field("simulation.baumgarte_beta")


class Config(Section):
    """One vehicle on one road, and how to compute it. Making one checks everything (ConfigError)."""

    name: str = _field("name")
    description: str = _field("description")
    vehicle: Vehicle = Vehicle()
    contact: Contact = Contact()
    drive: Drive = Drive()
    road: Road = SineRoad()
    simulation: Simulation = Simulation()

    @model_validator(mode="before")
    @classmethod
    def _check(cls, given: Any) -> dict[str, Any]:
        if isinstance(given, Config):
            return given.__dict__
        if isinstance(given, dict):
            given = {key: _plain(part) for key, part in given.items()}
        values = check_values(given)
        values.setdefault("road.type", PARAMETER["road.type"].default)
        positions = values.get("vehicle.road_wheels.positions")
        if isinstance(positions, tuple):
            values["vehicle.road_wheels.count"] = len(positions)
            values["vehicle.road_wheels.spacing"] = (positions[0] - positions[-1]) / (len(positions) - 1)
            values["vehicle.road_wheels.offset"] = (positions[0] + positions[-1]) / 2
        return _nest(values)

    def value(self, path: str) -> Value:
        """The value at a dotted path. Raises KeyError for a key that this configuration does not have."""
        if path not in PARAMETER or not PARAMETER[path].applies_to(self.road.type):
            raise KeyError(path)
        return _FIELDS[path](self)

    def parameter(self, path: str) -> Parameter:
        """The table's row of a key, in the unit that its basis (wheel or torsion) gives it here. Raises KeyError."""
        parameter, basis = PARAMETER[path], f"{path.rpartition('.')[0]}.basis"
        return parameter.torsional() if basis in PARAMETER and self.value(basis) == "torsion" else parameter

    def values(self) -> dict[str, Value]:
        """Everything a file must say to get this configuration, by dotted path, in the table's order."""
        values = {
            parameter.key: _FIELDS[parameter.key](self)
            for parameter in PARAMETERS
            if parameter.applies_to(self.road.type)
        }
        for one, others in EXCLUSIVE:
            if values[one] is not None:
                for other in others:
                    del values[other]
        return {path: value for path, value in values.items() if value is not None}

    def replace(self, changes: Mapping[str, Any]) -> Config:
        """A new configuration with these values, by dotted path; None takes an optional value away.

        Of two ways to say the same (positions or count, spacing, offset; preload force or deflection) the new
        one stays, and a new road type drops what only the old one had. Raises ConfigError with all faults.
        """
        quick = self._with_values(changes)
        if quick is not None:
            return quick
        values: dict[str, Any] = dict(self.values())
        for one, others in EXCLUSIVE:
            if changes.get(one) is not None:
                for other in others:
                    values.pop(other, None)
            elif one in values and (one in changes or any(other in changes for other in others)):
                del values[one]
                values |= {other: self.value(other) for other in others}
        road_type = str(changes.get("road.type", self.road.type))
        known = {path: value for path, value in values.items() if PARAMETER[path].applies_to(road_type)}
        known |= {path: value for path, value in changes.items() if path in PARAMETER}
        faults = [unknown_fault(path, value) for path, value in changes.items() if path not in PARAMETER]
        try:
            config = config_from_dict(_nest(known))
        except ConfigError as error:
            faults += error.faults
        if faults:
            raise ConfigError(faults)
        return config

    def _with_values(self, changes: Mapping[str, Any]) -> Config | None:
        """The same, where single values change that nothing else is derived from, as in a study: what stays is not
        checked again. None for other changes, and for values that are not allowed.
        """
        if not all(key in _SINGLE and PARAMETER[key].applies_to(self.road.type) for key in changes):
            return None
        config = self
        try:
            for key, value in changes.items():
                config = _put(config, key.split("."), convert(PARAMETER[key], value))
        except (ValueError, OverflowError):
            return None
        return config if rules_hold(changes.keys(), config.value, self.road.type) else None


S = TypeVar("S", bound=Section)


def _put(section: S, path: list[str], value: Value) -> S:
    """The section with another value at a path within it."""
    name, *rest = path
    return section.model_copy(update={name: _put(getattr(section, name), rest, value) if rest else value})


def config_from_dict(given: Any) -> Config:
    """A Config from nested mappings. Raises ConfigError with all faults."""
    return Config.model_validate(given)


def parse_config(text: str, source: str = "") -> Config:
    """A Config from YAML text; `source` names it in messages. Raises ConfigError with all faults."""
    return _configured(text, source, None, {}, None)


def parse_value(text: str) -> Any:
    """A single value as a YAML file would give it: text, a list, or None. Raises ConfigError."""
    return _parsed(text)


def dump_config(config: Config) -> str:
    """The whole configuration as YAML; parse_config gives the same one back."""
    values = config.values()
    if isinstance(config.road, SumRoad):
        values["road.parts"] = tuple(part_values(part) for part in config.road.parts)
    return dump_yaml(_nest(values))


def part_values(road: SimpleRoad) -> dict[str, Value]:
    """All that a file says of a road that is part of a sum, by the last word of its key."""
    keys = {key.removeprefix("road."): PARAMETER[key] for key in PARAMETER if key.startswith("road.")}
    values = {name: getattr(road, name) for name, parameter in keys.items() if parameter.applies_to(road.type)}
    return {name: value for name, value in values.items() if value is not None}


def load_config(
    path_or_preset: str | Path,
    reading: Mapping[str, Any] | None = None,
    on_read: Callable[[str], None] | None = None,
) -> Config:
    """A Config from a preset's name or a YAML file, with the profiles it names. Raises ConfigError with all faults.

    reading: road.columns and road.units that take the place of the file's; on_read: gets a sentence for each profile.
    """
    name = str(path_or_preset)
    folder = None
    try:
        if name in preset_names():
            data = (_PRESETS / f"{name}.yaml").read_bytes()
        else:
            folder = Path(path_or_preset).parent
            data = read_file(path_or_preset, SIZE_LIMIT)
    except FileNotFoundError:
        known = ", ".join(preset_names())
        raise _text_error(f"there is no such file, nor a preset of that name ({known})", name) from None
    except (OSError, ValueError) as error:
        raise _text_error(f"cannot be read: {getattr(error, 'strerror', None) or error}", name) from None
    if len(data) > SIZE_LIMIT:
        raise _text_error(f"the file is larger than {SIZE_LIMIT} bytes", name)
    try:
        return _configured(data.decode("utf-8-sig"), name, folder, reading or {}, on_read)
    except UnicodeDecodeError:
        raise _text_error("the file is not UTF-8 text", name) from None


def read_profile(path: str | Path, columns: Any = (), units: Any = (), key: str = "road.file") -> ProfileFile:
    """The profile in a file; columns and units as in a configuration. Raises ConfigError for `key`."""
    place = key.removesuffix("file")
    given = {"columns": columns, "units": units}
    for name, value in given.items():
        parameter = PARAMETER[f"road.{name}"]
        try:
            given[name] = convert(parameter, value)
        except ValueError:
            message = f"{shorten(value)} is not allowed; give {parameter.allowed}"
            raise ConfigError([Fault(f"{place}{name}", shorten(value), message)]) from None
    try:
        return read_profile_file(read_file(path, FILE_LIMIT), given["columns"], given["units"])
    except PointsError as error:
        message = f"{error} ({Path(path).name[:80]})"
    except (OSError, ValueError) as error:
        message = f"{str(path)[:200]} cannot be read: {getattr(error, 'strerror', None) or error}"
    raise ConfigError([Fault(key, str(path), message)])


def _configured(
    text: str,
    source: str,
    folder: Path | None,
    reading: Mapping[str, Any],
    on_read: Callable[[str], None] | None,
) -> Config:
    """A Config from YAML text; profiles are read from files in the folder, if there is one."""
    faults: list[Fault] = []
    said: list[str] = []
    try:
        given = _parsed(text)
        if folder is not None and isinstance(given, dict):
            road = given.get("road")
            if isinstance(road, dict) and road.get("type") == "profile":
                road |= {key.removeprefix("road."): value for key, value in reading.items()}
            _read_profiles(road, "road", folder, faults, said)
        config = config_from_dict(given)
    except ConfigError as error:
        faults += error.faults
    if faults:
        raise ConfigError(faults, source)
    if on_read is not None:
        for sentence in said:
            on_read(sentence)
    return config


def _read_profiles(road: Any, key: str, folder: Path, faults: list[Fault], said: list[str]) -> None:
    """Put the points of the files that a road names beside the names, and say what was read."""
    if not isinstance(road, dict):
        return
    file = road.get("file")
    if road.get("type") == "profile" and isinstance(file, str) and file and "points" not in road:
        try:
            read = read_profile(folder / file, road.get("columns", ()), road.get("units", ()), f"{key}.file")
            road["points"] = read.points
            said.append(f"{file}: {read.said}")
        except ConfigError as error:
            faults += error.faults
            for name in ("file", "columns", "units"):
                road.pop(name, None)
    parts = road.get("parts")
    for number, part in enumerate(parts[:PART_LIMIT] if isinstance(parts, list) else []):
        _read_profiles(part, f"{key}.parts[{number}]", folder, faults, said)


def preset_names() -> list[str]:
    """Names of the configurations that come with the program, the paper's first."""
    names = (file.name.removesuffix(".yaml") for file in _PRESETS.iterdir() if file.name.endswith(".yaml"))
    return sorted(names, key=lambda name: (not name.startswith("paper"), name))


def preset_title(name: str) -> str:
    """The title of a preset."""
    return load_config(name).name


def _plain(part: Any) -> Any:
    """A section given as an object, as the mapping it was made of."""
    if isinstance(part, SimpleRoad | SumRoad):
        part = {"type": part.type} | {name: getattr(part, name) for name in part.model_fields_set}
    elif isinstance(part, Section):
        part = part.model_dump(exclude_unset=True)
    if isinstance(part, dict) and isinstance(part.get("parts"), list | tuple):
        part = part | {"parts": [_plain(road) for road in part["parts"]]}
    return part


def _nest(values: Mapping[str, Any]) -> dict[str, Any]:
    """Nested mappings from values by dotted path."""
    nested: dict[str, Any] = {}
    for path, value in values.items():
        *sections, leaf = path.split(".")
        inner = nested
        for section in sections:
            inner = inner.setdefault(section, {})
        inner[leaf] = value
    return nested


def _parsed(text: str) -> Any:
    try:
        return parse_yaml(text)
    except yaml.reader.ReaderError as error:
        line = text.count("\n", 0, error.position) + 1
        raise _text_error(f"line {line}: not YAML text: the character U+{error.character:04X} is not allowed") from None
    except yaml.MarkedYAMLError as error:
        mark, problem = error.problem_mark, " ".join((error.problem or "not YAML").split())
        where = f"line {mark.line + 1}, column {mark.column + 1}: " if mark else ""
        raise _text_error(where + _CLEARER.get(problem, problem) + _lines(text, mark, error.context_mark)) from None


def _lines(text: str, mark: yaml.Mark | None, context: yaml.Mark | None) -> str:
    """The line at which a fault was found, and the one where what is faulty began, if that is another."""
    lines = text.splitlines()
    if len(lines) < 2:
        return ""
    shown = {place.line: lines[place.line].strip() for place in (mark, context) if place and place.line < len(lines)}
    return "".join(f"; line {number + 1} is {shorten(line)}" for number, line in shown.items() if line)


# What PyYAML says, and what a reader can do about it
_CLEARER = {
    r"found character '\t' that cannot start any token": "a tab; indent with blanks",
    "but found another document": "a second document; give one, without a line ---",
    "mapping values are not allowed here": "a colon too many; put texts that hold one in quotes",
}


def _text_error(message: str, source: str = "") -> ConfigError:
    return ConfigError([Fault("", "", message)], source)
