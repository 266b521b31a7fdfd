"""The picture of an instant against the trajectory it is made of; no viewer."""

from __future__ import annotations

import numpy as np
import pytest

from app.view3d.snapshot import SIDES, Poses, build_scene
from app.view3d.track_belt import track_path
from model import Trajectory, load_config, simulate


def run(**changes: object) -> Trajectory:
    short = {"simulation.duration": 2.0, "simulation.output_rate": 50}
    return simulate(load_config("paper").replace({**short, **changes}))


@pytest.fixture(scope="module")
def trajectory() -> Trajectory:
    return run()


def turned(poses: Poses, vectors: np.ndarray) -> np.ndarray:
    """Vectors (K, 3) of K bodies, in the view's frame."""
    w, xyz = poses.wxyzs[:, :1].astype(float), poses.wxyzs[:, 1:].astype(float)
    return vectors + 2 * np.cross(xyz, np.cross(xyz, vectors) + w * vectors)


def test_bodies_stand_where_the_trajectory_has_them(trajectory: Trajectory) -> None:
    scene, system, k = build_scene(trajectory), trajectory.system, 83
    now, q = scene.at(trajectory.t[k]), trajectory.q[k]
    assert now.x == q[0, 0]
    groups = {
        "road_arms": system.road_arms,
        "imaginary_wheels": system.imaginary_wheels,
        "imaginary_arms": system.imaginary_arms,
    }
    for name, bodies in groups.items():
        drawn = getattr(now, name).positions.reshape(2, -1, 3)
        for side, sign in zip(drawn, SIDES, strict=True):
            np.testing.assert_allclose(side[:, 0] + now.x, q[bodies, 0], atol=1e-6)
            np.testing.assert_allclose(side[:, 2], q[bodies, 1], atol=1e-6)
            assert (np.sign(side[:, 1]) == sign).all()
    wheels = now.road_wheels.positions.reshape(2, -1, 3)[:, :-1]  # without the idler
    np.testing.assert_allclose(wheels[..., 0] + now.x, np.tile(q[system.road_wheels, 0], (2, 1)), atol=1e-6)


def test_hull_is_carried_by_the_centre_of_mass_and_pitches_with_it(trajectory: Trajectory) -> None:
    k = int(np.abs(trajectory.q[:, 0, 2]).argmax())
    now, (_, y, pitch) = build_scene(trajectory).at(trajectory.t[k]), trajectory.q[k, 0]
    cg_height = trajectory.config.vehicle.chassis.cg_height
    mass = now.hull.positions + turned(now.hull, np.array([[0.0, 0.0, cg_height]]))
    np.testing.assert_allclose(mass, [[0.0, 0.0, y]], atol=1e-6)
    nose = turned(now.hull, np.array([[1.0, 0.0, 0.0]]))
    np.testing.assert_allclose(nose, [[np.cos(pitch), 0.0, np.sin(pitch)]], atol=1e-6)


def test_wheels_of_both_sides_turn_forwards_and_show_their_face_outwards(trajectory: Trajectory) -> None:
    now = build_scene(trajectory).at(0.0)
    later = build_scene(trajectory).at(0.02)
    face = np.array([[0.0, -1.0, 0.0]])
    for name in ("road_wheels", "imaginary_wheels", "sprockets"):
        before, after = getattr(now, name), getattr(later, name)
        sides = np.sign(before.positions[:, 1])
        np.testing.assert_allclose(turned(before, face)[:, 1], sides, atol=1e-6)
        top = np.array([[0.0, 0.0, 1.0]])
        spoke = turned(before._replace(wxyzs=before.wxyzs * (1, -1, -1, -1)), top)  # the body's own upward direction
        np.testing.assert_allclose(turned(before, spoke), np.tile(top, (len(spoke), 1)), atol=1e-5)
        assert (turned(after, spoke)[:, 0] > 0.05).all(), name


