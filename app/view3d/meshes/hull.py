"""The hull: of a fighting vehicle with a turret, of a carrier, or a robot's, stretched to the wheels it stands on.

In the design pose: x forward, y to the left, z above flat ground; m, at the size of the paper's vehicle.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from app.view3d.meshes.measures import Measures
from app.view3d.meshes.running_gear import DARK_STEEL, RUBBER, STEEL
from app.view3d.meshes.solids import Part, Rgba, both_sides, box, convex, lathe, lengthwise, upright

PAINT: Rgba = (118, 130, 98, 255)
PAINT_LIGHT: Rgba = (132, 144, 112, 255)
PAINT_DARK: Rgba = (86, 96, 74, 255)
FLOOR: Rgba = (66, 74, 60, 255)
GLASS: Rgba = (46, 60, 72, 255)
LAMP: Rgba = (250, 240, 204, 255)
TAIL_LAMP: Rgba = (176, 54, 44, 255)
TURRET = (0.82, 0.04), (0.50, 0.385)  # radius and height over the roof, of the cone's foot and top
TURRET_CORNERS = 32  # of its circles among the edges
GUN = 0.84, 2.52  # m before the turret's axis, from the mantlet to the muzzle
GUN_HEIGHT, GUN_RISE = 0.20, 0.03  # m over the roof, and m upwards for each m forward

Point = tuple[float, float, float]


class Shape(NamedTuple):
    """What tells hulls apart; m."""

    tip: float  # of the nose, ahead of the sprocket
    front: float  # edge of the roof, behind the sprocket
    roof: float  # height
    half_width: float  # of the roof


SHAPES = {
    "turret": Shape(0.46, 1.30, 1.56, 1.20),
    "carrier": Shape(0.30, 0.36, 1.80, 1.43),
    "plain": Shape(0.46, 0.40, 1.26, 1.20),
}


def hull(measures: Measures) -> list[Part]:
    """Everything that is fixed to the chassis, about the point of the ground under its centre of mass."""
    unit = measures.at_scale_one()
    parts = [*_body(unit), *_fenders(unit), *_lamps(unit), *_rollers(unit)]
    match measures.hull:
        case "turret":
            parts += [*_turret(unit), *_fittings(unit)]
        case "carrier":
            parts += _carrier_fittings(unit)
        case _:
            parts += _lid(unit)
    return [part.scaled(measures.scale) for part in parts]


def _across(outline: Sequence[Point]) -> np.ndarray:
    """Corners on both sides from (x, half width, z)."""
    return np.array([(x, sign * y, z) for x, y, z in outline for sign in (-1, 1)])


def hull_edges(measures: Measures) -> list[np.ndarray]:
    """Lines, each (K, 3), along the edges that make the shape of body, turret and gun; in the frame of `hull`."""
    unit = measures.at_scale_one()
    upper, (_, chin) = _upper(unit), _nose(unit)
    side = np.array([*upper, upper[0], chin])
    across = [np.array([corner, corner]) for corner in (*upper, chin)]
    lines = [side, side * (1, -1, 1), *(bar * np.array([(1, 1, 1), (1, -1, 1)]) for bar in across)]
    if measures.hull == "turret":
        lines += _turret_edges(unit)
    return [measures.scale * line for line in lines]


def _turret_edges(measures: Measures) -> list[np.ndarray]:
    around = 2 * np.pi * np.arange(TURRET_CORNERS + 1) / TURRET_CORNERS
    circle = np.column_stack([np.cos(around), np.sin(around), np.zeros(len(around))])
    foot, top = (radius * circle + (0.0, 0.0, z) for radius, z in TURRET)
    height = np.array([0.0, 0.0, GUN_HEIGHT + 0.05])  # along its upper edge
    turret = [foot, top, *np.stack([foot, top], axis=1)[: -1 : TURRET_CORNERS // 8]]
    turret += [np.array([(x, 0.0, GUN_RISE * x) for x in GUN]) + height]
    return [line + _turret_foot(measures) for line in turret]


def _nose(measures: Measures) -> tuple[Point, Point]:
    """Its tip and, below, its chin."""
    nose, w = measures.sprocket.x, measures.hull_half_width
    return (nose + SHAPES[measures.hull].tip, w, measures.fender + 0.04), (nose + 0.02, w, measures.belly + 0.16)


def _upper(measures: Measures) -> list[Point]:
    """Corners of the body above the fenders, from the tip up and back."""
    nose, tail, deck = measures.sprocket.x, measures.idler.x, measures.fender + 0.02
    wide, shape = measures.half_width - 0.08, SHAPES[measures.hull]
    return [
        _nose(measures)[0],
        (nose + 0.30, wide, deck),
        (nose + 0.24, wide - 0.05, deck + 0.10),
        (nose - shape.front, shape.half_width, shape.roof),
        (tail - 0.24, shape.half_width, shape.roof),
        (tail - 0.36, wide, deck),
    ]


def _turret_foot(measures: Measures) -> np.ndarray:
    return np.array([measures.middle - 0.18, 0.0, SHAPES[measures.hull].roof - 0.005])


def _body(measures: Measures) -> list[Part]:
    nose, tail, floor, deck = measures.sprocket.x, measures.idler.x, measures.belly, measures.fender + 0.02
    w = measures.hull_half_width
    tip, chin = _nose(measures)
    lower = [
        chin,
        (nose - 0.28, w, floor),
        (tail - 0.02, w, floor),
        (tail - 0.26, w, deck),
        (nose + 0.34, w, deck),
    ]
    return [
        convex(_across(lower), FLOOR, chamfer=0.02),
        convex(_across(_upper(measures)), PAINT, chamfer=0.03),
        convex(_across([tip, chin, (nose - 0.2, w, deck)]), PAINT_DARK, chamfer=0.02),
    ]


def _fenders(measures: Measures) -> list[Part]:
    """Plates over the tracks with a skirt outside and mudguards at both ends."""
    inner, outer, z = measures.hull_half_width - 0.05, measures.half_width, measures.fender
    front, rear = measures.sprocket.x + 0.22, measures.idler.x - 0.26

    def plate(near: tuple[float, float], far: tuple[float, float]) -> Part:
        corners = [(x, y, top - dz) for x, top in (near, far) for y in (inner, outer) for dz in (0.0, 0.025)]
        return convex(corners, PAINT_DARK)

    skirt = box(((front + rear) / 2, outer - 0.01, z - 0.03), (front - rear, 0.02, 0.06), PAINT)
    return both_sides(
        [
            plate((front, z), (rear, z)),
            plate((front, z), (front + 0.20, z - 0.16)),
            plate((rear, z), (rear - 0.12, z - 0.12)),
            skirt,
        ]
    )


def _turret(measures: Measures) -> list[Part]:
    """A low conical turret with a hatch, a sight and a light gun."""
    ring = lathe([(0.86, 0.0), (0.86, 0.05), (0.80, 0.05)], PAINT_DARK, 32)
    foot, top = TURRET
    cone = lathe([foot, (0.54, 0.36), top, (0.0, 0.40)], PAINT, 48)
    hatch = lathe([(0.24, 0.38), (0.24, 0.43), (0.20, 0.45), (0.0, 0.46)], PAINT_LIGHT, 20)
    gun = [(0.0, 0.7), (0.055, 0.7), (0.055, 1.35), (0.034, 1.37), (0.034, 2.30), (0.048, 2.30), (0.048, GUN[1])]
    mantlet = [(0.50, y, z) for y in (-0.22, 0.22) for z in (0.10, 0.34)]
    mantlet += [(0.84, y, z) for y in (-0.12, 0.12) for z in (0.14, 0.28)]
    parts = [
        upright(ring),
        upright(cone),
        upright(hatch).moved(-0.12, -0.16),
        convex(mantlet, PAINT_DARK, chamfer=0.02),
        lengthwise(lathe([*gun, (0.0, GUN[1])], DARK_STEEL, 12)).pitched(GUN_RISE).moved(z=GUN_HEIGHT),
        box((0.30, 0.30, 0.40), (0.16, 0.14, 0.14), PAINT_DARK),
        box((0.385, 0.30, 0.41), (0.01, 0.10, 0.07), GLASS),
        box((-0.62, 0.34, 0.62), (0.014, 0.014, 0.9), DARK_STEEL),
        box((-0.62, 0.34, 0.18), (0.06, 0.06, 0.16), PAINT_DARK),
    ]
    return [part.moved(*_turret_foot(measures)) for part in parts]


def _lamps(measures: Measures) -> list[Part]:
    nose, tail, deck = measures.sprocket.x, measures.idler.x, measures.fender + 0.02
    lamp = lengthwise(lathe([(0.0, -0.06), (0.075, -0.06), (0.075, 0.06)], PAINT_DARK, 14))
    lens = lengthwise(lathe([(0.075, 0.055), (0.05, 0.075), (0.0, 0.08)], LAMP, 14))
    ahead = [part.moved(nose + 0.12, 1.06, deck + 0.20) for part in (lamp, lens)]
    return both_sides([*ahead, box((tail - 0.37, 1.25, deck + 0.10), (0.05, 0.14, 0.07), TAIL_LAMP)])


def _lid(measures: Measures) -> list[Part]:
    """What closes a plain body: a plate on its roof."""
    shape = SHAPES[measures.hull]
    front, rear = measures.sprocket.x - shape.front - 0.15, measures.idler.x - 0.10
    return [box(((front + rear) / 2, 0.0, shape.roof + 0.01), (front - rear, 1.7, 0.05), PAINT_LIGHT)]


class _Plates:
    """The sloping plates of the body above the fenders, for what lies on them."""

    def __init__(self, measures: Measures) -> None:
        _, (_, wide, deck), (x, _, z), (front, narrow, roof), *_ = _upper(measures)
        self._foot, self._top = np.array([x, z]), np.array([front, roof])
        self._slope = float(np.arctan2(*(self._top - self._foot)[::-1])) - np.pi
        self._fender, self._rise = np.array([wide, deck]), np.array([narrow - wide, roof - deck])
        self._lean = float(np.arctan2(*self._rise[::-1])) - np.pi

    def on_glacis(self, along: float, y: float, size: Point, colour: Rgba) -> Part:
        """A block, `along` of the way from the glacis's foot to the roof."""
        x, z = self._foot + along * (self._top - self._foot)
        return box((0.0, 0.0, 0.0), size, colour).pitched(self._slope).moved(x, y, z)

    def on_side(self, x: float, up: float, size: Point, colour: Rgba) -> Part:
        """A block on the left, `up` of the way from the fender to the roof."""
        y, z = self._fender + up * self._rise
        return box((0.0, 0.0, 0.0), size, colour).rolled(self._lean).moved(x, y, z)


