"""What the user may switch on and off in the 3-D view (SWITCHES), and what most of it shows: drawings over the vehicle.

To add a switch, write what it shows here, and a row of SWITCHES: the panel makes its checkbox of that, and the view
takes from there whether it is on at first.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import NamedTuple, Protocol

import numpy as np
import viser

from app.format.colours import Palette, Theme
from app.format.load_colours import load_colours
from app.format.units import METRIC, Unit, Units
from app.view3d.labels import BELOW
from app.view3d.meshes.measures import Measures
from app.view3d.meshes.solids import lathe, light
from app.view3d.nodes import Frame, on_both_sides, paint, update
from app.view3d.snapshot import SIDES, Poses, Scene, Snapshot

IN_AIR = (255, 42, 42)  # of the ring around a wheel that has left the ground
TICK = 0.10  # m, half the length of a static load's tick, at the size of the paper's vehicle
FLANGE = 0.05  # m, half the length of a travel bar's end marks
BESIDE = 0.13  # m from a wheel's centre back to its travel bar
LINE = 0.022  # m, thickness of lines
METRE = METRIC.of("m")
BARS, BARS_IN_FEET = (1.0, 0.5, 0.2, 0.1, 0.05), (3.0, 2.0, 1.0, 0.5, 0.2)  # lengths of a scale bar
PICKED_RING = 1.12  # outer radius of the ring around the wheel that is picked, times the wheel's
RING = 0.80  # inner radius of a wheel's ring, times its outer
TRACTION_SCALE = 5.0  # times as long per newton as the loads' arrows: tractions are so much smaller
LEAST_TRACTION = 0.01  # m of arrow: shorter ones are not drawn
GRID_WIDTH, GRID_HEIGHT = 30.0, 4.0  # m, half of the height is below the road
OVERLAYS = "/overlays"  # the node above all of them


class Overlay(Protocol):
    """Something drawn over one vehicle in a viser scene."""

    def show(self, on: Mapping[str, bool]) -> None:
        """Take over which switches are on, by their names in SWITCHES."""

    def colour(self, theme: Theme, palette: Palette) -> None: ...

    def draw(self, scene: Scene, now: Snapshot) -> None:
        """Bring it to where it is now, if it is shown."""


class MovingLines:
    """Lines that move with the vehicle, shown by the switch of the same name."""

    def __init__(
        self,
        name: str,
        points: Callable[[Scene, Snapshot], np.ndarray],
        api: viser.SceneApi,
        scene: Scene,
        now: Snapshot,
    ) -> None:
        """points: (K, 2, 3) both ends of each line, in the view's frame, m."""
        self._name, self._points = name, points
        self._lines = _lines(api, name, points(scene, now), scene.measures.scale)

    def show(self, on: Mapping[str, bool]) -> None:
        self._lines.visible = on[self._name]

    def colour(self, theme: Theme, palette: Palette) -> None:
        paint(self._lines, theme.overlays)

    def draw(self, scene: Scene, now: Snapshot) -> None:
        if self._lines.visible:
            update(self._lines, points=self._points(scene, now))


class TractionArrows:
    """Arrows in the wheels' colours."""

    def __init__(self, api: viser.SceneApi, scene: Scene, now: Snapshot) -> None:
        s = scene.measures.scale
        self._arrows = api.add_arrows(
            f"{OVERLAYS}/traction",
            traction_arrows(scene, now),
            (0, 0, 0),
            shaft_radius=0.018 * s,
            head_radius=0.045 * s,
            head_length=0.09 * s,
        )

    def show(self, on: Mapping[str, bool]) -> None:
        self._arrows.visible = on["traction"]

    def colour(self, theme: Theme, palette: Palette) -> None:
        self._arrows.colors = on_both_sides(palette.wheels)

    def draw(self, scene: Scene, now: Snapshot) -> None:
        if self._arrows.visible:
            update(self._arrows, points=traction_arrows(scene, now))


