"""Sensitivity of functions whose indices are known, and of a vehicle."""

from __future__ import annotations

import numpy as np
import pytest

from model.study.design import DesignError, Range
from model.study.sensitivity import morris, sensitivity, sobol
from tests.model.support import PAPER

A, B = 7.0, 0.1
PI = np.pi


def ishigami(points: np.ndarray) -> np.ndarray:
    """sin x₁ + A sin² x₂ + B x₃⁴ sin x₁, each x from −π to π."""
    x = PI * (2 * points.T - 1)
    return (np.sin(x[0]) + A * np.sin(x[1]) ** 2 + B * x[2] ** 4 * np.sin(x[0]))[None]


def test_indices_of_the_ishigami_function_lie_within_their_bounds():
    parts = np.array([(1 + B * PI**4 / 5) ** 2 / 2, A**2 / 8, 0.0])
    both = B**2 * PI**8 * (1 / 18 - 1 / 50)
    first, total = parts / (parts.sum() + both), (parts + np.array([both, 0, both])) / (parts.sum() + both)
    found = sobol(ishigami, 3, 1024, seed=1)
    np.testing.assert_allclose(found.first, [first], atol=0.05)
    np.testing.assert_allclose(found.total, [total], atol=0.05)
    assert (found.first_low <= first).all()
    assert (found.first_high >= first).all()
    assert (found.total_low <= total).all()
    assert (found.total_high >= total).all()


def test_indices_and_their_bounds_are_the_same_for_the_same_seed():
    first, again, other = (sobol(ishigami, 3, 16, seed) for seed in (1, 1, 2))
    for name in vars(first):
        np.testing.assert_array_equal(getattr(first, name), getattr(again, name), err_msg=name)
        assert not np.array_equal(getattr(first, name), getattr(other, name)), name


def test_a_figure_that_nothing_changes_has_no_shares():
    found = sobol(lambda points: np.stack([points[:, 0], 0 * points[:, 0]]), 2, 16, seed=1)
    np.testing.assert_array_equal(found.total[1], 0)
    np.testing.assert_array_equal([found.first[1], found.total_low[1], found.total_high[1]], 0)


def test_the_screening_finds_slopes_and_what_depends_on_others():
    def function(points: np.ndarray) -> np.ndarray:
        x, y, z = points.T
        return np.array([3 * x - 2 * y, x * y + 0 * z])

    found = morris(function, 3, 20, seed=1)
    np.testing.assert_allclose(found.mean[0], [3, -2, 0], atol=1e-12)
    np.testing.assert_allclose(found.strength[0], [3, 2, 0], atol=1e-12)
    np.testing.assert_allclose(found.spread[0], 0, atol=1e-12)
    assert found.spread[1, 0] > 0.2
    assert found.strength[1, 2] == 0


def test_trajectories_stay_within_the_ranges():
    seen = []
    morris(lambda points: seen.append(points) or points.T[:1], 5, 50, seed=2)
    assert seen[0].min() == 0
    assert seen[0].max() == pytest.approx(1)
    assert np.isin(np.round(3 * seen[0]), (0, 1, 2, 3)).all()


def test_a_vehicle_feels_its_speed_more_than_its_friction():
    over = [Range("drive.speed_kmh", 10, 20), Range("contact.friction", 0.6, 0.8)]
    base = PAPER.replace({"simulation.duration": 3})
    found = sensitivity(base, over, ("absorbed_power", "peak_load"), trajectories=3, samples=4)
    assert found.runs == 3 * 3 + 4 * 4
    assert (found.indices.total[:, 0] > 10 * found.indices.total[:, 1]).all()
    assert (found.screening.mean[:, 0] > 0).all()


def test_too_many_runs_that_come_to_grief_are_no_result():
    over = [Range("vehicle.road_suspension.stiffness", 100, 5e4), Range("drive.speed_kmh", 10, 20)]
    with pytest.raises(DesignError, match=r"^incomplete: \d+ of \d+ runs, such as: no rest pose: .*narrower ranges"):
        sensitivity(PAPER.replace({"simulation.duration": 1}), over, ("shock",), trajectories=2, samples=2)
    with pytest.raises(DesignError, match="two keys or more"):
        sensitivity(PAPER, over[:1], ("shock",))
