"""The 3-D view of one browser tab: what of a run is shown, and from where.

While the camera follows, the vehicle stands still in the view and the road moves under it: the camera is never
touched, and the user's own orbit and zoom stay. Frame of the view: x forward, y to the left, z up; m.
"""

from __future__ import annotations

import viser

from app.camera import Camera, View
from app.colours import DARK, LIGHT, wheel_palette
from app.nodes import RoadNodes, Surroundings, VehicleNodes
from app.scene import Scene, build_scene
from model.trajectory import Trajectory


class Stage:
    """What one tab sees. One thread shows and draws; switches and views may be set from others at any time."""

    def __init__(self, client: viser.ClientHandle, dark: bool = False) -> None:
        self.follow = True  # the camera goes with the vehicle
        self.arrow_scale = 1.0  # times the default length of the load arrows
        self._client = client
        self._dark = dark
        self._visible = {"hull": True, "arrows": True, "labels": True}
        self._camera = Camera(client)
        self._surroundings = Surroundings(client.scene, DARK if dark else LIGHT)
        self._scene: Scene | None = None
        self._vehicle: VehicleNodes | None = None
        self._road: RoadNodes | None = None
        self._time = 0.0
        self._origin = 0.0  # of the view along the road, m
        self._recentre = False  # bring the view to the vehicle once, though it does not follow

    def show(self, trajectory: Trajectory) -> None:
        """Take over a run, at the time drawn last. Nodes are made anew only where their shape has changed.

        A run that broke down before its first sample leaves the former one.
        """
        if not len(trajectory.t):
            return
        before, scene = self._scene, build_scene(trajectory, self._scene)
        self._scene = scene
        with self._client.atomic():
            if before is None or before.layout != scene.layout:
                self._build(scene)
            self.draw(self._time)
        if before is None:
            self.set_view("side")

    def draw(self, time: float) -> None:
        """Show the run at a time, s; a time outside of the run shows its start or its end."""
        self._time = time
        scene, vehicle, road = self._scene, self._vehicle, self._road
        if scene is None or vehicle is None or road is None:
            return
        follow = self.follow or self._recentre
        now = scene.at(time, self.arrow_scale, None if follow else self._origin)
        self._origin, self._recentre = now.origin, False
        with self._client.atomic():
            vehicle.draw(scene, now)
            road.draw(scene, now)
            self._surroundings.draw(scene, now)

    def set_view(self, name: View) -> None:
        """Look at the vehicle from one of the standpoints; before the first run there is nothing to look at."""
        if self._scene is not None:
            self._recentre = True
            self._camera.look(name, self._scene.layout)

    def set_dark(self, dark: bool) -> None:
        """Change between the light and the dark theme."""
        self._dark = dark
        theme = DARK if dark else LIGHT
        with self._client.atomic():
            self._surroundings.colour(theme)
            if self._scene is not None and self._vehicle is not None and self._road is not None:
                self._vehicle.colour(wheel_palette(self._scene.system.n, self._scene.system.m, dark))
                self._road.colour(theme)

    @property
    def show_hull(self) -> bool:
        return self._visible["hull"]

    @show_hull.setter
    def show_hull(self, on: bool) -> None:
        self._switch("hull", on)

    @property
    def show_arrows(self) -> bool:
        """Of the normal loads."""
        return self._visible["arrows"]

    @show_arrows.setter
    def show_arrows(self, on: bool) -> None:
        self._switch("arrows", on)

    @property
    def show_labels(self) -> bool:
        """The wheels' names."""
        return self._visible["labels"]

    @show_labels.setter
    def show_labels(self, on: bool) -> None:
        self._switch("labels", on)

    def _switch(self, what: str, on: bool) -> None:
        self._visible[what] = on
        if self._vehicle is not None:
            self._vehicle.show(**self._visible)

    def _build(self, scene: Scene) -> None:
        """Make vehicle and road anew."""
        if self._vehicle is not None and self._road is not None:
            self._vehicle.remove()
            self._road.remove()
        now = scene.at(self._time, self.arrow_scale, None if self.follow else self._origin)
        self._vehicle = VehicleNodes(self._client.scene, scene, now)
        self._vehicle.colour(wheel_palette(scene.system.n, scene.system.m, self._dark))
        self._vehicle.show(**self._visible)
        self._road = RoadNodes(self._client.scene, scene.layout)
        self._road.colour(DARK if self._dark else LIGHT)
