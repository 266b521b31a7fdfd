"""The 3-D view on a real viser scene without a browser: which nodes and messages runs, instants and switches cause."""

from __future__ import annotations

import asyncio
from collections.abc import Iterator
from contextlib import AbstractContextManager
from typing import Any

import numpy as np
import pytest
import viser

from app.view3d.camera import AIMS, camera_pose
from app.view3d.meshes.measures import Measures, measures_of
from app.view3d.nodes import ROUNDING
from app.view3d.overlays import SWITCHES
from app.view3d.view import View3D
from model import Trajectory, load_config, simulate
from model.dynamics.vehicle import build_system


class Tab:
    """A tab without a browser: the scene of a server, and a camera that stays where it is put."""

    def __init__(self, server: viser.ViserServer) -> None:
        self.scene, self.camera = server.scene, Camera()
        self._server = server
        self.messages: list[Any] = []
        queue = server.scene._queue_scene_message

        def counted(message: Any) -> None:
            self.messages.append(message)
            queue(message)

        server.scene._queue_scene_message = counted  # type: ignore[method-assign]

    def atomic(self) -> AbstractContextManager[None]:
        return self._server.atomic()

    def nodes(self) -> set[str]:
        return set(self.scene._handle_from_node_name)

    def sent(self) -> list[Any]:
        """Messages since the last call."""
        messages, self.messages[:] = list(self.messages), []
        return messages


class Camera:
    def __init__(self) -> None:
        self.image_width, self.image_height = 1600, 1000
        self.fov = 0.0
        self.position = self.look_at = self.up_direction = np.zeros(3)

    def on_update(self, callback: object) -> None:
        self.moved = callback


@pytest.fixture
def tab() -> Iterator[Tab]:
    server = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
    yield Tab(server)
    server.stop()


def run(**changes: object) -> Trajectory:
    short = {"simulation.duration": 1.0, "simulation.output_rate": 50}
    return simulate(load_config("paper").replace({**short, **changes}))


@pytest.fixture(scope="module")
def paper() -> Trajectory:
    return run()


def drawn(messages: list[Any], name: str, what: str) -> np.ndarray:
    """A property of a node as the last message sets it."""
    return [m.updates[what] for m in messages if m.name == name and what in getattr(m, "updates", {})][-1]


def metre_marks(vertices: np.ndarray) -> np.ndarray:
    """Where between two metres the tiles begin."""
    return np.unique((np.unique(vertices[::6, 0])[[0, -1]] % 1.0).round(4) % 1.0)


def test_nothing_is_drawn_before_the_first_run(tab: Tab) -> None:
    view = View3D(tab)  # type: ignore[arg-type]
    view.draw(1.0)
    view.set_view("front")
    assert not any(name.startswith(("/vehicle", "/road")) for name in tab.nodes())


def test_an_instant_takes_few_messages_and_makes_no_nodes(tab: Tab, paper: Trajectory) -> None:
    view = View3D(tab)  # type: ignore[arg-type]
    view.show(paper)
    view.draw(0.10)
    nodes = tab.nodes()
    tab.sent()
    view.draw(0.12)
    assert tab.nodes() == nodes
    assert 8 <= len(tab.sent()) <= 15


def test_another_stiffness_makes_no_nodes_and_sends_no_road(tab: Tab, paper: Trajectory) -> None:
    view = View3D(tab)  # type: ignore[arg-type]
    view.show(paper)
    view.draw(0.0)
    handles = dict(tab.scene._handle_from_node_name)
    tab.sent()
    view.show(run(**{"vehicle.road_suspension.stiffness": 60000}))
    view.draw(0.0)
    assert dict(tab.scene._handle_from_node_name) == handles
    assert not any(getattr(message, "name", "").startswith("/road/") for message in tab.sent())


