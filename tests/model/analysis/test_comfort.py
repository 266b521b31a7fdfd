"""Ride comfort against the standards' own figures, and against signals and motions whose answer is known."""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np
import pytest
import scipy.signal

from model import load_config, simulate
from model.analysis.comfort import (
    FOOT,
    POWER_LIMIT,
    W_D,
    W_K,
    absorption,
    filtered,
    reaction,
    ride_comfort,
    running_rms,
)
from model.analysis.signals import point_acceleration, seat, window
from tests.model.analysis.support import standing
from tests.model.support import FLAT, PAPER

# ISO 2631-1, table 3: gains × 1000 at the exact frequencies of third-octave bands, by their numbers (10 lg f).
GAINS = {
    "vertical": (W_K, {-10: 31.2, -7: 121, -4: 352, 0: 482, 3: 531, 6: 967, 7: 1039, 8: 1054, 9: 1036, 12: 768, 15: 405,
                       16: 314, 17: 246, 18: 186, 19: 132}),
    "along": (W_D, {-10: 62.4, -3: 853, 0: 1011, 3: 890, 6: 512, 9: 253, 12: 125, 15: 63.2, 18: 29.5}),
}  # fmt: skip


@pytest.mark.parametrize("direction", GAINS)
@pytest.mark.parametrize("rate", [200.0, 2000.0])
def test_sampled_sines_come_out_as_the_standard_weights_them(direction, rate):
    weighting, gains = GAINS[direction]
    t = np.arange(int(60 * rate)) / rate
    late = (t > 20) & (t < 50)
    for band, gain in gains.items():
        frequency = 10 ** (band / 10)
        found = filtered(np.sqrt(2) * np.sin(2 * np.pi * frequency * t), rate, weighting)[late]
        # the table's bands are rounded to their nominal frequencies: 3.98 Hz is called 4
        assert 1000 * np.sqrt(np.mean(found**2)) == pytest.approx(gain, rel=0.02), frequency


@pytest.mark.parametrize(
    ("frequency", "gain"), [(1, 482), (2, 531), (4, 967), (5, 1039), (6.3, 1054), (8, 1036), (16, 769), (80, 132)]
)
def test_gains_at_nominal_frequencies(frequency, gain):
    assert 1000 * abs(W_K(2j * np.pi * np.array([frequency]))[0]) == pytest.approx(gain, rel=0.01)
    t = np.arange(60 * 200) / 200
    found = filtered(np.sqrt(2) * np.sin(2 * np.pi * frequency * t), 200, W_K)[4000:10000]
    assert 1000 * np.sqrt(np.mean(found**2)) == pytest.approx(gain, rel=0.01)


@pytest.mark.parametrize(("rate", "within"), [(2000.0, 0.005), (200.0, 0.025)])
def test_bursts_of_iso_8041(rate, within):
    """Saw teeth of 100 rad/s that rise from zero, measured for 10 s."""
    t = np.arange(int(10 * rate)) / rate
    periods = 100 * t / (2 * np.pi)
    saw = 2 * ((periods + 0.5) % 1) - 1
    for count, expected in {1: 0.0299, 2: 0.0411, 4: 0.0577, 8: 0.0814, 16: 0.115, np.inf: 0.362}.items():
        weighted = filtered(np.where(periods < count, saw, 0), rate, W_K)
        assert np.sqrt(np.mean(weighted**2)) == pytest.approx(expected, rel=within)


@pytest.mark.parametrize(("frequency", "rms"), [(1, 8.5), (2, 3.8), (3, 2.25), (4.5, 1.64), (6, 1.95), (10, 3.4)])
def test_sines_of_which_six_watts_are_absorbed(frequency, rms):
    t = np.arange(4000) / 200
    output = filtered(np.sqrt(2) * rms / FOOT * np.sin(2 * np.pi * frequency * t), 200, absorption)
    assert np.mean(output[1000:3000] ** 2) == pytest.approx(POWER_LIMIT, rel=0.03)


