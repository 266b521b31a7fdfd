"""Standpoints around the vehicle, and the camera of one browser tab. Frame of the view: z up; m."""

from __future__ import annotations

from contextlib import AbstractContextManager
from itertools import product
from typing import Any, Literal, NamedTuple, Protocol

import numpy as np
import viser

from app.view3d.meshes.measures import Measures

Standpoint = Literal["side", "three-quarter", "front", "wheel"]
FIELD_OF_VIEW = 0.36  # rad, vertical: a long lens, so that wheels stay round and heights comparable
FARTHEST = 150.0  # m: well within the sky
MARGIN = 1.05  # of what is to be in the picture
OTHER_SIZE = 1.5  # times as long: a vehicle for which the camera goes nearer or further away, and of which a smaller or
# larger one is no ghost


class CameraPose(NamedTuple):
    """Where a camera stands and what it sees."""

    position: np.ndarray  # (3,)
    look_at: np.ndarray  # (3,)
    fov: float  # rad, vertical


class _Aim(NamedTuple):
    """A direction to look from, degrees, and what is to be in the picture, at the size of the paper's vehicle."""

    bearing: float  # from ahead towards the right side
    elevation: float  # above the horizon
    behind: float | None  # m behind the first wheel that it reaches; None: all the vehicle
    bottom: float  # m above ground
    top: float


AIMS: dict[Standpoint, _Aim] = {
    "side": _Aim(90.0, 7.0, None, -0.75, 2.1),
    "three-quarter": _Aim(52.0, 15.0, None, -0.4, 2.0),
    "front": _Aim(12.0, 7.0, None, -0.2, 2.0),
    "wheel": _Aim(78.0, 5.0, 1.8, -1.0, 1.1),
}


def camera_pose(standpoint: Standpoint, measures: Measures, aspect: float, covered: float = 0.0) -> CameraPose:
    """Where to stand so that the vehicle (for "wheel": its first wheels) fits a picture of this width by height.

    covered: the share of its height, at its foot, that something else hides; the vehicle stands above that.
    """
    aim, s = AIMS[standpoint], measures.scale
    bearing, elevation = np.radians([aim.bearing, aim.elevation])
    ahead, aside = np.cos(bearing), -np.sin(bearing)
    towards = np.array([ahead * np.cos(elevation), aside * np.cos(elevation), np.sin(elevation)])
    right = np.array([-aside, ahead, 0.0])
    up = np.cross(towards, right)

    x = measures.idler.x - 0.7 * s, measures.sprocket.x + 0.8 * s
    y = -measures.half_width, measures.half_width
    if aim.behind is not None:
        x = measures.front - aim.behind * s, measures.front + 0.6 * s
        y = -measures.arrow, -measures.track
    box = np.array([x, y, (aim.bottom * s, aim.top * s)])
    centre = box.mean(axis=1)
    corners = np.array(list(product(*box))) - centre
    half_height = np.tan(FIELD_OF_VIEW / 2) / MARGIN
    spread = np.maximum(np.abs(corners @ right) / aspect, np.abs(corners @ up) / (1 - covered))
    distance = (corners @ towards + spread / half_height).max()
    look_at = centre - covered * distance * np.tan(FIELD_OF_VIEW / 2) * up
    return CameraPose(look_at + distance * towards, look_at, FIELD_OF_VIEW)


def about_as_long(one: Measures, other: Measures) -> bool:
    """Whether two vehicles can be looked at from the same place."""
    return 1 / OTHER_SIZE < one.length / other.length < OTHER_SIZE


class BrowserCamera(Protocol):
    """The camera that the browser draws with: viser's CameraHandle, or a stand-in."""

    fov: float
    position: Any
    look_at: Any
    up_direction: Any
    max_orbit_distance: Any

    @property
    def image_width(self) -> int: ...

    @property
    def image_height(self) -> int: ...

    def on_update(self, callback: Any) -> Any: ...


class Tab(Protocol):
    """Where a scene is drawn: viser's ClientHandle, or a stand-in."""

    @property
    def scene(self) -> viser.SceneApi: ...

    @property
    def camera(self) -> BrowserCamera: ...

    def atomic(self) -> AbstractContextManager[None]: ...


class Camera:
    """Keeps the camera at a standpoint, also when the picture takes another shape; the user may move it away."""

    def __init__(self, client: Tab) -> None:
        self._camera = client.camera
        self._client = client
        self._at: tuple[Standpoint, Measures] | None = None
        self._pose: CameraPose | None = None
        self._aspect = self._covered = 0.0
        client.camera.max_orbit_distance = FARTHEST
        client.camera.on_update(self._refit)

    def look(self, standpoint: Standpoint, measures: Measures) -> None:
        """Go to a standpoint."""
        self._at = standpoint, measures
        self._aspect = _aspect(self._camera)
        self._pose = camera_pose(standpoint, measures, self._aspect, self._covered)
        with self._client.atomic():
            self._camera.fov = self._pose.fov
            self._camera.up_direction = (0.0, 0.0, 1.0)
            self._camera.position = self._pose.position
            self._camera.look_at = self._pose.look_at

    def fit(self, measures: Measures) -> None:
        """Go to the same standpoint of another vehicle, unless it is about as long as the one before."""
        if self._at is not None and not about_as_long(measures, self._at[1]):
            self.look(self._at[0], measures)

    def clear(self, covered: float) -> None:
        """Keep the vehicle above the foot of the picture, of which this share of its height is hidden."""
        stands, self._covered = covered == self._covered, covered
        if not stands:
            self._go_again()

    def spacing(self, metres: float, height: float) -> float:
        """How far apart points on the vehicle's axis are in a picture of this height, in the unit of the height.

        Infinitely far as long as the camera stands nowhere.
        """
        if self._pose is None:
            return float("inf")
        ahead = np.asarray(self._camera.look_at, dtype=float) - self._camera.position
        distance = max(float(np.linalg.norm(ahead)), 1e-6)
        across = np.sqrt(max(1 - (ahead[0] / distance) ** 2, 0.0))
        return metres * across * height / (2 * distance * np.tan(max(self._camera.fov, 1e-3) / 2))

    async def _refit(self, camera: BrowserCamera) -> None:
        """Go there again when the picture's shape has changed."""
        if abs(_aspect(camera) / max(self._aspect, 1e-6) - 1) >= 0.01:
            self._go_again()

    def _go_again(self) -> None:
        """Go to the standpoint again, unless the user has moved the camera."""
        if self._at is not None and not self.turned:
            self.look(*self._at)

    @property
    def turned(self) -> tuple[float, ...]:
        """Where the camera stands and what it looks at, m, (6,), to the centimetre; empty: it is at its standpoint.

        The user may have moved it away.
        """
        if self._pose is None:
            return ()
        now = np.array([self._camera.position, self._camera.look_at], dtype=float)
        moved = np.abs(now - self._pose[:2]).max()
        near = 0.01 * np.linalg.norm(self._pose.position)
        return () if moved < near else tuple(np.round(now, 2).ravel().tolist())


def _aspect(camera: BrowserCamera) -> float:
    """Width by height of the picture, also while a page is being opened and has no size yet."""
    return max(camera.image_width, 1) / max(camera.image_height, 1)