class WheelRings:
    """Rings that say which wheels are in the air, or how much each one carries."""

    def __init__(self, api: viser.SceneApi, scene: Scene, now: Snapshot) -> None:
        R, s = scene.measures.radius, scene.measures.scale
        ring = lathe([(R, 0.008 * s), (R, -0.008 * s), (RING * R, -0.008 * s)], (0, 0, 0, 255))
        places = ring_places(scene, now)
        self._in_air = self._coloured = False
        self._any = True  # some wheel has a ring
        self._rings = api.add_batched_meshes_simple(
            f"{OVERLAYS}/rings",
            ring.vertices,
            ring.faces,
            places.wxyzs,
            places.positions,
            side="double",
            lod="off",
            cast_shadow=False,
        )

    def show(self, on: Mapping[str, bool]) -> None:
        self._in_air, self._coloured = on["in_air"], on["load_colours"]
        self._rings.visible = self._in_air or self._coloured

    def colour(self, theme: Theme, palette: Palette) -> None:
        """Nothing: their colours say something."""

    def draw(self, scene: Scene, now: Snapshot) -> None:
        """While no wheel has a ring nothing is sent."""
        needed = self._coloured or (self._in_air and bool((now.contacts.load <= 0.0).any()))
        if self._rings.visible and (needed or self._any):
            self._any = needed
            places = ring_places(scene, now)
            colours, sizes = ring_looks(scene, now, self._in_air, self._coloured)
            update(
                self._rings,
                batched_positions=places.positions,
                batched_wxyzs=places.wxyzs,
                batched_colors=colours,
                batched_scales=sizes,
            )


class PickedWheel:
    """A white ring around the wheel that is picked, on both sides of the vehicle."""

    def __init__(self, api: viser.SceneApi, scene: Scene, now: Snapshot) -> None:
        R, s = scene.measures.radius, scene.measures.scale
        ring = lathe([(PICKED_RING * R, 0.01 * s), (PICKED_RING * R, -0.01 * s), (R, -0.01 * s)], (0, 0, 0, 255))
        places = ring_places(scene, now)
        self._wheel: int | None = None
        self._rings = api.add_batched_meshes_simple(
            f"{OVERLAYS}/picked",
            ring.vertices,
            ring.faces,
            places.wxyzs[: len(SIDES)],
            places.positions[: len(SIDES)],
            batched_colors=np.full((len(SIDES), 3), 255, dtype=np.uint8),
            side="double",
            lod="off",
            cast_shadow=False,
            visible=False,
        )

    def pick(self, wheel: int | None) -> None:
        """Mark this wheel, in the model's order; None, or one that this vehicle lacks: none."""
        self._wheel = wheel
        if wheel is None:
            self._rings.visible = False

    def show(self, on: Mapping[str, bool]) -> None:
        """Nothing: it follows what is picked."""

    def colour(self, theme: Theme, palette: Palette) -> None:
        """Nothing: white stands out from wheels and track."""

    def draw(self, scene: Scene, now: Snapshot) -> None:
        count = len(scene.system.wheel)
        if self._wheel is None or self._wheel >= count:
            return
        places, rows = ring_places(scene, now), [self._wheel + k * count for k in range(len(SIDES))]
        update(self._rings, batched_positions=places.positions[rows], batched_wxyzs=places.wxyzs[rows])
        if not self._rings.visible:
            self._rings.visible = True


class Grid:
    """A wall of squares behind the vehicle."""

    def __init__(self, api: viser.SceneApi, scene: Scene, now: Snapshot) -> None:
        self._frame = Frame(api, f"{OVERLAYS}/grid")
        self._grid = api.add_grid(
            f"{OVERLAYS}/grid/lines",
            width=GRID_WIDTH,
            height=2 * GRID_HEIGHT,
            plane="xz",
            cell_size=0.5,
            section_size=1.0,
            cell_thickness=0.6,
            position=(0.0, scene.measures.road_half_width, 0.0),
        )

    def show(self, on: Mapping[str, bool]) -> None:
        self._frame.node.visible = on["grid"]

    def colour(self, theme: Theme, palette: Palette) -> None:
        self._grid.section_color = self._grid.cell_color = theme.grid

    def draw(self, scene: Scene, now: Snapshot) -> None:
        """It stays with the vehicle, but its lines stay with the road."""
        if self._frame.node.visible:
            self._frame.move(now.x - now.origin - (now.x + scene.passed) % 1.0)


class ScaleBar:
    """A bar of a round length, with its length below it."""

    def __init__(self, api: viser.SceneApi, scene: Scene, now: Snapshot) -> None:
        self._measures = scene.measures
        self._frame = Frame(api, f"{OVERLAYS}/scale_bar")
        self._bar = _lines(api, "scale_bar/line", scale_bar(scene.measures, METRE), scene.measures.scale)
        self._name = api.add_label(f"{OVERLAYS}/scale_bar/name", "", anchor="top-center")
        self.tell_in(METRE)

    def tell_in(self, unit: Unit) -> None:
        """Be a round number of this unit of length long."""
        bar = scale_bar(self._measures, unit)
        x, y, z = bar[0].mean(axis=0).tolist()
        self._bar.points = bar
        self._name.text = f"{bar_length(self._measures, unit):g}{unit.after}"
        self._name.position = (x, y, z - 0.04 * self._measures.scale)

    def show(self, on: Mapping[str, bool]) -> None:
        self._frame.node.visible = on["scale_bar"]

    def colour(self, theme: Theme, palette: Palette) -> None:
        paint(self._bar, theme.overlays)

    def draw(self, scene: Scene, now: Snapshot) -> None:
        if self._frame.node.visible:
            self._frame.move(now.x - now.origin, scene.lowest - BELOW * scene.measures.scale)