def test_nothing_comes_before_its_cause_nor_back_round_the_end():
    pulse = np.zeros(400)
    pulse[200:220] = 1.0
    weighted = filtered(pulse, 2000, W_K)
    assert np.abs(weighted[:190]).max() < 1e-3 * np.abs(weighted).max()
    late = np.zeros(4000)
    late[-1] = 1.0
    assert np.abs(filtered(late, 2000, W_K)[:2000]).max() < 1e-4


def test_running_rms_of_a_signal_that_begins_and_ends():
    signal = np.zeros(1000)
    signal[300:350] = 2.0
    running = running_rms(signal, 100)
    assert running[299] == 0
    assert running[324] == pytest.approx(2 * np.sqrt(0.25))
    assert running.max() == running[349] == pytest.approx(2 * np.sqrt(0.5))
    assert running[460] == 0
    assert running_rms(np.full(20, 3.0), 100)[-1] == pytest.approx(3 * np.sqrt(0.2))  # shorter than a second


def shaken(frequency: float, amplitude: float, axis: int = 1, seconds: float = 40.0):
    """A run whose hull is shaken along an axis."""
    config = FLAT.replace({"simulation.duration": seconds})
    run = standing(config, samples=int(200 * seconds) + 1)
    run.a[:, 0, axis] = amplitude * np.sin(2 * np.pi * frequency * run.t)
    return run


def test_the_figures_of_a_sine():
    found = ride_comfort(shaken(5, 1.0))
    weighted = 1.039
    assert found.vertical == pytest.approx(weighted / np.sqrt(2), rel=0.01)
    assert found.fore_aft == 0
    assert found.crest_factor == pytest.approx(np.sqrt(2), rel=0.05)  # a little more when it begins
    assert found.dose == pytest.approx(weighted * (3 / 8 * 40) ** 0.25, rel=0.01)
    assert found.transient == pytest.approx(weighted / np.sqrt(2), rel=0.02)
    assert ride_comfort(shaken(4.5, np.sqrt(2) * 1.64)).absorbed_power == pytest.approx(6, rel=0.03)
    longer = ride_comfort(shaken(5, 1.0, seconds=80.0))
    assert longer.dose / found.dose == pytest.approx(2**0.25, rel=0.005)
    assert longer.vertical == pytest.approx(found.vertical, rel=0.005)


def test_a_jolt_counts_whichever_way_it_goes():
    up = shaken(5, 1.0)
    up.a[4000, 0, 1] += 30.0
    down = shaken(5, -1.0)
    down.a[4000, 0, 1] -= 30.0
    one, other = ride_comfort(up), ride_comfort(down)
    assert one.crest_factor > 3
    assert (other.crest_factor, other.shock) == (one.crest_factor, one.shock)


def test_both_directions_are_weighted_each_in_its_way_and_added():
    run = shaken(1, 1.0, axis=0)
    found = ride_comfort(run)
    assert (found.vertical, found.crest_factor, found.absorbed_power) == (0, None, 0)
    assert found.fore_aft == pytest.approx(1.011 / np.sqrt(2), rel=0.01)
    run.a[:, 0, 1] = run.a[:, 0, 0]
    both = ride_comfort(run)
    assert both.total == pytest.approx(np.hypot(0.482, 1.011) / np.sqrt(2), rel=0.01)
    assert both.reaction == "fairly uncomfortable"


@pytest.mark.parametrize(
    ("acceleration", "word"),
    [
        (0.0, "not uncomfortable"),
        (0.3149, "not uncomfortable"),
        (0.315, "a little uncomfortable"),
        (0.55, "fairly uncomfortable"),
        (0.8, "uncomfortable"),
        (1.5, "very uncomfortable"),
        (2.0, "extremely uncomfortable"),
        (50.0, "extremely uncomfortable"),
    ],
)
def test_words_of_the_standard(acceleration, word):
    assert reaction(acceleration) == word


