"""The configuration of one run: frozen, typed, validated once where it enters.

Defaults, ranges and descriptions are in parameters.py, what may stand together in validation.py; config_files.py reads
and writes it.
"""

from __future__ import annotations

from collections.abc import Mapping
from operator import attrgetter
from typing import Annotated, Any, Literal, TypeVar

from pydantic import BaseModel, ConfigDict, Field, model_validator

from model.config.parameters import PARAMETER, PARAMETERS, Parameter, Value
from model.config.validation import (
    EXCLUSIVE,
    ConfigError,
    Fault,
    check_values,
    convert,
    rules_hold,
    unknown_fault,
    wheel_positions,
)

__all__ = ["Config", "ConfigError", "Fault", "config_from_dict"]

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
        return nested_values(values)

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
            config = config_from_dict(nested_values(known))
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


def _plain(part: Any) -> Any:
    """A section given as an object, as the mapping it was made of."""
    if isinstance(part, SimpleRoad | SumRoad):
        part = {"type": part.type} | {name: getattr(part, name) for name in part.model_fields_set}
    elif isinstance(part, Section):
        part = part.model_dump(exclude_unset=True)
    if isinstance(part, dict) and isinstance(part.get("parts"), list | tuple):
        part = part | {"parts": [_plain(road) for road in part["parts"]]}
    return part


def nested_values(values: Mapping[str, Any]) -> dict[str, Any]:
    """Nested mappings from values by dotted path."""
    nested: dict[str, Any] = {}
    for path, value in values.items():
        *sections, leaf = path.split(".")
        inner = nested
        for section in sections:
            inner = inner.setdefault(section, {})
        inner[leaf] = value
    return nested
