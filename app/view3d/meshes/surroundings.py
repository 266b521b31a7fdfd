"""Sky, ground and road. Frame: x forward, y to the left, z up; m."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from app.view3d.meshes.measures import Measures
from app.view3d.meshes.solids import Part, Rgb, lathe, upright

FAR = 400.0  # radius of sky and ground
BEHIND, AHEAD = 80.0, 120.0  # m of road that are drawn
TILES = 2.0  # m by which the road's strip moves: tiles of both colours
SHADOW_LAYERS = 5
SHADOW_COLUMNS = 36


def sky(haze: Rgb, middle: Rgb, zenith: Rgb) -> Part:
    """The inside of a sphere: haze at and below the horizon, clearing upwards."""
    elevation = np.radians([90, 70, 50, 35, 25, 18, 13, 9, 6, 4, 2, 0.8, 0, -4, -90])
    profile = [(float(FAR * np.cos(e)), float(FAR * np.sin(e))) for e in elevation]
    clear = np.degrees(np.maximum(elevation, 0.0))
    stops = np.array([haze, middle, zenith])
    colours = np.column_stack([np.interp(clear, [0.0, 8.0, 60.0], stops[:, k]) for k in range(3)])
    return upright(_graded(profile, colours))


def ground(near: Rgb, haze: Rgb) -> Part:
    """A level disc that fades into the haze of the horizon."""
    radius = np.array([FAR, 260.0, 160.0, 100.0, 65.0, 40.0, 25.0, 0.0])
    clear = np.clip(1 - radius / 180.0, 0.0, 1.0)[:, None] ** 1.5
    colours = clear * np.array(near) + (1 - clear) * np.array(haze)
    return upright(_graded([(float(r), 0.0) for r in radius], colours))


class RoadStrip:
    """A road as a solid bank, in tiles of one metre of which every other has another colour.

    Two meshes, tiles of even and of odd metres, whose vertices move along with the vehicle while the faces stay.
    """

    def __init__(self, reach: float, half_width: float) -> None:
        """reach: m before and behind the vehicle's middle where the road is cut finely; farther away more coarsely."""
        offsets: list[np.ndarray] = []
        self.faces: list[np.ndarray] = []
        for parity in (0, 1):
            tiles = np.arange(-BEHIND + parity, AHEAD, TILES)
            cells = [_cells(max(-tile, tile - TILES) - reach) for tile in tiles]
            offsets += [tile + np.linspace(0.0, 1.0, count + 1) for tile, count in zip(tiles, cells, strict=True)]
            self.faces.append(_strip_faces([count + 1 for count in cells]))
            if parity == 0:
                self._even = sum(count + 1 for count in cells)
        self._offsets = np.concatenate(offsets)
        self._corners = np.zeros((len(self._offsets), 6, 3), dtype=np.float32)
        self._corners[:, :, 0] = self._offsets[:, None]
        self._corners[:, :3, 1], self._corners[:, 3:, 1] = -half_width, half_width

    def start(self, x: float) -> float:
        """Where the strip stands for a vehicle at x, m."""
        return float(np.floor(x / TILES) * TILES)

    def vertices(self, start: float, height: Callable[[np.ndarray], np.ndarray], foot: float) -> list[np.ndarray]:
        """Vertices (V, 3) of both meshes, x from where the strip stands, from the road down to the foot, m."""
        corners = self._corners.copy()
        corners[:, 1:5, 2] = height(start + self._offsets)[:, None]
        corners[:, ::5, 2] = foot
        return [part.reshape(-1, 3) for part in (corners[: self._even], corners[self._even :])]


def shadow(measures: Measures) -> np.ndarray:
    """Vertices (V, 3) of a vehicle's shadow on level ground: strips, each narrower and higher than the one before."""
    strips = []
    for layer in range(SHADOW_LAYERS):
        inset, z = (layer - 2) * 0.08 * measures.scale, 0.003 + 0.002 * layer
        x = np.linspace(measures.idler.x + inset, measures.sprocket.x - inset, SHADOW_COLUMNS)
        for side in (-1, 1):
            edge = side * (measures.half_width - inset)
            strips.append(np.column_stack([x, np.full_like(x, edge), np.full_like(x, z)]))
    return np.concatenate(strips)


def shadow_faces() -> np.ndarray:
    """Faces (F, 3) of a shadow's vertices."""
    column, right = np.arange(SHADOW_COLUMNS - 1), 2 * SHADOW_COLUMNS * np.arange(SHADOW_LAYERS)
    a = (right[:, None] + column).ravel()
    b, c, d = a + 1, a + SHADOW_COLUMNS + 1, a + SHADOW_COLUMNS
    return np.column_stack([a, b, c, a, c, d]).reshape(-1, 3)


def _cells(distance: float) -> int:
    """How many parts a tile of road is cut into, so many metres from the finely cut stretch."""
    return 20 if distance <= 0.0 else 8 if distance < 10.0 else 3 if distance < 35.0 else 1


def _strip_faces(column_counts: list[int]) -> np.ndarray:
    """Faces (F, 3) of tiles with so many columns of six corners: right flank, top, left flank."""
    faces, first = [], 0
    for count in column_counts:
        columns = 6 * (first + np.arange(count - 1))
        for corner in (0, 2, 4):
            a, b, c, d = (columns + k for k in (corner, corner + 6, corner + 7, corner + 1))
            faces += [np.column_stack([a, b, c]), np.column_stack([a, c, d])]
        first += count
    return np.concatenate(faces)


def _graded(profile: list[tuple[float, float]], colours: np.ndarray) -> Part:
    """A lathe part with one colour (K, 3) at each of the profile's K points."""
    sections = 32
    part = lathe(profile, (0, 0, 0, 255), sections)
    ends = np.column_stack([np.arange(len(profile) - 1), np.arange(1, len(profile))]).ravel()
    opaque = np.column_stack([np.round(colours[ends]), np.full(len(ends), 255)])
    return part._replace(colour=np.repeat(opaque, sections, axis=0))
