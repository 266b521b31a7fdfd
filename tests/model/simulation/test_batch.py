"""Many runs at once."""

from __future__ import annotations

import numpy as np

from model import simulate, simulate_many
from model.dynamics.equilibrium import NoEquilibriumError
from model.simulation.trajectory import Trajectory
from tests.model.support import FLAT, PAPER, ROAD_SPRING, WHEELS


def loads(run: Trajectory) -> np.ndarray:
    return run.normal_load


def test_many_runs_are_those_of_one_at_a_time():
    speeds = [PAPER.replace({"drive.speed_kmh": speed, "simulation.duration": 1}) for speed in range(10, 40)]
    for config, found in zip(speeds, simulate_many(speeds, loads), strict=True):
        assert isinstance(found, np.ndarray)
        np.testing.assert_array_equal(found, simulate(config).normal_load)


def test_a_vehicle_that_cannot_rest_does_not_stop_the_others():
    tipping = FLAT.replace({f"{ROAD_SPRING}.stiffness": 5000.0, f"{WHEELS}.count": 6})
    found = list(simulate_many([FLAT, tipping, FLAT], lambda run: run.complete, workers=1))
    assert found[0] is found[2] is True
    assert isinstance(found[1], NoEquilibriumError)


def test_configurations_are_taken_as_they_are_needed():
    taken = 0

    def endless():
        nonlocal taken
        while True:
            taken += 1
            yield FLAT.replace({"simulation.duration": 0.1})

    found = simulate_many(endless(), lambda run: run.complete, workers=1)
    assert [next(found) for _ in range(3)] == [True] * 3
    assert taken < 12
    found.close()
