"""What users take home: file names, and pictures as PNG."""

from __future__ import annotations

import io
import re
from collections.abc import Mapping
from typing import Any, Protocol

import numpy as np
from PIL import Image

from app.controls import shown_text
from model.parameters import PARAMETER

SIZES = {"1280 × 720": (1280, 720), "1920 × 1080": (1920, 1080), "3840 × 2160": (3840, 2160)}
RENDER_TIMEOUT = 20.0  # s; a hidden tab never answers
NAME_LIMIT = 120  # characters of a file's name before its suffix


class Camera(Protocol):
    """The browser's side of a screenshot: viser's ClientHandle."""

    def get_render(self, height: int, width: int, *, transport_format: Any, timeout: float | None) -> np.ndarray: ...


class NoPictureError(Exception):
    """The browser sent no picture; the message says why and what to do."""


def take_picture(camera: Camera, width: int, height: int, background: str) -> bytes:
    """PNG of the 3-D view, width × height pixels, on a plain background (CSS colour). Waits for the browser.

    Raises NoPictureError when the tab is hidden, closed or cannot render so large a picture.
    """
    try:
        pixels = camera.get_render(height, width, transport_format="png", timeout=RENDER_TIMEOUT)
    except TimeoutError as error:
        raise NoPictureError(
            "The browser sent no picture. Keep the tab in front until the picture is done, and try again."
        ) from error
    except RuntimeError as error:
        raise NoPictureError("The browser could not draw the picture. Try a smaller size.") from error
    picture = Image.fromarray(pixels)
    if picture.mode == "RGBA":
        opaque = Image.new("RGBA", picture.size, background)
        picture = Image.alpha_composite(opaque, picture).convert("RGB")
    file = io.BytesIO()
    picture.save(file, "PNG")
    return file.getvalue()


def file_name(title: str, changes: Mapping[str, Any], detail: str, suffix: str) -> str:
    """A safe name: what was run, what was changed, what is in it: "paper-vehicle_speed-22-km-h_1280x720.png"."""
    parts = [_plain(title) or "run"]
    for key, value in changes.items():
        parameter = PARAMETER[key]
        text = shown_text(parameter, value) if isinstance(value, int | float | tuple) else str(value)
        parts.append(_plain(f"{parameter.label} {text} {parameter.shown_unit}"))
    end = f"_{_plain(detail)}" if detail else ""
    return "_".join(part for part in parts if part)[: NAME_LIMIT - len(end)].rstrip("-_.") + end + suffix


def _plain(text: str) -> str:
    """Small letters, digits, hyphens and decimal points; nothing that a file system could take amiss."""
    return re.sub(r"(?<!\d)\.|\.(?!\d)|[^a-z0-9.]+", "-", text.lower()).strip("-")
