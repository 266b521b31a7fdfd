"""Coloured solids and how they become one mesh or one GLB. Frame: x forward, y to the left, z up; m."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import cache
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

Rgb = tuple[int, int, int]  # sRGB, 0…255
Rgba = tuple[int, int, int, int]  # sRGB and opacity, 0…255


class Part(NamedTuple):
    """A piece of one colour, or with one for each vertex. Faces that share vertices are shaded smoothly."""

    vertices: np.ndarray  # (V, 3)
    faces: np.ndarray  # (F, 3), counter-clockwise seen from outside
    colour: Rgba | np.ndarray  # or (V, 4)

    def moved(self, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Part:
        return self._replace(vertices=self.vertices + np.array([x, y, z]))

    def scaled(self, factor: float) -> Part:
        return self._replace(vertices=self.vertices * factor)

    def pitched(self, angle: float) -> Part:
        """Turned in the x–z plane about the origin, nose up for a positive angle (rad)."""
        c, s = np.cos(angle), np.sin(angle)
        return self._replace(vertices=self.vertices @ np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]]))

    def rolled(self, angle: float) -> Part:
        """Turned in the y–z plane about the origin, left side up for a positive angle (rad)."""
        c, s = np.cos(angle), np.sin(angle)
        return self._replace(vertices=self.vertices @ np.array([[1, 0, 0], [0, c, s], [0, -s, c]]))

    def mirrored(self) -> Part:
        """The same on the other side of the vehicle."""
        return self._replace(vertices=self.vertices * (1, -1, 1), faces=self.faces[:, ::-1])


def both_sides(parts: Sequence[Part]) -> list[Part]:
    """The parts and their mirror images."""
    return [*parts, *(part.mirrored() for part in parts)]


def box(centre: tuple[float, float, float], size: tuple[float, float, float], colour: Rgba) -> Part:
    """A box with flat faces."""
    cube = _cube()
    return cube._replace(vertices=cube.vertices * size + np.array(centre), colour=colour)


def convex(points: Sequence[tuple[float, float, float]] | np.ndarray, colour: Rgba, chamfer: float = 0.0) -> Part:
    """The convex hull of points, flat-shaded; chamfer: how far the edges are cut back, m."""
    outlines = _outlines(np.array(points, dtype=float))
    if chamfer > 0.0:
        outlines = _outlines(np.concatenate([_inset(outline, chamfer) for outline in outlines]))
    first = np.cumsum([0, *(len(outline) for outline in outlines)])
    fans = [
        start + np.array([(0, k, k + 1) for k in range(1, len(outline) - 1)])
        for start, outline in zip(first[:-1], outlines, strict=True)
    ]
    return Part(np.concatenate(outlines), np.concatenate(fans), colour)


def lathe(profile: Sequence[tuple[float, float]], colour: Rgba, sections: int = 40) -> Part:
    """A solid of revolution about the y axis, from (radius, y) points; smooth around, sharp at the points.

    The outside lies to the left of the profile when y runs to the right and the radius up.
    """
    beta = np.linspace(0.0, 2 * np.pi, sections, endpoint=False)
    around = np.column_stack([np.cos(beta), np.zeros(sections), np.sin(beta)])
    here = np.arange(sections)
    following = np.roll(here, -1)
    vertices, faces = [], []
    for k, ends in enumerate(pairwise(profile)):
        vertices += [around * radius + (0.0, y, 0.0) for radius, y in ends]
        near = 2 * k * sections
        far = near + sections
        faces.append(np.column_stack([near + here, far + here, far + following]))
        faces.append(np.column_stack([near + here, far + following, near + following]))
    return Part(np.concatenate(vertices), np.concatenate(faces), colour)


def upright(part: Part) -> Part:
    """A solid made about the y axis, set up about the z axis."""
    return part._replace(vertices=part.vertices @ np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]]))


def lengthwise(part: Part) -> Part:
    """A solid made about the y axis, laid along the x axis."""
    return part._replace(vertices=part.vertices @ np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]]))


def joined(parts: Iterable[Part]) -> tuple[np.ndarray, np.ndarray]:
    """Vertices (V, 3) and faces (F, 3) of all parts, their colours forgotten."""
    vertices, faces, _ = _merged(parts)
    return vertices, faces


def glb(parts: Iterable[Part], *, glow: float = 0.0) -> bytes:
    """The parts as binary glTF with vertex colours; translucent if a part is.

    glow: 0 for parts that stand in the scene's light; else they shine by themselves, so many times their colours.
    """
    import trimesh
    from trimesh.exchange.gltf import export_glb

    vertices, faces, amounts = _merged(parts)
    brightness = 1.0
    material: dict[str, Any] = {}
    if glow:
        peak = float(amounts[:, :3].max())  # so that dark colours use all of the 8 bits too
        amounts[:, :3] /= peak
        brightness = glow * peak
        material["extensions"] = {"KHR_materials_unlit": {}}
    if (amounts[:, 3] < 1.0).any():
        material["alphaMode"] = "BLEND"
    material["pbrMetallicRoughness"] = {
        "baseColorFactor": [brightness, brightness, brightness, 1.0],
        "metallicFactor": 0.0,
        "roughnessFactor": 0.75,
    }
    colours = np.round(255 * amounts).astype(np.uint8)
    mesh = trimesh.Trimesh(vertices, faces, vertex_colors=colours, process=False)

    def dress(tree: dict[str, Any]) -> None:
        tree["materials"] = [material]
        tree["extensionsUsed"] = list(material.get("extensions", {}))
        for shape in tree["meshes"]:
            for primitive in shape["primitives"]:
                primitive["material"] = 0

    data = export_glb(trimesh.Scene(mesh), include_normals=False, tree_postprocessor=dress)
    assert isinstance(data, bytes)
    return data


def warm_up() -> None:
    """Load the libraries that make meshes: it takes half a second, which no page should have to wait."""
    glb([convex([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], (0, 0, 0, 255))])


def light(colours: np.ndarray) -> np.ndarray:
    """sRGB 0…255 (..., 3) as amounts of light 0…1: the renderer reads vertex colours and batched colours so."""
    encoded = np.asarray(colours, dtype=float) / 255
    return np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)


def _merged(parts: Iterable[Part]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Vertices (V, 3) and faces (F, 3) of all parts; amounts of light and opacity, 0…1, at the vertices (V, 4)."""
    vertices, faces, amounts, count = [], [], [], 0
    for part in parts:
        vertices.append(part.vertices)
        faces.append(part.faces + count)
        colour = np.broadcast_to(np.array(part.colour, dtype=float), (len(part.vertices), 4))
        amounts.append(np.column_stack([light(colour[:, :3]), colour[:, 3] / 255]))
        count += len(part.vertices)
    return np.concatenate(vertices), np.concatenate(faces), np.concatenate(amounts)


