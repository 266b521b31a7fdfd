"""What a browser keeps between visits: there and back, and texts that others have written. Pure."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import cache
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.panels.road_parts import ADDED, with_part
from app.runs.history import RUN_COLOURS, RUNS, Kept, Runs
from app.runs.request import Request
from app.runs.storage import LONGEST, PRESETS, State, state_from, state_text
from model.config.config_files import load_config
from tests.app.conftest import make_run

PAPER, OTHER = load_config("paper"), load_config("half_round")
REQUEST = Request(PAPER).changed("drive.speed_kmh", 33).changed("vehicle.road_suspension.stiffness", (6e4, *[7e4] * 5))


def kept_runs() -> tuple[Kept, ...]:
    runs = Runs()
    for speed in (10, 20, 30):
        request = Request(OTHER, {"drive.speed_kmh": speed})
        runs.keep(request, make_run(request.config(), samples=2))
    runs.rename(2, "Mine")
    return tuple(runs)


@cache
def text() -> str:
    runs = kept_runs()
    return state_text(PAPER, REQUEST, [OTHER], runs, runs[1], dark=True)


def test_all_comes_back_but_the_trajectories() -> None:
    runs = tuple(replace(kept, number=0, run=None) for kept in kept_runs())
    assert state_from(text()) == State(PAPER, Request(PAPER, REQUEST.changes), (OTHER,), runs, runs[1], dark=True)


@pytest.mark.parametrize("added", ADDED)
def test_a_road_made_of_parts_comes_back(added: str) -> None:
    request = Request(PAPER, with_part(PAPER, added))
    found = state_from(state_text(PAPER, request, [request.config()], (), None, dark=None))
    assert found.request is not None
    assert found.request.config() == found.presets[0] == request.config()


@pytest.mark.parametrize("stored", ["", "nonsense", "[]", "null", "3", "[" * 100_000, " " * LONGEST + "{}"])
def test_what_is_no_state_is_refused(stored: str) -> None:
    with pytest.raises(ValueError, match=r"it is|Expecting"):
        state_from(stored)


def test_what_cannot_be_used_is_left_out_and_the_rest_comes_back() -> None:
    state = json.loads(text())
    state["wish"]["config"]["drive.speed_kmh"] = 4000
    state["presets"] += [3, {"no.such.key": 1}]
    state["runs"][0]["colour"] = "red } </style><script>"
    del state["runs"][1]["base"]
    found = state_from(json.dumps(state))
    assert (found.start, found.request, found.presets) == (PAPER, None, (OTHER,))
    assert [kept.config.drive.speed_kmh for kept in found.runs] == [30]


def test_only_so_much_comes_back_as_is_kept() -> None:
    state = json.loads(text())
    state["runs"] = state["runs"][:1] * (RUNS + 5)
    state["presets"] *= PRESETS + 5
    state["runs"][-1]["name"] = "x" * 10_000 + "\n"
    found = state_from(json.dumps(state))
    assert (len(found.runs), len(found.presets)) == (RUNS, PRESETS)
    assert len(found.runs[-1].name) < 100


JSON = st.recursive(
    st.none() | st.booleans() | st.floats() | st.text(max_size=5) | st.sampled_from(RUN_COLOURS),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner, max_size=3),
    max_leaves=4,
)


@settings(max_examples=60, deadline=None)
@given(st.data())
def test_no_value_put_anywhere_does_harm(data: st.DataObject) -> None:
    state = json.loads(text())
    part: Any = state
    while True:
        keys = list(part) if isinstance(part, dict) else list(range(len(part)))
        key = data.draw(st.sampled_from(keys))
        if not isinstance(part[key], dict | list) or not part[key] or data.draw(st.integers(0, 3)) == 0:
            break
        part = part[key]
    part[key] = data.draw(JSON)
    found = state_from(json.dumps(state))
    assert all(kept.colour in RUN_COLOURS and kept.request.config() == kept.config for kept in found.runs)
    if found.request is not None:
        state_text(PAPER, found.request, found.presets, found.runs, found.baseline, found.dark, found.units)
