"""Pictures of the 3-D view: PNG files, and the frames of movies."""

from __future__ import annotations

import io
from collections.abc import Callable, Iterator
from typing import Any, Protocol

import numpy as np
from PIL import Image

SIZES = {
    "1280 × 720": (1280, 720),
    "1920 × 1080": (1920, 1080),
    "2560 × 1440": (2560, 1440),
    "3840 × 2160": (3840, 2160),
}
FIGURE_SIZE = (1600, 900)  # px of the picture in a figure
MOVIE_SIZE = (1280, 720)  # px
MOVIE_RATE = 20.0  # frames a second
MOVIE_LENGTH = 4.0  # s at most
RENDER_TIMEOUT = 20.0  # s; a hidden tab never answers


class Viewpoint(Protocol):
    """Where the user looks from: viser's CameraHandle, or a stand-in."""

    @property
    def wxyz(self) -> np.ndarray: ...

    @property
    def position(self) -> np.ndarray: ...

    @property
    def fov(self) -> float: ...

    @property
    def aspect(self) -> float: ...


class Browser(Protocol):
    """What draws a picture: viser's ClientHandle, or a stand-in."""

    @property
    def camera(self) -> Viewpoint: ...

    def get_render(
        self, height: int, width: int, *, wxyz: Any, position: Any, fov: float, transport_format: Any, timeout: Any
    ) -> np.ndarray: ...


class NoPictureError(Exception):
    """The browser sent no picture; the message says why and what to do."""


def take_picture(browser: Browser, width: int, height: int, background: str | None) -> bytes:
    """PNG of the 3-D view, width × height pixels; without a background (CSS colour) it is transparent where there is
    nothing. Waits for the browser.

    Raises NoPictureError when the tab is hidden, closed or cannot render so large a picture.
    """
    picture = Image.fromarray(_render(browser, width, height, "png"))
    if picture.mode == "RGBA" and background is not None:
        opaque = Image.new("RGBA", picture.size, background)
        picture = Image.alpha_composite(opaque, picture).convert("RGB")
    file = io.BytesIO()
    picture.save(file, "PNG")
    return file.getvalue()


def movie_frames(browser: Browser, seek: Callable[[float], None], start: float, end: float) -> Iterator[np.ndarray]:
    """Pixels (H, W, 3) of each frame from `start` to `end`, s of the run; `seek` shows a time. Waits for the browser.

    Raises NoPictureError like take_picture.
    """
    for frame in range(round((end - start) * MOVIE_RATE)):
        seek(start + frame / MOVIE_RATE)
        yield _render(browser, *MOVIE_SIZE, "jpeg")


def framed(fov: float, page_aspect: float, picture_aspect: float) -> float:
    """Vertical field of view, rad, with which a picture shows from left to right what the page shows.

    fov: the page's; aspects: width by height.
    """
    return float(2 * np.arctan(np.tan(fov / 2) * page_aspect / picture_aspect))


def _render(browser: Browser, width: int, height: int, kind: str) -> np.ndarray:
    viewpoint = browser.camera
    try:
        return browser.get_render(
            height,
            width,
            wxyz=viewpoint.wxyz,
            position=viewpoint.position,
            fov=framed(viewpoint.fov, viewpoint.aspect, width / height),
            transport_format=kind,
            timeout=RENDER_TIMEOUT,
        )
    except TimeoutError as error:
        raise NoPictureError(
            "The browser sent no picture. Keep the tab in front until the picture is done, and try again."
        ) from error
    except RuntimeError as error:
        raise NoPictureError("The browser could not draw the picture. Try a smaller size.") from error
