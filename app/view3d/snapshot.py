"""What the 3-D view shows at an instant, without a viewer: a run and a time -> poses, track, arrows.

Frame of the view: x forward, y to the left, z up; m. The model's (x, y) becomes (x, ±side, y): one side of the vehicle
is computed, both are drawn, right side first. The view's origin lies on the road at a place of the caller's choice,
by default under the hull's centre of mass: numbers stay small however far the vehicle has come, and a camera that
follows it stands still. Points of the model's plane are complex, x + iy.
"""

from __future__ import annotations

import cmath
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from app.view3d.meshes.measures import Measures, measures_of
from app.view3d.meshes.surroundings import AHEAD, BEHIND, TILES, shadow
from app.view3d.track_belt import ARC, points_along, track_path
from model.analysis.ride import wheel_heights
from model.dynamics.vehicle import System
from model.road.road import Road
from model.simulation.drive import REBASE
from model.simulation.trajectory import Trajectory

SIDES = np.array([-1.0, 1.0])  # right, left
FACED = ("road_wheels", "sprockets", "imaginary_wheels")  # have an outside: on the left they are turned about z
NO_LOAD = 1e-3  # m of arrow for a wheel without load: its head stays in the ground
GRAIN = 0.02  # m between the heights of a ground line
FADE = 15.0  # m over which the ground goes over into a level where no road is laid


class Poses(NamedTuple):
    """Of K bodies: positions (K, 3), m, and orientations (K, 4) as wxyz."""

    positions: np.ndarray
    wxyzs: np.ndarray


class Travel(NamedTuple):
    """Heights of the road wheels' centres over the hull's foot point, in the hull's frame, m; (n,) each."""

    lowest: np.ndarray
    highest: np.ndarray
    static: np.ndarray


class Contacts(NamedTuple):
    """Where the W wheels of one side meet the road, or would, and with what."""

    points: np.ndarray  # (W, 2) x in the view's frame and height, m
    normals: np.ndarray  # (W, 2) from the road to the wheel's centre
    load: np.ndarray  # (W,) N
    traction: np.ndarray  # (W,) N, along the road, forward
    per_newton: float  # m of arrow


class Snapshot(NamedTuple):
    """All that moves. Bodies of both sides: the right side's, front first, then the left side's."""

    x: float  # of the hull's centre of mass along the road, m
    origin: float  # of the view along the road, m
    hull: Poses  # 1: the point of the ground under the centre of mass, in the design pose
    road_wheels: Poses  # 2 (n + 1): each side's idler after its road wheels
    sprockets: Poses  # 2
    imaginary_wheels: Poses  # 2 m
    road_arms: Poses  # 2 n
    imaginary_arms: Poses  # 2 m
    shoes: Poses  # of both tracks
    arrows: np.ndarray  # (2 W, 2, 3) foot at the contact point and tip, normal loads
    contacts: Contacts
    shadow: np.ndarray  # (V, 3) vertices of the vehicle's shadow on the road


@dataclass(frozen=True)
class GroundLine:
    """Heights of a road every GRAIN metres, to be read off quickly: fine enough for the eye."""

    road: Road
    x: np.ndarray  # (K,) m, rising
    heights: np.ndarray  # (K,) m

    @staticmethod
    def along(road: Road, first: float, last: float, like: GroundLine | None = None) -> GroundLine:
        """The line from `first` to `last`, m; the one that is there already, if it is long enough."""
        if like is not None and like.road is road and like.x[0] <= first and like.x[-1] >= last:
            return like
        x = np.arange(first, last + 25.0, GRAIN)  # with something to spare for the next run
        return GroundLine(road, x, road.height(x))

    @staticmethod
    def of_laid(road: Road, like: GroundLine | None = None) -> GroundLine:
        """The whole line of a stretch of road, level beyond; taken over from `like`, if it is of the same stretch."""
        if like is not None and like.road.profile is road.profile:
            return replace(like, road=road)
        first, last = road.profile.pieces[0].nodes[0], road.profile.pieces[-1].nodes[-1]
        x = np.arange(np.ceil(first / GRAIN), np.floor(last / GRAIN) + 1) * GRAIN
        heights = road.height(x)
        level = [np.median(heights)]
        return GroundLine(
            road, np.concatenate([[first - FADE], x, [last + FADE]]), np.concatenate([level, heights, level])
        )

    def height(self, x: np.ndarray) -> np.ndarray:
        return np.interp(x, self.x, self.heights)


