"""Meshes fit the vehicle they are made for."""

from __future__ import annotations

import json
from io import BytesIO
from typing import Any

import numpy as np
import pytest
import trimesh

from app.view3d.meshes import running_gear
from app.view3d.meshes.hull import hull, hull_edges
from app.view3d.meshes.measures import Measures, measures_of
from app.view3d.meshes.solids import box, convex, glb, joined, lathe, lengthwise, light, upright
from app.view3d.meshes.surroundings import TILES, RoadStrip, ground, shadow, shadow_faces, sky
from app.view3d.snapshot import build_scene
from model import load_config, simulate
from model.config.parameters import HULLS
from model.dynamics.vehicle import build_system

GREY = (128, 128, 128, 255)
SUSPENSION_TRAVEL = 0.10  # m at the size of the paper's vehicle that wheels may rise before they touch the drawn hull


def measures(**changes: object) -> Measures:
    config = load_config("paper").replace(changes)
    return measures_of(build_system(config), config.vehicle.hull)


VEHICLES = {
    "paper": {},
    "two wheels": {"vehicle.road_wheels.count": 2, "vehicle.road_wheels.spacing": 1.5},
    "twenty wheels": {"vehicle.road_wheels.count": 20},
    "large wheels": {"vehicle.road_wheels.radius": 0.5, "vehicle.road_wheels.spacing": 1.1},
    "small wheels": {"vehicle.road_wheels.radius": 0.2, "vehicle.road_wheels.spacing": 0.5},
    "steep arms": {"vehicle.road_arms.angle_deg": 40},
    "carrier": {"vehicle.hull": "carrier"},
    "plain": {"vehicle.hull": "plain"},
    "offset": {"vehicle.road_wheels.offset": 0.3},
    "uneven": {"vehicle.road_wheels.positions": [1.9, 1.0, 0.3, -0.5, -1.6]},
}


@pytest.mark.parametrize("changes", VEHICLES.values(), ids=VEHICLES)
def test_hull_spans_the_running_gear_and_keeps_clear_of_it(changes: dict[str, object]) -> None:
    vehicle = measures(**changes)
    vertices, _ = joined(hull(vehicle))
    s = vehicle.scale
    assert vertices[:, 0].max() > vehicle.sprocket.x + vehicle.sprocket.radius
    assert vertices[:, 0].min() < vehicle.idler.x - vehicle.idler.radius
    inner, outer = (vehicle.track + side * vehicle.track_width / 2 for side in (-1, 1))
    over_track = (np.abs(vertices[:, 1]) > inner) & (np.abs(vertices[:, 1]) < outer)
    for x in vehicle.wheel_x:
        reach = np.hypot(vertices[:, 0] - x, vertices[:, 2] - vehicle.radius)
        assert reach[over_track].min() > vehicle.radius + SUSPENSION_TRAVEL * s
    assert (vertices[np.abs(vertices[:, 1]) < inner, 2] > 0.2 * s).all()


@pytest.mark.parametrize(("hull_shape", "top"), [("carrier", (1.7, 2.1)), ("plain", (1.2, 1.4))])
def test_only_a_hull_with_a_turret_has_a_gun(hull_shape: str, top: tuple[float, float]) -> None:
    """Nor have the edges of another, which its ghost shows."""
    with_turret, without = measures(), measures(**{"vehicle.hull": hull_shape})
    for part in (joined(hull(without))[0], np.vstack(hull_edges(without))):
        assert top[0] < part[:, 2].max() < top[1]
        assert part[:, 0].max() < without.sprocket.x + 0.6
    for part in (joined(hull(with_turret))[0], np.vstack(hull_edges(with_turret))):
        assert part[:, 2].max() > 1.9


@pytest.mark.parametrize("hull_shape", HULLS)
def test_nothing_of_a_hull_stands_out_over_its_glacis(hull_shape: str) -> None:
    """What lies on it is then seen: tip, foot of the glacis and roof are corners of a convex side."""
    side = hull_edges(measures(**{"vehicle.hull": hull_shape}))[0][[0, 2, 3, 4], ::2]
    along = np.diff(side, axis=0)
    assert (along[:-1, 0] * along[1:, 1] - along[:-1, 1] * along[1:, 0] > 0).all()