def test_another_amplitude_sends_the_road_only(tab: Tab, paper: Trajectory) -> None:
    view = View3D(tab)  # type: ignore[arg-type]
    view.show(paper)
    view.draw(0.0)
    handles = dict(tab.scene._handle_from_node_name)
    tab.sent()
    view.show(run(**{"road.amplitude": 0.2}))
    view.draw(0.0)
    assert dict(tab.scene._handle_from_node_name) == handles
    assert sum(getattr(message, "name", "").startswith("/road/") for message in tab.sent()) == 2


def test_another_vehicle_replaces_the_nodes_of_the_former(tab: Tab, paper: Trajectory) -> None:
    view = View3D(tab)  # type: ignore[arg-type]
    view.show(run(**{"vehicle.imaginary_wheels.enabled": False}))
    assert "/vehicle/imaginary_wheels" not in tab.nodes()
    assert "/vehicle/labels/I1" not in tab.nodes()
    view.show(paper)
    assert {"/vehicle/imaginary_wheels", "/vehicle/labels/R6", "/vehicle/labels/I5"} <= tab.nodes()
    view.show(run(**{"vehicle.road_wheels.count": 4}))
    assert {"/vehicle/labels/R5", "/vehicle/labels/I4"}.isdisjoint(tab.nodes())


def test_switches_outlive_another_vehicle_and_save_messages(tab: Tab, paper: Trajectory) -> None:
    view = View3D(tab)  # type: ignore[arg-type]
    view.show(paper)
    for switch in ("arrows", "names", "scale_bar"):
        view.set_switch(switch, False)
    view.show(run(**{"vehicle.road_wheels.count": 4}))
    for name in ("/vehicle/arrows", "/vehicle/labels", "/overlays/scale_bar"):
        assert not tab.scene._handle_from_node_name[name].visible
    tab.sent()
    view.draw(0.5)
    assert {"/vehicle/arrows", "/overlays/scale_bar"}.isdisjoint({message.name for message in tab.sent()})
    view.set_switch("arrows", True)
    assert tab.scene._handle_from_node_name["/vehicle/arrows"].visible
    np.testing.assert_array_equal(  # and it is not as it was when it was hidden
        drawn(tab.sent(), "/vehicle/arrows", "points"),
        view._scene.at(0.5).arrows,  # type: ignore[union-attr]
    )


@pytest.mark.parametrize("name", SWITCHES)
def test_each_switch_that_shows_an_overlay_hides_it_and_shows_it(tab: Tab, paper: Trajectory, name: str) -> None:
    def seen() -> set[str]:
        nodes = tab.scene._handle_from_node_name.items()
        return {path for path, node in nodes if path.startswith("/overlays/") and node.visible}

    view = View3D(tab)  # type: ignore[arg-type]
    for switch in SWITCHES:
        view.set_switch(switch, False)
    view.show(paper)
    hidden = seen()
    view.set_switch(name, True)
    shown = seen() - hidden
    assert bool(shown) == (SWITCHES[name].overlay is not None)
    view.set_switch(name, False)
    assert seen() == hidden


def test_a_switch_that_does_not_exist_is_refused(tab: Tab) -> None:
    with pytest.raises(ValueError, match=r"'smoke'\. Allowed: follow, arrows"):
        View3D(tab).set_switch("smoke", True)  # type: ignore[arg-type]


def test_loads_at_the_names_are_those_of_the_time_and_sent_only_when_they_read_otherwise(
    tab: Tab, paper: Trajectory
) -> None:
    def texts() -> dict[str, str]:
        found = [m for m in tab.sent() if "/labels/" in m.name and "text" in getattr(m, "updates", {})]
        return {message.name.rpartition("/")[2]: message.updates["text"] for message in found}

    view = View3D(tab)  # type: ignore[arg-type]
    view.show(paper)
    view.draw(0.5)
    view.write_names()
    assert not texts()
    view.set_switch("loads", True)
    said, load = texts(), paper.normal_load[round(0.5 * paper.config.simulation.output_rate)]
    assert said["R1"].split() == ["R1", f"{load[0] / 1e3:.1f}"]
    assert said["I5"].split() == ["I5", f"{load[-1] / 1e3:.1f}"]
    view.write_names()
    assert not texts()
    view.draw(0.0)
    view.write_names()
    assert texts()
    view.set_switch("names", False)
    assert tab.scene._handle_from_node_name["/vehicle/labels"].visible
    texts()
    view.set_switch("loads", False)
    assert texts()["R1"] == "R1"
    assert not tab.scene._handle_from_node_name["/vehicle/labels"].visible