def _fittings(measures: Measures) -> list[Part]:
    """Hatches, doors, vision blocks, splash boards, stowage, exhaust and tow hooks about a turret."""
    nose, tail, middle, deck = measures.sprocket.x, measures.idler.x, measures.middle, measures.fender + 0.02
    plates, roof = _Plates(measures), SHAPES[measures.hull].roof
    blocks = [middle - 1.45 + 0.62 * k for k in range(4)]
    pairs = [
        box((tail + 0.25, 0.42, roof + 0.012), (0.52, 0.52, 0.04), PAINT_LIGHT),
        box((tail - 0.31, 0.34, deck + 0.26), (0.06, 0.62, 0.46), PAINT_LIGHT),
        box((middle - 0.90, 1.44, deck + 0.09), (0.9, 0.14, 0.18), PAINT_LIGHT),
        box((middle + 0.35, 1.44, deck + 0.07), (1.1, 0.10, 0.12), PAINT_DARK),
        *(plates.on_side(x, 0.68, (0.15, 0.13, 0.05), PAINT_DARK) for x in blocks),
        *(plates.on_side(x, 0.68, (0.07, 0.05, 0.07), GLASS) for x in blocks),
        _tow_hook(measures),
    ]
    return [
        plates.on_glacis(0.30, 0.0, (0.03, 2.0, 0.16), PAINT_DARK),
        plates.on_glacis(0.52, 0.0, (0.03, 2.0, 0.07), PAINT_DARK),
        plates.on_glacis(0.72, 0.55, (0.50, 0.56, 0.05), PAINT_LIGHT),
        plates.on_glacis(0.95, 0.55, (0.10, 0.44, 0.12), GLASS),
        plates.on_glacis(0.70, -0.55, (0.50, 0.70, 0.04), PAINT_LIGHT),
        box((nose - 1.0, -1.34, deck + 0.30), (0.5, 0.06, 0.16), RUBBER),
        *both_sides(pairs),
    ]