@pytest.mark.parametrize(
    ("preset", "shape"), [("paper", "turret"), ("m113", "carrier"), ("m113_rs", "carrier"), ("robot", "plain")]
)
def test_presets_are_drawn_as_what_they_are(preset: str, shape: str) -> None:
    run = simulate(load_config(preset).replace({"simulation.duration": 0.1}))
    assert build_scene(run).measures.hull == shape


@pytest.mark.parametrize("changes", VEHICLES.values(), ids=VEHICLES)
def test_drawn_wheels_lie_inside_of_the_models_circle_and_apart(changes: dict[str, object]) -> None:
    vehicle = measures(**changes)
    vertices, _ = joined(running_gear.road_wheel(vehicle))
    radius = np.hypot(vertices[:, 0], vertices[:, 2]).max()
    assert radius == pytest.approx(vehicle.tyre_radius, rel=0.01)
    assert radius <= vehicle.radius - vehicle.shoe_thickness + 1e-9
    assert 2 * radius < -np.diff(vehicle.wheel_x).max()
    disc, _ = joined(running_gear.imaginary_wheel(vehicle))
    assert np.hypot(disc[:, 0], disc[:, 2]).max() == pytest.approx(vehicle.radius, rel=0.01)
    shoe, _ = joined(running_gear.track_shoe(vehicle))
    assert shoe[:, 2].max() == pytest.approx(0.0, abs=1e-9)
    assert shoe[:, 2].min() == pytest.approx(-vehicle.shoe_thickness)


def test_arm_reaches_from_its_pivot_to_its_wheel() -> None:
    vehicle = measures()
    vertices, _ = joined(running_gear.road_arm(vehicle))
    half = np.array(vehicle.pivot) / 2
    ends = vertices[:, ::2].max(axis=0), vertices[:, ::2].min(axis=0)
    assert (ends[0] >= half).all()
    assert (ends[1] <= -half).all()
    assert (ends[0] < half + 0.08).all()
    assert (ends[1] > -half - 0.08).all()


def test_layers_do_not_share_a_place_sideways() -> None:
    vehicle = measures()
    wheel, _ = joined(running_gear.road_wheel(vehicle))
    assert vehicle.hull_half_width < vehicle.track - vehicle.track_width / 2
    assert vehicle.track + wheel[:, 1].max() < vehicle.track + vehicle.track_width / 2
    order = [vehicle.track + vehicle.track_width / 2, vehicle.disc, vehicle.arm, vehicle.link, vehicle.arrow]
    assert order == sorted(order)
    assert vehicle.arrow < vehicle.road_half_width


def test_a_box_is_closed_and_faces_outwards() -> None:
    part = box((1.0, 2.0, 3.0), (2.0, 1.0, 1.0), GREY)
    mesh = trimesh.Trimesh(part.vertices, part.faces)
    mesh.merge_vertices()
    assert mesh.is_watertight
    assert mesh.volume == pytest.approx(2.0)
    np.testing.assert_allclose(mesh.bounds, [[0.0, 1.5, 2.5], [2.0, 2.5, 3.5]], atol=1e-9)


def test_a_chamfer_breaks_the_edges_and_leaves_the_faces() -> None:
    part = convex([(x, y, z) for x in (0, 2) for y in (0, 1) for z in (0, 1)], GREY, chamfer=0.1)
    mesh = trimesh.Trimesh(part.vertices, part.faces)
    mesh.merge_vertices()
    assert mesh.is_watertight
    np.testing.assert_allclose(mesh.bounds, [[0, 0, 0], [2, 1, 1]], atol=1e-9)
    assert mesh.volume == pytest.approx(2.0 - 4 * (2 + 1 + 1) * 0.1**2 / 2, rel=0.01)


def test_a_lathe_part_faces_outwards_however_it_is_laid() -> None:
    for laid in (lambda part: part, upright, lengthwise):
        part = laid(lathe([(0.0, -1.0), (1.0, -1.0), (1.0, 1.0), (0.0, 1.0)], GREY, 64))
        mesh = trimesh.Trimesh(part.vertices, part.faces)
        assert mesh.volume == pytest.approx(2 * np.pi, rel=0.01)
        assert trimesh.Trimesh(part.mirrored().vertices, part.mirrored().faces).volume == pytest.approx(mesh.volume)


