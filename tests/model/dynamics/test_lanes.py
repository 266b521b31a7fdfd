"""The layout in lanes, at every edge of a block."""

from __future__ import annotations

import numpy as np
import pytest

from model.dynamics import equations
from model.dynamics.lanes import INT_E, LANES, WORK, coordinates, pack, places, state_size
from model.dynamics.vehicle import build_system
from model.road.road import build_road
from model.simulation.integrate import Integration
from model.simulation.simulate import starting_state
from tests.model.dynamics.test_kernel import AGREEMENT, kernel_rates, worst_difference
from tests.model.support import PAPER, WHEELS, random_state

SIZES = (2, 3, 4, 5, LANES, LANES + 1, 2 * LANES, 2 * LANES + 1, 20)


def vehicle(wheels: int, imaginary: bool = True):
    return PAPER.replace(
        {
            f"{WHEELS}.count": wheels,
            f"{WHEELS}.spacing": 3.5 / (wheels - 1),
            "vehicle.imaginary_wheels.enabled": imaginary,
        }
    )


@pytest.mark.parametrize("wheels", SIZES)
@pytest.mark.parametrize("imaginary", [True, False])
def test_each_number_of_the_state_has_a_place_of_its_own(wheels, imaginary):
    system = build_system(vehicle(wheels, imaginary))
    place = coordinates(system)
    assert len(place) == 6 * len(system.mass) + len(system.wheel) + 1
    assert len(np.unique(place)) == len(place)
    assert (place >= 0).all()
    assert (place < state_size(system.n)).all()
    body, xi = places(system.n, system.m)
    assert INT_E not in body
    assert INT_E not in xi


@pytest.mark.parametrize("wheels", SIZES)
@pytest.mark.parametrize("imaginary", [True, False])
def test_agrees_with_the_equations_at_every_size(wheels, imaginary):
    config = vehicle(wheels, imaginary)
    system, road = build_system(config), build_road(config)
    rng = np.random.default_rng(wheels)
    for _ in range(4):
        t, state = random_state(system, rng)
        differences = worst_difference(kernel_rates(system, road, t, state), equations.rates(system, road, t, state))
        assert max(differences.values()) <= AGREEMENT, differences


@pytest.mark.parametrize("wheels", [3, LANES + 1])
def test_empty_lanes_stay_empty_and_change_nothing(wheels):
    """Far along the road, where a wheel at the origin would have something to be pulled by."""
    config = vehicle(wheels).replace({"simulation.duration": 2})
    system, road = build_system(config), build_road(config)
    y, _ = starting_state(system)
    run = Integration(system, road.table, y, 2.0, 100.0)
    run.advance(2.0)
    empty = np.ones(len(run.y), dtype=bool)
    empty[[*coordinates(system), WORK]] = False
    assert empty.any()
    assert (run.y[empty] == 0.0).all()


def test_what_is_packed_stands_where_it_belongs():
    system = build_system(PAPER)
    _, state = random_state(system, np.random.default_rng(0))
    y = pack(system, *state)
    body, xi = places(system.n, system.m)
    np.testing.assert_array_equal(y[body], np.hstack([state.q, state.v]))
    np.testing.assert_array_equal(y[xi], state.xi)
    assert y[INT_E] == state.int_e
