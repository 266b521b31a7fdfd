"""Spectra of signals whose answer is known, and the modes of the vehicle against other ways to find them."""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np
import pytest

from model import load_config, simulate
from model.equilibrium import rest_pose
from model.kernel import make_work, pack, rates
from model.road import build_road
from model.spectrum import acceleration_spectrum, amplitude_spectrum, marks, steady_from
from model.vehicle import build_system
from tests.model.support import FLAT, OPTIONS, PAPER


@pytest.fixture(scope="module")
def paper_run():
    return simulate(load_config("paper"))


@pytest.mark.parametrize(("frequency", "length"), [(0.6, 1051), (3.0, 2000), (7.77, 801), (40.0, 333)])
def test_a_sine_shows_its_amplitude_at_its_frequency(frequency, length):
    rate, amplitude = 200.0, 3.5
    t = np.arange(length) / rate
    found, height = amplitude_spectrum(12 + amplitude * np.sin(2 * np.pi * frequency * t + 0.7), rate)
    assert height.max() == pytest.approx(amplitude, rel=0.01)
    assert found[height.argmax()] == pytest.approx(frequency, abs=0.1 * rate / length + 1e-3)
    assert height[0] < 1e-9  # the mean is not shown
    assert found[-1] == rate / 2


def test_two_sines_are_told_apart():
    t = np.arange(2000) / 200
    found, height = amplitude_spectrum(np.sin(2 * np.pi * t) + 0.2 * np.cos(2 * np.pi * 1.5 * t), 200)
    peaks = np.flatnonzero((height[1:-1] > height[:-2]) & (height[1:-1] > height[2:]) & (height[1:-1] > 0.1)) + 1
    assert found[peaks] == pytest.approx([1.0, 1.5], abs=0.03)
    assert height[peaks] == pytest.approx([1.0, 0.2], rel=0.05)


@pytest.mark.parametrize("length", [1, 2, 3])
def test_runs_of_a_few_samples_have_a_spectrum_too(length):
    found, height = amplitude_spectrum(np.ones(length), 200)
    assert len(found) == len(height)
    assert np.allclose(height, 0)


def test_the_papers_spectrum_peaks_where_its_waves_are_met(paper_run):
    found, height = acceleration_spectrum(paper_run)
    assert found[height.argmax()] == pytest.approx(0.6, abs=0.01)
    assert marks(paper_run.config).excitation == pytest.approx(0.595, abs=0.001)
    steady = paper_run.a[paper_run.t >= steady_from(paper_run), 0, 1]
    assert height.max() / np.sqrt(2) == pytest.approx(np.sqrt(np.mean(steady**2)), rel=0.05)


def test_only_the_steady_part_counts(paper_run):
    before = paper_run.t < steady_from(paper_run)
    disturbed = replace(paper_run, a=paper_run.a + 50 * before[:, None, None] * np.sin(40 * paper_run.t)[:, None, None])
    np.testing.assert_array_equal(acceleration_spectrum(disturbed)[1], acceleration_spectrum(paper_run)[1])


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({}, (2.75 + 7 + 1.75) / (15 / 3.6) + 2),
        ({"road.ramp": 0, "road.start": 3}, (3 + 1.75) / (15 / 3.6) + 2),
        ({"road.start": 100}, 5.0),  # half the run at most
        ({"road.type": "flat"}, 0.0),
        ({"road.type": "half_round"}, 0.0),
    ],
)
def test_when_the_steady_part_begins(paper_run, changes, expected):
    assert steady_from(replace(paper_run, config=PAPER.replace(changes))) == pytest.approx(expected)


def test_bounce_and_pitch_of_the_papers_vehicle():
    found = marks(PAPER)
    assert found.bounce.frequency == pytest.approx(1.57, rel=0.02)
    assert found.bounce.damping_ratio == pytest.approx(0.5, abs=0.05)
    assert found.pitch.frequency == pytest.approx(1.04, rel=0.01)
    assert found.pitch.damping_ratio == pytest.approx(0.3, abs=0.05)
    assert found.fastest_decay == pytest.approx(-350, rel=0.02)


@pytest.mark.parametrize("option", sorted(set(OPTIONS) - {"twenty wheels"}))
def test_the_modes_are_among_those_of_the_whole_state(option):
    """All q and v perturbed one by one, joints and all: Baumgarte adds eigenvalues but moves none."""
    config = PAPER.replace(OPTIONS[option])
    found = marks(config)
    system = build_system(config)._replace(v_ref=0.0)
    road = build_road(config.replace({"road.type": "flat"})).table
    q, _ = rest_pose(system)
    rest, work = pack(q, np.zeros_like(q), np.zeros(len(system.wheel)), 0.0), make_work(system)

    def rate(state):
        change = np.empty_like(state)
        rates(system, road, 0.0, state, change, work)
        return change

    nudges = 1e-6 * np.eye(len(rest))
    eigenvalues = np.linalg.eigvals(np.column_stack([(rate(rest + e) - rate(rest - e)) / 2e-6 for e in nudges]))
    assert found.fastest_decay == pytest.approx(eigenvalues.real.min(), rel=1e-4)
    for mode in (found.bounce, found.pitch):
        omega, zeta = 2 * np.pi * mode.frequency, mode.damping_ratio
        assert np.abs(eigenvalues - omega * complex(-zeta, np.sqrt(1 - zeta**2))).min() < 1e-4 * omega


def test_bounce_of_a_hull_on_springs():
    """With light wheels on hard ground and level arms, all there is is a mass on n springs and dampers."""
    changes = {
        "vehicle.imaginary_wheels.enabled": False,
        "vehicle.road_wheels.mass": 0.5,
        "vehicle.road_arms.mass": 0.5,
        "vehicle.road_arms.angle_deg": 0.0,
        "vehicle.road_suspension.damping": 1000.0,
        "contact.normal_stiffness": 1e10,
    }
    bounce = marks(PAPER.replace(changes)).bounce
    omega = np.sqrt(6 * 75530 / 5125)
    assert bounce.frequency == pytest.approx(omega / (2 * np.pi), rel=0.01)
    assert bounce.damping_ratio == pytest.approx(6 * 1000 / (2 * 5125 * omega), rel=0.02)


def test_pitch_is_the_one_that_slows_with_the_pitch_inertia():
    before, after = marks(PAPER), marks(PAPER.replace({"vehicle.chassis.pitch_inertia": 4 * 14630}))
    assert after.pitch.frequency == pytest.approx(before.pitch.frequency / 2, rel=0.1)
    assert after.bounce.frequency == pytest.approx(before.bounce.frequency, rel=0.05)


def test_what_does_not_swing_is_not_marked():
    stiffly_damped = {
        "vehicle.imaginary_wheels.enabled": False,
        "vehicle.road_suspension.damping": 30000.0,
        "contact.normal_damping": 1e10,
    }
    found = marks(PAPER.replace(stiffly_damped))
    assert found.bounce is None
    assert found.pitch is None


def test_a_road_without_waves_has_no_excitation():
    assert marks(FLAT).excitation is None
    assert marks(PAPER.replace({"road.amplitude": 0})).excitation is None
    faster = marks(PAPER.replace({"drive.speed_kmh": 36, "road.wavelength": 4}))
    assert faster.excitation == pytest.approx(2.5)
    assert faster.bounce == marks(FLAT).bounce  # the modes are the vehicle's alone


def test_the_marks_are_quick_enough_for_every_settled_run():
    def seconds() -> float:
        began = time.perf_counter()
        marks(PAPER)
        return time.perf_counter() - began

    assert min(seconds() for _ in range(5)) < 0.1