def read_glb(data: bytes) -> tuple[dict[str, Any], np.ndarray]:
    """The JSON of a GLB and its vertex colours (V, 4)."""
    length = int.from_bytes(data[12:16], "little")
    tree = json.loads(data[20 : 20 + length])
    accessor = tree["accessors"][tree["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"]]
    start = 28 + length + tree["bufferViews"][accessor["bufferView"]]["byteOffset"]
    return tree, np.frombuffer(data, np.uint8, 4 * accessor["count"], start).reshape(-1, 4)


def test_a_glb_can_be_read_by_others() -> None:
    parts = [box((0, 0, 0), (1, 2, 3), GREY), lathe([(0.0, 2.0), (1.0, 3.0)], (200, 10, 10, 255), 7)]
    [mesh] = trimesh.load(BytesIO(glb(parts)), file_type="glb", process=False).geometry.values()
    vertices, faces = joined(parts)
    np.testing.assert_allclose(mesh.vertices, vertices, atol=1e-6)
    np.testing.assert_array_equal(mesh.faces, faces)
    assert len(np.unique(mesh.visual.vertex_attributes["color"], axis=0)) == 2


def test_glb_carries_colours_as_light() -> None:
    part = convex([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], (255, 188, 0, 255))
    tree, colours = read_glb(glb([part]))
    np.testing.assert_array_equal(np.unique(colours, axis=0), [[255, 128, 0, 255]])
    assert tree["materials"][0]["pbrMetallicRoughness"]["metallicFactor"] == 0.0
    assert "alphaMode" not in tree["materials"][0]
    assert "extensions" not in tree["materials"][0]


def test_glb_of_a_translucent_part_blends() -> None:
    tree, colours = read_glb(glb([box((0, 0, 0), (1, 1, 1), (0, 0, 255, 51))]))
    assert tree["materials"][0]["alphaMode"] == "BLEND"
    assert (colours[:, 3] == 51).all()


def test_glowing_glb_keeps_dark_colours_apart() -> None:
    parts = [box((x, 0, 0), (1, 1, 1), (level, level, level, 255)) for x, level in ((0, 20), (2, 21))]
    tree, colours = read_glb(glb(parts, glow=1.5))
    factor = tree["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"][0]
    assert "KHR_materials_unlit" in tree["extensionsUsed"]
    np.testing.assert_allclose(np.unique(colours[:, 0]) / 255 * factor, 1.5 * light(np.array([20, 21])), rtol=0.01)


def test_sky_surrounds_and_ground_is_level() -> None:
    dome = sky((200, 220, 240), (100, 150, 200), (50, 80, 120))
    assert trimesh.Trimesh(dome.vertices, dome.faces).volume < 0.0  # seen from within
    disc = ground((100, 100, 90), (200, 220, 240))
    np.testing.assert_allclose(disc.vertices[:, 2], 0.0, atol=1e-9)


def test_road_strip_has_the_roads_height_and_stripes_of_one_metre() -> None:
    strip, x = RoadStrip(reach=5.0, half_width=2.0), 13.7
    start = strip.start(x)
    assert start <= x < start + TILES
    meshes = strip.vertices(start, np.sin, -2.0)
    for parity, (vertices, faces) in enumerate(zip(meshes, strip.faces, strict=True)):
        on_road = vertices + np.float32([start, 0.0, 0.0])
        assert on_road[:, 0].min() <= x - 70.0
        assert on_road[:, 0].max() >= x + 110.0
        upper = on_road[:, 2] > -1.5
        np.testing.assert_allclose(on_road[upper, 2], np.sin(on_road[upper, 0]), atol=1e-4)
        mesh = trimesh.Trimesh(on_road, faces, process=False)
        assert (np.floor(mesh.triangles_center[:, 0]).astype(int) % 2 == parity).all()
        near = np.abs(mesh.triangles_center[:, 0] - x) < 5.0
        assert (np.ptp(mesh.triangles[near, :, 0], axis=1) < 0.06).all()
        top = np.abs(mesh.face_normals[:, 1]) < 0.5
        assert (mesh.face_normals[top, 2] > 0.0).all()


def test_shadow_is_a_stack_of_strips_that_look_up() -> None:
    vehicle = measures()
    mesh = trimesh.Trimesh(shadow(vehicle), shadow_faces(), process=False)
    assert (mesh.face_normals[:, 2] > 0.99).all()
    assert np.abs(mesh.vertices[:, 1]).max() < vehicle.road_half_width
