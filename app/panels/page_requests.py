"""What the page asks for by its own scripts: a kind and a content, as JSON. Pure."""

from __future__ import annotations

import json

from app.panels.actions import Actions
from app.runs.examples import EXAMPLE
from model.config.parameters import PARAMETER


def carry_out(text: str, actions: Actions) -> None:
    """Pass on what the page asks for. Anybody may have written the text: what is nothing of this kind is left alone."""
    try:
        asked = json.loads(text)
        kind, content = asked["kind"], asked["content"]
    except (ValueError, KeyError, TypeError, RecursionError):
        return
    match kind, content:
        case "link", str():
            actions.open_link(content)
        case "reset", str() if content in PARAMETER:
            actions.reset_one(content)
        case "example", str() if content in EXAMPLE:
            actions.try_example(content)
        case "undo example", _:
            actions.undo_example()
        case "keep example", _:
            actions.keep_example()
        case "first", list():
            actions.set_first([key for key in content if isinstance(key, str)])