class Overlays:
    """All overlays of one vehicle."""

    def __init__(self, api: viser.SceneApi, scene: Scene, now: Snapshot) -> None:
        self._node = api.add_frame(OVERLAYS, show_axes=False)
        makers = dict.fromkeys(switch.overlay for switch in SWITCHES.values() if switch.overlay is not None)
        self._picked = PickedWheel(api, scene, now)
        self._all = [self._picked, *(make(api, scene, now) for make in makers)]

    def pick(self, wheel: int | None) -> None:
        """Mark the wheel that is picked, in the model's order; None: none."""
        self._picked.pick(wheel)

    def show(self, on: Mapping[str, bool]) -> None:
        """Take over which switches are on."""
        for overlay in self._all:
            overlay.show(on)

    def colour(self, theme: Theme, palette: Palette) -> None:
        for overlay in self._all:
            overlay.colour(theme, palette)

    def draw(self, scene: Scene, now: Snapshot) -> None:
        """Bring what is shown to where it is now."""
        for overlay in self._all:
            overlay.draw(scene, now)

    def tell_in(self, units: Units) -> None:
        """Tell lengths in these units."""
        for overlay in self._all:
            if isinstance(overlay, ScaleBar):
                overlay.tell_in(units.of("m"))

    def remove(self) -> None:
        self._node.remove()


def traction_arrows(scene: Scene, now: Snapshot) -> np.ndarray:
    """(2 W, 2, 3) foot at the contact point and tip along the road; one below LEAST_TRACTION ends in its foot."""
    touch = now.contacts
    length = touch.traction * (TRACTION_SCALE * touch.per_newton)
    length = np.where(np.abs(length) < LEAST_TRACTION, 0.0, length)
    ahead = np.column_stack([touch.normals[:, 1], -touch.normals[:, 0]])
    return _aside(touch.points, touch.points + length[:, None] * ahead, scene.measures.arrow)


def static_ticks(scene: Scene, now: Snapshot) -> np.ndarray:
    """(2 W, 2, 3) a tick across each load's arrow where its tip is at rest on flat ground."""
    touch = now.contacts
    tip = touch.points + (scene.trajectory.static_load * touch.per_newton)[:, None] * touch.normals
    across = TICK * scene.measures.scale * np.column_stack([touch.normals[:, 1], -touch.normals[:, 0]])
    return _aside(tip - across, tip + across, scene.measures.arrow + 0.03 * scene.measures.scale)


def ring_places(scene: Scene, now: Snapshot) -> Poses:
    """Of 2 W rings in front of all wheels' faces, the right side's first."""
    n, measures = scene.system.n, scene.measures
    road, imaginary = now.road_wheels, now.imaginary_wheels
    positions, wxyzs = [], []
    for k, side in enumerate(SIDES):
        wheels = slice(k * (n + 1), k * (n + 1) + n)
        discs = slice(k * scene.system.m, (k + 1) * scene.system.m)
        for batch, rows, y in ((road, wheels, measures.disc - 0.03), (imaginary, discs, measures.disc + 0.03)):
            there = batch.positions[rows].copy()
            there[:, 1] = side * y
            positions.append(there)
            wxyzs.append(batch.wxyzs[rows])
    return Poses(np.concatenate(positions), np.concatenate(wxyzs))


def ring_looks(scene: Scene, now: Snapshot, in_air: bool, coloured: bool) -> tuple[np.ndarray, np.ndarray]:
    """Colours (2 W, 3), 0…255 of light, and sizes (2 W,) of the rings; size 0 where there is nothing to say."""
    load = now.contacts.load
    flying = load <= 0.0
    amounts = np.full((len(load), 3), _amounts(np.array(IN_AIR)))
    if coloured:
        told = ~(flying & in_air)
        amounts[told] = _amounts(load_colours(load[told] / scene.load_top)[:, :3])
    sizes = ((flying & in_air) | (~flying & coloured)).astype(np.float32)
    return np.tile(amounts, (len(SIDES), 1)), np.tile(sizes, len(SIDES))


