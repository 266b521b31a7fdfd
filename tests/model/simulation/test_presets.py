"""The vehicles that come with the program: they stand level, carry their weight and drive the paper's road."""

from __future__ import annotations

import numpy as np
import pytest

from model import load_config, simulate
from model.dynamics.equilibrium import rest_pose
from model.dynamics.vehicle import build_system

VEHICLES = {"paper": 6, "paper_0583": 6, "m113": 5, "m113_rs": 5, "marder": 6, "robot": 4}
HEAVE = {"m113": 2.8, "m113_rs": 3.4, "marder": 2.5}  # Hz, of the sprung hull on its published springs alone


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


@pytest.mark.parametrize("name", HEAVE)
def test_springs_give_the_published_heave_frequency(name):
    system = build_system(load_config(name))
    lever = (system.u_i[: system.n, 0] - system.q_design[1 + system.n : 1 + 2 * system.n, 0]) + system.q_design[0, 0]
    stiffness = (system.k_s[: system.n] / lever**2).sum()
    assert np.sqrt(stiffness / system.mass[0]) / (2 * np.pi) == pytest.approx(HEAVE[name], rel=0.12)
