"""A drawing of the vehicle from its right side, for figures: where no browser is at hand to draw the 3-D view."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.patches import Circle

from app.format.colours import LIGHT, Palette
from app.view3d.meshes import running_gear
from app.view3d.meshes.hull import hull
from app.view3d.meshes.solids import Part
from app.view3d.snapshot import Poses, Scene, Snapshot, build_scene
from model.simulation.trajectory import Trajectory, wheel_names

LAMP = np.array([0.25, -0.55, 0.8])  # towards the light: x forward, y to the left, z up
DIM = 0.55  # brightness of faces turned away from the light
LEAST_ARROW = 0.01  # m: a shorter one is not drawn
ROOM = 0.9  # m before, behind and above the vehicle, at the size of the paper's


def draw_side_view(axes: Axes, trajectory: Trajectory, palette: Palette, time: float) -> None:
    """Fill axes, whose shape is kept, with the vehicle on its road at a time, s; arrows are the normal loads."""
    scene = build_scene(trajectory)
    now = scene.at(time)
    system, measures = scene.system, scene.measures
    s = measures.scale
    left, right = measures.idler.x - ROOM * s, measures.sprocket.x + (ROOM + 0.5) * s
    box = axes.get_window_extent()
    height = (right - left) * box.height / box.width
    bottom = float(now.hull.positions[0, 2]) - 0.3 * (height - 2.1 * s) - 0.25 * s
    axes.set_xlim(left, right)
    axes.set_ylim(bottom, bottom + height)
    axes.set_axis_off()
    points = height / box.height * axes.get_figure().dpi / 72  # type: ignore[union-attr]  # m a point

    x = np.linspace(left, right, 600)
    ground = scene.ground.height(x + now.origin)
    axes.fill_between(x, ground, bottom, color=_shade(LIGHT.road[0]), lw=0)
    axes.plot(x, ground, color=_shade(LIGHT.road[1], 0.7), lw=0.8)
    _draw_hull(axes, scene, now)

    shoes = _right(now.shoes)
    belt = shoes.positions[np.append(np.arange(len(shoes.positions)), 0)]
    axes.plot(
        belt[:, 0],
        belt[:, 2],
        color=_shade(running_gear.SHOE[:3], 0.8),
        lw=measures.shoe_thickness / points,
        dashes=(2.2, 0.25),
    )
    for poses, radius in (
        (_right(now.sprockets), measures.sprocket.radius),
        (_right(now.road_wheels), measures.tyre_radius),
    ):
        for pose in zip(poses.positions, poses.wxyzs, strict=True):
            _draw_wheel(axes, *pose, radius - measures.shoe_thickness * (radius != measures.tyre_radius))
    for position in _right(now.imaginary_wheels).positions:
        blue = _shade(running_gear.IMAGINARY)
        axes.add_patch(
            Circle((position[0], position[2]), system.r, fc=(*blue, 0.15), ec=(*blue, 0.8), lw=0.7, zorder=4)
        )
    _draw_arms(axes, scene, now, palette)
    for arrow, colour in zip(now.arrows[: len(palette.wheels)], palette.wheels, strict=True):
        if np.ptp(arrow[:, 2]) < LEAST_ARROW:
            continue
        style = {
            "arrowstyle": "-|>,head_width=0.16,head_length=0.32",
            "color": colour,
            "lw": 1.6,
            "shrinkA": 0,
            "shrinkB": 0,
        }
        axes.annotate("", arrow[1, ::2], arrow[0, ::2], arrowprops=style, zorder=7)
    _label(axes, scene, now, palette, points)


def highest_load(run: Trajectory) -> float:
    """When a wheel carries most, s: the moment to draw where nobody has chosen one."""
    return float(run.t[run.normal_load.max(axis=1).argmax()])


def _right(poses: Poses) -> Poses:
    """Those of the vehicle's right side."""
    half = len(poses.positions) // 2
    return Poses(poses.positions[:half], poses.wxyzs[:half])


def _turned(pose: np.ndarray, angle: float, points: np.ndarray) -> np.ndarray:
    """Points (K, 2) of a body at a position (3,) of the view, turned by an angle: in the plane x, z."""
    c, s = np.cos(angle), np.sin(angle)
    return pose[::2] + points @ np.array([[c, s], [-s, c]])


