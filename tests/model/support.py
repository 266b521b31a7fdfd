"""What several tests of the physics share: configurations with every option, and states to judge them at."""

from __future__ import annotations

from typing import Any

import numpy as np

from model.config.config import Config
from model.dynamics.equations import State
from model.dynamics.equilibrium import rest_pose
from model.dynamics.lanes import COORDINATES, places
from model.dynamics.vehicle import System

PAPER = Config()
FLAT = PAPER.replace({"road.type": "flat"})

WHEELS, ARMS = "vehicle.road_wheels", "vehicle.road_arms"
ROAD_SPRING, IMAGINARY = "vehicle.road_suspension", "vehicle.imaginary_suspension"

# Every option of model/MODEL.md at least once.
OPTIONS: dict[str, dict[str, Any]] = {
    "paper": {},
    "without imaginary wheels": {"vehicle.imaginary_wheels.enabled": False},
    "uneven positions": {f"{WHEELS}.positions": (2.0, 1.1, 0.5, -1.9)},
    "offset": {f"{WHEELS}.offset": 0.3, f"{WHEELS}.spacing": 0.583},
    "torsion basis": {
        f"{ROAD_SPRING}.basis": "torsion",
        f"{ROAD_SPRING}.stiffness": 9000.0,
        f"{ROAD_SPRING}.damping": 500.0,
        f"{IMAGINARY}.basis": "torsion",
        f"{IMAGINARY}.stiffness": 1300.0,
        f"{IMAGINARY}.damping": 600.0,
    },
    "a value for each wheel": {
        f"{ROAD_SPRING}.stiffness": (9e4, 6e4, 7e4, 8e4, 5e4, 1e5),
        f"{ROAD_SPRING}.damping": (5e3, 1e3, 0.0, 2e3, 3e3, 6e3),
    },
    "progressive, asymmetric, with stops": {
        f"{ROAD_SPRING}.progression": 60.0,
        f"{ROAD_SPRING}.rebound_ratio": 2.5,
        f"{ROAD_SPRING}.bump_travel": 0.03,
        f"{ROAD_SPRING}.rebound_travel": 0.04,
    },
    "stops of a torsion bar": {
        f"{ROAD_SPRING}.basis": "torsion",
        f"{ROAD_SPRING}.stiffness": 9000.0,
        f"{ROAD_SPRING}.damping": 500.0,
        f"{ROAD_SPRING}.progression": 5.0,
        f"{ROAD_SPRING}.bump_travel": 0.05,
        f"{ROAD_SPRING}.stop_stiffness": 1e5,
        f"{ROAD_SPRING}.stop_damping": 2e3,
    },
    "preload force": {f"{IMAGINARY}.preload_force": 2500.0},
    "no preload": {f"{IMAGINARY}.preload_deflection": 0.0},
    "reacts on chassis": {f"{IMAGINARY}.reacts_on": "chassis"},
    "prescribed": {"drive.mode": "prescribed"},
    "prescribed, without imaginary wheels": {
        "drive.mode": "prescribed",
        "vehicle.imaginary_wheels.enabled": False,
    },
    "prescribed, reacts on chassis, uneven": {
        "drive.mode": "prescribed",
        f"{IMAGINARY}.reacts_on": "chassis",
        f"{WHEELS}.positions": (1.4, 0.2, -1.3),
    },
    "given inertias": {
        f"{WHEELS}.inertia": 5.0,
        f"{ARMS}.inertia": 1.5,
        "vehicle.imaginary_wheels.inertia": 2.0,
        "vehicle.imaginary_wheels.mass": 30.0,
    },
    "arms that run up": {f"{ARMS}.angle_deg": -35.0, f"{ARMS}.length": 0.5},
    "weak drive": {"drive.force_limit": 800.0},
    "slippery": {"contact.friction": 0.05},
    "two wheels": {f"{WHEELS}.count": 2, f"{WHEELS}.spacing": 3.0},
    "twenty wheels": {f"{WHEELS}.count": 20},
    "flat": {"road.type": "flat"},
    "half round": {"road.type": "half_round"},
    "bridging": {"road.amplitude": 0.04, "road.wavelength": 0.7},
}


def random_state(system: System, rng: np.random.Generator) -> tuple[float, State]:
    """A time and a state far from any motion: off the constraints, wheels in the ground and in the air.

    Now and then the vehicle tumbles, with all angles anywhere.
    """
    q, _ = rest_pose(system)
    B, W = len(system.mass), len(system.wheel)
    q = q + rng.normal(0.0, 0.02, (B, 3)) * [1.0, 1.0, 5.0]
    q[:, 0] += rng.uniform(0.0, 14.0)
    q[:, 1] += rng.uniform(-0.05, 0.12)
    if rng.random() < 0.2:
        q[:, 2] = rng.uniform(-7.0, 7.0, B)
    v = rng.normal(0.0, 0.5, (B, 3))
    v[:, 0] += system.v_ref
    v[system.wheel, 2] -= system.v_ref / system.r
    if rng.random() < 0.1:
        v[:, 1] += 3.0  # faster out of the ground than its damping lets it push
    xi = rng.normal(0.0, 10.0 ** rng.uniform(-4, -1.5), W)
    return rng.uniform(0.0, 4.0), State(q, v, xi, rng.normal(0.0, 0.5))


def admissible_state(system: System, rng: np.random.Generator) -> State:
    """A random state that fulfils the joints' constraints, in positions and velocities, near the rest pose."""
    q, _ = rest_pose(system)
    v = np.zeros_like(q)
    q[:, 2] += rng.normal(0.0, 0.1, len(q))
    v[:, 2] = rng.normal(0.0, 0.5, len(q))
    q[0, :2] += rng.uniform([0.0, -0.03], [14.0, 0.02])
    v[0, :2] = rng.normal([system.v_ref, 0.0], 0.5)
    v[system.wheel, 2] -= system.v_ref / system.r
    for i, j, u_i, u_j in zip(system.joint_i, system.joint_j, system.u_i, system.u_j, strict=True):
        arm_i, arm_j = turned(u_i, q[i, 2]), turned(u_j, q[j, 2])
        q[j, :2] = q[i, :2] + arm_i - arm_j
        v[j, :2] = v[i, :2] + v[i, 2] * across(arm_i) - v[j, 2] * across(arm_j)
    return State(q, v, rng.normal(0.0, 0.003, len(system.wheel)), rng.normal(0.0, 0.3))


def turned(u: np.ndarray, angle: float) -> np.ndarray:
    """A vector (2,) turned counter-clockwise."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([c * u[0] - s * u[1], s * u[0] + c * u[1]])


def across(u: np.ndarray) -> np.ndarray:
    """A vector (2,) turned by +90°."""
    return np.array([-u[1], u[0]])


def entries(system: System, coordinate: str) -> np.ndarray:
    """Where the flat state has x, y, theta, v_x, v_y or omega of all bodies: (B,)."""
    return places(system.n, system.m)[0][:, COORDINATES.index(coordinate)]