def _outlines(points: np.ndarray) -> list[np.ndarray]:
    """Corners (K, 3) of every flat face of the points' convex hull, counter-clockwise seen from outside."""
    from scipy.spatial import ConvexHull

    solid = ConvexHull(points)
    normals, face_of = np.unique(solid.equations.round(6), axis=0, return_inverse=True)
    outlines = []
    for face, normal in enumerate(normals[:, :3]):
        corners = points[np.unique(solid.simplices[face_of.ravel() == face])]
        centred = corners - corners.mean(axis=0)
        across = centred[0] / np.linalg.norm(centred[0])
        angle = np.arctan2(centred @ np.cross(normal, across), centred @ across)
        outlines.append(corners[np.argsort(angle)])
    return outlines


def _inset(outline: np.ndarray, distance: float) -> np.ndarray:
    """A convex outline (K, 3) moved inwards in its plane, at most by a third of a corner's shorter edge."""
    back, ahead = np.roll(outline, 1, axis=0) - outline, np.roll(outline, -1, axis=0) - outline
    back_length, ahead_length = np.linalg.norm(back, axis=1), np.linalg.norm(ahead, axis=1)
    back, ahead = back / back_length[:, None], ahead / ahead_length[:, None]
    sine = np.linalg.norm(np.cross(back, ahead), axis=1)
    step = np.minimum(distance / np.maximum(sine, 0.2), np.minimum(back_length, ahead_length) / 3)
    return outline + step[:, None] * (back + ahead)


@cache
def _cube() -> Part:
    """A cube of edge length 1 about the origin, made when first needed: that loads SciPy, for half a second."""
    return convex([(x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)], (0, 0, 0, 255))
