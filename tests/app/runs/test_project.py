"""A project: there and back, and files that others have written. Pure."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Any

import pytest

from app.panels.road_parts import with_part
from app.runs.project import LIMIT, Project, project_from, project_text
from app.runs.request import Request
from app.runs.study_choice import StudyChoice
from model.config.config import ConfigError
from model.config.config_files import load_config
from tests.app.runs.test_storage import kept_runs

PAPER, OTHER = load_config("paper"), load_config("half_round")
RUNS = tuple(replace(kept, number=0, run=None) for kept in kept_runs())
PROJECT = Project(
    shown=Request(PAPER, with_part(PAPER, "step")),
    presets=(OTHER,),
    runs=RUNS,
    ticked=(0, 2),
    baseline=RUNS[1],
    study=StudyChoice(view="limits"),
)


def opened(values: Any) -> Project:
    return project_from("mine.trackride", json.dumps(values).encode())


def values() -> dict[str, Any]:
    found: dict[str, Any] = json.loads(project_text(PROJECT))
    return found


def test_all_comes_back() -> None:
    found = opened(values())
    assert found.shown.config() == PROJECT.shown.config()
    assert replace(found, shown=PROJECT.shown) == PROJECT


def test_a_project_without_a_baseline_comes_back() -> None:
    bare = replace(PROJECT, runs=(), ticked=(), baseline=None, presets=())
    assert replace(opened(json.loads(project_text(bare))), shown=bare.shown) == bare


@pytest.mark.parametrize(
    "content", [b"", b"\xff\xfe", b"[]", b"null", b"[" * 100_000, b'{"format": "else"}', b"name: My tank"]
)
def test_what_is_no_project_is_refused(content: bytes) -> None:
    with pytest.raises(ConfigError, match="p: this is no project"):
        project_from("p", content)


def test_a_file_that_is_too_large_is_not_looked_at() -> None:
    with pytest.raises(ConfigError, match="larger than 100 MB"):
        project_from("p", b" " * (LIMIT + 1))


def test_a_newer_version_is_named() -> None:
    with pytest.raises(ConfigError, match="version 2; this Trackride reads version 1"):
        opened(values() | {"version": 2})


def faults(**changes: Any) -> list[str]:
    with pytest.raises(ConfigError) as caught:
        opened(values() | changes)
    return [str(fault) for fault in caught.value.faults]


def test_every_fault_is_named_with_its_place() -> None:
    runs = values()["runs"]
    runs[1]["config"]["drive.speed_kmh"] = 4000
    runs[2]["colour"] = "url(x)"
    said = faults(runs=runs, ticked=[0, 7], presets=[{"vehicle.wings": 2}], extra=1)
    assert len(said) == 5
    for start in ("'extra'", "presets[1]: vehicle.wings", "runs[2]: drive.speed_kmh", "runs[3]", "ticked[2]"):
        assert any(line.startswith(start) for line in said), (start, said)
    assert any("7 is no place among 3 runs" in line for line in said)


@pytest.mark.parametrize("part", ["shown", "presets", "runs", "ticked", "baseline"])
@pytest.mark.parametrize("nonsense", [3, "text", [None], {"base": 1}, True])
def test_nonsense_is_named_with_its_part(part: str, nonsense: Any) -> None:
    assert all(line.startswith(part) for line in faults(**({"ticked": []} | {part: nonsense})))


@pytest.mark.parametrize("nonsense", [3, "text", [None], {"view": 1}])
def test_choices_of_studies_that_make_no_sense_are_the_usual_ones(nonsense: Any) -> None:
    assert opened(values() | {"study": nonsense}).study == StudyChoice()


def test_a_part_that_is_missing_is_named() -> None:
    given = values()
    del given["shown"], given["study"]
    with pytest.raises(ConfigError) as caught:
        opened(given)
    assert [str(fault) for fault in caught.value.faults] == ["shown: is missing", "study: is missing"]
