"""The ghost: another run's vehicle, pale and translucent, in the place of the present one, so that postures compare."""

from __future__ import annotations

import numpy as np
import viser

from app.colours import Theme
from app.nodes import paint, update
from app.scene import SIDES, Scene
from assets.hull import hull
from assets.solids import joined, light

GHOST = "/ghost"
THICKNESS = 0.022  # m, of its lines, at the size of the paper's vehicle
CORNERS = 32  # of a wheel's circle
OPACITY = 0.32  # of its hull
SHRUNK = 0.988  # of the hull: where both stand alike the ghost hides in the vehicle, and their faces do not mix
OUTSIDE = 0.035  # m from what a line stands for outwards, at the size of the paper's vehicle


class Outline:
    """Wheels and arms seen from the side, as segments between points of the model's bodies. Pure."""

    def __init__(self, scene: Scene) -> None:
        system, layout = scene.system, scene.layout
        bodies = np.arange(len(system.mass))
        circle = np.exp(2j * np.pi * np.arange(CORNERS + 1) / CORNERS)
        half_arm = complex(*layout.pivot) / 2
        half_links = np.array([-0.5, 0.5]) * np.array(layout.links)[:, None]
        wheel_face = layout.disc - OUTSIDE * layout.scale
        ends = zip(scene.places.on_hull[1:3], (layout.sprocket.radius, layout.idler.radius), strict=True)
        parts = [(system.chassis, at + radius * circle, wheel_face) for at, radius in ends]
        parts += [(body, layout.radius * circle, wheel_face) for body in bodies[system.road_wheels]]
        parts += [(body, layout.radius * circle, layout.disc) for body in bodies[system.imaginary_wheels]]
        parts += [(body, np.array([-half_arm, half_arm]), layout.arm) for body in bodies[system.road_arms]]
        links = zip(bodies[system.imaginary_arms], half_links, strict=True)
        parts += [(body, half.astype(complex), layout.link) for body, half in links]

        self._body = np.concatenate([np.full(len(line) - 1, body) for body, line, _ in parts])
        self._ends = np.concatenate([np.column_stack([line[:-1], line[1:]]) for _, line, _ in parts])
        aside = np.concatenate([np.full(len(line) - 1, y) for _, line, y in parts]) + OUTSIDE * layout.scale
        self._points = np.zeros((len(SIDES), len(self._body), 2, 3), dtype=np.float32)
        self._points[..., 1] = (SIDES[:, None] * aside)[..., None]

    def segments(self, q: np.ndarray, along: float) -> np.ndarray:
        """(S, 2, 3) in the view's frame for bodies q (B, 3), moved forward by `along`, m."""
        centre = (q[:, 0] + along + 1j * q[:, 1])[self._body]
        ends = centre[:, None] + np.exp(1j * q[:, 2])[self._body][:, None] * self._ends
        points = self._points.copy()
        points[..., 0], points[..., 2] = ends.real, ends.imag
        return points.reshape(-1, 2, 3)


class Ghost:
    """The vehicle of one run in a viser scene."""

    def __init__(self, api: viser.SceneApi, scene: Scene, theme: Theme) -> None:
        self.scene = scene
        self._outline = Outline(scene)
        self._node = api.add_frame(GHOST, show_axes=False)
        self._lines = api.add_line_segments(
            f"{GHOST}/lines",
            self._outline.segments(scene.bodies(0.0), 0.0),
            (0, 0, 0),
            thickness=THICKNESS * scene.layout.scale,
        )
        vertices, faces = joined(hull(scene.layout))
        self._hull = api.add_batched_meshes_simple(
            f"{GHOST}/hull",
            _shrunk(vertices),
            faces,
            np.array([[1.0, 0.0, 0.0, 0.0]]),
            np.zeros((1, 3)),
            opacity=OPACITY,
            lod="off",
            cast_shadow=False,
            receive_shadow=False,
        )
        self.colour(theme)

    def follow(self, scene: Scene) -> None:
        """Show another run of a vehicle that looks the same."""
        self.scene = scene

    def colour(self, theme: Theme) -> None:
        paint(self._lines, theme.ghost)
        self._hull.batched_colors = light(np.array([theme.ghost]))

    def draw(self, time: float, x: float) -> None:
        """Stand at a time, s, with the hull's centre of mass at x in the view, m."""
        q = self.scene.bodies(time)
        centre, height, pitch = q[self.scene.system.chassis]
        foot = x + 1j * height + np.exp(1j * pitch) * self.scene.places.on_hull[0]
        update(self._lines, points=self._outline.segments(q, x - float(centre)))
        update(
            self._hull,
            batched_positions=np.array([[foot.real, 0.0, foot.imag]], dtype=np.float32),
            batched_wxyzs=np.array([[np.cos(pitch / 2), 0.0, -np.sin(pitch / 2), 0.0]], dtype=np.float32),
        )

    def show(self, on: bool) -> None:
        self._node.visible = on

    def remove(self) -> None:
        self._node.remove()


def _shrunk(vertices: np.ndarray) -> np.ndarray:
    middle = (vertices.min(axis=0) + vertices.max(axis=0)) / 2
    return middle + SHRUNK * (vertices - middle)
