"""The 3-D view of one browser tab: what of a run is shown, and from where.

While the camera follows, the vehicle stands still in the view and the road moves under it: the camera is never
touched, and the user's own orbit and zoom stay. Frame of the view: x forward, y to the left, z up; m.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

from app.format.colours import DARK, LIGHT, Theme, wheel_palette
from app.format.load_unit import load_unit
from app.format.units import METRIC, Units
from app.view3d.camera import Camera, Standpoint, Tab, about_as_long
from app.view3d.ghost import GHOST, Ghost
from app.view3d.labels import WheelLabels
from app.view3d.nodes import RoadNodes, Surroundings, VehicleNodes
from app.view3d.obstacle_mark import ObstacleMark
from app.view3d.overlays import SWITCHES, Overlays
from app.view3d.snapshot import Scene, build_scene, live_scene
from model.analysis.wheel_contact import WheelState, wheel_state
from model.road.road import Road
from model.simulation.trajectory import Trajectory


class _Nodes(NamedTuple):
    """What is made anew for a vehicle of another shape."""

    vehicle: VehicleNodes
    labels: WheelLabels  # below the vehicle's node: they go when it goes
    road: RoadNodes
    overlays: Overlays


class View3D:
    """What one tab sees. For one thread; switches take effect at once, also while nothing else is drawn."""

    def __init__(self, client: Tab, dark: bool = False) -> None:
        self._client = client
        self._dark, self._units = dark, METRIC
        self._on = {name: switch.on for name, switch in SWITCHES.items()}
        self._arrow_scale = 1.0
        self._camera = Camera(client)
        self._surroundings = Surroundings(client.scene, self._theme)
        self._scene: Scene | None = None
        self._nodes: _Nodes | None = None
        self._ghost: Ghost | None = None
        self._beside: list[Ghost] = []  # of runs beside the baseline
        self._marks_obstacle = False
        self._obstacle: ObstacleMark | None = None
        self._picked: Callable[[int], None] = lambda wheel: None
        self._height, self._type = 900, 1.0  # px of the picture, and type by its usual size
        self._marked: int | None = None  # wheel that is picked
        self._time = 0.0
        self._live = False  # a drive is shown, which has no time in common with a ghost
        self._origin = 0.0  # of the view along the road, m
        self._recentre = False  # bring the view to the vehicle once, though it does not follow

    def show(self, trajectory: Trajectory) -> None:
        """Take over a run for the next `draw`. Nodes are made anew only where their shape has changed.

        A run that broke down before its first sample leaves the one before it.
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

        While a drive is shown it stays hidden; so does a ghost of another size, which would fill the view or be lost.
        """
        before = self._ghost.scene if self._ghost is not None else None
        scene = build_scene(trajectory, before) if trajectory is not None and len(trajectory.t) else None
        with self._client.atomic():
            if self._ghost is not None and scene is not None and self._ghost.scene.measures == scene.measures:
                self._ghost.follow(scene)
            else:
                self._replace_ghost(scene)
            self.draw(self._time)

    def show_beside(self, runs: Sequence[tuple[Trajectory, str]]) -> None:
        """Show the vehicles of these runs, too, each as an outline of its colour (CSS). None may be much larger or
        smaller than the vehicle that is shown; a run without samples is left out."""
        with self._client.atomic():
            for ghost in self._beside:
                ghost.remove()
            self._beside = [
                Ghost(self._client.scene, build_scene(run), self._theme, f"{GHOST}/{k}", colour)
                for k, (run, colour) in enumerate(runs)
                if len(run.t)
            ]
            self._show_or_hide_ghost()
            self.draw(self._time)

    @property
    def ghost_of_other_size(self) -> bool:
        """Whether there is a ghost that is not shown since it is much larger or smaller than the vehicle."""
        ghost, scene = self._ghost, self._scene
        return ghost is not None and scene is not None and not about_as_long(ghost.scene.measures, scene.measures)

    def draw(self, time: float) -> None:
        """Show the run at a time, s; a time outside of the run shows its start or its end."""
        self._time = time
        scene, nodes = self._scene, self._nodes
        if scene is None or nodes is None:
            return
        follow = self._on["follow"] or self._recentre
        now = scene.at(time, self._arrow_scale, None if follow else self._origin)
        self._origin, self._recentre = now.origin, False
        with self._client.atomic():
            nodes.vehicle.draw(scene, now)
            nodes.road.draw(scene, now)
            nodes.labels.move(now.x - now.origin, scene.lowest)
            nodes.overlays.draw(scene, now)
            if not self._live:
                for ghost in self._ghosts:
                    ghost.draw(time, now.x - now.origin)
            if self._obstacle is not None:
                self._obstacle.draw(scene, now)
            self._surroundings.draw(scene, now)

    @property
    def turned_camera(self) -> tuple[float, ...]:
        """See app/view3d/camera.py."""
        return self._camera.turned

    def set_view(self, standpoint: Standpoint) -> None:
        """Look at the vehicle from one of the standpoints; before the first run there is nothing to look at."""
        if self._scene is not None:
            self._recentre = True
            self._camera.look(standpoint, self._scene.measures)

    def set_dark(self, dark: bool) -> None:
        """Change between the light and the dark theme."""
        self._dark = dark
        with self._client.atomic():
            self._surroundings.colour(self._theme)
            for ghost in self._ghosts:
                ghost.colour(self._theme)
            self._colour_nodes()

    def set_units(self, units: Units) -> None:
        """Tell loads and lengths in these units."""
        self._units = units
        if self._nodes is not None:
            self._nodes.overlays.tell_in(units)
            self.write_names()

    def on_pick(self, act: Callable[[int], None]) -> None:
        """Call act(wheel), which must not block, on the event loop when the user clicks a wheel (model's order)."""
        self._picked = act

    def mark_wheel(self, wheel: int | None) -> None:
        """Mark the wheel that is picked, in the model's order; None: none."""
        self._marked = wheel
        if self._nodes is not None:
            self._nodes.overlays.pick(wheel)
            self.draw(self._time)

    def mark_obstacle(self, on: bool) -> None:
        """Mark the obstacle of the road, also of the roads to come, until the vehicle has passed it; or no more."""
        if on != self._marks_obstacle:
            self._marks_obstacle = on
            self._mark()
            self.draw(self._time)

    def _mark(self) -> None:
        with self._client.atomic():
            if self._obstacle is not None:
                self._obstacle.remove()
            scene = self._scene if self._marks_obstacle and not self._live else None
            self._obstacle = None if scene is None else ObstacleMark(self._client.scene, scene)

    def set_switch(self, name: str, on: bool) -> None:
        """Turn one of app.view3d.overlays.SWITCHES on or off. Raises ValueError for another name."""
        if name not in SWITCHES:
            raise ValueError(f"Unknown switch of the 3-D view: {name!r}. Allowed: {', '.join(SWITCHES)}")
        self._on[name] = on
        self._show_what_is_on()
        self.draw(self._time)

    def set_arrow_scale(self, scale: float) -> None:
        """Make all force arrows this many times as long as at first."""
        self._arrow_scale = scale
        self.draw(self._time)

    def show_surroundings(self, on: bool) -> None:
        """Show sky and ground, or hide them."""
        self._surroundings.show(on)

    def fit_page(self, height: int, covered: float, type_scale: float) -> None:
        """The picture is `height` px high, of which panels hide the share `covered` at its foot.

        type_scale: how many times as large as usual names are written.
        """
        self._height, self._type = height, type_scale
        self._camera.clear(covered)
        if self._nodes is not None:
            self._nodes.labels.set_type(type_scale)

    def write_names(self) -> None:
        """Bring the wheels' names and the loads at them up to date: seldom enough to be read."""
        if self._scene is None or self._nodes is None:
            return
        labels = self._nodes.labels
        labels.thin_out(lambda metres: self._camera.spacing(metres, self._height))
        if self._on["loads"]:
            labels.write(self._scene.loads(self._time), load_unit(self._scene.system, self._units))

    def wheel_state(self, wheel: int) -> WheelState | None:
        """A wheel, in the model's order, at the time drawn last; None where there is no such wheel."""
        scene = self._scene
        if scene is None or wheel >= len(scene.system.wheel):
            return None
        return wheel_state(scene.trajectory, wheel, self._time, scene.ground.road)

    @property
    def load_top(self) -> float | None:
        """N at the end of the colour scale while the wheels show their loads in colours; else None."""
        return self._scene.load_top if self._scene is not None and self._on["load_colours"] else None

    @property
    def _theme(self) -> Theme:
        return DARK if self._dark else LIGHT

    @property
    def _ghosts(self) -> list[Ghost]:
        return [*([] if self._ghost is None else [self._ghost]), *self._beside]

    def _replace_ghost(self, scene: Scene | None) -> None:
        if self._ghost is not None:
            self._ghost.remove()
        self._ghost = Ghost(self._client.scene, scene, self._theme) if scene is not None else None
        self._show_or_hide_ghost()

    def _show_or_hide_ghost(self) -> None:
        if self._ghost is not None:
            self._ghost.show(not self._live and not self.ghost_of_other_size)
        for ghost in self._beside:
            ghost.show(
                not self._live and self._scene is not None and about_as_long(ghost.scene.measures, self._scene.measures)
            )

    def _show_what_is_on(self) -> None:
        if self._nodes is not None:
            self._nodes.vehicle.show(self._on)
            self._nodes.labels.show(self._on)
            self._nodes.overlays.show(self._on)
            self.write_names()

    def _colour_nodes(self) -> None:
        if self._scene is not None and self._nodes is not None:
            palette = wheel_palette(self._scene.system.n, self._scene.system.m, self._dark)
            self._nodes.vehicle.colour(palette)
            self._nodes.road.colour(self._theme)
            self._nodes.overlays.colour(self._theme, palette)

    def _set_live(self, live: bool) -> None:
        if live != self._live:
            self._live, self._recentre = live, True
            self._show_or_hide_ghost()

    def _take(self, scene: Scene) -> None:
        before, self._scene = self._scene, scene
        if before is None or before.measures != scene.measures:
            with self._client.atomic():
                self._build(scene)
                self._show_or_hide_ghost()
        if before is None:
            self.set_view("side")
        else:
            self._camera.fit(scene.measures)
        if self._marks_obstacle:
            self._mark()

    def _build(self, scene: Scene) -> None:
        """Make vehicle, road and overlays anew."""
        if self._nodes is not None:
            self._nodes.vehicle.remove()
            self._nodes.road.remove()
            self._nodes.overlays.remove()
        now = scene.at(self._time, self._arrow_scale, None if self._on["follow"] else self._origin)
        api = self._client.scene
        self._nodes = _Nodes(
            VehicleNodes(api, scene, now),
            WheelLabels(api, scene.measures),
            RoadNodes(api, scene.measures),
            Overlays(api, scene, now),
        )
        self._nodes.vehicle.on_click(lambda wheel: self._picked(wheel))
        self._nodes.labels.set_type(self._type)
        self._nodes.overlays.pick(self._marked)
        self._nodes.overlays.tell_in(self._units)
        self._colour_nodes()
        self._show_what_is_on()