@dataclass(frozen=True)
class Scene:
    """One run, ready to be looked at."""

    trajectory: Trajectory
    system: System
    measures: Measures
    places: Places
    ground: GroundLine
    passed: float = 0.0  # m by which the origin of a drive has moved along
    before: Travel | None = None  # of a drive, until now

    @cached_property
    def load_scale(self) -> float:
        """m of arrow per N: an even share of the weight on each road wheel is as high as the wheel."""
        weight = float(self.system.weight.sum())
        return 2 * self.measures.radius * self.system.n / weight

    @cached_property
    def lowest(self) -> float:
        """Height of the lowest point of the road that can be seen, m.

        Rounded down to 5 cm (but for 5 mm; less for small vehicles), so that it stays the same for runs that differ
        little.
        """
        grain = 0.05 * min(self.measures.scale, 1.0)
        return grain * float(np.floor(self.ground.heights.min() / grain + 0.1))

    @cached_property
    def load_top(self) -> float:
        """N: the end of the colour scale of loads, twice an even share of the weight on each road wheel."""
        return 4 * self.measures.radius / self.load_scale

    @cached_property
    def travel(self) -> Travel:
        """How far the road wheels have moved in the hull."""
        height = wheel_heights(self.system, self.trajectory.q) - self.places.on_hull[0].imag
        now = Travel(height.min(axis=0), height.max(axis=0), height[0])
        if self.before is None:
            return now
        low, high, static = self.before
        return Travel(np.minimum(low, now.lowest), np.maximum(high, now.highest), static)

    def at(self, time: float, arrow_scale: float = 1.0, origin: float | None = None) -> Snapshot:
        """The instant `time`, s, between samples in proportion; before the start or after the end, these.

        arrow_scale: times the default length of the arrows; origin: of the view, x on the road, m.
        """
        places = self.places
        q, load, traction = self._between(time)
        x, pitch = float(q[0, 0]), float(q[0, 2])
        origin = x if origin is None else origin
        contacts, normals, _ = self.ground.road.nearest(q[self.system.wheel, :2])

        # Bodies of the model, then what is fixed to the hull or turns with the track
        point = q[:, 0] - origin + 1j * q[:, 1]
        point = np.concatenate([point, point[0] + places.on_hull * cmath.rect(1.0, pitch)])
        angle = np.concatenate([q[:, 2], pitch - (x + self.passed) * places.turns])

        # The track, lifted out of the ground
        pins = places.pins(track_path(point[places.circled], places.radii), x + self.passed, origin + self.passed)
        shadow = places.shadow.copy()
        shadow[:, 0] += x - origin
        ground = self.ground.height(np.concatenate([pins.real, shadow[:, 0]]) + origin)
        pins.imag = np.maximum(pins.imag, ground[: len(pins)])
        shadow[:, 2] += ground[len(pins) :]
        shoe, chord = (pins[1:] + pins[:-1]) / 2, np.angle(pins[1:] - pins[:-1])

        arrows = places.arrows.copy()
        per_newton = self.load_scale * arrow_scale
        length = np.maximum(load * per_newton, NO_LOAD)
        contacts[:, 0] -= origin
        arrows[:, :, 0, ::2] = contacts
        arrows[:, :, 1, ::2] = contacts + length[:, None] * normals

        poses = places.poses(
            np.concatenate([point[places.body], shoe, shoe]), np.concatenate([angle[places.body], chord, chord])
        )
        touch = Contacts(contacts, normals, load, traction, per_newton)
        return Snapshot(x, origin, arrows=arrows.reshape(-1, 2, 3), contacts=touch, shadow=shadow, **poses)

    def bodies(self, time: float) -> np.ndarray:
        """q (B, 3) of all bodies at a time, s."""
        return self._between(time)[0]

    def loads(self, time: float) -> np.ndarray:
        """Normal loads (W,), N, at a time, s."""
        return self._between(time)[1]

    def _between(self, time: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """q (B, 3), normal loads (W,) and tractions (W,) at a time."""
        run = self.trajectory
        last = len(run.t) - 1
        sample = min(max((time - run.t[0]) * run.config.simulation.output_rate, 0.0), last)
        k = min(int(sample), last - 1) if last else 0
        part = sample - k
        if part == 0.0:
            return run.q[k].copy(), run.normal_load[k], run.traction[k]
        q, load, traction = (a[k] + part * (a[k + 1] - a[k]) for a in (run.q, run.normal_load, run.traction))
        return q, load, traction


class Places:
    """What is drawn where in the arrays of a snapshot: the same for every instant and every run of a vehicle."""

    def __init__(self, system: System, measures: Measures) -> None:
        bodies = np.arange(len(system.mass))
        foot, sprocket, idler = len(bodies) + np.arange(3)
        rollers = idler + 1 + np.arange(len(measures.rollers))

        # Fixed to the hull, from its centre of mass; radians that they turn per m of track
        ends = measures.sprocket, measures.idler
        fixed = np.array([(0.0, 0.0), *(circle[:2] for circle in (*ends, *measures.rollers))])
        self.on_hull = fixed @ [1, 1j] - system.q_design[system.chassis, :2] @ [1, 1j]
        self.turns = np.array([0.0, *(1 / end.radius for end in ends), *np.zeros(len(rollers))])

        # The track's circles, clockwise from the sprocket: under the wheels, round the idler, over the rollers
        wheels = system.wheel[np.argsort(-system.q_design[system.wheel, 0])]
        self.circled = np.concatenate([[sprocket], wheels, [idler], rollers])
        around = [measures.sprocket.radius, *np.full(len(wheels), measures.radius), measures.idler.radius]
        self.radii = np.array([*around, *(roller.radius for roller in measures.rollers)])
        self.under_middle = (1 + len(wheels) // 2) * len(ARC) + len(ARC) // 2
        self.middle, self.shoe_pitch = measures.middle, measures.shoe_pitch
        design = np.concatenate([system.q_design[:, :2] @ [1, 1j], fixed @ [1, 1j]])
        path = track_path(design[self.circled], self.radii)
        self.shoe_count = round(float(np.abs(np.roll(path, -1) - path).sum()) / measures.shoe_pitch)

        # Rows of a snapshot's bodies: which body, how far to the left, and whether turned about z
        rows = {
            "hull": (np.array([foot]), np.zeros(1)),
            "road_wheels": (np.append(bodies[system.road_wheels], idler), SIDES * measures.track),
            "sprockets": (np.array([sprocket]), SIDES * measures.track),
            "imaginary_wheels": (bodies[system.imaginary_wheels], SIDES * measures.disc),
            "road_arms": (bodies[system.road_arms], SIDES * measures.arm),
            "imaginary_arms": (bodies[system.imaginary_arms], SIDES * measures.link),
            "shoes": (np.arange(self.shoe_count), SIDES * measures.track),
        }
        edges = pairwise(np.cumsum([0, *(len(row) * len(sides) for row, sides in rows.values())]))
        self._rows = {name: slice(*ends) for name, ends in zip(rows, edges, strict=True)}
        self.body = np.concatenate([np.tile(row, len(sides)) for row, sides in list(rows.values())[:-1]])
        side = np.concatenate([np.repeat(sides, len(row)) for row, sides in rows.values()])
        faced = np.concatenate([np.full(len(row) * len(sides), name in FACED) for name, (row, sides) in rows.items()])
        turned = faced & (side > 0.0)
        self._positions = np.zeros((len(side), 3), dtype=np.float32)
        self._positions[:, 1] = side
        self._wxyzs = np.zeros((len(side), 4), dtype=np.float32)
        start = 4 * np.arange(len(side))
        self._cosine, self._sine = start + np.where(turned, 3, 0), start + np.where(turned, 1, 2)

        self.arrows = np.zeros((len(SIDES), len(system.wheel), 2, 3), dtype=np.float32)
        self.arrows[..., 1] = (SIDES * measures.arrow)[:, None, None]
        self.shadow = shadow(measures).astype(np.float32)

    def pins(self, path: np.ndarray, travelled: float, origin: float) -> np.ndarray:
        """Pins (shoes + 1,) of the track along its closed path (K,); those below stay where they are on the road."""
        beyond = float(path[self.under_middle].real) - self.middle - travelled + origin
        part = travelled / self.shoe_pitch % 1.0
        return points_along(path, self.under_middle, beyond, self.shoe_count, part)

    def poses(self, points: np.ndarray, angles: np.ndarray) -> dict[str, Poses]:
        """Points (K,) and angles θ (K,) of all rows, by the name of the snapshot's field."""
        positions, wxyzs = self._positions.copy(), self._wxyzs.copy()
        positions[:, 0], positions[:, 2] = points.real, points.imag
        half = angles / 2
        flat = wxyzs.reshape(-1)
        flat[self._cosine], flat[self._sine] = np.cos(half), -np.sin(half)
        return {name: Poses(positions[rows], wxyzs[rows]) for name, rows in self._rows.items()}


def build_scene(trajectory: Trajectory, like: Scene | None = None) -> Scene:
    """The scene of a run; takes over what it shares with another one, which makes it cheap."""
    system, config = trajectory.system, trajectory.config
    measures = measures_of(system, config.vehicle.hull)
    x = trajectory.q[:, system.chassis, 0]
    first, last = float(x.min()) - BEHIND - TILES, float(x.max()) + AHEAD + TILES
    if like is None or like.measures != measures:
        ground = GroundLine.along(trajectory.road, first, last)
        return Scene(trajectory, system, measures, Places(system, measures), ground)
    ground = GroundLine.along(trajectory.road, first, last, like.ground)
    return Scene(trajectory, system, measures, like.places, ground)


def live_scene(recent: Trajectory, road: Road, like: Scene | None = None) -> Scene:
    """The scene of the last moments of a drive (model/simulation/drive.py) on the road about it; 30 a second are cheap.

    like: the scene before this one. Where the drive's origin has moved along since, `passed` says by how much.
    """
    x = float(recent.q[-1, 0, 0])
    ground = GroundLine.of_laid(road, like.ground if like else None)
    if like is None:
        measures = measures_of(recent.system, recent.config.vehicle.hull)
        return Scene(recent, recent.system, measures, Places(recent.system, measures), ground)
    fell_back = like.trajectory.q[-1, 0, 0] - x
    passed = like.passed + REBASE * round(fell_back / REBASE)
    system, measures, places = like.system, like.measures, like.places
    if like.trajectory.config is not recent.config:
        system, measures = recent.system, measures_of(recent.system, recent.config.vehicle.hull)
    if measures != like.measures:
        return Scene(recent, system, measures, Places(system, measures), ground, passed)
    before = like.travel if recent.t[0] > like.trajectory.t[0] else None
    return Scene(recent, system, measures, places, ground, passed, before)
