"""Where a tab was: there and back, when it is told and stored, and texts that others have written. Pure."""

from __future__ import annotations

import json
from typing import Any

import pytest

from app.runs.tab_place import EVERY, Place, TabPlace, place_from, place_text


def test_a_place_comes_back() -> None:
    place = Place(1.25, False, (0.5, -9.0, 1.0), (0.0, 0.0, 0.75))
    assert place_from(place_text(place)) == place


@pytest.mark.parametrize(
    "changes",
    [
        {"time": "soon"},
        {"time": float("nan")},
        {"position": [0, 0]},
        {"position": None},
        {"look_at": [0, 0, 1e300]},
        {"look_at": [0, 0, [1]]},
        {"playing": 1},
    ],
)
def test_what_is_no_place_is_none(changes: dict[str, Any]) -> None:
    place = {"time": 0.0, "playing": True, "position": [0, 0, 1], "look_at": [0, 0, 0]}
    assert place_from(json.dumps(place)) is not None
    assert place_from(json.dumps(place | changes)) is None


@pytest.mark.parametrize("text", ["", "null", "[]", "[" * 100_000])
def test_a_text_that_says_no_place_is_none(text: str) -> None:
    assert place_from(text) is None


def test_the_first_word_of_a_tab_counts_and_nothing_is_stored_before_it() -> None:
    here, there = (
        Place(1.0, False, (0.0, 0.0, 1.0), (0.0, 0.0, 0.0)),
        Place(2.0, True, (0.0, 0.0, 1.0), (0.0, 0.0, 0.0)),
    )
    tab = TabPlace()
    assert tab.news(here, 10.0) is None
    tab.told(place_text(there))
    tab.told(place_text(here))
    assert tab.to_return_to() == there
    assert tab.to_return_to() is None
    assert tab.news(here, 10.0) == place_text(here)
    assert tab.news(here, 20.0) is None
    assert tab.news(there, 20.0) == place_text(there)
    assert tab.news(here, 20.0 + 0.9 * EVERY) is None
    assert tab.news(here, 20.0 + EVERY) == place_text(here)