def test_only_the_steady_part_counts_but_the_filter_knows_the_rest():
    run = simulate(PAPER)
    early = np.zeros_like(run.a)
    early[(run.t > 0.5) & (run.t < 1.5)] = 30.0
    quiet, disturbed = ride_comfort(run), ride_comfort(replace(run, a=run.a + early))
    assert quiet.window == window(run)
    assert quiet.window.start > 4
    assert disturbed.vertical == pytest.approx(quiet.vertical, rel=0.02)
    weighted = filtered(run.a[:, 0, 1], 200, W_K)[run.t >= quiet.window.start]
    assert quiet.vertical == np.sqrt(np.mean(weighted**2))


@pytest.mark.parametrize("point", [(0.0, 0.0), (1.5, 0.1), (-2.0, -0.6)])
def test_a_point_of_the_hull_moves_with_it_as_a_rigid_body(point):
    """Twice differentiated positions of the point, in a motion of large angles."""
    run = standing(FLAT, samples=2001)
    t, h = np.arange(2001) * 1e-3, 1e-3
    turn, along, up = 0.8 * np.sin(3 * t), 4 * t + 0.2 * np.cos(2 * t), 0.3 * np.sin(5 * t)
    for k, x in enumerate((along, up, turn)):
        run.q[:, 0, k] = x
        run.v[:, 0, k] = np.gradient(x, h, edge_order=2)
        run.a[:, 0, k] = np.gradient(run.v[:, 0, k], h, edge_order=2)
    x, y = point
    place = np.column_stack([along + np.cos(turn) * x - np.sin(turn) * y, up + np.sin(turn) * x + np.cos(turn) * y])
    expected = np.gradient(np.gradient(place, h, axis=0), h, axis=0)
    np.testing.assert_allclose(point_acceleration(run, point)[5:-5], expected[5:-5], atol=2e-3)


def test_the_driver_sits_where_the_configuration_says_and_feels_the_pitching():
    assert seat(PAPER) == (1.5, 0.1)
    assert seat(PAPER.replace({"vehicle.seat.x": -1, "vehicle.seat.y": 0.4})) == (-1, 0.4)
    run = simulate(load_config("paper"))
    assert ride_comfort(run, seat(run.config)).vertical > 2 * ride_comfort(run).vertical


def test_a_shock_is_the_largest_acceleration_behind_the_low_pass():
    """Sampled ten times as finely, with SciPy's filter."""
    rate, t = 2000, np.arange(20000) / 2000
    kick = 15 * np.exp(-(((t - 5.0012) / 0.02) ** 2)) * np.cos(120 * (t - 5))
    low_pass = scipy.signal.butter(2, 30, fs=rate)
    expected = np.abs(scipy.signal.lfilter(*low_pass, kick)).max() / 9.80665
    run = standing(FLAT, samples=2000)
    run.a[:, 0, 1] = kick[::10]
    assert ride_comfort(run).shock == pytest.approx(expected, rel=0.005)
    run.a[:, 0, 1] *= -1
    assert ride_comfort(run).shock == pytest.approx(expected, rel=0.005)


def test_a_shock_hardly_depends_on_the_sample_rate():
    config = load_config("half_round").replace({"drive.speed_kmh": 30})
    few, many = (
        ride_comfort(simulate(config.replace({"simulation.output_rate": rate})), seat(config)) for rate in (200, 2000)
    )
    assert few.shock == pytest.approx(many.shock, rel=0.01)
    assert few.dose == pytest.approx(many.dose, rel=0.005)


@pytest.mark.parametrize("rate", [10, 20, 100, 199])
def test_too_few_samples_have_no_comfort_rather_than_a_wrong_one(rate):
    rough = load_config("random_road").replace({"drive.speed_kmh": 25, "road.roughness_class": "D"})
    assert ride_comfort(simulate(rough.replace({"simulation.output_rate": rate}))) is None
    assert ride_comfort(simulate(rough.replace({"simulation.output_rate": 200}))) is not None


def test_a_run_of_one_sample_has_figures():
    assert ride_comfort(standing(samples=1)).total == 0


def test_the_figures_are_quick_enough_for_every_run():
    run = simulate(PAPER)

    def seconds() -> float:
        began = time.process_time()
        ride_comfort(run, (1.5, 0.1))
        return time.process_time() - began

    assert min(seconds() for _ in range(5)) < 0.02
