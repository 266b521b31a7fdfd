"""What the paper's vehicle does, and the paper's two observations (model/MODEL.md, "What this vehicle does")."""

from __future__ import annotations

import numpy as np
import pytest

from model import Trajectory, simulate
from model.dynamics import kernel
from model.dynamics.lanes import coordinates, in_lanes, make_work
from model.dynamics.vehicle import build_system
from model.road.road import build_road
from model.simulation.simulate import starting_state
from tests.model.support import FLAT, IMAGINARY, PAPER


def steady(run: Trajectory) -> slice:
    """The samples after the vehicle has come onto the full waves: the last four periods."""
    return slice(-round(4 * 7.0 / (15 / 3.6) * 200), None)


@pytest.fixture(scope="module")
def run() -> Trajectory:
    return simulate(PAPER.replace({"simulation.duration": 15}))


def test_the_hull_is_shaken_at_the_rate_of_the_waves(run):
    a = run.a[steady(run), 0, 1]
    spectrum = np.abs(np.fft.rfft(a - a.mean()))
    frequency = np.fft.rfftfreq(len(a), 1 / 200)
    assert frequency[spectrum.argmax()] == pytest.approx(15 / 3.6 / 7.0, abs=0.05)
    assert np.sqrt((a**2).mean()) == pytest.approx(0.66, abs=0.01)


def test_the_first_road_wheel_swings_from_the_air_to_twice_its_load(run):
    assert run.normal_load[:, 0].min() == 0.0
    assert run.normal_load[:, 0].max() == pytest.approx(19e3, rel=0.03)


def test_the_speed_is_kept(run):
    assert np.abs(run.v[:, 0, 0] - 15 / 3.6).max() < 0.25


def test_natural_frequencies_and_stiffest_eigenvalue():
    """Eigenvalues of the motion on flat ground about rest, from differences of the right-hand side."""
    system, table = build_system(FLAT), build_road(FLAT).table
    system = system._replace(v_ref=0.0)
    y, _ = starting_state(system)
    lanes, work, place = in_lanes(system), make_work(system), coordinates(system)

    def rates(change: np.ndarray) -> np.ndarray:
        near, dy = y.copy(), np.empty_like(y)
        near[place] += change
        kernel.rates(lanes, table, 0.0, near, dy, work)
        return dy[place]

    step = 1e-6 * np.eye(len(place))
    matrix = np.column_stack([(rates(d) - rates(-d)) / 2e-6 for d in step])
    values = np.linalg.eigvals(matrix)
    # Two oscillate slowly: pitch and bounce. Baumgarte's own, at −20 1/s, do not.
    oscillating = values[(values.imag > 3.0) & (values.imag < 30.0) & (values.real > -9.0)]
    frequency, damping = np.abs(oscillating) / (2 * np.pi), -oscillating.real / np.abs(oscillating)
    order = np.argsort(frequency)
    assert frequency[order] == pytest.approx([1.04, 1.55], abs=0.005)
    assert damping[order] == pytest.approx([0.34, 0.55], abs=0.005)
    assert values.real.min() == pytest.approx(-353, rel=0.005)


def test_stiffer_imaginary_springs_take_load_but_leave_the_ride_alone():
    """Their share of the load grows, the rms acceleration does not, until about ×3."""
    shares, accelerations = [], []
    for factor in (0.1, 0.5, 1, 2, 3, 5):
        run = simulate(PAPER.replace({f"{IMAGINARY}.stiffness": 1e4 * factor, "simulation.duration": 15}))
        load = run.normal_load[steady(run)]
        shares.append(load[:, 6:].mean(axis=0).sum() / load.mean(axis=0).sum())
        accelerations.append(np.sqrt((run.a[steady(run), 0, 1] ** 2).mean()))
    np.testing.assert_allclose(shares, [0.07, 0.11, 0.15, 0.23, 0.32, 0.47], atol=0.01)
    np.testing.assert_allclose(accelerations, [0.648, 0.648, 0.649, 0.660, 0.680, 0.768], atol=0.015)