def test_longer_arrows_are_drawn_at_once(tab: Tab, paper: Trajectory) -> None:
    view = View3D(tab)  # type: ignore[arg-type]
    view.show(paper)
    view.draw(0.5)
    before = drawn(tab.sent(), "/vehicle/arrows", "points")
    view.set_arrow_scale(2.0)
    after = drawn(tab.sent(), "/vehicle/arrows", "points")
    np.testing.assert_allclose(after[:, 1] - after[:, 0], 2 * (before[:, 1] - before[:, 0]), atol=2e-3)


def test_following_the_road_moves_else_the_vehicle(tab: Tab, paper: Trajectory) -> None:
    view = View3D(tab)  # type: ignore[arg-type]
    view.show(paper)
    x = paper.q[:, 0, 0]
    tab.sent()
    view.draw(0.5)
    sent = tab.sent()
    assert metre_marks(drawn(sent, "/road/even", "vertices")) == pytest.approx(-x[25] % 1.0, abs=ROUNDING)
    arm = drawn(sent, "/vehicle/road_arms", "batched_positions")[0, 0]
    assert arm == pytest.approx(paper.q[25, 1, 0] - x[25], abs=1e-5)
    view.set_switch("follow", False)
    view.draw(0.6)
    sent = tab.sent()
    assert not any(message.name.startswith("/road") for message in sent)
    arm = drawn(sent, "/vehicle/road_arms", "batched_positions")[0, 0]
    assert arm == pytest.approx(paper.q[30, 1, 0] - x[25], abs=1e-5)
    sky = [message.position[0] for message in sent if message.name == "/sky"]
    assert sky == pytest.approx([x[30] - x[25]])
    view.set_view("side")  # brings the vehicle back into the picture
    view.draw(0.6)
    arm = drawn(tab.sent(), "/vehicle/road_arms", "batched_positions")[0, 0]
    assert arm == pytest.approx(paper.q[30, 1, 0] - x[30], abs=1e-5)
    view.draw(1.0)
    arm = drawn(tab.sent(), "/vehicle/road_arms", "batched_positions")[0, 0]
    assert arm == pytest.approx(paper.q[50, 1, 0] - x[30], abs=1e-5)


def test_dark_changes_colours_without_new_vehicle(tab: Tab, paper: Trajectory) -> None:
    view = View3D(tab)  # type: ignore[arg-type]
    view.show(paper)
    arrows = tab.scene._handle_from_node_name["/vehicle/arrows"]
    before = arrows.colors.copy()
    view.set_dark(True)
    assert tab.scene._handle_from_node_name["/vehicle/arrows"] is arrows
    assert (arrows.colors != before).any()
    view.set_dark(False)
    np.testing.assert_array_equal(arrows.colors, before)


def test_a_run_without_samples_leaves_the_former(tab: Tab, paper: Trajectory) -> None:
    view = View3D(tab)  # type: ignore[arg-type]
    view.show(paper)
    fields = {name: getattr(paper, name) for name in Trajectory.__dataclass_fields__}
    arrays = {name: value[:0] for name, value in fields.items() if isinstance(value, np.ndarray)}
    view.show(Trajectory(**{**fields, **arrays}))
    tab.sent()
    view.draw(0.5)
    arm = drawn(tab.sent(), "/vehicle/road_arms", "batched_positions")[0, 0]
    assert arm == pytest.approx(paper.q[25, 1, 0] - paper.q[25, 0, 0], abs=1e-5)


