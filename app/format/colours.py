"""Colours: one for each wheel, the same in plot, arrow and label, and those of the scene; light and dark.

Road wheels run through warm hues, imaginary wheels through cool ones. From the front wheel to the rear each is lighter
than the one before, by so much that colour-blind eyes and grey print tell any two of six apart; the ends of both
families were searched for that (tests/app/format/test_colours.py says how far apart they are). Made in OKLCH
(Ottosson 2020), where equal steps look equal.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import NamedTuple

import numpy as np

Colour = tuple[int, int, int]  # sRGB, 0…255

# OKLab -> cone responses (cubed) -> linear sRGB
_LMS_OF_LAB = np.array(
    [
        [1.0, 0.3963377774, 0.2158037573],
        [1.0, -0.1055613458, -0.0638541728],
        [1.0, -0.0894841775, -1.2914855480],
    ]
)
_RGB_OF_LMS = np.array(
    [
        [4.0767416621, -3.3077115913, 0.2309699292],
        [-1.2684380046, 2.6097574011, -0.3413193965],
        [-0.0041960863, -0.7034186147, 1.7076147010],
    ]
)


class _Family(NamedTuple):
    """A run of colours from the front wheel to the rear: (lightness, chroma, hue in degrees) at both ends."""

    front: tuple[float, float, float]
    rear: tuple[float, float, float]


# Of a light background, and of a dark one
_ROAD = {
    False: _Family((0.25, 0.175, -3.0), (0.75, 0.17, 80.0)),
    True: _Family((0.478, 0.167, -20.0), (0.958, 0.175, 71.0)),
}
_IMAGINARY = {
    False: _Family((0.25, 0.15, 274.0), (0.735, 0.13, 188.0)),
    True: _Family((0.472, 0.19, 286.0), (0.96, 0.077, 185.0)),
}


@dataclass(frozen=True)
class Palette:
    """The colours of one vehicle's curves, arrows and labels, as CSS (#rrggbb)."""

    road: tuple[str, ...]  # one for each road wheel, front first
    imaginary: tuple[str, ...]  # one for each imaginary wheel, front first
    hull: str

    @property
    def wheels(self) -> tuple[str, ...]:
        """Of all wheels in the model's order: road, then imaginary."""
        return self.road + self.imaginary


@dataclass(frozen=True)
class Theme:
    """The colours of the scene around the vehicle."""

    haze: Colour  # at the horizon
    sky: Colour  # above it
    zenith: Colour
    ground: Colour
    road: tuple[Colour, Colour]  # every other metre
    ghost: Colour
    overlays: Colour  # lines that are drawn over the vehicle
    grid: Colour
    key_light: float  # intensities
    sky_light: float


LIGHT = Theme(
    haze=(222, 234, 246),
    sky=(140, 190, 240),
    zenith=(70, 130, 205),
    ground=(142, 150, 122),
    road=((214, 202, 180), (190, 177, 152)),
    ghost=(152, 126, 234),
    overlays=(30, 34, 40),
    grid=(140, 150, 164),
    key_light=3.0,
    sky_light=1.6,
)
DARK = Theme(
    haze=(62, 69, 80),
    sky=(38, 45, 57),
    zenith=(14, 18, 24),
    ground=(46, 50, 53),
    road=((92, 95, 100), (76, 79, 84)),
    ghost=(196, 172, 255),
    overlays=(236, 240, 246),
    grid=(96, 104, 116),
    key_light=2.4,
    sky_light=1.3,
)


@cache
def wheel_palette(road_count: int, imaginary_count: int, dark: bool = False) -> Palette:
    """The palette of a vehicle with so many wheels, for a light or a dark background."""
    return Palette(
        road=_ramp(_ROAD[dark], road_count),
        imaginary=_ramp(_IMAGINARY[dark], imaginary_count),
        hull="#e6e9ec" if dark else "#2b2f33",
    )


def rgb(css: str) -> Colour:
    """#rrggbb as numbers."""
    return int(css[1:3], 16), int(css[3:5], 16), int(css[5:7], 16)


def _ramp(family: _Family, count: int) -> tuple[str, ...]:
    along = np.linspace(0.0, 1.0, count)[:, None]
    lightness, chroma, hue = (np.array(family.front) * (1 - along) + np.array(family.rear) * along).T
    angle = np.radians(hue)
    lab = np.column_stack([lightness, chroma * np.cos(angle), chroma * np.sin(angle)])
    light = np.clip((lab @ _LMS_OF_LAB.T) ** 3 @ _RGB_OF_LMS.T, 0.0, 1.0)
    encoded = np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)
    return tuple("#{:02x}{:02x}{:02x}".format(*colour) for colour in np.round(255 * encoded).astype(int))
