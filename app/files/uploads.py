"""Files that users upload: configurations, profiles and runs; their content may be anything. Pure."""

from __future__ import annotations

from dataclasses import dataclass
from io import BytesIO
from typing import Any

from model.config.config import Config, ConfigError, Fault, ProfileRoad
from model.config.config_files import SIZE_LIMIT, parse_config
from model.config.profile_files import ProfileFile, ProfileSource, Reading, open_profile_file
from model.config.profile_points import PointsError
from model.road.road import RAMP_AHEAD
from model.simulation.trajectory import Trajectory

RUN_LIMIT = 100e6  # bytes of a run's file…
UNPACKED_LIMIT = 500e6  # … and of the arrays in it


def text_in(content: bytes) -> str | None:
    """The text of a configuration that may hold faults, to be mended; None: it is no text, or too large."""
    if len(content) > SIZE_LIMIT:
        return None
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        return None


def configuration(name: str, content: bytes) -> Config:
    """What a YAML file says. Raises ConfigError with all faults."""
    if len(content) > SIZE_LIMIT:
        raise ConfigError([Fault("", "", f"the file is larger than {SIZE_LIMIT} bytes")], name)
    try:
        return parse_config(content.decode("utf-8-sig"), source=name)
    except UnicodeDecodeError:
        raise ConfigError([Fault("", "", "the file is not UTF-8 text")], name) from None


@dataclass(frozen=True)
class ProfileQuestion:
    """A file with a profile of which the user is to say how it is to be read."""

    name: str  # of the file
    source: ProfileSource
    reading: Reading  # what is likely
    why: str  # it is asked: a sentence without its full stop; empty: because the user wants it


def profile(name: str, content: bytes) -> ProfileFile | ProfileQuestion:
    """What a file says, or a question where its headings leave something open or contradict the numbers.

    Raises ConfigError where it can be read in no way.
    """
    try:
        source = open_profile_file(content)
        try:
            read, why = source.read(), source.doubt
        except PointsError as error:
            likely, why = source.likely(), str(error)
        else:
            if not why:
                return read
            likely = source.likely()
    except PointsError as error:
        raise _refused(name, str(error)) from None
    if likely is None:
        raise _refused(name, why)
    return ProfileQuestion(name, source, likely, why)


def question(name: str, content: bytes, present: Reading) -> ProfileQuestion:
    """The question how a file is to be read that is read in this way now, in which all or nothing may be said.

    Raises ConfigError where it can be read in no way.
    """
    try:
        source = open_profile_file(content)
    except PointsError as error:
        raise _refused(name, str(error)) from None
    whole = len(present.columns) == (2 if source.x_is_column else 1) and all(present.units)
    reading = present if whole and set(present.columns) <= set(source.columns) else source.likely()
    if reading is None:
        raise _refused(name, "there is no way in which its numbers make a road")
    return ProfileQuestion(name, source, reading, "")


def profile_changes(name: str, read: ProfileFile, reading: Reading | None, config: Config) -> dict[str, Any]:
    """Changes (dotted key -> value) that make a file's profile the road; reading: how the user wants it to be read.

    A profile that is not level under the vehicle is put ahead of it. Raises ConfigError with all faults.
    """
    changes: dict[str, Any] = {"road.type": "profile", "road.file": name, "road.points": read.points}
    if reading is not None:
        changes |= {"road.columns": reading.columns, "road.units": reading.units}
    elif isinstance(config.road, ProfileRoad):
        changes |= {"road.columns": (), "road.units": ()}  # those of the file before
    try:
        config.replace(changes)
    except ConfigError:
        changes["road.start"] = round(config.vehicle.road_wheels.x[0] + RAMP_AHEAD, 6)
        config.replace(changes)
    return changes


def _refused(name: str, why: str) -> ConfigError:
    return ConfigError([Fault("", "", why)], name)


def run_from(name: str, content: bytes) -> Trajectory:
    """The run in a .npz file. Raises ValueError (the message says why), or ConfigError for its configuration."""
    if len(content) > RUN_LIMIT:
        raise ValueError(f"{name} is larger than {RUN_LIMIT / 1e6:.0f} MB.")
    return Trajectory.load(BytesIO(content), name, largest=UNPACKED_LIMIT)