def test_between_samples_poses_and_loads_are_in_proportion(trajectory: Trajectory) -> None:
    scene, k, part = build_scene(trajectory), 60, 0.25
    t = trajectory.t[k] + part * (trajectory.t[k + 1] - trajectory.t[k])
    expected = (1 - part) * trajectory.q[k] + part * trajectory.q[k + 1]
    load = (1 - part) * trajectory.normal_load[k] + part * trajectory.normal_load[k + 1]
    now = scene.at(t)
    assert now.x == pytest.approx(expected[0, 0], abs=1e-9)
    arms = now.road_arms.positions[: trajectory.system.n]
    np.testing.assert_allclose(arms[:, 2], expected[trajectory.system.road_arms, 1], atol=1e-6)
    length = np.linalg.norm(now.arrows[: len(load), 1] - now.arrows[: len(load), 0], axis=1)
    np.testing.assert_allclose(length, load * scene.load_scale, rtol=1e-4)


@pytest.mark.parametrize("time", [-1.0, 1e9])
def test_outside_of_the_run_its_ends_are_shown(trajectory: Trajectory, time: float) -> None:
    end = trajectory.q[0 if time < 0 else -1, 0, 0]
    assert build_scene(trajectory).at(time).x == end


def test_a_run_of_one_sample_can_be_seen() -> None:
    trajectory = run()
    one = Trajectory(
        **{
            name: value[:1] if isinstance(value, np.ndarray) and name != "static_load" else value
            for name, value in vars(trajectory).items()
            if name in Trajectory.__dataclass_fields__
        }
    )
    assert build_scene(one).at(0.5).x == trajectory.q[0, 0, 0]


def test_arrows_stand_on_the_contact_points_and_are_as_long_as_the_loads(trajectory: Trajectory) -> None:
    scene, k = build_scene(trajectory), 90
    now = scene.at(trajectory.t[k], arrow_scale=2.0)
    centres = trajectory.q[k][trajectory.system.wheel, :2]
    points, normals, _ = scene.ground.road.nearest(centres)
    right, left = now.arrows.reshape(2, -1, 2, 3)
    np.testing.assert_allclose(right[:, 0, ::2] + [now.x, 0.0], points, atol=1e-5)
    np.testing.assert_allclose(right[:, :, ::2], left[:, :, ::2])
    assert (right[..., 1] < -scene.measures.track).all()
    assert (left[..., 1] > scene.measures.track).all()
    arrow = right[:, 1, ::2] - right[:, 0, ::2]
    np.testing.assert_allclose(
        arrow, 2 * scene.load_scale * trajectory.normal_load[k][:, None] * normals, rtol=1e-3, atol=2e-3
    )


def test_an_unloaded_wheel_has_no_arrow_above_the_ground() -> None:
    trajectory = run(**{"drive.speed_kmh": 40, "road.wavelength": 2.0})
    k, wheel = np.argwhere(trajectory.normal_load == 0.0)[0]
    foot, tip = build_scene(trajectory).at(trajectory.t[k]).arrows[wheel]
    assert 0.0 < tip[2] - foot[2] <= 1.1e-3


CASES = [
    {},
    {"vehicle.imaginary_wheels.enabled": False},
    {"vehicle.road_wheels.count": 2, "vehicle.road_wheels.spacing": 2.4},
    {"vehicle.road_wheels.count": 20},
    {"vehicle.road_wheels.spacing": 0.583},
    {"vehicle.road_wheels.radius": 0.6, "vehicle.road_wheels.spacing": 1.3},
    {"road.amplitude": 0.04, "road.wavelength": 0.7},
    {"road.type": "half_round", "road.position": 4.0, "road.height": 0.1, "road.radius": 0.2},
]