def seen(point: np.ndarray, position: np.ndarray, look_at: np.ndarray, fov: float, aspect: float) -> np.ndarray:
    """Where a camera (z up) has a point in its picture: −1…1 from left to right and from below."""
    ahead = (look_at - position) / np.linalg.norm(look_at - position)
    right = np.cross(ahead, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    depth = (point - position) @ ahead
    half = depth * np.tan(fov / 2)
    return np.array([(point - position) @ right / (half * aspect), (point - position) @ np.cross(right, ahead) / half])


@pytest.mark.parametrize("aspect", [0.66, 1.0, 1.78, 2.4])
@pytest.mark.parametrize("standpoint", AIMS)
@pytest.mark.parametrize("changes", [{}, {"vehicle.road_wheels.count": 14}, {"vehicle.road_wheels.count": 2}])
def test_a_view_has_what_it_is_for_in_the_picture(standpoint: Any, aspect: float, changes: dict[str, object]) -> None:
    vehicle: Measures = measures_of(build_system(load_config("paper").replace(changes)), "turret")
    place = camera_pose(standpoint, vehicle, aspect)
    s = vehicle.scale
    if standpoint == "wheel":
        corners = [(vehicle.front + x * s, -vehicle.track, z * s) for x in (-0.3, 0.3) for z in (0.0, 0.6)]
    else:
        ends = vehicle.idler.x - 0.4 * s, vehicle.sprocket.x + 0.4 * s
        corners = [(x, y, z * s) for x in ends for y in (-1.5 * s, 1.5 * s) for z in (0.0, 1.2)]
    for corner in corners:
        where = seen(np.array(corner), place.position, place.look_at, place.fov, aspect)
        assert np.abs(where).max() < 1.0, corner
    assert place.position[1] < 0.0  # on the right side, where the lamp stands and the labels are
    assert place.position[2] > 0.3 * s


def test_the_camera_goes_nearer_to_a_much_smaller_vehicle_only(tab: Tab, paper: Trajectory) -> None:
    view = View3D(tab)  # type: ignore[arg-type]
    view.show(paper)
    view.set_view("front")
    for preset, moves in (("m113", False), ("robot", True), ("robot", False), ("paper", True)):
        before = np.array(tab.camera.position)
        view.show(simulate(load_config(preset).replace({"simulation.duration": 0.1})))
        after = np.array(tab.camera.position)
        assert (np.linalg.norm(after - before) > 1.0) == moves
        assert after[0] > 2 * abs(after[1])  # still from the front


def test_the_camera_fits_a_new_shape_of_the_picture_unless_moved(tab: Tab, paper: Trajectory) -> None:
    view = View3D(tab)  # type: ignore[arg-type]
    view.show(paper)
    wide = np.array(tab.camera.position)
    tab.camera.image_width = 800
    asyncio.run(tab.camera.moved(tab.camera))  # type: ignore[operator]
    narrow = np.array(tab.camera.position)
    assert np.linalg.norm(narrow) > 1.2 * np.linalg.norm(wide)
    aside = narrow + np.array([0.0, 3.0, 0.0])
    tab.camera.position = aside
    tab.camera.image_width = 1600
    asyncio.run(tab.camera.moved(tab.camera))  # type: ignore[operator]
    np.testing.assert_array_equal(tab.camera.position, aside)


def test_only_a_camera_that_the_user_has_turned_is_told(tab: Tab, paper: Trajectory) -> None:
    view = View3D(tab)  # type: ignore[arg-type]
    assert view.turned_camera == ()
    view.show(paper)
    view.set_view("front")
    assert view.turned_camera == ()
    tab.camera.position = np.array([1.234, -5.0, 2.0])
    assert view.turned_camera == (1.23, -5.0, 2.0, *np.round(tab.camera.look_at, 2))
    view.set_view("side")
    assert view.turned_camera == ()


def test_a_picked_wheel_has_a_ring_that_goes_with_it_and_goes_again(tab: Tab, paper: Trajectory) -> None:
    view = View3D(tab)  # type: ignore[arg-type]
    view.show(paper)
    view.draw(0.5)
    ring = tab.scene._handle_from_node_name["/overlays/picked"]
    assert not ring.visible
    view.mark_wheel(8)  # I3
    assert ring.visible
    tab.sent()
    view.draw(0.6)
    places = drawn(tab.sent(), "/overlays/picked", "batched_positions")
    wheels = drawn_wheels(view)
    assert np.abs(places[:, [0, 2]] - wheels[8]).max() < 1e-3
    view.mark_wheel(None)
    assert not ring.visible


def drawn_wheels(view: View3D) -> np.ndarray:
    """Centres of the wheels of one side, (W, 2) along and up in the view, at the time drawn last."""
    scene = view._scene
    assert scene is not None
    q = scene.bodies(view._time)[scene.system.wheel]
    return q[:, :2] - [float(scene.bodies(view._time)[scene.system.chassis, 0]), 0.0] + [view_x(view), 0.0]


def view_x(view: View3D) -> float:
    """Where the hull's centre of mass is along the view."""
    scene = view._scene
    assert scene is not None
    now = scene.at(view._time)
    return now.x - now.origin


def test_names_are_thinned_out_where_they_would_pile_up(tab: Tab, paper: Trajectory) -> None:
    view = View3D(tab)  # type: ignore[arg-type]
    view.show(paper)
    view.fit_page(250, 0.0, 1.0)
    nodes = tab.scene._handle_from_node_name
    for standpoint, shown in (("side", True), ("front", False), ("side", True)):
        view.set_view(standpoint)  # type: ignore[arg-type]
        view.write_names()
        assert nodes["/vehicle/labels/R1"].visible
        assert nodes["/vehicle/labels/I1"].visible
        assert nodes["/vehicle/labels/R2"].visible == nodes["/vehicle/labels/I2"].visible == shown


def test_names_grow_with_the_type_of_the_page(tab: Tab, paper: Trajectory) -> None:
    view = View3D(tab)  # type: ignore[arg-type]
    view.fit_page(1440, 0.0, 1.27)
    view.show(paper)
    assert tab.scene._handle_from_node_name["/vehicle/labels/R1"].font_screen_scale == 1.27


def test_the_vehicle_stands_above_what_hides_the_foot_of_the_picture(tab: Tab, paper: Trajectory) -> None:
    view = View3D(tab)  # type: ignore[arg-type]
    view.show(paper)
    before = np.array(tab.camera.look_at)
    view.fit_page(430, 0.43, 1.0)
    assert tab.camera.look_at[2] < before[2] - 0.3
    tab.camera.position = tab.camera.position + np.array([0.0, 3.0, 0.0])  # by the user
    moved = np.array(tab.camera.position)
    view.fit_page(900, 0.0, 1.0)
    np.testing.assert_array_equal(tab.camera.position, moved)


def test_an_obstacle_is_marked_on_its_road_until_the_vehicle_has_passed(tab: Tab) -> None:
    kerb = simulate(load_config("kerb").replace({"simulation.duration": 4.0}))
    view = View3D(tab)  # type: ignore[arg-type]
    view.mark_obstacle(True)  # before the run whose obstacle is meant
    view.show(kerb)
    view.draw(0.0)
    nodes, uneven = tab.scene._handle_from_node_name, kerb.road.uneven
    assert uneven is not None
    assert nodes["/obstacle/name"].text == "Step"
    ends = nodes["/obstacle/line"].points
    assert ends[..., 0].max() == pytest.approx(uneven[1] - uneven[0], abs=1e-5)
    at = [m.position[0] for m in tab.sent() if m.name == "/obstacle" and hasattr(m, "position")][-1]
    assert at == pytest.approx(uneven[0] - kerb.q[0, kerb.system.chassis, 0])
    assert nodes["/obstacle"].visible
    last = kerb.q[:, kerb.system.wheel, 0].min(axis=1) - kerb.system.r
    passed = float(kerb.t[int((last > uneven[1]).argmax())])
    assert passed > 0.0
    view.draw(passed + 0.05)
    assert not nodes["/obstacle"].visible
    view.mark_obstacle(False)
    assert "/obstacle" not in tab.nodes()
    view.mark_obstacle(True)
    view.show(run())  # waves all along
    assert "/obstacle" not in tab.nodes()
