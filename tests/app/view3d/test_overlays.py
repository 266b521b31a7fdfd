"""Ghost, overlays, a drive in the 3-D view and the card of a wheel, without a browser."""

from __future__ import annotations

import asyncio
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from app.format.load_unit import KILONEWTON
from app.format.units import METRIC, US, Units
from app.panels.wheel_card import card
from app.view3d.ghost import Outline
from app.view3d.meshes.hull import hull, hull_edges
from app.view3d.meshes.solids import joined, light
from app.view3d.overlays import IN_AIR, ring_looks, scale_bar, static_ticks, traction_arrows, travel_bars
from app.view3d.snapshot import Scene, build_scene, live_scene
from app.view3d.view import View3D
from model import Trajectory, load_config, simulate
from model.analysis.ride import suspension_travel
from model.analysis.wheel_contact import wheel_state
from model.simulation.drive import REBASE, LiveDrive
from tests.app.view3d.test_view import Tab, drawn, tab

__all__ = ["tab"]  # a fixture


def run(**changes: object) -> Trajectory:
    return simulate(load_config("paper").replace({"simulation.duration": 4.0, **changes}))


@pytest.fixture(scope="module")
def scene() -> Scene:
    return build_scene(run())


def flight(scene: Scene) -> tuple[float, int]:
    """A time at which a wheel is in the air, and which wheel."""
    sample, wheel = np.argwhere(scene.trajectory.normal_load[200:] <= 0.0)[0]
    return float(scene.trajectory.t[200 + sample]), int(wheel)


def test_a_load_at_rest_ends_at_its_mark(scene: Scene) -> None:
    now = scene.at(0.0)
    marks, W = static_ticks(scene, now), len(scene.system.wheel)
    middle = marks[:W].mean(axis=1)
    np.testing.assert_allclose(middle[:, ::2], now.arrows[:W, 1, ::2], atol=2e-3)
    twice = static_ticks(scene, scene.at(0.0, 2.0))[:W].mean(axis=1)
    np.testing.assert_allclose(twice[:, 2] - now.arrows[:W, 0, 2], 2 * (middle[:, 2] - now.arrows[:W, 0, 2]), rtol=1e-3)


def test_traction_points_along_the_road_the_way_it_pushes(scene: Scene) -> None:
    time = 3.0
    now, W = scene.at(time), len(scene.system.wheel)
    way = np.diff(traction_arrows(scene, now)[:W], axis=1)[:, 0, ::2]
    drawn_ones = np.hypot(*way.T) > 0.0
    assert drawn_ones.any()
    assert np.all(np.sign(way[drawn_ones, 0]) == np.sign(now.contacts.traction[drawn_ones]))
    assert np.abs((way * now.contacts.normals).sum(axis=1)).max() < 1e-5


def test_only_wheels_in_the_air_have_the_red_ring(scene: Scene) -> None:
    time, wheel = flight(scene)
    now, W = scene.at(time), len(scene.system.wheel)
    flying = now.contacts.load <= 0.0
    assert flying[wheel]
    assert not flying.all()
    colours, sizes = ring_looks(scene, now, in_air=True, coloured=False)
    np.testing.assert_array_equal(sizes[:W] > 0.0, flying)
    np.testing.assert_array_equal(colours[wheel], np.round(255 * light(np.array(IN_AIR))))
    colours, sizes = ring_looks(scene, now, in_air=False, coloured=True)
    np.testing.assert_array_equal(sizes[W:] > 0.0, ~flying)
    assert len(np.unique(colours[:W][~flying], axis=0)) > 3


def test_travel_bars_are_as_long_as_the_wheels_have_moved(scene: Scene) -> None:
    travel, n = suspension_travel(scene.trajectory), scene.system.n
    bars = travel_bars(scene, scene.at(2.0))[:n]
    np.testing.assert_allclose(np.linalg.norm(bars[:, 1] - bars[:, 0], axis=1), np.ptp(travel, axis=0), atol=1e-5)


@pytest.mark.parametrize(("units", "long"), [(METRIC, 1.0), (US, 3 * 0.3048)])
def test_the_scale_bar_is_a_metre_or_three_feet(scene: Scene, units: Units, long: float) -> None:
    start, end = scale_bar(scene.measures, units.of("m"))[0]
    assert np.linalg.norm(end - start) == pytest.approx(long, abs=1e-6)


def test_the_ghost_of_the_same_run_lies_on_the_vehicle(scene: Scene) -> None:
    now = scene.at(3.0)
    points = Outline(scene).segments(scene.bodies(3.0), -now.origin).reshape(-1, 3)
    for wheel in now.road_wheels.positions[: scene.system.n]:
        distance = np.hypot(*(points[:, ::2] - wheel[::2]).T)
        assert (np.abs(distance - scene.measures.radius) < 1e-4).sum() >= 64


def test_the_ghosts_hull_has_the_edges_of_the_hull(scene: Scene) -> None:
    vertices, _ = joined(hull(scene.measures))
    edges = np.concatenate(hull_edges(scene.measures))
    np.testing.assert_allclose(edges.max(axis=0)[0], vertices.max(axis=0)[0], atol=0.1)
    np.testing.assert_allclose(np.abs(edges[:, 1]).max(), np.abs(vertices[:, 1]).max(), atol=0.15)
    foot = scene.places.on_hull[0]
    points = Outline(scene).segments(scene.trajectory.system.q_design, 0.0).reshape(-1, 3)
    for x, y, z in edges:
        place = foot + complex(*scene.trajectory.system.q_design[0, :2]) + x + 1j * z
        assert np.linalg.norm(points - (place.real, y, place.imag), axis=1).min() < 1e-5


