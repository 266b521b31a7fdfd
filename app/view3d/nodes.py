"""The viser nodes of a vehicle, its road and its surroundings: made once for a shape, moved by snapshots."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import viser
from viser import _messages as messages

from app.format.colours import Colour, Palette, Theme, rgb
from app.view3d.meshes import running_gear
from app.view3d.meshes.hull import hull
from app.view3d.meshes.measures import Measures
from app.view3d.meshes.solids import Part, glb, joined, light
from app.view3d.meshes.surroundings import RoadStrip, ground, shadow_faces, sky
from app.view3d.snapshot import SIDES, Poses, Scene, Snapshot
from model.road.road import Profile

VEHICLE = "/vehicle"  # the node above all of the vehicle's
GROUND_BELOW = 0.55  # m from the lowest point of the road down to the ground around it
ROUNDING = 1 / 256  # m to which the road's vertices are rounded: nobody sees it, and replays are a third smaller
GLOW = 1.5  # of sky and ground: evens out the renderer's tone mapping, which darkens white


def update(node: viser.SceneNodeHandle, **properties: Any) -> None:
    """Set properties of a node in one message: viser's own assignment takes 0.25 ms of Python for each."""
    node._impl.api._queue_scene_message(messages.SceneNodeUpdateMessage(node.name, properties))


def paint(lines: viser.LineSegmentsHandle, colour: Colour) -> None:
    """Give all segments one colour: once they are made, viser takes a colour for each end only."""
    lines.colors = np.full(lines.points.shape, light(np.array(colour)))


class Frame:
    """A node that carries others along the view's x and z axes."""

    def __init__(self, api: viser.SceneApi, name: str) -> None:
        self.node = api.add_frame(name, show_axes=False)
        self._at = 0.0, 0.0

    def move(self, x: float = 0.0, z: float = 0.0) -> None:
        """Put it at x and z, m; like `update`, cheaper than viser's own assignment."""
        if (x, z) != self._at:
            self._at = x, z
            self.node._impl.api._queue_scene_message(messages.SetPositionMessage(self.node.name, (x, 0.0, z)))


class VehicleNodes:
    """A vehicle with its load arrows."""

    def __init__(self, api: viser.SceneApi, scene: Scene, now: Snapshot) -> None:
        measures, system = scene.measures, scene.system
        self._api = api
        self._wheels = system.n, system.m
        self._node = api.add_frame(VEHICLE, show_axes=False)
        self._shadow = api.add_mesh_simple(
            f"{VEHICLE}/shadow", now.shadow, shadow_faces(), color=(0, 0, 0), opacity=0.09
        )
        idler = (measures.idler.radius - measures.shoe_thickness) / measures.tyre_radius
        sizes = np.tile([1.0] * system.n + [idler], len(SIDES))
        self._batches: dict[str, viser.BatchedGlbHandle | viser.BatchedMeshHandle] = {
            "hull": self._painted("hull", hull(measures), now.hull),
            "road_wheels": self._painted("road_wheels", running_gear.road_wheel(measures), now.road_wheels, sizes),
            "sprockets": self._painted("sprockets", running_gear.sprocket(measures), now.sprockets),
            "shoes": self._painted("shoes", running_gear.track_shoe(measures), now.shoes),
        }
        self._road_arms = self._plain("road_arms", running_gear.road_arm(measures), now.road_arms)
        self._batches["road_arms"] = self._road_arms
        self._imaginary_arms: viser.BatchedMeshHandle | None = None
        if system.m:
            disc, rod = running_gear.imaginary_wheel(measures), running_gear.imaginary_arm(measures)
            stretch = np.ones((len(SIDES) * system.m, 3))
            stretch[:, 0] = np.tile(measures.links, len(SIDES))
            self._batches["imaginary_wheels"] = self._painted("imaginary_wheels", disc, now.imaginary_wheels)
            self._imaginary_arms = self._plain("imaginary_arms", rod, now.imaginary_arms, stretch)
            self._batches["imaginary_arms"] = self._imaginary_arms
        s = measures.scale
        self._arrows = api.add_arrows(
            f"{VEHICLE}/arrows",
            now.arrows,
            (0, 0, 0),
            shaft_radius=0.022 * s,
            head_radius=0.055 * s,
            head_length=0.10 * s,
        )

    def colour(self, palette: Palette) -> None:
        """Give arms and arrows their wheels' colours."""
        self._road_arms.batched_colors = on_both_sides(palette.road)
        if self._imaginary_arms is not None:
            self._imaginary_arms.batched_colors = on_both_sides(palette.imaginary)
        self._arrows.colors = on_both_sides(palette.wheels)

    def draw(self, scene: Scene, now: Snapshot) -> None:
        """Bring everything that is visible to where it is now."""
        for name, node in self._batches.items():
            poses: Poses = getattr(now, name)
            update(node, batched_positions=poses.positions, batched_wxyzs=poses.wxyzs)
        update(self._shadow, vertices=now.shadow)
        if self._arrows.visible:
            update(self._arrows, points=now.arrows)

    def show(self, on: Mapping[str, bool]) -> None:
        """Take over which switches are on."""
        self._arrows.visible = on["arrows"]

    def on_click(self, act: Callable[[int], None]) -> None:
        """Call act(wheel), which must not block, when the user clicks a wheel; numbered as in a run's arrays."""

        def pick(batch: str, first: int, count: int, of_side: int) -> None:
            async def picked(event: Any) -> None:
                row = (event.instance_index or 0) % of_side
                if row < count:
                    act(first + row)

            self._batches[batch].on_click(picked)

        n, m = self._wheels
        pick("road_wheels", 0, n, n + 1)  # an idler beside them
        if m:
            pick("imaginary_wheels", n, m, m)

    def remove(self) -> None:
        self._node.remove()

    def _painted(
        self, name: str, parts: list[Part], poses: Poses, sizes: np.ndarray | None = None
    ) -> viser.BatchedGlbHandle:
        """Instances of a mesh in the colours of its parts."""
        return self._api.add_batched_glb(
            f"{VEHICLE}/{name}", glb(parts), poses.wxyzs, poses.positions, batched_scales=sizes, lod="off"
        )

    def _plain(
        self, name: str, parts: list[Part], poses: Poses, sizes: np.ndarray | None = None
    ) -> viser.BatchedMeshHandle:
        """Instances of a mesh, each of which has a colour of its own."""
        return self._api.add_batched_meshes_simple(
            f"{VEHICLE}/{name}", *joined(parts), poses.wxyzs, poses.positions, batched_scales=sizes, lod="off"
        )


