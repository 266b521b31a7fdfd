"""A project: the runs that are kept, baseline, presets and what is shown, as one file to save and open. Pure.

The file is JSON. Of runs it holds the configurations, from which they are made again in milliseconds.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from contextlib import suppress
from dataclasses import asdict, dataclass, replace
from importlib.metadata import version
from typing import Any, TypeVar

from app.runs.history import RUNS, Kept
from app.runs.request import Request
from app.runs.storage import BAD, PRESETS, config_from, request_from, request_values, run_from, run_values
from app.runs.study_choice import StudyChoice, choice_from
from model.config.config import Config, ConfigError, Fault
from model.config.config_files import part_values
from model.config.validation import shorten

SUFFIX = ".trackride"
FORMAT, VERSION = "Trackride project", 1
LIMIT = 100_000_000  # bytes of a file that is looked at
HEAD = ("format", "version", "made_with")
PARTS = ("shown", "presets", "runs", "ticked", "baseline", "study")

T = TypeVar("T")


@dataclass(frozen=True)
class Project:
    """What the user has at hand."""

    shown: Request
    presets: tuple[Config, ...]  # the user's own, oldest first
    runs: tuple[Kept, ...]  # oldest first; their trajectories are not saved
    ticked: tuple[int, ...]  # places in `runs` of those that are shown beside
    baseline: Kept | None
    study: StudyChoice


def project_text(project: Project) -> str:
    """The content of the file."""
    values = {
        "format": FORMAT,
        "version": VERSION,
        "made_with": f"Trackride {version('trackride')}",
        "shown": request_values(project.shown, project.shown.config()),
        "presets": [preset.values() for preset in project.presets],
        "runs": [run_values(kept) for kept in project.runs],
        "ticked": project.ticked,
        "baseline": None if project.baseline is None else run_values(project.baseline),
        "study": asdict(replace(project.study, fit=0)),
    }
    return json.dumps(values, default=part_values, indent=1, ensure_ascii=False)  # default: roads in a sum


def project_from(name: str, content: bytes) -> Project:
    """What a file says. name: of the file. Raises ConfigError with all faults: nothing of it is used then."""
    values = _values(name, content)
    faults: list[Fault] = [Fault(key, "", "is missing") for key in PARTS if key not in values]
    faults += [Fault(shorten(key), "", "is not known here") for key in values if key not in (*HEAD, *PARTS)]

    def one(place: str, read: Callable[[Any], T], given: Any) -> T | None:
        try:
            return read(given)
        except ConfigError as error:
            faults.extend(Fault(f"{place}: {fault.path}", fault.value, fault.message) for fault in error.faults)
        except BAD as error:
            faults.append(Fault(place, "", f"is not what a project holds ({shorten(str(error))})"))
        return None

    def several(key: str, read: Callable[[Any], T], most: int) -> tuple[T, ...]:
        given = values.get(key, [])
        if not isinstance(given, list) or len(given) > most:
            faults.append(Fault(key, "", f"must be a list of at most {most}"))
            return ()
        found = [one(f"{key}[{number}]", read, each) for number, each in enumerate(given, 1)]
        return tuple(each for each in found if each is not None)

    shown = one("shown", request_from, values["shown"]) if "shown" in values else None
    presets, runs = several("presets", config_from, PRESETS), several("runs", run_from, RUNS)
    ticked = several("ticked", _place(len(values["runs"]) if isinstance(values.get("runs"), list) else 0), RUNS)
    given = values.get("baseline")
    baseline = None if given is None else one("baseline", run_from, given)
    if faults or shown is None:
        raise ConfigError(faults, name)
    return Project(shown, presets, runs, ticked, baseline, choice_from(json.dumps(values["study"])))


def _values(name: str, content: bytes) -> dict[str, Any]:
    """The file's parts, if it is one of ours. Raises ConfigError."""
    fault = ""
    values: Any = None
    if len(content) > LIMIT:
        fault = f"the file is larger than {LIMIT / 1e6:.0f} MB"
    else:
        with suppress(ValueError, RecursionError):
            values = json.loads(content.decode("utf-8-sig"))
        if not isinstance(values, dict) or values.get("format") != FORMAT:
            fault = 'this is no project; give a file that "Save project" has made'
        elif values.get("version") != VERSION:
            fault = f"it is of version {shorten(str(values.get('version')))}; this Trackride reads version {VERSION}"
    if fault:
        raise ConfigError([Fault("", "", fault)], name)
    return values


def _place(count: int) -> Callable[[Any], int]:
    """Reads a place in a list of so many."""

    def read(given: Any) -> int:
        if type(given) is not int or not 0 <= given < count:
            raise ValueError(f"{given!r} is no place among {count} runs")
        return given

    return read