def test_a_ghost_is_there_until_it_is_taken_away_and_hidden_in_a_drive(tab: Tab) -> None:
    view = View3D(tab)  # type: ignore[arg-type]
    present, other = run(), run(**{"drive.speed_kmh": 25.0})
    view.show(present)
    view.show_ghost(other)
    view.draw(3.0)
    ghost = build_scene(other)
    bodies = ghost.bodies(3.0)
    np.testing.assert_allclose(
        drawn(tab.sent(), "/ghost", "points"), Outline(ghost).segments(bodies, -bodies[0, 0]), atol=1e-4
    )
    drive = LiveDrive(load_config("paper"))
    drive.advance(0.1)
    view.show_live(drive.recent(0.1), drive.road())
    view.draw(0.1)
    assert not tab.scene._handle_from_node_name["/ghost"].visible
    view.show(present)
    assert tab.scene._handle_from_node_name["/ghost"].visible
    view.show(simulate(load_config("robot").replace({"simulation.duration": 1.0})))
    assert view.ghost_of_other_size
    assert not tab.scene._handle_from_node_name["/ghost"].visible
    view.show(other)
    assert not view.ghost_of_other_size
    assert tab.scene._handle_from_node_name["/ghost"].visible
    view.show_ghost(None)
    assert not any(name.startswith("/ghost") for name in tab.nodes())


def test_a_drive_goes_on_where_its_origin_moves_along() -> None:
    drive = LiveDrive(load_config("paper"))
    drive.advance(0.5)
    recent, road = drive.recent(0.1), drive.road()
    before = live_scene(recent, road)
    drive._move_origin(REBASE)
    after = live_scene(drive.recent(0.1), drive.road(), before)
    assert after.passed == REBASE
    one, other = before.at(0.5), after.at(0.5)
    assert other.x == pytest.approx(one.x - REBASE)
    for name in ("hull", "road_wheels", "sprockets", "shoes"):
        for mine, its in zip(getattr(one, name), getattr(other, name), strict=True):
            np.testing.assert_allclose(np.abs(mine), np.abs(its), atol=2e-3)
    np.testing.assert_allclose(one.contacts.points, other.contacts.points, atol=1e-6)


def test_the_road_of_a_drive_is_laid_once_for_many_instants(tab: Tab) -> None:
    drive, view = LiveDrive(load_config("paper")), View3D(tab)  # type: ignore[arg-type]
    drive.advance(0.1)
    view.show_live(drive.recent(0.1), drive.road())
    heights = view._scene.ground.heights  # type: ignore[union-attr]
    drive.advance(0.2)
    view.show_live(drive.recent(0.1), drive.road())
    assert view._scene.ground.heights is heights  # type: ignore[union-attr]


def test_a_wheel_s_card_says_when_it_is_in_the_air(scene: Scene) -> None:
    time, wheel = flight(scene)
    state = wheel_state(scene.trajectory, wheel, time)
    text = card(state, "#123456", KILONEWTON)
    assert all(part in text for part in ("in the air", "0.00 kN", "#123456", "–"))
    assert "<b>0.000 m/s</b>" in card(replace(state, slip_velocity=-1e-5), "#123456", KILONEWTON)
    rolling = card(wheel_state(scene.trajectory, 2, 0.0), "#123456", KILONEWTON)
    assert "R3" in rolling
    assert "in the air" not in rolling


@pytest.mark.parametrize(("row", "wheel"), [(0, 0), (5, 5), (6, None), (7, 0), (12, 5)])
def test_a_click_picks_the_wheel_on_either_side_and_no_idler(tab: Tab, row: int, wheel: int | None) -> None:
    view = View3D(tab)  # type: ignore[arg-type]
    picked: list[int] = []
    view.on_pick(picked.append)
    view.show(run(**{"simulation.duration": 0.1}))
    clicked = tab.scene._handle_from_node_name["/vehicle/road_wheels"]._impl.click_cb[0].callback
    asyncio.run(clicked(SimpleNamespace(instance_index=row)))  # type: ignore[arg-type]
    assert picked == ([] if wheel is None else [wheel])


def test_rings_are_sent_while_there_are_any_and_once_more_to_be_gone(tab: Tab, scene: Scene) -> None:
    view = View3D(tab)  # type: ignore[arg-type]
    view.show(scene.trajectory)
    time, wheel = flight(scene)

    def sizes() -> list[np.ndarray]:
        return [
            m.updates["batched_scales"] for m in tab.sent() if m.name == "/overlays/rings" and hasattr(m, "updates")
        ]

    view.draw(0.0)  # on the ground
    tab.sent()
    view.draw(0.01)
    assert not sizes()
    view.draw(time)
    assert sizes()[-1][wheel] > 0.0
    view.draw(0.0)
    assert not sizes()[-1].any()
    view.draw(0.01)
    assert not sizes()
