"""The drive at its limit: the rate of ∫e jumps there, and where it would chatter it is held."""

import numpy as np
import pytest

from model.config.config import Config
from model.dynamics.lanes import INT_E
from model.dynamics.vehicle import build_system
from model.road.road import build_road
from model.simulation.integrate import Integration
from model.simulation.simulate import starting_state

LIMIT = {"drive.force_limit": 300, "simulation.duration": 3}
TRIM = {"drive.integral_gain": 1e5}  # so strong that the demand stays at the limit for a while
EXACT = {"simulation.rtol": 1e-9, "simulation.atol": 1e-11}


def driven(changes):
    """The run of the paper's vehicle with these changes, and each millisecond: ∫e, and which way the drive is held."""
    config = Config().replace({**LIMIT, **changes})
    system, road = build_system(config), build_road(config)
    run = Integration.of(config.simulation, system, road.table, starting_state(system)[0], config.simulation.duration)
    found = []
    while run.t < run.duration:
        run.advance(run.t + 1e-3)
        found.append((run.y[INT_E], run._work.held[0]))
    return run, np.array(found)


def test_the_integral_is_exact_where_the_drive_comes_to_its_limit_and_off_it():
    run, _ = driven({})
    right, _ = driven(EXACT)
    limited = np.abs(run.samples.F) == run.system.F_max
    assert np.abs(np.diff(limited.astype(int))).sum() == 3
    assert run.y[INT_E] == pytest.approx(right.y[INT_E], abs=1e-7)
    assert np.abs(run.samples.F - right.samples.F).max() < 0.1


def test_the_drive_that_is_held_moves_as_one_that_chatters_in_tiny_steps():
    held, found = driven({**TRIM, **EXACT})
    chattering, never = driven({**TRIM, "simulation.integrator": "rk4", "simulation.step": 1e-4})
    assert found[:, 1].any()
    assert not never[:, 1].any()
    assert held.y[INT_E] == pytest.approx(chattering.y[INT_E], abs=1e-7)
    assert np.abs(held.samples.F - chattering.samples.F).max() < 0.1
