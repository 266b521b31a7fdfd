"""The vehicles that come with the program: they stand level, carry their weight and drive the paper's road."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pytest

from model import load_config, simulate
from model.analysis.modes import vehicle_modes
from model.analysis.ride import Summary
from model.dynamics.equilibrium import rest_pose
from model.dynamics.vehicle import build_system

VEHICLES = {"paper": 6, "paper_0583": 6, "m113": 5, "m113_rs": 5, "marder": 6, "robot": 4}


class Chrono(NamedTuple):
    """Half of a vehicle of Project Chrono's, and how it bounces."""

    mass: float  # kg, of all of it; the model's links between wheels are beside that
    gap: float  # kg of track between two wheels
    preload: float  # N m, of a torsion bar at the assembly pose
    assembly: float  # °, angle of the arms there
    bounce: float  # Hz, at rest, with the track's imaginary wheels
    driver: tuple[float, float]  # m before and above the centre of mass of all that is sprung


CHRONO = {
    "m113": Chrono(5662, 78.0, 1e4, 24.95, 3.00, (2.01, 0.871)),
    "m113_rs": Chrono(4497, 78.0, 1e4, 24.95, 3.47, (1.5, 0.1)),
    "marder": Chrono(14648, 82.7, 2.7e4, 9.23, 2.39, (2.793, -0.004)),
}
# The M113's hull alone, its torsion bars at rest under that, no track under the wheels
HULL_ALONE = {
    "vehicle.chassis.mass": 3909.62,
    "vehicle.chassis.pitch_inertia": 13643.8,
    "vehicle.chassis.cg_height": 1.0112,
    "vehicle.road_wheels.radius": 0.305,
    "vehicle.road_wheels.positions": (1.4091, 0.7421, 0.0751, -0.5919, -1.2579),
    "vehicle.road_arms.angle_deg": 43.63,
    "vehicle.imaginary_wheels.inertia": 3.63,
    "vehicle.seat.x": 1.5,
    "vehicle.seat.y": 0.1,
}
ASSEMBLY = {
    "vehicle.chassis.cg_height": 0.926,
    "vehicle.road_wheels.positions": (1.351, 0.684, 0.017, -0.65, -1.316),
    "vehicle.road_arms.angle_deg": 24.95,
}


@pytest.mark.parametrize("name", VEHICLES)
def test_a_vehicle_settles_level_on_flat_ground(name):
    system = build_system(load_config(name))
    q, load = rest_pose(system)
    assert system.n == VEHICLES[name]
    assert abs(np.degrees(q[0, 2])) < 1.0
    assert (load > 0.0).all()
    assert load.sum() == pytest.approx(system.weight.sum(), rel=1e-9)


@pytest.mark.parametrize("name", VEHICLES)
def test_a_vehicle_drives_the_papers_road(name):
    config = load_config(name)
    run = simulate(config.replace({"road.type": "sine", "road.amplitude": 0.1, "road.wavelength": 7.0}))
    assert run.complete
    assert run.constraint_residual.max() < 10e-6
    speed = config.drive.speed_kmh / 3.6
    assert np.abs(run.v[:, 0, 0] - speed).max() < 0.15 * speed


@pytest.mark.parametrize("name", CHRONO)
def test_published_vehicles_weigh_what_chronos_do(name):
    vehicle = load_config(name).vehicle
    system = build_system(load_config(name))
    assert system.mass.sum() - system.mass[system.imaginary_arms].sum() == pytest.approx(CHRONO[name].mass, abs=1)
    assert vehicle.imaginary_wheels.mass == pytest.approx(CHRONO[name].gap, abs=0.1)
    assert (vehicle.seat.x, vehicle.seat.y) == CHRONO[name].driver


@pytest.mark.parametrize("name", CHRONO)
def test_published_vehicles_rest_on_chronos_torsion_bars(name):
    """The mean torque that holds the design pose is the bars' at the arms' turn from the assembly pose."""
    config, chrono = load_config(name), CHRONO[name]
    bare = config.replace({"vehicle.imaginary_suspension.preload_deflection": 0})
    system = build_system(bare)
    turn = np.radians(config.vehicle.road_arms.angle_deg - chrono.assembly)
    bar = chrono.preload - system.k_s[0] * turn
    assert system.tau_0[: system.n].mean() == pytest.approx(bar, abs=20)


@pytest.mark.parametrize("name", CHRONO)
def test_published_vehicles_bounce_as_at_rest(name):
    bounce = vehicle_modes(load_config(name)).bounce
    assert bounce is not None
    assert bounce.frequency == pytest.approx(CHRONO[name].bounce, abs=0.02)


def test_an_m113_at_rest_rides_harder_than_at_its_assembly_pose():
    """3.34 Hz instead of 2.87, twice the absorbed power on ground of class D at 30 km/h: of the hull alone."""
    found = []
    for changes in (HULL_ALONE, HULL_ALONE | ASSEMBLY):
        config = load_config("m113").replace(changes)
        bounce = vehicle_modes(config).bounce
        ground = {"road.type": "random", "road.roughness_class": "D", "drive.speed_kmh": 30}
        felt = Summary(simulate(config.replace(ground))).seat
        assert bounce is not None
        assert felt is not None
        found.append((bounce.frequency, felt.absorbed_power))
    (rest, rough), (assembly, smooth) = found
    assert rest == pytest.approx(3.34, abs=0.02)
    assert assembly == pytest.approx(2.87, abs=0.02)
    assert rough == pytest.approx(5.6, rel=0.1)
    assert smooth == pytest.approx(2.5, rel=0.2)
