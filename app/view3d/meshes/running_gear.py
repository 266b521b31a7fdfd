"""Wheels, sprocket, arms and track shoes of the right side, each about its own middle, wheels about the y axis; m."""

from __future__ import annotations

import numpy as np

from app.view3d.meshes.measures import Measures
from app.view3d.meshes.solids import Part, Rgba, box, convex, lathe, lengthwise

RUBBER: Rgba = (44, 46, 48, 255)
STEEL: Rgba = (126, 132, 118, 255)
DARK_STEEL: Rgba = (84, 88, 84, 255)
MARK: Rgba = (244, 214, 106, 255)  # one spoke, to see the wheel turn
SHOE: Rgba = (96, 95, 92, 255)
GROUSER: Rgba = (62, 62, 62, 255)
IMAGINARY = (46, 134, 222)
HALF_WIDTH = 0.13  # of road wheel and sprocket at the size of the paper's vehicle


def road_wheel(measures: Measures) -> list[Part]:
    """A rubber tyre on a dished steel disc with six spokes, one of them marked; its face to the right."""
    R, w = measures.at_scale_one().tyre_radius, HALF_WIDTH
    tyre = [(0.80, -0.9 * w), (0.95, -w), (1.0, -0.7 * w), (1.0, 0.7 * w), (0.95, w), (0.0, w)]
    dish = [(0.0, -0.95 * w), (0.20, -0.95 * w), (0.28, -0.4 * w), (0.66, -0.5 * w), (0.74, -0.9 * w)]
    spoke = box((0.48 * R, -0.55 * w, 0.0), (0.42 * R, 0.34 * w, 0.09 * R), STEEL)
    parts = [
        _turned(tyre, R, RUBBER),
        _turned([*dish, (0.80, -0.9 * w)], R, STEEL),
        *_spaced(spoke, 6, marked=True),
    ]
    return _sized(parts, measures)


def imaginary_wheel(measures: Measures) -> list[Part]:
    """A thin translucent disc with an opaque rim and three spokes, one of them white; its face to the right."""
    R, w = measures.at_scale_one().radius, 0.012
    solid, glass, pale = (*IMAGINARY, 235), (*IMAGINARY, 64), (*IMAGINARY, 150)
    spoke = box((0.54 * R, -w, 0.0), (0.82 * R, 0.4 * w, 0.035 * R), pale)
    parts = [
        _turned([(0.95, -w), (1.0, -w), (1.0, w)], R, solid),
        _turned([(0.13, -0.9 * w), (0.95, -0.9 * w)], R, glass),
        _turned([(0.0, -2 * w), (0.13, -2 * w), (0.13, 0.0)], R, solid),
        spoke._replace(colour=(255, 255, 255, 210)),
        *_spaced(spoke, 3)[1:],
    ]
    return _sized(parts, measures)


def sprocket(measures: Measures) -> list[Part]:
    """A toothed driving wheel with eight bolts, one of them marked; its face to the right."""
    unit, w = measures.at_scale_one(), HALF_WIDTH
    R = unit.sprocket.radius - unit.shoe_thickness
    rim = [(0.80, -0.95 * w), (0.97, -0.95 * w), (0.97, 0.95 * w), (0.0, 0.95 * w)]
    dish = [(0.0, -w), (0.28, -w), (0.34, -0.55 * w), (0.70, -0.55 * w), (0.80, -0.95 * w)]
    corners = [(0.9, -0.1), (0.9, 0.1), (1.1, -0.04), (1.1, 0.04)]
    tooth = convex([(x * R, y * w, z * R) for y in (-0.9, -0.66) for x, z in corners], DARK_STEEL)
    bolt = box((0.55 * R, -0.6 * w, 0.0), (0.12 * R, 0.2 * w, 0.12 * R), DARK_STEEL)
    teeth = round(2 * np.pi * unit.sprocket.radius / unit.shoe_pitch)
    parts = [
        _turned(rim, R, DARK_STEEL),
        _turned(dish, R, STEEL),
        *_spaced(tooth, teeth),
        *_spaced(bolt, 8, marked=True),
    ]
    return _sized(parts, measures)


def track_shoe(measures: Measures) -> list[Part]:
    """One link of the track: x along the track, z out of it; its outer face at z = 0."""
    unit = measures.at_scale_one()
    p, t, width = unit.shoe_pitch, unit.shoe_thickness, unit.track_width
    parts = [
        box((0.0, 0.0, -0.65 * t), (0.86 * p, width, 0.7 * t), SHOE),
        box((0.0, 0.0, -0.2 * t), (0.3 * p, 0.98 * width, 0.4 * t), GROUSER),
    ]
    return _sized(parts, measures)


def road_arm(measures: Measures) -> list[Part]:
    """A tapered arm with a boss at either end, about its centre of mass, as it lies in the design pose."""
    forward, up = measures.at_scale_one().pivot
    half = float(np.hypot(forward, up)) / 2
    ends = ((-half, 0.032), (half, 0.045))
    bar = convex([(x, y, z) for x, h in ends for y in (-0.015, 0.015) for z in (-h, h)], DARK_STEEL)
    parts = [bar]
    for x, radius in ((-half, 0.055), (half, 0.07)):
        boss = [(0.0, -0.034), (0.8 * radius, -0.034), (radius, -0.026), (radius, 0.034), (0.0, 0.034)]
        parts.append(lathe(boss, DARK_STEEL, sections=16).moved(x))
    return _sized([part.pitched(float(np.arctan2(up, forward))) for part in parts], measures)


def imaginary_arm(measures: Measures) -> list[Part]:
    """A rod of unit length along x, about its middle: to be stretched to an imaginary arm's length."""
    radius = 0.018 * measures.scale
    return [lengthwise(lathe([(radius, -0.5), (radius, 0.5)], DARK_STEEL, sections=10))]


def _turned(profile: list[tuple[float, float]], radius: float, colour: Rgba) -> Part:
    """A lathe part whose profile gives radii as parts of `radius`."""
    return lathe([(part * radius, y) for part, y in profile], colour, sections=28)


def _spaced(part: Part, count: int, marked: bool = False) -> list[Part]:
    """The part `count` times around the y axis; the first in the colour of a mark, if asked."""
    parts = [part.pitched(2 * np.pi * k / count) for k in range(count)]
    return [parts[0]._replace(colour=MARK), *parts[1:]] if marked else parts


def _sized(parts: list[Part], measures: Measures) -> list[Part]:
    return [part.scaled(measures.scale) for part in parts]
