"""What may be drawn over the vehicle: tractions, static loads, wheels in the air, loads as colours, travel, scales."""

from __future__ import annotations

import numpy as np
import viser

from app.format.colours import Palette, Theme, rgb
from app.format.load_colours import load_colours
from app.view3d.labels import BELOW
from app.view3d.meshes.measures import Layout
from app.view3d.meshes.solids import lathe, light
from app.view3d.nodes import Frame, paint, update
from app.view3d.snapshot import SIDES, Poses, Scene, Snapshot

IN_AIR = (255, 42, 42)  # of the ring around a wheel that has left the ground
TICK = 0.10  # m, half the length of a static load's mark, at the size of the paper's vehicle
FLANGE = 0.05  # m, half the length of a travel bar's end marks
BESIDE = 0.13  # m from a wheel's centre back to its travel bar
LINE = 0.022  # m, thickness of marks
RING = 0.80  # inner radius of a wheel's ring, times its outer
TRACTION_SCALE = 5.0  # times as long per newton as the loads' arrows: tractions are so much smaller
LEAST_TRACTION = 0.01  # m of arrow: shorter ones are not drawn
GRID_WIDTH, GRID_HEIGHT = 30.0, 4.0  # m, half of the height is below the road
DEFAULTS = {
    "traction": False,
    "static_load": True,
    "in_air": True,
    "load_colours": False,
    "travel": False,
    "grid": False,
    "scale_bar": True,
}  # part -> whether it is shown at first


def _amounts(colours: np.ndarray) -> np.ndarray:
    """sRGB 0…255 as amounts of light 0…255."""
    return np.round(255 * light(colours)).astype(np.uint8)


_IN_AIR_AMOUNTS = _amounts(np.array(IN_AIR))


class Marks:
    """The marks of one vehicle in a viser scene."""

    def __init__(self, api: viser.SceneApi, scene: Scene, now: Snapshot, shown: dict[str, bool]) -> None:
        """shown: by part, as in DEFAULTS."""
        layout, s = scene.layout, scene.layout.scale
        self._shown = shown
        self._node = api.add_frame("/marks", show_axes=False)
        self._traction = api.add_arrows(
            "/marks/traction",
            traction_arrows(scene, now),
            (0, 0, 0),
            shaft_radius=0.018 * s,
            head_radius=0.045 * s,
            head_length=0.09 * s,
        )
        self._static = _lines(api, "static_load", static_marks(scene, now), s)
        self._travel = _lines(api, "travel", travel_bars(scene, now), s)
        ring = lathe([(layout.radius, 0.008 * s), (layout.radius, -0.008 * s), (RING * layout.radius, -0.008 * s)],
                     (0, 0, 0, 255))  # fmt: skip
        places = ring_places(scene, now)
        self._ringed = True  # some wheel has a ring
        self._rings = api.add_batched_meshes_simple(
            "/marks/rings",
            ring.vertices,
            ring.faces,
            places.wxyzs,
            places.positions,
            side="double",
            lod="off",
            cast_shadow=False,
        )
        self._grid_frame, self._scale_frame = Frame(api, "/marks/grid"), Frame(api, "/marks/scale_bar")
        self._grid = self._make_grid(api, layout)
        bar = scale_bar(layout)
        self._bar = _lines(api, "scale_bar/line", bar, s)
        middle = bar[0].mean(axis=0)
        api.add_label(
            "/marks/scale_bar/name",
            f"{bar_length(layout):g} m",
            position=(float(middle[0]), float(middle[1]), float(middle[2]) - 0.04 * s),
            anchor="top-center",
        )
        self.show()

    def _make_grid(self, api: viser.SceneApi, layout: Layout) -> viser.GridHandle:
        return api.add_grid(
            "/marks/grid/lines",
            width=GRID_WIDTH,
            height=2 * GRID_HEIGHT,
            plane="xz",
            cell_size=0.5,
            section_size=1.0,
            cell_thickness=0.6,
            position=(0.0, layout.road_half_width, 0.0),
        )

    def colour(self, theme: Theme, palette: Palette) -> None:
        self._traction.colors = np.tile(light(np.array([rgb(c) for c in palette.wheels])), (len(SIDES), 1))
        for lines in (self._static, self._travel, self._bar):
            paint(lines, theme.marks)
        self._grid.section_color = self._grid.cell_color = theme.grid

    def show(self) -> None:
        """Take over which parts are shown."""
        self._traction.visible = self._shown["traction"]
        self._static.visible = self._shown["static_load"]
        self._travel.visible = self._shown["travel"]
        self._rings.visible = self._shown["in_air"] or self._shown["load_colours"]
        self._grid_frame.node.visible = self._shown["grid"]
        self._scale_frame.node.visible = self._shown["scale_bar"]

    def draw(self, scene: Scene, now: Snapshot) -> None:
        """Bring what is visible to where it is now."""
        shown, x = self._shown, now.x - now.origin
        if shown["traction"]:
            update(self._traction, points=traction_arrows(scene, now))
        if shown["static_load"]:
            update(self._static, points=static_marks(scene, now))
        if shown["travel"]:
            update(self._travel, points=travel_bars(scene, now))
        ringed = shown["load_colours"] or (shown["in_air"] and bool((now.contacts.load <= 0.0).any()))
        if self._rings.visible and (ringed or self._ringed):
            self._ringed = ringed
            places = ring_places(scene, now)
            colours, sizes = ring_looks(scene, now, shown["in_air"], shown["load_colours"])
            update(
                self._rings,
                batched_positions=places.positions,
                batched_wxyzs=places.wxyzs,
                batched_colors=colours,
                batched_scales=sizes,
            )
        if shown["grid"]:
            self._grid_frame.move(x - (now.x + scene.passed) % 1.0)
        if shown["scale_bar"]:
            self._scale_frame.move(x, scene.lowest - BELOW * scene.layout.scale)

    def remove(self) -> None:
        self._node.remove()


