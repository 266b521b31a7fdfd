"""Known optima and fronts are found; those of a vehicle keep their bounds."""

from __future__ import annotations

import numpy as np
import pytest

from model import load_config
from model.study.design import DesignError, Range, design
from model.study.optimum import Bound, best_of, front, least, on_road, optimise, parse_bound
from model.study.running import Outcome
from tests.model.support import PAPER

SPEED, AMPLITUDE = Range("drive.speed_kmh", 5, 45), Range("road.amplitude", 0.0, 0.2)


def test_the_least_of_a_crooked_valley_is_found():
    def rosenbrock(points: np.ndarray) -> np.ndarray:
        x, y = 4 * points.T - 2
        return (1 - x) ** 2 + 100 * (y - x**2) ** 2

    start = design("latin-hypercube", 16, 2, 1)
    found = least(rosenbrock, start, 60, np.random.default_rng(1))
    np.testing.assert_allclose(4 * found - 2, 1, atol=0.02)


def test_the_front_of_two_goals_is_found_and_none_of_it_is_better_than_another():
    def zdt1(points: np.ndarray) -> np.ndarray:
        g = 1 + 9 * points[:, 1:].mean(axis=1)
        return np.array([points[:, 0], g * (1 - np.sqrt(points[:, 0] / g))]).T

    points = front(zdt1, design("latin-hypercube", 24, 3, 1), 40, np.random.default_rng(1))
    values = zdt1(points)
    values = values[best_of(values)]
    assert len(values) > 15
    np.testing.assert_allclose(values[:, 1], 1 - np.sqrt(values[:, 0]), atol=0.05)
    assert not ((values[:, None] < values).all(axis=2)).any()
    assert np.diff(np.sort(values[:, 0])).max() < 0.25


def test_best_of_leaves_out_what_is_worse_or_twice():
    values = np.array([[1, 3], [2, 2], [3, 1], [2, 3], [1, 3], [2.5, 2]])
    assert best_of(values).tolist() == [0, 1, 2]


def made_up(jobs):
    """A vehicle whose shock is least at 20 km/h, and whose peak load falls with speed; it cannot stand beyond 40."""
    found = []
    for base, changes, figures in jobs:
        speed = changes.get("drive.speed_kmh", base.drive.speed_kmh)
        worse = 2.0 if base.road.type == "flat" else 1.0
        known = {"shock": worse * (1 + (speed - 20) ** 2), "peak_load": 100 - speed}
        if speed <= 40:
            found.append(Outcome("complete", tuple(known[figure] for figure in figures)))
        else:
            found.append(Outcome("no rest pose: no", (None,) * len(figures)))
    return found


def test_bounds_are_kept_and_what_cannot_run_is_left_out():
    found = optimise([PAPER], [SPEED], ("shock",), [Bound("peak_load", 75)], generations=15, evaluate=made_up)
    assert found.front[0].changes["drive.speed_kmh"] == pytest.approx(25, abs=0.05)
    assert found.front[0].bounded[0] <= 75
    assert found.before is not None
    assert found.before.goals == (26.0,)
    two = optimise([PAPER], [SPEED], ("shock", "peak_load"), generations=15, evaluate=made_up)
    speeds = [solution.changes["drive.speed_kmh"] for solution in two.front]
    assert min(speeds) == pytest.approx(20, abs=0.5)
    assert max(speeds) == pytest.approx(40, abs=0.5)
    goals = np.array([solution.goals for solution in two.front])
    assert (np.diff(goals, axis=0) * [1, -1] > 0).all()


@pytest.mark.parametrize(("mean", "shock"), [(False, 2.0), (True, 1.5)])
def test_of_several_roads_the_worst_or_the_mean_counts(mean, shock):
    bases = [PAPER, PAPER.replace({"road.type": "flat"})]
    found = optimise(bases, [SPEED], ("shock",), mean=mean, generations=15, evaluate=made_up)
    assert found.front[0].goals[0] == pytest.approx(shock, abs=0.01)


def test_what_cannot_be_kept_is_said():
    with pytest.raises(DesignError, match=r"no point can be run and keeps the bounds \(such as: no rest pose"):
        optimise([PAPER], [SPEED], ("shock",), [Bound("peak_load", 10)], generations=1, evaluate=made_up)


def test_a_vehicle_is_calmest_when_it_is_slow():
    base = PAPER.replace({"simulation.duration": 2})
    found = optimise([base], [SPEED, AMPLITUDE], ("acceleration_peak",), generations=2)
    assert found.front[0].goals[0] < 0.5 * found.before.goals[0]


def test_bounds_are_read():
    assert parse_bound(" peak_load.R1 <= 3.5e1", PAPER) == Bound("peak_load.R1", 35.0)
    for text in ("peak_load", "peak_load<35", "peak_load<=x", "peak<=3"):
        with pytest.raises(DesignError):
            parse_bound(text, PAPER)


@pytest.mark.parametrize("road", ["half_round", "obstacles", "random_road", "kerb"])
def test_a_vehicle_is_put_on_the_road_of_another(road):
    other = load_config(road)
    assert on_road(PAPER, other).road == other.road
    assert on_road(PAPER, other).vehicle == PAPER.vehicle
