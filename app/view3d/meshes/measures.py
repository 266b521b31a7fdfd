"""The measures of a vehicle's picture, from its System: what the model does not say is decided here.

Design pose of the model: x forward from the chassis's centre of mass, height above flat ground; sideways from
the vehicle's middle plane outwards; m. The model is one side of the vehicle; the picture shows both.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from model.dynamics.vehicle import System

PAPER_RADIUS = 0.32  # m, of the wheels of the paper's vehicle


class Circle(NamedTuple):
    x: float
    height: float
    radius: float


@dataclass(frozen=True)
class Measures:
    """Compares equal for vehicles that look the same."""

    wheel_x: tuple[float, ...]  # road wheels, front first
    radius: float  # of road wheels and imaginary wheels, to the ground: the track's shoes included
    links: tuple[float, ...]  # lengths of the imaginary arms
    pivot: tuple[float, float]  # of a road arm, from its wheel's centre: forward, up
    floor: float  # height of the hull's floor, as the model has it
    hull: str  # its shape, one of model.config.parameters.HULLS

    @property
    def scale(self) -> float:
        """How much larger than the paper's vehicle, by its wheels."""
        return self.radius / PAPER_RADIUS

    def at_scale_one(self) -> Measures:
        """The same vehicle at the size of the paper's."""
        s = self.scale
        return Measures(
            tuple(x / s for x in self.wheel_x),
            self.radius / s,
            tuple(length / s for length in self.links),
            (self.pivot[0] / s, self.pivot[1] / s),
            self.floor / s,
            self.hull,
        )

    @property
    def front(self) -> float:
        return self.wheel_x[0]

    @property
    def rear(self) -> float:
        return self.wheel_x[-1]

    @property
    def length(self) -> float:
        """From sprocket to idler."""
        return self.sprocket.x - self.idler.x

    @property
    def middle(self) -> float:
        return (self.front + self.rear) / 2

    @property
    def sprocket(self) -> Circle:
        """The driving wheel, fixed to the hull; radius to the track's outer face."""
        return Circle(self.front + 0.84 * self.scale, 0.64 * self.scale, 0.27 * self.scale)

    @property
    def idler(self) -> Circle:
        return Circle(self.rear - 0.80 * self.scale, 0.58 * self.scale, 0.25 * self.scale)

    @property
    def rollers(self) -> tuple[Circle, ...]:
        """Return rollers that carry the upper run, rear first (in the direction in which the track moves)."""
        count = max(2, round((self.front - self.rear) / (1.15 * self.scale)))
        x = np.linspace(self.rear, self.front, 2 * count + 1)[1::2]
        return tuple(Circle(float(at), 0.80 * self.scale, 0.10 * self.scale) for at in x)

    @property
    def belly(self) -> float:
        """Height of the hull's floor as it is drawn: below the fenders however high it is given."""
        return float(np.clip(self.floor, 0.2 * self.scale, 0.6 * self.scale))

    @property
    def fender(self) -> float:
        """Height of the fenders, over the upper run."""
        return 1.02 * self.scale

    @property
    def shoe_pitch(self) -> float:
        return 0.14 * self.scale

    @property
    def shoe_thickness(self) -> float:
        return 0.04 * self.scale

    @property
    def tyre_radius(self) -> float:
        """Of the drawn road wheel: the track lies between it and the ground; neighbours stay apart."""
        closest = -float(np.diff(self.wheel_x).max())
        return min(self.radius - self.shoe_thickness, 0.49 * closest)

    # Sideways layers, from the middle plane outwards
    @property
    def hull_half_width(self) -> float:
        return 0.94 * self.scale

    @property
    def track(self) -> float:
        """Middle of the track and of the road wheels."""
        return 1.20 * self.scale

    @property
    def track_width(self) -> float:
        return 0.36 * self.scale

    @property
    def disc(self) -> float:
        """Imaginary wheels."""
        return 1.43 * self.scale

    @property
    def arm(self) -> float:
        return 1.48 * self.scale

    @property
    def link(self) -> float:
        return 1.53 * self.scale

    @property
    def arrow(self) -> float:
        return 1.62 * self.scale

    @property
    def half_width(self) -> float:
        """Of the whole vehicle, fenders included."""
        return 1.56 * self.scale

    @property
    def road_half_width(self) -> float:
        return 2.0 * self.scale


def measures_of(system: System, hull: str) -> Measures:
    """The measures of a vehicle whose hull has this shape (one of model.config.parameters.HULLS)."""
    design = system.q_design
    wheels = design[system.road_wheels]
    half_arm = design[1, :2] - wheels[0, :2]
    links = 2 * (wheels[: system.m, 0] - design[system.imaginary_arms, 0])
    return Measures(
        wheel_x=tuple(wheels[:, 0].tolist()),
        radius=system.r,
        links=tuple(links.tolist()),
        pivot=(2 * float(half_arm[0]), 2 * float(half_arm[1])),
        floor=system.belly,
        hull=hull,
    )