class RoadNodes:
    """The stretch of road around the vehicle.

    Its vertices are sent anew as it moves through the view: a node's position would reach the picture a frame before
    the vehicle's poses, and wheels would not stand on the road.
    """

    def __init__(self, api: viser.SceneApi, measures: Measures) -> None:
        reach = (measures.front - measures.rear) / 2 + 1.8 * measures.scale
        self._strip = RoadStrip(reach, measures.road_half_width)
        self._shown: tuple[Profile, float, float] | None = None  # of the road; where the strip stands, its foot
        self._meshes: list[np.ndarray] = []  # of the tiles from there on, rounded
        self._shift = 0.0
        self._tiles = [
            api.add_mesh_simple(f"/road/{name}", np.zeros((3, 3)), faces, cast_shadow=False)
            for name, faces in zip(("even", "odd"), self._strip.faces, strict=True)
        ]

    def colour(self, theme: Theme) -> None:
        for tiles, colour in zip(self._tiles, theme.road, strict=True):
            tiles.color = colour

    def draw(self, scene: Scene, now: Snapshot) -> None:
        """Show the road around the vehicle; nothing is sent while it looks the same."""
        start, foot = self._strip.start(now.x), scene.lowest - GROUND_BELOW
        shift = round((start - now.origin) / ROUNDING) * ROUNDING
        road = scene.ground.road.profile
        if self._shown is None or self._shown[0] is not road or self._shown[1:] != (start, foot):
            self._shown = road, start, foot
            exact = self._strip.vertices(start, scene.ground.height, foot)
            self._meshes = [np.round(vertices / ROUNDING) * ROUNDING for vertices in exact]
        elif shift == self._shift:
            return
        self._shift = shift
        along = np.array([shift, 0.0, 0.0], dtype=np.float32)
        for tiles, vertices in zip(self._tiles, self._meshes, strict=True):
            update(tiles, vertices=vertices + along)

    def remove(self) -> None:
        for tiles in self._tiles:
            tiles.remove()


class Surroundings:
    """Light, sky and ground."""

    def __init__(self, api: viser.SceneApi, theme: Theme) -> None:
        self._api = api
        api.configure_default_lights(False)
        api.configure_environment_map(None)
        self._key = api.add_light_directional("/light/key", color=(255, 246, 232), position=(3.0, -6.0, 7.0))
        api.add_light_directional("/light/fill", color=(214, 228, 255), intensity=0.5, position=(-4.0, 6.0, 3.0))
        self._all_round = api.add_light_hemisphere(
            "/light/sky", sky_color=(226, 236, 250), ground_color=(196, 188, 172)
        )
        self._sky, self._ground = Frame(api, "/sky"), Frame(api, "/ground")
        self.colour(theme)

    def colour(self, theme: Theme) -> None:
        self._key.intensity, self._all_round.intensity = theme.key_light, theme.sky_light
        self._glowing("/sky/dome", sky(theme.haze, theme.sky, theme.zenith))
        self._glowing("/ground/disc", ground(theme.ground, theme.haze))

    def show(self, on: bool) -> None:
        """Sky and ground."""
        self._sky.node.visible = self._ground.node.visible = on

    def draw(self, scene: Scene, now: Snapshot) -> None:
        """Centre them on the vehicle, the ground below its road."""
        x = now.x - now.origin
        self._sky.move(x)
        self._ground.move(x, scene.lowest - GROUND_BELOW)

    def _glowing(self, name: str, mesh: Part) -> None:
        self._api.add_glb(name, glb([mesh], glow=GLOW), cast_shadow=False, receive_shadow=False)


def on_both_sides(colours: tuple[str, ...]) -> np.ndarray:
    """CSS colours of W wheels as amounts of light (2 W, 3), for both sides of the vehicle."""
    return np.tile(light(np.array([rgb(colour) for colour in colours])), (len(SIDES), 1))
