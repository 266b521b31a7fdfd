"""Figures, on hand-made runs whose answers are known, and on the paper's."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from model import load_config, simulate
from model.analysis.ride import Summary, imaginary_share, suspension_travel
from model.analysis.signals import window
from model.analysis.wheel_contact import penetration
from model.road.road import build_road
from tests.model.analysis.support import RATE, standing, whats


def test_a_standing_vehicle():
    figures = Summary(standing())
    assert figures.names == ["R1", "R2", "R3", "R4", "R5", "R6", "I1", "I2", "I3", "I4", "I5"]
    assert (figures.load_min == 5000).all()
    assert (figures.load_mean == 5000).all()
    assert (figures.load_max == 5000).all()
    assert (figures.air_time == 0).all()
    assert (figures.acceleration_rms, figures.acceleration_peak, figures.drift) == (0, 0, 0)
    assert (figures.pitch_low, figures.pitch_high) == (0, 0)
    assert not figures.travel_down.any()
    assert not figures.travel_up.any()
    assert figures.imaginary_share == pytest.approx(5 / 11)
    assert figures.real_time_factor == pytest.approx(4 / RATE / 0.02)
    assert whats(standing()) == []


def test_loads_and_time_in_the_air():
    run = standing()
    run.normal_load[:, 2] = [0, 1000, 2000, 0, 7000]
    figures = Summary(run)
    assert (figures.load_min[2], figures.load_mean[2], figures.load_max[2]) == (0, 2000, 7000)
    assert figures.air_time[2] == pytest.approx(2 / RATE)
    assert figures.air_time[3] == 0


def test_share_of_imaginary_wheels_is_a_mean_over_time_and_leaves_jumps_out():
    run = standing(samples=3)
    run.normal_load[0, 6:] = 0  # none
    run.normal_load[1, :6] = 0  # all
    run.normal_load[2] = 0  # in the air
    assert imaginary_share(run.normal_load, 6) == pytest.approx(0.5)
    assert imaginary_share(0 * run.normal_load, 6) == 0
    assert imaginary_share(run.normal_load[:, :6], 6) == 0


def test_acceleration_is_the_hulls_vertical_one():
    run = standing(samples=4)
    run.a[:, 0, 1] = [3, -4, 0, 0]
    run.a[:, 0, 0] = 100
    run.a[:, 1:] = 100
    figures = Summary(run)
    assert figures.acceleration_rms == pytest.approx(2.5)
    assert figures.acceleration_peak == 4


def test_dynamic_load_coefficient_is_the_spread_of_the_load_over_that_at_rest():
    run = standing(samples=4)
    run.normal_load[:, 2] = [4000, 6000, 4000, 6000]
    run.normal_load[:, 3] = 8000
    run.static_load[7] = 0
    found = Summary(run).load_coefficient
    assert found[2] == pytest.approx(0.2)
    assert found[3] == 0
    assert np.isnan(found[7])


def test_pitch_and_drift():
    run = standing(samples=3)
    run.q[:, 0, 2] = [0, 0.1, -0.2]
    run.constraint_residual[:] = [0, 3e-6, 1e-6]
    figures = Summary(run)
    assert (figures.pitch_low, figures.pitch_high, figures.drift) == (-0.2, 0.1, 3e-6)


def test_travel_is_seen_from_the_hull():
    run = standing(samples=4)
    second = run.system.road_wheels.start + 1
    run.q[1, second, 1] += 0.05  # the wheel rises
    run.q[2, :, 1] += 0.3  # all rise together: no travel
    angle = 0.2  # all turn about the hull together: no travel
    turned = run.q[3, :, :2] - run.q[3, 0, :2]
    rotation = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    run.q[3, :, :2] = run.q[3, 0, :2] + turned @ rotation.T
    run.q[3, :, 2] = angle
    expected = np.zeros((4, 6))
    expected[1, 1] = 0.05
    np.testing.assert_allclose(suspension_travel(run), expected, atol=1e-12)
    figures = Summary(run)
    assert (figures.travel_up[1], figures.travel_down[1]) == (pytest.approx(0.05), pytest.approx(0))


def test_one_sample_is_enough():
    assert Summary(standing(samples=1)).acceleration_rms == 0
    assert whats(standing(samples=1)) == []


def test_the_papers_run():
    run = simulate(load_config("paper"))
    figures = Summary(run)
    assert figures.acceleration_rms == pytest.approx(0.66, abs=0.02)
    assert figures.imaginary_share == pytest.approx(0.15, abs=0.01)
    assert figures.load_min[0] == 0
    assert figures.load_max[0] == pytest.approx(19000, rel=0.02)
    contact = build_road(run.config).nearest(run.q[0, run.system.wheel, :2])[2]
    np.testing.assert_allclose(penetration(run)[0], run.system.r - contact)
    assert penetration(run)[0, :6].max() == pytest.approx(0.0127, abs=0.0008)
    assert whats(run) == []


def test_means_are_of_the_window_and_the_largest_values_of_the_whole_run():
    run = simulate(load_config("half_round").replace({"simulation.duration": 12}))
    figures, taken = Summary(run), window(run)
    counts = (run.t >= taken.start) & (run.t <= taken.end)
    assert 400 < counts.sum() < 700
    assert figures.window == taken
    assert figures.acceleration_rms == pytest.approx(np.sqrt(np.mean(run.a[counts, 0, 1] ** 2)))
    np.testing.assert_allclose(figures.load_mean, run.normal_load[counts].mean(axis=0))
    np.testing.assert_allclose(figures.load_rms, np.sqrt((run.normal_load[counts] ** 2).mean(axis=0)))
    np.testing.assert_allclose(figures.load_coefficient, run.normal_load[counts].std(axis=0) / run.static_load)
    assert figures.imaginary_share == imaginary_share(run.normal_load[counts], 6)
    np.testing.assert_array_equal(figures.load_max, run.peaks.load)
    assert figures.acceleration_peak == run.peaks.acceleration
    run.normal_load[-1], run.a[-1, 0, 1] = 1e6, -100
    at_samples = Summary(replace(run, tracked=None))
    assert (at_samples.load_max == 1e6).all()
    assert at_samples.acceleration_peak == 100