def _carrier_fittings(measures: Measures) -> list[Part]:
    """Splash board, ramp, hatches of driver, commander and load, stowage, exhaust and tow hooks of a carrier."""
    nose, tail, middle, deck = measures.sprocket.x, measures.idler.x, measures.middle, measures.fender + 0.02
    plates, roof, front = _Plates(measures), SHAPES[measures.hull].roof, nose - SHAPES[measures.hull].front
    hatch = upright(lathe([(0.26, 0.0), (0.26, 0.05), (0.20, 0.08), (0.0, 0.09)], PAINT_LIGHT, 20))
    cupola = upright(lathe([(0.42, 0.0), (0.40, 0.14), (0.30, 0.20), (0.0, 0.22)], PAINT, 24))
    blocks = [box((0.38 * x, 0.38 * y, 0.09), (0.12, 0.12, 0.07), GLASS) for x, y in ((1, 0), (0.6, 0.8), (-0.4, 0.9))]
    pairs = [
        *(part.moved(front - 1.35, 0.0, roof) for part in blocks),
        plates.on_side(middle - 0.55, 0.55, (1.5, 0.34, 0.06), PAINT_LIGHT),
        _tow_hook(measures),
    ]
    return [
        plates.on_glacis(0.42, 0.0, (0.62, 2.2, 0.05), PAINT_LIGHT),
        plates.on_glacis(0.42, 0.0, (0.06, 2.2, 0.09), PAINT_DARK),
        hatch.moved(front - 0.34, 0.62, roof),
        box((front - 0.02, 0.62, roof + 0.05), (0.06, 0.40, 0.07), GLASS),
        box((front - 0.42, -0.55, roof + 0.012), (0.62, 0.80, 0.03), PAINT_DARK),
        cupola.moved(front - 1.35, 0.0, roof),
        box((tail - 0.31, 0.0, deck + 0.42), (0.10, 1.7, 0.66), PAINT_LIGHT),
        box((tail + 0.66, 0.0, roof + 0.015), (1.15, 1.30, 0.05), PAINT_LIGHT),
        *both_sides(pairs),
    ]


def _tow_hook(measures: Measures) -> Part:
    return box((measures.sprocket.x + 0.30, 0.55, measures.belly + 0.34), (0.16, 0.07, 0.10), DARK_STEEL)


def _rollers(measures: Measures) -> list[Part]:
    """Return rollers under the upper run, and the axles of sprocket and idler."""
    parts = []
    for roller in measures.rollers:
        R = roller.radius - measures.shoe_thickness
        wheel = lathe([(0.0, -0.10), (R, -0.10), (R, 0.10), (0.4 * R, 0.10), (0.0, 0.11)], RUBBER, 16)
        parts.append(wheel.moved(roller.x, measures.track - 0.04, roller.height))
    for end in (measures.sprocket, measures.idler):
        axle = lathe([(0.35 * end.radius, -0.3), (0.3 * end.radius, 0.0)], STEEL, 14)
        parts.append(axle.moved(end.x, measures.track, end.height))
    return both_sides(parts)
