"""The ghost: another run's vehicle in pale lines, at the place of the present one, so that their poses can be compared.

Lines only: translucent faces would mix with the vehicle's own, in patches, where both stand nearly alike.
"""

from __future__ import annotations

import numpy as np
import viser

from app.format.colours import Theme, rgb
from app.view3d.meshes.hull import hull_edges
from app.view3d.nodes import paint, update
from app.view3d.snapshot import SIDES, Scene

GHOST = "/ghost"
THICKNESS = 0.022  # m, of its lines, at the size of the paper's vehicle
CORNERS = 32  # of a wheel's circle
OUTSIDE = 0.035  # m that a line is drawn outside of the part it outlines, at the size of the paper's vehicle


class Outline:
    """Hull, wheels and arms as segments between points of the model's bodies. Pure."""

    def __init__(self, scene: Scene) -> None:
        system, measures = scene.system, scene.measures
        bodies = np.arange(len(system.mass))
        circle = np.exp(2j * np.pi * np.arange(CORNERS + 1) / CORNERS)
        half_arm = complex(*measures.pivot) / 2
        half_links = np.array([-0.5, 0.5]) * np.array(measures.links)[:, None]
        wheel_face = measures.disc - OUTSIDE * measures.scale
        ends = zip(scene.places.on_hull[1:3], (measures.sprocket.radius, measures.idler.radius), strict=True)
        parts = [(system.chassis, at + radius * circle, wheel_face) for at, radius in ends]
        parts += [(body, measures.radius * circle, wheel_face) for body in bodies[system.road_wheels]]
        parts += [(body, measures.radius * circle, measures.disc) for body in bodies[system.imaginary_wheels]]
        parts += [(body, np.array([-half_arm, half_arm]), measures.arm) for body in bodies[system.road_arms]]
        links = zip(bodies[system.imaginary_arms], half_links, strict=True)
        parts += [(body, half.astype(complex), measures.link) for body, half in links]

        # Body, points in its frame and their places to the left
        lines = [
            (body, line, np.full(len(line), side * (aside + OUTSIDE * measures.scale)))
            for side in SIDES
            for body, line, aside in parts
        ]
        foot = scene.places.on_hull[0]
        lines += [(system.chassis, foot + edge[:, 0] + 1j * edge[:, 2], edge[:, 1]) for edge in hull_edges(measures)]
        self._body = np.concatenate([np.full(len(line) - 1, body) for body, line, _ in lines])
        self._ends = np.concatenate([np.column_stack([line[:-1], line[1:]]) for _, line, _ in lines])
        self._points = np.zeros((len(self._body), 2, 3), dtype=np.float32)
        self._points[..., 1] = np.concatenate([np.column_stack([aside[:-1], aside[1:]]) for _, _, aside in lines])

    def segments(self, q: np.ndarray, along: float) -> np.ndarray:
        """(S, 2, 3) in the view's frame for bodies q (B, 3), moved forward by `along`, m."""
        centre = (q[:, 0] + along + 1j * q[:, 1])[self._body]
        ends = centre[:, None] + np.exp(1j * q[:, 2])[self._body][:, None] * self._ends
        points = self._points.copy()
        points[..., 0], points[..., 2] = ends.real, ends.imag
        return points


class Ghost:
    """The vehicle of one run in a viser scene."""

    def __init__(self, api: viser.SceneApi, scene: Scene, theme: Theme, name: str = GHOST, colour: str = "") -> None:
        """name: of its node; colour: CSS, of its own; empty: the theme's."""
        self.scene, self._colour = scene, colour
        self._outline = Outline(scene)
        self._lines = api.add_line_segments(
            name,
            self._outline.segments(scene.bodies(0.0), 0.0),
            (0, 0, 0),
            thickness=THICKNESS * scene.measures.scale,
        )
        self.colour(theme)

    def follow(self, scene: Scene) -> None:
        """Show another run of a vehicle that looks the same."""
        self.scene = scene

    def colour(self, theme: Theme) -> None:
        paint(self._lines, rgb(self._colour) if self._colour else theme.ghost)

    def draw(self, time: float, x: float) -> None:
        """Stand at a time, s, with the hull's centre of mass at x in the view, m."""
        q = self.scene.bodies(time)
        update(self._lines, points=self._outline.segments(q, x - float(q[self.scene.system.chassis, 0])))

    def show(self, on: bool) -> None:
        if self._lines.visible != on:
            self._lines.visible = on

    def remove(self) -> None:
        self._lines.remove()
