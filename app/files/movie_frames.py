"""The frames of a movie of the 3-D view: which stretch of a run it shows, and what is written into them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from importlib import resources
from io import BytesIO
from typing import Any

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from app.files.pictures import Browser, render
from model.simulation.trajectory import Trajectory

RATE = 20.0  # frames a second
LENGTHS: dict[str, float | None] = {"4 s": 4.0, "10 s": 10.0, "30 s": 30.0, "whole run": None}  # as shown -> s
FROM_START = {"time shown": False, "start": True}  # as shown
LETTERS = 0.026  # of a frame's height: the height of its stamp's letters
PAD = 0.6  # of that: round about the stamp


@dataclass(frozen=True)
class MovieChoice:
    """What the user wants to be filmed."""

    length: float | None = LENGTHS["4 s"]  # s at most; None: up to the end of the run
    from_start: bool = False  # of the run; else from the time that is shown
    stamped: bool = False  # time, vehicle and speed are written into the frames

    def stretch(self, run: Trajectory, time: float) -> tuple[float, float]:
        """From when to when in the run, s; `time` is shown. Near its end it begins earlier, to be as long as others."""
        first, last = float(run.t[0]), float(run.t[-1])
        if self.from_start:
            start = first
        else:
            start = min(max(time, first), last) if self.length is None else max(min(time, last - self.length), first)
        return start, last if self.length is None else min(start + self.length, last)


def movie_times(start: float, end: float) -> list[float]:
    """s of the run, of each frame; at least one."""
    return [start + frame / RATE for frame in range(max(round((end - start) * RATE), 1))]


def movie_frames(
    browser: Browser, show: Callable[[float], None], times: list[float], size: tuple[int, int]
) -> Iterator[np.ndarray]:
    """Pixels (H, W, 3) of each frame, of `size` (width, height); `show` brings a time, s of the run, into view.

    Waits for the browser. Raises NoPictureError like take_picture.
    """
    for time in times:
        show(time)
        yield render(browser, *size, "jpeg")


def stamped(pixels: np.ndarray, text: str) -> np.ndarray:
    """The same frame (H, W, 3) with a text in its lower left corner, on a dark ground."""
    picture = Image.fromarray(pixels)
    height = max(int(LETTERS * picture.height), 9)
    pad = int(PAD * height)
    _, top, right, bottom = _letters(height).getbbox(text)
    x, y = 2 * pad, picture.height - 3 * pad - height
    ground = Image.new("RGBA", picture.size)
    draw = ImageDraw.Draw(ground)
    draw.rectangle((x - pad, y - pad, x + right + pad, picture.height - 2 * pad), fill=(20, 24, 28, 150))
    draw.text((x, y - (top + bottom - height) / 2), text, font=_letters(height), fill="white")
    return np.asarray(Image.alpha_composite(picture.convert("RGBA"), ground).convert("RGB"))


def stamp_text(run: Trajectory, time: float, title: str) -> str:
    """ "t = 3.25 s · Paper vehicle · 14.9 km/h": time, what is shown, and how fast it is then."""
    speed = 3.6 * float(np.interp(time, run.t, run.v[:, run.system.chassis, 0])) + 0.0  # no minus before zero
    return f"t = {time:.2f} s · {title} · {speed:.1f} km/h"


@cache
def _letters(height: int) -> Any:
    """A font that knows more than English letters: matplotlib brings it."""
    font = resources.files("matplotlib").joinpath("mpl-data", "fonts", "ttf", "DejaVuSans.ttf")
    return ImageFont.truetype(BytesIO(font.read_bytes()), height)
