"""A fit finds what a record was made with."""

from __future__ import annotations

import numpy as np
import pytest

from model import simulate
from model.study.design import DesignError, Range
from model.study.fit import G, fit, fit_runs, read_record
from tests.model.support import PAPER

BASE = PAPER.replace({"simulation.duration": 4, "drive.speed_kmh": 25})
DAMPING, STIFFNESS = "vehicle.road_suspension.damping", "vehicle.road_suspension.stiffness"
OVER = [Range(DAMPING, 2000, 20000), Range(STIFFNESS, 50000, 120000)]
TRUE = {DAMPING: 7000.0, STIFFNESS: 80000.0}
LAG, OFFSET, NOISE = 3.217, 0.15, 0.3  # s, m/s², m/s²


def runs(changes):
    """An oscillation of a rate and a damping, as quick as can be."""
    t = np.arange(0, 6, 0.01)
    found = []
    for change in changes:
        rate, damping = change.get(DAMPING, 5000.0) / 1000, change.get(STIFFNESS, 60000.0) / 1e5
        found.append((t, np.where(t > 0.5, 3 * np.exp(-damping * (t - 0.5)) * np.sin(rate * (t - 0.5)), 0.0)))
    return found


def test_intervals_hold_the_truth_in_most_noise_draws():
    ((t, a),) = runs([TRUE])
    hit = dict.fromkeys((DAMPING, STIFFNESS, "lag", "offset"), 0)
    for draw in range(20):
        noise = np.random.default_rng(draw).normal(0, NOISE, len(t))
        found = fit_runs(runs, (t + LAG, a + OFFSET + noise), OVER, seed=draw)
        known = {**dict(zip(found.keys, found.estimates, strict=True)), "lag": found.lag, "offset": found.offset}
        for name, truth in {**TRUE, "lag": LAG, "offset": OFFSET}.items():
            hit[name] += known[name].low <= truth <= known[name].high
            assert known[name].high - known[name].low < (0.3 * truth if truth > 1 else 0.2)
        assert found.rms == pytest.approx(NOISE, rel=0.1)
    assert min(hit.values()) >= 18, hit


def test_a_run_that_is_not_right_yet_lies_on_the_event_not_its_quiet_end_over_it():
    def thrice(changes):
        return [(np.arange(0, 20, 0.01), np.pad(3 * a, (0, 1400))) for _, a in runs(changes)]

    ((t, a),) = runs([TRUE])
    found = fit_runs(thrice, (t + LAG, a), OVER)
    assert abs(found.lag.value - LAG) < 0.2
    assert found.explained < 0  # three times as large it is worse than no motion, and that is told


def test_run_and_record_of_other_rates_are_compared_in_the_band_of_both():
    ((t, a),) = runs([TRUE])
    fine = np.arange(0, 5.9, 0.002)
    noise = np.random.default_rng(5).normal(0, NOISE, len(fine))
    found = fit_runs(runs, (fine + LAG, np.interp(fine, t, a) + noise), OVER)
    assert found.low_pass == pytest.approx(40)
    assert found.rms < 0.6 * NOISE
    for key, estimate in zip(found.keys, found.estimates, strict=True):
        assert estimate.low < TRUE[key] < estimate.high
    assert fit_runs(runs, (t, a), OVER, low_pass=10).low_pass == 10


def test_a_record_that_no_run_resembles_is_refused():
    with pytest.raises(DesignError, match="no run resembles the record"):
        fit_runs(lambda changes: [(t, 0 * t) for _ in changes], (t := np.arange(0, 4, 0.01), np.sin(t)), OVER)


def test_a_vehicle_is_found_in_its_record():
    run = simulate(BASE.replace(TRUE))
    noise = np.random.default_rng(3).normal(0, NOISE, len(run.t))
    found = fit(BASE, (run.t + LAG, run.a[:, 0, 1] + OFFSET + noise), OVER)
    for key, estimate in zip(found.keys, found.estimates, strict=True):
        assert estimate.low < TRUE[key] < estimate.high
        assert estimate.high - estimate.low < 0.4 * TRUE[key]
    assert found.lag.low < LAG < found.lag.high
    assert found.offset.low < OFFSET < found.offset.high
    assert found.rms < found.rms_before
    assert not any(found.at_end)
    assert len(found.t) == len(found.fitted) > 600


def test_what_is_left_and_no_noise_makes_intervals_wider():
    ((t, a),) = runs([TRUE])
    drifting = np.cumsum(np.random.default_rng(1).normal(0, 0.05, len(t)))
    found = fit_runs(runs, (t, a + drifting - drifting.mean()), OVER)
    assert found.samples < len(t) / 5


def test_a_record_is_read_with_its_units():
    rows = "\n".join(f"{10 * k},0,{0.1 * k}" for k in range(30))
    t, a = read_record(f"# by hand\ntime [ms], pitch [deg], vertical acceleration (g)\n{rows}\n")
    np.testing.assert_allclose(t, 0.01 * np.arange(30))
    np.testing.assert_allclose(a, 0.1 * np.arange(30) * G)
    named = read_record("t [s];front a [m/s^2];rear a [m/s²]\n" + rows.replace(",", ";"), ["t", "rear a"])
    np.testing.assert_allclose(named[1], 0.1 * np.arange(30))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "holds no lines"),
        ("0,1\n1,2\n", "begins with numbers; give a heading with units"),
        ("t,a\n0,1\n", "column 't' has no unit; give one of s, sec, ms"),
        ("t [s],a [furlong]\n0,1\n", "has the unit 'furlong'; give one of m/s^2"),
        ("t [s],z [m]\n0,1\n", "none is named a or acceleration"),
        ("t [s],a [g]\n0,1\n", "has 1 samples; 20 or more"),
        ("t [s],a [g]\n0,x\n", "line 2 below the comments"),
        ("t [s],a [g]\n" + "0,1\n" * 30, "time must grow"),
    ],
)
def test_records_that_cannot_be_read_are_refused(text, words):
    with pytest.raises(DesignError) as refused:
        read_record(text)
    assert words in str(refused.value)


def test_a_record_much_longer_than_the_run_is_refused():
    t = np.arange(0, 4, 0.01)
    with pytest.raises(DesignError, match="no run lies over the record"):
        fit_runs(lambda changes: [None for _ in changes], (t, np.sin(t)), OVER)
