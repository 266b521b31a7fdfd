"""Configurations from YAML and back: presets, files, and the measured profiles that files name."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from importlib import resources
from pathlib import Path
from typing import Any

import yaml

from model.config.config import Config, SimpleRoad, SumRoad, config_from_dict, nested_values
from model.config.parameters import PARAMETER, PART_LIMIT, Value
from model.config.profile_files import ProfileFile, read_profile_file
from model.config.profile_points import FILE_LIMIT, PointsError
from model.config.strict_yaml import dump_yaml, key_lines, parse_yaml
from model.config.validation import ConfigError, Fault, convert, shorten
from model.files import read_file

SIZE_LIMIT = 8_000_000  # bytes of a configuration file; 10 km of profile take 5 million
_PRESETS = resources.files("configs")
# What PyYAML says, and what a reader can do about it
_CLEARER = {
    r"found character '\t' that cannot start any token": "a tab; indent with blanks",
    "but found another document": "a second document; give one, without a line ---",
    "mapping values are not allowed here": "a colon too many; put texts that hold one in quotes",
}


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
    return dump_yaml(nested_values(values))


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
        raise ConfigError(_placed(faults, text), source)
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


def _parsed(text: str) -> Any:
    try:
        return parse_yaml(text)
    except yaml.reader.ReaderError as error:
        line = text.count("\n", 0, error.position) + 1
        message = f"line {line}: not YAML text: the character U+{error.character:04X} is not allowed"
        raise _text_error(message, line=line) from None
    except yaml.MarkedYAMLError as error:
        mark, problem = error.problem_mark, " ".join((error.problem or "not YAML").split())
        where = f"line {mark.line + 1}, column {mark.column + 1}: " if mark else ""
        message = where + _CLEARER.get(problem, problem) + _lines(text, mark, error.context_mark)
        began = error.context_mark if error.context and "block" not in error.context else None  # such as a [ left open
        place = began or mark
        raise _text_error(message, line=place.line + 1 if place else 0) from None


def _lines(text: str, mark: yaml.Mark | None, context: yaml.Mark | None) -> str:
    """The line at which a fault was found, and the one where what is faulty began, if that is another."""
    lines = text.splitlines()
    if len(lines) < 2:
        return ""
    shown = {place.line: lines[place.line].strip() for place in (mark, context) if place and place.line < len(lines)}
    return "".join(f"; line {number + 1} is {shorten(line)}" for number, line in shown.items() if line)


def _text_error(message: str, source: str = "", line: int = 0) -> ConfigError:
    return ConfigError([Fault("", "", message, line)], source)


def _placed(faults: list[Fault], text: str) -> list[Fault]:
    """The faults with the lines of their keys. One without a key is of a text that may be no YAML."""
    if not any(fault.path for fault in faults):
        return faults
    lines = key_lines(text, [fault.path for fault in faults])
    return [replace(fault, line=line) for fault, line in zip(faults, lines, strict=True)]
