"""Spectra of signals whose answer is known, and of the paper's run."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy.signal

from model import load_config, simulate
from model.analysis.signals import seat, window
from model.analysis.spectrum import (
    acceleration_density,
    acceleration_spectrum,
    amplitude_spectrum,
    excitation,
    power_spectral_density,
)
from tests.model.support import FLAT, PAPER


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
    assert excitation(paper_run.config) == pytest.approx(0.595, abs=0.001)
    steady = paper_run.a[paper_run.t >= window(paper_run).start, 0, 1]
    assert height.max() / np.sqrt(2) == pytest.approx(np.sqrt(np.mean(steady**2)), rel=0.05)


def test_only_the_steady_part_counts(paper_run):
    before = paper_run.t < window(paper_run).start
    disturbed = replace(paper_run, a=paper_run.a + 50 * before[:, None, None] * np.sin(40 * paper_run.t)[:, None, None])
    np.testing.assert_array_equal(acceleration_spectrum(disturbed)[1], acceleration_spectrum(paper_run)[1])


@pytest.mark.parametrize(("length", "segment"), [(4000, 1000), (1700, 1000), (873, 873), (41, 41)])
def test_power_density_is_welchs(length, segment):
    signal = 3 + np.random.default_rng(1).normal(size=length).cumsum()
    frequency, density = power_spectral_density(signal, 200)
    points = 2 * (len(frequency) - 1)
    expected = scipy.signal.welch(signal, 200, "hann", segment, noverlap=segment - segment // 2, nfft=points)
    np.testing.assert_allclose(frequency, expected[0])
    np.testing.assert_allclose(density, expected[1], rtol=1e-9, atol=1e-12 * density.max())


def test_the_area_under_the_density_is_the_variance():
    noise = np.random.default_rng(2).normal(0, 1.5, 20000)
    frequency, density = power_spectral_density(noise + 7, 200)
    assert np.trapezoid(density, frequency) == pytest.approx(1.5**2, rel=0.03)
    assert density[(frequency > 20) & (frequency < 80)].mean() == pytest.approx(1.5**2 / 100, rel=0.05)


def test_both_spectra_are_of_the_point_that_is_asked_for(paper_run):
    point = seat(paper_run.config)
    for spectrum in (acceleration_spectrum, acceleration_density):
        frequency, height = spectrum(paper_run, point)
        assert frequency[height.argmax()] == pytest.approx(0.6, abs=0.02)
        assert height.max() > 1.5 * spectrum(paper_run)[1].max()


@pytest.mark.parametrize("length", [1, 2, 3])
def test_runs_of_a_few_samples_have_a_power_density_too(length):
    assert np.allclose(power_spectral_density(np.ones(length), 200)[1], 0)


def test_a_road_without_waves_has_no_excitation():
    assert excitation(FLAT) is None
    assert excitation(PAPER.replace({"road.amplitude": 0})) is None
    assert excitation(PAPER.replace({"drive.speed_kmh": 36, "road.wavelength": 4})) == pytest.approx(2.5)
