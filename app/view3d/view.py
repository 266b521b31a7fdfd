"""The 3-D view of one browser tab: what of a run is shown, and from where.

While the camera follows, the vehicle stands still in the view and the road moves under it: the camera is never
touched, and the user's own orbit and zoom stay. Frame of the view: x forward, y to the left, z up; m.
"""

from __future__ import annotations

from collections.abc import Callable

from app.format.colours import DARK, LIGHT, wheel_palette
from app.format.load_unit import load_unit
from app.view3d.camera import Camera, Tab, View
from app.view3d.ghost import Ghost
from app.view3d.labels import WheelLabels
from app.view3d.nodes import RoadNodes, Surroundings, VehicleNodes
from app.view3d.overlays import DEFAULTS, Marks
from app.view3d.snapshot import Scene, build_scene, live_scene
from model.analysis.ride import WheelState, wheel_state
from model.road.road import Road
from model.simulation.trajectory import Trajectory


class _Mark:
    """Whether a part of the marks, named `show_` and the part, is shown."""

    def __set_name__(self, owner: type, name: str) -> None:
        self._part = name.removeprefix("show_")

    def __get__(self, stage: Stage, owner: type) -> bool:
        return stage._marked[self._part]

    def __set__(self, stage: Stage, on: bool) -> None:
        stage._switch_mark(self._part, on)


