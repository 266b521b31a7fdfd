"""Names of the files that a user downloads."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from app.format.parameters import shown_text
from model.config.config import Config

NAME_LIMIT = 120  # characters of a file's name before its suffix


def file_name(config: Config, title: str, changes: Mapping[str, Any], detail: str, suffix: str) -> str:
    """A safe name: what was run, what was changed, what is in it: "paper-vehicle_speed-22-km-h_1280x720.png".

    config: with the changes, for their units.
    """
    parts = [_plain(title) or "run"]
    for key, value in changes.items():
        parameter = config.parameter(key)
        text = str(value) if value is None or parameter.kind == "choice" else shown_text(parameter, value)
        parts.append(_plain(f"{parameter.label} {text} {parameter.shown_unit}"))
    end = f"_{_plain(detail)}" if detail else ""
    return "_".join(part for part in parts if part)[: NAME_LIMIT - len(end)].rstrip("-_.") + end + suffix


def _plain(text: str) -> str:
    """Small letters, digits, hyphens and decimal points; nothing that a file system does not allow."""
    return re.sub(r"(?<!\d)\.|\.(?!\d)|[^a-z0-9.]+", "-", text.lower()).strip("-")
