"""Pictures of the 3-D view, drawn by the browser."""

from __future__ import annotations

import io
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
    picture = Image.fromarray(render(browser, width, height, "png"))
    if picture.mode == "RGBA" and background is not None:
        opaque = Image.new("RGBA", picture.size, background)
        picture = Image.alpha_composite(opaque, picture).convert("RGB")
    file = io.BytesIO()
    picture.save(file, "PNG")
    return file.getvalue()


def framed(fov: float, page_aspect: float, picture_aspect: float) -> float:
    """Vertical field of view, rad, with which a picture shows from left to right what the page shows.

    fov: the page's; aspects: width by height.
    """
    return float(2 * np.arctan(np.tan(fov / 2) * page_aspect / picture_aspect))


def render(browser: Browser, width: int, height: int, kind: str) -> np.ndarray:
    """Pixels (H, W, 3) of the 3-D view for the kind "jpeg"; for "png" (H, W, 4), the last channel how opaque they are.

    Raises NoPictureError like take_picture.
    """
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
