"""The ends of what model/MODEL.md says an integrator completes: every run must be whole, finite and held together."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from model import Trajectory, simulate
from tests.model.support import IMAGINARY, PAPER, ROAD_SPRING, WHEELS

SHORT = PAPER.replace({"simulation.duration": 4})


def assert_sound(run: Trajectory) -> None:
    assert run.status == "complete", run.config
    for name in ("q", "v", "a", "normal_load", "traction", "drive_force", "multipliers"):
        assert np.isfinite(getattr(run, name)).all(), name
    assert run.constraint_residual.max() < 1e-3
    assert run.normal_load.min() >= 0.0
    friction = run.config.contact.friction * run.normal_load
    assert (np.abs(run.traction) <= friction * (1 + 1e-12) + 1e-9).all()


@pytest.mark.parametrize(("amplitude", "wavelength"), list(product([0.0, 0.1, 0.3], [0.5, 2.0, 20.0])))
def test_speeds_and_waves(amplitude, wavelength):
    for speed in (2.0, 70.0):
        road = {"road.amplitude": amplitude, "road.wavelength": wavelength, "drive.speed_kmh": speed}
        assert_sound(simulate(SHORT.replace(road)))


@pytest.mark.parametrize(
    "changes",
    [
        {f"{ROAD_SPRING}.stiffness": 7553.0},
        {f"{ROAD_SPRING}.stiffness": 755300.0},
        {f"{IMAGINARY}.stiffness": 1e3},
        {f"{IMAGINARY}.stiffness": 1e5},
        {f"{WHEELS}.count": 2, f"{WHEELS}.spacing": 3.0},
        {f"{WHEELS}.count": 20},
        {f"{WHEELS}.radius": 0.05},
        {f"{WHEELS}.radius": 1.0},
        {f"{ROAD_SPRING}.damping": 0.0, f"{IMAGINARY}.damping": 0.0},
        {f"{IMAGINARY}.preload_deflection": 0.0},
        {"contact.friction": 0.0},
        {"drive.force_limit": 0.0},
    ],
)
@pytest.mark.parametrize("mode", ["cruise", "prescribed"])
def test_vehicles(changes, mode):
    """On the paper's road, and on one that throws them about."""
    for road in ({}, {"drive.speed_kmh": 50.0, "road.wavelength": 3.0}):
        assert_sound(simulate(SHORT.replace(changes | road | {"drive.mode": mode})))


@pytest.mark.parametrize(("height", "radius"), [(0.05, 0.05), (0.3, 0.3), (0.2, 2.0)])
def test_obstacles(height, radius):
    road = {"road.type": "half_round", "road.height": height, "road.radius": radius, "road.position": 6.0}
    for speed in (2.0, 15.0, 70.0):
        assert_sound(simulate(SHORT.replace(road | {"drive.speed_kmh": speed, "simulation.duration": 6.0})))