def _angle(wxyz: np.ndarray) -> float:
    return float(2 * np.arctan2(-wxyz[2], wxyz[0]))


def _draw_hull(axes: Axes, scene: Scene, now: Snapshot) -> None:
    """Its faces that are seen from the right, the farthest first."""
    faces, shades = [], []
    for part in hull(scene.measures):
        corners = part.vertices[part.faces]
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        normal /= np.maximum(np.linalg.norm(normal, axis=1), 1e-12)[:, None]
        seen = normal[:, 1] < -1e-6
        lit = DIM + (1 - DIM) * np.maximum(normal[seen] @ (LAMP / np.linalg.norm(LAMP)), 0.0)
        faces.append(corners[seen])
        shades.append(np.clip(lit[:, None] * 1.25 * _colours(part)[seen] / 255, 0, 1))
    corners, colours = np.concatenate(faces), np.concatenate(shades)
    order = np.argsort(-corners[:, :, 1].mean(axis=1))
    angle = _angle(now.hull.wxyzs[0])
    flat = _turned(now.hull.positions[0], angle, corners[order][:, :, ::2].reshape(-1, 2)).reshape(-1, 3, 2)
    axes.add_collection(
        PolyCollection(list(flat), facecolors=colours[order], edgecolors=colours[order], linewidths=0.5, zorder=1.5)
    )


def _colours(part: Part) -> np.ndarray:
    """(F, 3) sRGB of a part's faces."""
    colours = np.broadcast_to(np.asarray(part.colour, dtype=float), (len(part.vertices), 4))
    return colours[part.faces[:, 0], :3]


def _draw_wheel(axes: Axes, position: np.ndarray, wxyz: np.ndarray, radius: float) -> None:
    """Tyre, disc, hub and one marked spoke."""
    centre = position[::2]
    for size, colour in ((1.0, running_gear.RUBBER), (0.78, running_gear.STEEL), (0.25, running_gear.DARK_STEEL)):
        axes.add_patch(Circle(tuple(centre), size * radius, color=_shade(colour[:3]), lw=0, zorder=3))
    spoke = _turned(position, _angle(wxyz), radius * np.array([[0.25, 0.0], [0.75, 0.0]]))
    axes.plot(spoke[:, 0], spoke[:, 1], color=_shade(running_gear.MARK[:3]), lw=1.4, zorder=3.1)


def _draw_arms(axes: Axes, scene: Scene, now: Snapshot, palette: Palette) -> None:
    """Road arms and imaginary arms, each in its wheel's colour."""
    system = scene.system
    n, m = system.n, system.m
    arms, links = _right(now.road_arms), _right(now.imaginary_arms)
    ends = [(system.u_j[i], system.u_i[n + i]) for i in range(n)]
    ends += [(system.u_j[2 * n + i], system.u_i[2 * n + m + i]) for i in range(m)]
    poses = [*zip(*arms, strict=True), *zip(*links, strict=True)]
    widths = [2.2] * n + [1.2] * m
    for (position, wxyz), pair, colour, width in zip(poses, ends, palette.wheels, widths, strict=True):
        line = _turned(position, _angle(wxyz), np.array(pair))
        axes.plot(
            line[:, 0], line[:, 1], color=colour, lw=width, solid_capstyle="round", marker="o", ms=width, zorder=5
        )


def _label(axes: Axes, scene: Scene, now: Snapshot, palette: Palette, points: float) -> None:
    """R1… and below them I1…, under the ground where the wheels touch; points: m of the view for each."""
    feet = now.arrows[: len(palette.wheels), 0]
    for name, foot, colour in zip(wheel_names(scene.system), feet, palette.wheels, strict=True):
        y = feet[:, 2].min() - (9 if name[0] == "R" else 17) * points
        axes.text(foot[0], y, name, color=colour, fontsize=5.5, ha="center", va="center", zorder=8)


def _shade(colour: Sequence[int], factor: float = 1.0) -> tuple[float, float, float]:
    r, g, b = (min(factor * part / 255, 1.0) for part in colour)
    return r, g, b
