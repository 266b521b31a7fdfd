"""What varies, over what, in which runs."""

from __future__ import annotations

import numpy as np
import pytest

from model import load_config, simulate
from model.analysis.figures import FIGURE, figures_by_name
from model.analysis.ride import Summary
from model.study.design import DesignError, Grid, Range, Values, checked_figures, make_study, parse_varied
from tests.model.support import PAPER, WHEELS

SPEED, AMPLITUDE = "drive.speed_kmh", "road.amplitude"


def test_a_grid_has_all_combinations_and_its_last_key_changes_fastest():
    study = make_study(PAPER, [Range(SPEED, 10, 30, 3), Values(AMPLITUDE, (0.1, 0.05))])
    assert study.keys == (SPEED, AMPLITUDE)
    assert list(study.points) == [(10, 0.1), (10, 0.05), (20, 0.1), (20, 0.05), (30, 0.1), (30, 0.05)]
    assert list(study.points[4:]) == [(30, 0.1), (30, 0.05)]
    assert len(Grid([tuple(range(1000))] * 3)) == 10**9


@pytest.mark.parametrize("sample", ["latin-hypercube:64", "sobol:64"])
def test_a_sample_fills_its_ranges_evenly_and_is_the_same_for_the_same_seed(sample):
    varied = [Range(SPEED, 10, 30), Range(AMPLITUDE, 0, 0.1), Values("drive.mode", ("cruise", "prescribed"))]
    first, again = (make_study(PAPER, varied, sample=sample, seed=5) for _ in range(2))
    assert list(first.points) == list(again.points)
    assert list(first.points) != list(make_study(PAPER, varied, sample=sample, seed=6).points)
    speeds, amplitudes, modes = zip(*first.points, strict=True)
    np.testing.assert_array_equal(np.bincount((np.array(speeds) - 10).astype(int) // 5), [16] * 4)
    np.testing.assert_array_equal(np.bincount((np.array(amplitudes) / 0.025).astype(int)), [16] * 4)
    assert modes.count("cruise") == 32


def test_whole_numbers_stay_whole_and_come_equally_often():
    seeds = Range("road.seed", 1, 4)
    base = load_config("random_road")
    points = make_study(base, [seeds], sample="sobol:64").points
    assert np.bincount([point[0] for point in points]).tolist() == [0, 16, 16, 16, 16]
    assert all(type(value) is int for (value,) in points)


@pytest.mark.parametrize(
    ("text", "varied"),
    [
        ("drive.speed_kmh=10:30:5", Range(SPEED, 10, 30, 5)),
        (" drive.speed_kmh = 1e1:3.5e1 ", Range(SPEED, 10, 35)),
        ("drive.speed_kmh=10", Values(SPEED, (10.0,))),
        ("drive.mode=cruise,prescribed", Values("drive.mode", ("cruise", "prescribed"))),
        ("road.start=null, 8", Values("road.start", (None, 8.0))),
        (f"{WHEELS}.positions=[1, 0, -1], [2, 0, -2]", Values(f"{WHEELS}.positions", ((1, 0, -1), (2, 0, -2)))),
        ("vehicle.imaginary_wheels.enabled=true,false", Values("vehicle.imaginary_wheels.enabled", (True, False))),
    ],
)
def test_what_varies_is_read(text, varied):
    assert parse_varied(text, PAPER) == varied


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("drive.speed_kmh", "give KEY=FROM:TO:N or KEY=a,b,c"),
        ("drive.spead_kmh=1:2:3", "the nearest known one is drive.speed_kmh"),
        ("drive=1:2:3", "is a section; name one of its keys"),
        ("drive.speed_kmh=30:10:5", "the range is empty"),
        ("drive.speed_kmh=10:10", "the range is empty"),
        ("drive.speed_kmh=10:30:1", "give a whole number from 2 to 10000000"),
        ("drive.speed_kmh=10:30:1000000000", "give a whole number from 2 to 10000000"),
        ("drive.speed_kmh=nan:30:5", "'nan' is no number; give KEY=FROM:TO:N, each a number from 0.5 to 100 km/h"),
        ("drive.speed_kmh=10:x", "'x' is no number"),
        ("drive.speed_kmh=10:30:x", "'x' is no number of values"),
        ("drive.speed_kmh=10:300:3", "300 is not allowed; give a number from 0.5 to 100 km/h"),
        ("drive.speed_kmh=10,fast", "'fast' is not allowed; give a number from 0.5 to 100 km/h"),
        ("drive.speed_kmh=10,10", "a value stands there twice"),
        ("drive.speed_kmh=[10", "line 1, column"),
        ("drive.mode=1:2:3", "has no range; give one of cruise, prescribed"),
        (
            "road.height=0.1:0.2:3",
            "a road of type sine has no such key; it belongs to half_round and trapezoid and step",
        ),
        ("name=a,b", "cannot be varied"),
        ("road.points=0 0", "cannot be varied"),
    ],
)
def test_what_cannot_vary_is_refused_with_what_can(text, words):
    with pytest.raises(DesignError) as refused:
        parse_varied(text, PAPER)
    assert words in str(refused.value)


def test_keys_of_other_roads_may_vary_with_the_type_of_the_road():
    assert parse_varied("road.height=0.1,0.2", PAPER, road_varies=True) == Values("road.height", (0.1, 0.2))


@pytest.mark.parametrize(
    ("varied", "sample", "words"),
    [
        ([], "grid", "nothing varies"),
        ([Range(SPEED, 1, 2, 2)] * 2, "grid", "drive.speed_kmh: is varied twice"),
        ([Range(SPEED, 1, 2)], "grid", "drive.speed_kmh=1:2: says no number of values; give drive.speed_kmh=1:2:5"),
        ([Range(SPEED, 1, 2)], "random:5", "give latin-hypercube:N, sobol:N or grid"),
        ([Range(SPEED, 1, 2)], "sobol", "give the number of runs"),
        ([Range(SPEED, 1, 2)], "sobol:0", "give the number of runs"),
        ([Range(SPEED, 1, 2)], "sobol:100", "give sobol:128"),
        ([Range(SPEED, 1, 2, 3)], "sobol:8", "drive.speed_kmh: a sample takes its own values, not 3; give FROM:TO"),
        ([Range(SPEED, 1, 2, 10**4), Range(AMPLITUDE, 0, 0.1, 10**4)], "grid", "100000000 runs are more than"),
    ],
)
def test_a_study_that_cannot_be_made_is_refused(varied, sample, words):
    with pytest.raises(DesignError) as refused:
        make_study(PAPER, varied, sample=sample)
    assert words in str(refused.value)


def test_figures_are_known_by_name_and_wheel():
    assert checked_figures(["shock", " peak_load.I5", "shock"], PAPER) == ("shock", "peak_load.I5")
    every = checked_figures([], PAPER)
    assert every[: len(FIGURE)] == tuple(FIGURE)
    assert set(every) == set(figures_by_name(Summary(simulate(PAPER.replace({"simulation.duration": 1})))))
    for name, words in {
        "peak_loads": "the nearest one is peak_load",
        "peak_load.I6": "give peak_load.R1 … peak_load.I5",
        "travel.I1": "give travel.R1 … travel.R6",
        "pitch.R1": "give pitch",
    }.items():
        with pytest.raises(DesignError, match="there is no such figure") as refused:
            checked_figures([name], PAPER)
        assert words in str(refused.value)
