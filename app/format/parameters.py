"""Parameters and their values as people read them, in plain text."""

from __future__ import annotations

from app.panels.controls import choice_words, shown_text
from model.config.parameters import Parameter, Value


def value_text(parameter: Parameter, value: Value) -> str:
    """A value with its unit: "75.53 kN/m"; "left out" for one that follows from others or is not there."""
    if value is None:
        return "left out"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if parameter.kind == "choice":
        return choice_words(str(value))
    return f"{shown_text(parameter, value)} {parameter.shown_unit}".strip()