class Stage:
    """What one tab sees. For one thread; switches take effect at once, also while nothing else is drawn."""

    def __init__(self, client: Tab, dark: bool = False) -> None:
        self._client = client
        self._dark = dark
        self._follow = True
        self._arrow_scale = 1.0
        self._show_surroundings = True
        self._visible = {"hull": True, "arrows": True}
        self._labelled = {"names": True, "loads": False}
        self._camera = Camera(client)
        self._surroundings = Surroundings(client.scene, DARK if dark else LIGHT)
        self._scene: Scene | None = None
        self._vehicle: VehicleNodes | None = None
        self._labels: WheelLabels | None = None
        self._road: RoadNodes | None = None
        self._time = 0.0
        self._marks: Marks | None = None
        self._marked = dict(DEFAULTS)
        self._picked: Callable[[int], None] = lambda wheel: None
        self._ghost: Ghost | None = None
        self._live = False  # a drive is shown, which has no time in common with a ghost
        self._origin = 0.0  # of the view along the road, m
        self._recentre = False  # bring the view to the vehicle once, though it does not follow

    def show(self, trajectory: Trajectory) -> None:
        """Take over a run for the next `draw`. Nodes are made anew only where their shape has changed.

        A run that broke down before its first sample leaves the former one.
        """
        if not len(trajectory.t):
            return
        self._set_live(False)
        self._take(build_scene(trajectory, self._scene))

    def show_live(self, recent: Trajectory, road: Road) -> None:
        """Take over the newest moments of an endless drive, up to 30 times a second; then `draw` a time among them.

        recent: `LiveDrive.recent(0.1)`, at least one sample; road: `LiveDrive.road()`, in the same frame. Where the
        drive's origin moves along, the view goes on as if it did not.
        """
        before, scene = self._scene, live_scene(recent, road, self._scene)
        if before is not None:
            self._origin -= scene.passed - before.passed
        self._set_live(True)
        self._take(scene)

    def show_ghost(self, trajectory: Trajectory | None) -> None:
        """Show another run's vehicle as a pale outline, at the same time and place as the present one; None: no more.

        While a drive is shown it stays hidden.
        """
        before = self._ghost.scene if self._ghost is not None else None
        scene = build_scene(trajectory, before) if trajectory is not None and len(trajectory.t) else None
        with self._client.atomic():
            if self._ghost is not None and before is not None and scene is not None and scene.layout == before.layout:
                self._ghost.follow(scene)
            else:
                if self._ghost is not None:
                    self._ghost.remove()
                self._ghost = Ghost(self._client.scene, scene, DARK if self._dark else LIGHT) if scene else None
                if self._ghost is not None:
                    self._ghost.show(not self._live)
            self.draw(self._time)

    def draw(self, time: float) -> None:
        """Show the run at a time, s; a time outside of the run shows its start or its end."""
        self._time = time
        scene, vehicle, road = self._scene, self._vehicle, self._road
        if scene is None or vehicle is None or road is None:
            return
        follow = self._follow or self._recentre
        now = scene.at(time, self._arrow_scale, None if follow else self._origin)
        self._origin, self._recentre = now.origin, False
        with self._client.atomic():
            vehicle.draw(scene, now)
            road.draw(scene, now)
            if self._labels is not None:
                self._labels.move(now.x - now.origin, scene.lowest)
            if self._marks is not None:
                self._marks.draw(scene, now)
            if self._ghost is not None and not self._live:
                self._ghost.draw(time, now.x - now.origin)
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
            if self._ghost is not None:
                self._ghost.colour(theme)
            if self._scene is not None and self._vehicle is not None and self._road is not None:
                palette = wheel_palette(self._scene.system.n, self._scene.system.m, dark)
                self._vehicle.colour(palette)
                self._road.colour(theme)
                if self._marks is not None:
                    self._marks.colour(theme, palette)

    def on_pick(self, act: Callable[[int], None]) -> None:
        """Call act(wheel), which must not block, on the event loop when the user clicks a wheel (model's order)."""
        self._picked = act

    show_traction = _Mark()
    show_static_load = _Mark()
    show_in_air = _Mark()
    show_load_colours = _Mark()
    show_travel = _Mark()
    show_grid = _Mark()
    show_scale_bar = _Mark()

    def _switch_mark(self, part: str, on: bool) -> None:
        self._marked[part] = on
        if self._marks is not None:
            self._marks.show()
            self.draw(self._time)

    def wheel_state(self, wheel: int) -> WheelState | None:
        """A wheel, in the model's order, at the time drawn last; None where there is no such wheel."""
        scene = self._scene
        if scene is None or wheel >= len(scene.system.wheel):
            return None
        return wheel_state(scene.trajectory, wheel, self._time, scene.ground.road)

    @property
    def load_top(self) -> float | None:
        """N at the end of the colour scale while the wheels show their loads in colours; else None."""
        return self._scene.load_top if self._scene is not None and self._marked["load_colours"] else None

    @property
    def follow(self) -> bool:
        """Whether the camera goes with the vehicle."""
        return self._follow

    @follow.setter
    def follow(self, on: bool) -> None:
        self._follow = on
        self.draw(self._time)

    @property
    def arrow_scale(self) -> float:
        """Length of the load arrows, times the default."""
        return self._arrow_scale

    @arrow_scale.setter
    def arrow_scale(self, scale: float) -> None:
        self._arrow_scale = scale
        self.draw(self._time)

    @property
    def show_surroundings(self) -> bool:
        """Sky and ground."""
        return self._show_surroundings

    @show_surroundings.setter
    def show_surroundings(self, on: bool) -> None:
        self._show_surroundings = on
        self._surroundings.show(on)

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
        return self._labelled["names"]

    @show_labels.setter
    def show_labels(self, on: bool) -> None:
        self._label(names=on)

    @property
    def show_loads(self) -> bool:
        """The normal loads at the wheels' names."""
        return self._labelled["loads"]

    @show_loads.setter
    def show_loads(self, on: bool) -> None:
        self._label(loads=on)

    def write_loads(self) -> None:
        """Bring the loads at the wheels' names up to date: seldom enough to be read."""
        if self._scene is not None and self._labels is not None and self._labelled["loads"]:
            self._labels.write(self._scene.loads(self._time), load_unit(self._scene.system))

    def _label(self, **changed: bool) -> None:
        self._labelled |= changed
        if self._labels is not None:
            self._labels.show(**self._labelled)
            self.write_loads()

    def _switch(self, what: str, on: bool) -> None:
        self._visible[what] = on
        if self._vehicle is not None:
            self._vehicle.show(**self._visible)
            self.draw(self._time)

    def _set_live(self, live: bool) -> None:
        if live != self._live:
            self._live, self._recentre = live, True
            if self._ghost is not None:
                self._ghost.show(not live)

    def _take(self, scene: Scene) -> None:
        before, self._scene = self._scene, scene
        if before is None or before.layout != scene.layout:
            with self._client.atomic():
                self._build(scene)
        if before is None:
            self.set_view("side")
        else:
            self._camera.fit(scene.layout)

    def _build(self, scene: Scene) -> None:
        """Make vehicle and road anew."""
        if self._vehicle is not None and self._road is not None:
            self._vehicle.remove()
            self._road.remove()
        if self._marks is not None:
            self._marks.remove()
        now = scene.at(self._time, self._arrow_scale, None if self._follow else self._origin)
        self._vehicle = VehicleNodes(self._client.scene, scene, now)
        palette = wheel_palette(scene.system.n, scene.system.m, self._dark)
        self._vehicle.colour(palette)
        self._vehicle.on_click(lambda wheel: self._picked(wheel))
        self._marks = Marks(self._client.scene, scene, now, self._marked)
        self._marks.colour(DARK if self._dark else LIGHT, palette)
        self._vehicle.show(**self._visible)
        self._labels = WheelLabels(self._client.scene, scene.layout)
        self._label()
        self._road = RoadNodes(self._client.scene, scene.layout)
        self._road.colour(DARK if self._dark else LIGHT)
