"""Wheel colours can be told apart, by colour-blind eyes too, and stand out from the background."""

from __future__ import annotations

import numpy as np
import pytest

from app.format.colours import rgb, wheel_palette
from app.view3d.meshes.solids import light

# Machado, Oliveira, Fernandes 2009, full severity, on linear sRGB
EYES = {
    "normal": np.eye(3),
    "protanopia": np.array(
        [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]]
    ),
    "deuteranopia": np.array(
        [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]]
    ),
    "tritanopia": np.array(
        [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]]
    ),
}
LMS_OF_RGB = np.array(
    [
        [0.4122214708, 0.5363325363, 0.0514459929],
        [0.2119034982, 0.6806995451, 0.1073969566],
        [0.0883024619, 0.2817188376, 0.6299787005],
    ]
)
LAB_OF_LMS = np.array(
    [
        [0.2104542553, 0.7936177850, -0.0040720468],
        [1.9779984951, -2.4285922050, 0.4505937099],
        [0.0259040371, 0.7827717662, -0.8086757660],
    ]
)


XYZ_OF_RGB = np.array(
    [
        [0.4124564, 0.3575761, 0.1804375],
        [0.2126729, 0.7151522, 0.0721750],
        [0.0193339, 0.1191920, 0.9503041],
    ]
)  # IEC 61966-2-1, white D65
BACKGROUND = {False: "#ffffff", True: "#1a1b1e"}  # of the page's plots
TWO_WHEELS = 12.0  # CIE 1976 ΔE of any two wheels of a family; about 2.3 is just noticeable
FROM_GROUND = 24.0  # the same between a wheel and what is behind its curve


def seen(colours: tuple[str, ...], eyes: str) -> np.ndarray:
    """Amounts of light (K, 3) that such eyes take the colours for."""
    return np.clip(light(np.array([rgb(colour) for colour in colours])) @ EYES[eyes].T, 0.0, 1.0)


def cielab(colours: tuple[str, ...], eyes: str) -> np.ndarray:
    """CIE 1976 L*a*b* (K, 3)."""
    part = seen(colours, eyes) @ XYZ_OF_RGB.T / XYZ_OF_RGB.sum(axis=1)
    x, y, z = np.where(part > 216 / 24389, np.cbrt(part), (24389 / 27 * part + 16) / 116).T
    return np.column_stack([116 * y - 16, 500 * (x - y), 200 * (y - z)])


def oklab(colours: tuple[str, ...], eyes: str) -> np.ndarray:
    """OKLab (K, 3); a distance of 0.02 is just noticeable."""
    return np.cbrt(seen(colours, eyes) @ LMS_OF_RGB.T) @ LAB_OF_LMS.T


def nearest(colours: np.ndarray) -> float:
    distance = np.linalg.norm(colours[:, None] - colours, axis=2)
    return float(distance[~np.eye(len(colours), dtype=bool)].min())


@pytest.mark.parametrize("dark", [False, True], ids=["light", "dark"])
@pytest.mark.parametrize("eyes", EYES)
def test_any_two_of_six_wheels_can_be_told_apart(eyes: str, dark: bool) -> None:
    palette = wheel_palette(6, 5, dark)
    assert nearest(cielab(palette.road, eyes)) > TWO_WHEELS
    assert nearest(cielab(palette.imaginary, eyes)) > TWO_WHEELS


@pytest.mark.parametrize("dark", [False, True], ids=["light", "dark"])
@pytest.mark.parametrize("count", [2, 6, 20])
def test_each_wheel_is_lighter_than_the_one_before(count: int, dark: bool) -> None:
    palette = wheel_palette(count, count - 1, dark)
    for family in (palette.road, palette.imaginary):
        assert (np.diff(cielab(family, "normal")[:, 0]) > 0).all()


@pytest.mark.parametrize("dark", [False, True], ids=["light", "dark"])
@pytest.mark.parametrize("eyes", EYES)
@pytest.mark.parametrize("count", [2, 6, 20])
def test_families_can_be_told_apart(count: int, eyes: str, dark: bool) -> None:
    palette = wheel_palette(count, count - 1, dark)
    road, imaginary = oklab(palette.road, eyes), oklab(palette.imaginary, eyes)
    assert np.linalg.norm(road[:, None] - imaginary, axis=2).min() > 0.11


@pytest.mark.parametrize("dark", [False, True], ids=["light", "dark"])
@pytest.mark.parametrize("eyes", EYES)
def test_colours_stand_out_from_the_background(eyes: str, dark: bool) -> None:
    palette = wheel_palette(6, 5, dark)
    ground = cielab((BACKGROUND[dark],), eyes)
    assert np.linalg.norm(cielab((*palette.wheels, palette.hull), eyes) - ground, axis=1).min() > FROM_GROUND
    luminance = seen((*palette.wheels, palette.hull, BACKGROUND[dark]), "normal") @ [0.2126, 0.7152, 0.0722] + 0.05
    contrast = luminance[:-1] / luminance[-1]
    assert np.maximum(contrast, 1 / contrast).min() > 2.2


@pytest.mark.parametrize(("road", "imaginary"), [(2, 0), (2, 1), (20, 19)])
def test_every_wheel_has_its_own_colour(road: int, imaginary: int) -> None:
    palette = wheel_palette(road, imaginary)
    assert (len(palette.road), len(palette.imaginary)) == (road, imaginary)
    assert len(set(palette.wheels)) == road + imaginary
    assert palette.wheels == palette.road + palette.imaginary