def travel_bars(scene: Scene, now: Snapshot) -> np.ndarray:
    """(2 · 5 n, 2, 3) beside each road wheel: where its centre has been, with both ends; at rest; and where it is."""
    low, high, rest = scene.travel
    s, (x, _, z), wxyz = scene.measures.scale, now.hull.positions[0], now.hull.wxyzs[0]
    foot, turn = complex(x, z), complex(wxyz[0], -wxyz[2]) ** 2
    wheels = now.road_wheels.positions[: scene.system.n]
    centre = (wheels[:, 0] + 1j * wheels[:, 2] - foot) / turn
    bar, flange = centre.real - BESIDE * s, FLANGE * s
    marks = (low, -flange, flange), (high, -flange, flange), (rest, -2 * flange, 0.0), (centre.imag, 0.0, BESIDE * s)
    level = [(bar + start + 1j * height, bar + end + 1j * height) for height, start, end in marks]
    ends = np.array([(bar + 1j * low, bar + 1j * high), *level])  # (5, 2, n)
    turned = foot + ends * turn
    from_, to = (np.column_stack([e.real.ravel(), e.imag.ravel()]) for e in (turned[:, 0], turned[:, 1]))
    return _aside(from_, to, scene.measures.arrow + 0.05 * s)


def bar_length(measures: Measures, unit: Unit) -> float:
    """In the unit, m or what m is told in: as much as goes three times between the first wheel and the last."""
    room = (measures.front - measures.rear) / 3 * unit.factor
    *longer, shortest = BARS if unit == METRE else BARS_IN_FEET
    return next((length for length in longer if length <= room), shortest)


def scale_bar(measures: Measures, unit: Unit) -> np.ndarray:
    """(3, 2, 3) a bar of round length with its ends, under the rear of the vehicle."""
    s = measures.scale
    a = np.array([measures.idler.x - 0.6 * s, -measures.road_half_width - 0.02 * s, -0.1 * s])
    b, up = a + np.array([bar_length(measures, unit) / unit.factor, 0.0, 0.0]), np.array([0.0, 0.0, 0.06 * s])
    return np.array([[a, b], [a - up, a + up], [b - up, b + up]], dtype=np.float32)


def _aside(start: np.ndarray, end: np.ndarray, aside: float) -> np.ndarray:
    """Segments (2 K, 2, 3) between points (K, 2) of the model's plane, on both sides of the vehicle."""
    points = np.zeros((len(SIDES), len(start), 2, 3), dtype=np.float32)
    points[..., 1] = (SIDES * aside)[:, None, None]
    points[:, :, 0, ::2], points[:, :, 1, ::2] = start, end
    return points.reshape(-1, 2, 3)


def _lines(api: viser.SceneApi, name: str, points: np.ndarray, scale: float) -> viser.LineSegmentsHandle:
    return api.add_line_segments(f"{OVERLAYS}/{name}", points, (0, 0, 0), thickness=LINE * scale)


def _amounts(colours: np.ndarray) -> np.ndarray:
    """sRGB 0…255 as amounts of light 0…255."""
    return np.round(255 * light(colours)).astype(np.uint8)


class Switch(NamedTuple):
    """Something that the user may switch on and off."""

    label: str
    on: bool  # at first
    hint: str
    overlay: Callable[[viser.SceneApi, Scene, Snapshot], Overlay] | None = None  # None: part of the vehicle or the view


SWITCHES = {
    "follow": Switch(
        "Follow vehicle", True, "The camera goes along with the vehicle (F); off: the vehicle drives past"
    ),
    "arrows": Switch(
        "Load arrows", True, "On each contact point, as high as the normal load f_n is large; none: in the air"
    ),
    "static_load": Switch(
        "Static loads",
        True,
        "A tick across each arrow: how high it is at rest on flat ground",
        partial(MovingLines, "static_load", static_ticks),
    ),
    "traction": Switch(
        "Traction arrows",
        False,
        f"Force f_t along the road, drawn {TRACTION_SCALE:g} times as long as a load of that size; forward: it drives",
        TractionArrows,
    ),
    "in_air": Switch("Wheels in the air", True, "A red ring around each wheel that has left the ground", WheelRings),
    "load_colours": Switch(
        "Load colours",
        False,
        "A ring on each wheel in the colour of its normal load f_n; the scale appears below",
        WheelRings,
    ),
    "travel": Switch(
        "Travel",
        False,
        "A bar beside each road wheel: how far it moves up and down in the hull; long mark: at rest",
        partial(MovingLines, "travel", travel_bars),
    ),
    "names": Switch(
        "Wheel names", True, "R1… are road wheels, I1… imaginary wheels, front first. Click a wheel for all its figures"
    ),
    "loads": Switch("Loads in figures", False, "The normal load f_n under each wheel's name"),
    "scale_bar": Switch("Scale bar", True, "A round length, under the rear of the vehicle", ScaleBar),
    "grid": Switch(
        "Grid",
        False,
        "Lines every half metre and metre on a wall behind the vehicle; heights from level ground",
        Grid,
    ),
}  # by name
