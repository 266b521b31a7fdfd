"""What scripts of the page ask for reaches those who do it; anything else is left alone."""

from __future__ import annotations

import json
from typing import Any

import pytest

from app.panels.page_requests import carry_out
from tests.app.session.conftest import Called


def asked(kind: str, content: Any) -> list[tuple[Any, ...]]:
    actions = Called()
    carry_out(json.dumps({"kind": kind, "content": content, "count": 1}), actions)  # type: ignore[arg-type]
    return actions.calls


def test_requests_reach_the_actions() -> None:
    assert asked("link", "paper") == [("open_link", "paper")]
    assert asked("reset", "drive.speed_kmh") == [("reset_one", "drive.speed_kmh")]
    assert asked("first", ["contact.friction", 3]) == [("set_first", ["contact.friction"])]
    assert asked("example", "Halve the damping") == [("try_example", "Halve the damping")]
    assert asked("undo example", "") == [("undo_example",)]
    assert asked("keep example", "") == [("keep_example",)]


@pytest.mark.parametrize("text", ["", "{", "[]", "7", '{"kind": "link"}', "[" * 100_000])
def test_a_text_that_is_no_request_is_left_alone(text: str) -> None:
    actions = Called()
    carry_out(text, actions)  # type: ignore[arg-type]
    assert actions.calls == []


def test_nor_is_a_request_of_no_known_kind() -> None:
    assert asked("link", 5) == asked("reset", "drive.sped") == asked("reset", ["x"]) == asked("x", "") == []
    assert asked("example", "Double the damping") == []