def traction_arrows(scene: Scene, now: Snapshot) -> np.ndarray:
    """(2 W, 2, 3) foot at the contact point and tip along the road; one below LEAST_TRACTION ends in its foot."""
    touch = now.contacts
    length = touch.traction * (TRACTION_SCALE * touch.per_newton)
    length = np.where(np.abs(length) < LEAST_TRACTION, 0.0, length)
    ahead = np.column_stack([touch.normals[:, 1], -touch.normals[:, 0]])
    return _aside(touch.points, touch.points + length[:, None] * ahead, scene.layout.arrow)


def static_marks(scene: Scene, now: Snapshot) -> np.ndarray:
    """(2 W, 2, 3) a tick across each load's arrow where its tip is at rest on flat ground."""
    touch = now.contacts
    tip = touch.points + (scene.trajectory.static_load * touch.per_newton)[:, None] * touch.normals
    across = TICK * scene.layout.scale * np.column_stack([touch.normals[:, 1], -touch.normals[:, 0]])
    return _aside(tip - across, tip + across, scene.layout.arrow + 0.03 * scene.layout.scale)


def ring_places(scene: Scene, now: Snapshot) -> Poses:
    """Of 2 W rings in front of all wheels' faces, the right side's first."""
    n, layout = scene.system.n, scene.layout
    road, imaginary = now.road_wheels, now.imaginary_wheels
    positions, wxyzs = [], []
    for k, side in enumerate(SIDES):
        wheels = slice(k * (n + 1), k * (n + 1) + n)
        discs = slice(k * scene.system.m, (k + 1) * scene.system.m)
        for batch, rows, y in ((road, wheels, layout.disc - 0.03), (imaginary, discs, layout.disc + 0.03)):
            there = batch.positions[rows].copy()
            there[:, 1] = side * y
            positions.append(there)
            wxyzs.append(batch.wxyzs[rows])
    return Poses(np.concatenate(positions), np.concatenate(wxyzs))


def ring_looks(scene: Scene, now: Snapshot, in_air: bool, coloured: bool) -> tuple[np.ndarray, np.ndarray]:
    """Colours (2 W, 3), 0…255 of light, and sizes (2 W,) of the rings; size 0 where there is nothing to say."""
    load = now.contacts.load
    flying = load <= 0.0
    amounts = np.full((len(load), 3), _IN_AIR_AMOUNTS)
    if coloured:
        told = ~(flying & in_air)
        amounts[told] = _amounts(load_colours(load[told] / scene.load_top)[:, :3])
    sizes = ((flying & in_air) | (~flying & coloured)).astype(np.float32)
    return np.tile(amounts, (len(SIDES), 1)), np.tile(sizes, len(SIDES))


def travel_bars(scene: Scene, now: Snapshot) -> np.ndarray:
    """(2 · 5 n, 2, 3) beside each road wheel: where its centre has been, with both ends; at rest; and where it is."""
    low, high, rest = scene.travel
    s, (x, _, z), wxyz = scene.layout.scale, now.hull.positions[0], now.hull.wxyzs[0]
    foot, turn = complex(x, z), complex(wxyz[0], -wxyz[2]) ** 2
    wheels = now.road_wheels.positions[: scene.system.n]
    centre = (wheels[:, 0] + 1j * wheels[:, 2] - foot) / turn
    bar, flange = centre.real - BESIDE * s, FLANGE * s
    marks = (low, -flange, flange), (high, -flange, flange), (rest, -2 * flange, 0.0), (centre.imag, 0.0, BESIDE * s)
    level = [(bar + start + 1j * height, bar + end + 1j * height) for height, start, end in marks]
    ends = np.array([(bar + 1j * low, bar + 1j * high), *level])  # (5, 2, n)
    turned = foot + ends * turn
    from_, to = (np.column_stack([e.real.ravel(), e.imag.ravel()]) for e in (turned[:, 0], turned[:, 1]))
    return _aside(from_, to, scene.layout.arrow + 0.05 * s)


def bar_length(layout: Layout) -> float:
    """m: as much as goes three times between the first wheel and the last."""
    room = (layout.front - layout.rear) / 3
    return next((length for length in (1.0, 0.5, 0.2, 0.1) if length <= room), 0.05)


def scale_bar(layout: Layout) -> np.ndarray:
    """(3, 2, 3) a bar of round length with its ends, under the rear of the vehicle."""
    s = layout.scale
    a = np.array([layout.idler.x - 0.6 * s, -layout.road_half_width - 0.02 * s, -0.1 * s])
    b, up = a + np.array([bar_length(layout), 0.0, 0.0]), np.array([0.0, 0.0, 0.06 * s])
    return np.array([[a, b], [a - up, a + up], [b - up, b + up]], dtype=np.float32)


def _aside(start: np.ndarray, end: np.ndarray, aside: float) -> np.ndarray:
    """Segments (2 K, 2, 3) between points (K, 2) of the model's plane, on both sides of the vehicle."""
    points = np.zeros((len(SIDES), len(start), 2, 3), dtype=np.float32)
    points[..., 1] = (SIDES * aside)[:, None, None]
    points[:, :, 0, ::2], points[:, :, 1, ::2] = start, end
    return points.reshape(-1, 2, 3)


def _lines(api: viser.SceneApi, name: str, points: np.ndarray, scale: float) -> viser.LineSegmentsHandle:
    return api.add_line_segments(f"/marks/{name}", points, (0, 0, 0), thickness=LINE * scale)