@pytest.mark.parametrize("changes", CASES, ids=lambda changes: " ".join(map(str, changes.values())) or "paper")
def test_track_goes_around_all_wheels_and_not_into_the_ground(changes: dict[str, object]) -> None:
    trajectory = run(**changes)
    scene, system = build_scene(trajectory), trajectory.system
    thickness = scene.measures.shoe_thickness
    for k in (0, 40, len(trajectory.t) - 1):
        now = scene.at(trajectory.t[k])
        right, left = now.shoes.positions.reshape(2, -1, 3)
        np.testing.assert_array_equal(right * (1, -1, 1), left)
        assert (right[:, 2] > scene.ground.road.height(right[:, 0] + now.x) - thickness).all()
        # Shoes hang together, and none comes inside of a wheel
        gaps = np.linalg.norm(np.roll(right, -1, axis=0) - right, axis=1)
        assert gaps.max() < 1.15 * scene.measures.shoe_pitch
        centres = trajectory.q[k][system.wheel, :2] - [now.x, 0.0]
        distance = np.linalg.norm(right[:, None, ::2] - centres, axis=2)
        assert distance.min() > scene.measures.radius - thickness
        # Each wheel hangs in the loop: the track passes below and above it
        below = np.array([right[np.abs(right[:, 0] - x) < scene.measures.shoe_pitch, 2].min() for x in centres[:, 0]])
        above = np.array([right[np.abs(right[:, 0] - x) < scene.measures.shoe_pitch, 2].max() for x in centres[:, 0]])
        assert (below < centres[:, 1] - scene.measures.tyre_radius + 1e-6).all()
        assert (above > centres[:, 1]).all()


def test_shoes_on_the_ground_do_not_slip() -> None:
    trajectory = run(**{"road.type": "flat"})
    scene = build_scene(trajectory)

    def on_the_ground(time: float) -> np.ndarray:
        now = scene.at(time)
        x, _, z = now.shoes.positions[: len(now.shoes.positions) // 2].T
        middle = (np.abs(x) < 1.0) & (z < scene.measures.shoe_thickness)
        return np.sort((x[middle] + now.x) % scene.measures.shoe_pitch)

    first, later = on_the_ground(1.0), on_the_ground(1.013)
    pitch = scene.measures.shoe_pitch
    shift = (np.median(later) - np.median(first) + pitch / 2) % pitch - pitch / 2
    assert abs(shift) < 0.1 * pitch
    assert trajectory.system.v_ref * 0.013 > 0.3 * pitch


def test_belt_around_two_wheels_has_the_known_length() -> None:
    path = track_path(np.array([2.0, 0.0], dtype=complex), np.array([0.5, 0.5]))
    length = np.abs(np.roll(path, -1) - path).sum()
    assert length == pytest.approx(4.0 + np.pi, rel=0.01)
    assert path.real.max() == pytest.approx(2.5)
    assert path.imag.min() == pytest.approx(-0.5)


def test_belt_passes_below_a_lifted_wheel() -> None:
    centres = np.array([2.0 + 0j, 1.0 + 0.2j, 0.0 + 0j])
    path = track_path(centres, np.full(3, 0.3))
    below = path[(path.imag < 0.0) & (np.abs(path.real - 1.0) < 0.2)]
    assert np.abs(below - centres[1]).min() >= 0.3 - 1e-9


def test_scenes_share_what_did_not_change(trajectory: Trajectory) -> None:
    first = build_scene(trajectory)
    stiffer = build_scene(run(**{"vehicle.road_suspension.stiffness": 60000}), first)
    assert stiffer.ground is first.ground
    assert stiffer.places is first.places
    rougher = build_scene(run(**{"road.amplitude": 0.2}), first)
    assert rougher.ground is not first.ground
    assert rougher.places is first.places
    longer = build_scene(run(**{"vehicle.road_wheels.spacing": 0.8}), first)
    assert longer.ground is not first.ground
    assert longer.places is not first.places


def test_load_arrows_are_comparable_between_runs_of_one_vehicle(trajectory: Trajectory) -> None:
    stiffer = run(**{"vehicle.imaginary_suspension.stiffness": 50000})
    assert build_scene(stiffer).load_scale == build_scene(trajectory).load_scale


def test_shadow_lies_on_the_road(trajectory: Trajectory) -> None:
    scene = build_scene(trajectory)
    now = scene.at(1.5)
    above = now.shadow[:, 2] - scene.ground.road.height(now.shadow[:, 0] + now.x)
    assert (above > 0.0).all()
    assert (above < 0.02).all()
