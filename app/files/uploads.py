"""Files that users upload: configurations, profiles and runs; their content may be anything. Pure."""

from __future__ import annotations

from io import BytesIO
from typing import Any

from model.config.config import Config, ConfigError, Fault, ProfileRoad
from model.config.config_files import SIZE_LIMIT, parse_config
from model.config.profile_files import read_profile_file
from model.config.profile_points import PointsError
from model.road.road import RAMP_AHEAD
from model.simulation.trajectory import Trajectory

RUN_LIMIT = 100e6  # bytes of a run's file…
UNPACKED_LIMIT = 500e6  # … and of the arrays in it


def configuration(name: str, content: bytes) -> Config:
    """What a YAML file says. Raises ConfigError with all faults."""
    if len(content) > SIZE_LIMIT:
        raise ConfigError([Fault("", "", f"the file is larger than {SIZE_LIMIT} bytes")], name)
    try:
        return parse_config(content.decode("utf-8-sig"), source=name)
    except UnicodeDecodeError:
        raise ConfigError([Fault("", "", "the file is not UTF-8 text")], name) from None


def profile_changes(name: str, content: bytes, config: Config) -> tuple[dict[str, Any], str]:
    """Changes (dotted key -> value) that make a file's profile the road, and a sentence that says what was read.

    A profile that is not level under the vehicle is put ahead of it. Raises ConfigError with all faults.
    """
    try:
        read = read_profile_file(content)
    except PointsError as error:
        raise ConfigError([Fault("", "", str(error))], name) from None
    changes: dict[str, Any] = {"road.type": "profile", "road.file": name, "road.points": read.points}
    if isinstance(config.road, ProfileRoad):
        changes |= {"road.columns": (), "road.units": ()}  # those of the file before
    try:
        config.replace(changes)
    except ConfigError:
        changes["road.start"] = round(config.vehicle.road_wheels.x[0] + RAMP_AHEAD, 6)
        config.replace(changes)
    return changes, read.said


def run_from(name: str, content: bytes) -> Trajectory:
    """The run in a .npz file. Raises ValueError (the message says why), or ConfigError for its configuration."""
    if len(content) > RUN_LIMIT:
        raise ValueError(f"{name} is larger than {RUN_LIMIT / 1e6:.0f} MB.")
    return Trajectory.load(BytesIO(content), name, largest=UNPACKED_LIMIT)
