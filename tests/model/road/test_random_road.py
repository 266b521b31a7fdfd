"""Random roads: as rough as their class says, the same everywhere, and driven on as any other."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from scipy.signal import welch

from model.road.nearest_point import FINAL_STEP, FLOOR
from model.road.random_road import HIGHEST, density, highest
from model.road.road import Road, build_road
from model.simulation.simulate import simulate
from tests.model.road.nearest import assert_nearest, centres_near
from tests.model.support import PAPER, WHEELS

RANDOM = PAPER.replace({"road.type": "random"})
LONG = {"road.longest_wave": 90}
TIGHT = {"simulation.rtol": 1e-8, "simulation.atol": 1e-10}
GOLDEN = [0.003870983678091847, -0.005481771484172613, 0.01045883328991997, 0.009636026631122438, -0.004836356368343258]


def rough(roughness_class: str, **more: object) -> Road:
    return build_road(RANDOM.replace({"road.roughness_class": roughness_class} | more))


@pytest.mark.parametrize(
    ("roughness_class", "radius", "wave"),
    [("A", 0.32, 20), ("E", 0.32, 20), ("C", 0.1, 20), ("H", 0.2, 20), ("C", 0.32, 90), ("G", 0.32, 40)],
)
def test_density_of_each_octave_is_that_of_the_class(roughness_class, radius, wave):
    """Within 1 dB, by Welch's method on what is driven on, from the longest wave to where the wheel feels nothing."""
    changes = {"road.length": 4000.0, f"{WHEELS}.radius": radius, "road.longest_wave": wave}
    road = rough(roughness_class, **changes)
    dx = 0.02
    x = 40.0 + np.arange(0.0, 4000.0, dx)
    n, measured = welch(road.height(x), 1 / dx, nperseg=int(400 / dx), window="hann")
    first, last = 1 / wave, highest(radius)
    edges = first * 2.0 ** np.arange(np.floor(np.log2(last / first)) + 1)
    assert edges[-1] > last / 2
    for low, high in pairwise(edges):
        octave = (n >= low) & (n < high)
        level = 10 * np.log10(measured[octave].sum() / density(roughness_class, n[octave]).sum())
        assert abs(level) < 1.0, (low, high, level)
    longer = (n > 0) & (n < first - 0.005)
    assert measured[longer].max(initial=0) < 0.01 * measured[(n > first) & (n < 2 * first)].min()
    beyond = (n > last + 0.05) & (n < 2 * last)
    assert measured[beyond].max() < 0.01 * measured[(n > last / 2) & (n < last)].min()


def test_density_of_class_c():
    """ISO 8608: 256e-6 m³ at 0.1 cycles/m, falling with the square."""
    assert density("C", np.array([0.1, 0.2])) == pytest.approx([256e-6, 64e-6])
    assert density("H", np.array([0.1])) == pytest.approx(4**5 * 256e-6)


def test_a_seed_gives_the_same_road_everywhere():
    """Heights computed once; they must never change, or runs could not be repeated."""
    x = np.array([5.0, 10.0, 50.0, 123.4, 1000.0])
    assert rough("C").height(x) == pytest.approx(GOLDEN, abs=1e-9)
    assert not np.allclose(rough("C", **{"road.seed": 2}).height(x), GOLDEN, atol=1e-3)


def test_longer_waves_are_added_to_the_same_road():
    """Every seed keeps its road: what comes in is longer than 20 m, and there is as much of it as ISO 8608 says."""
    length, dx = 1000.0, 0.1
    x = 30.0 + np.arange(0.0, length, dx)
    lines = [np.fft.rfft(rough("D", **{"road.length": length, **more}).height(x)) for more in ({}, LONG)]
    n = np.arange(len(lines[0])) / length
    shorter, longer = n >= 1 / 20 - 1e-9, (n >= 1 / 90) & (n < 1 / 20 - 1e-9)
    np.testing.assert_allclose(lines[1][shorter], lines[0][shorter], atol=1e-7)
    assert np.abs(lines[0][longer]).max() < 1e-7
    amplitude = np.abs(lines[1][longer]) * 2 * dx / length
    np.testing.assert_allclose(amplitude, np.sqrt(2 * density("D", n[longer]) / length), rtol=1e-3)
    np.testing.assert_array_equal(rough("D", **{"road.longest_wave": 20.0}).height(x), rough("D").height(x))


@pytest.mark.parametrize(("speed", "low", "high"), [(20, 1.0, 1.2), (60, 1.15, 1.45), (100, 1.6, 2.3)])
def test_at_speed_the_hull_pitches_on_longer_waves_too(speed, low, high):
    """Pitch, rms, on waves up to 90 m beside that on waves up to 20 m: hence ride_warnings.py."""
    fast = RANDOM.replace({
        "road.roughness_class": "B", "road.length": 1000, "drive.speed_kmh": speed, "simulation.duration": 30,
        "simulation.output_rate": 50, "simulation.rtol": 1e-3,
    })  # fmt: skip
    runs = [simulate(fast.replace(more)) for more in ({}, LONG)]
    pitch = [run.q[run.t > 6, run.system.chassis, 2].std() for run in runs]
    assert low < pitch[1] / pitch[0] < high


def test_waves_are_no_longer_than_the_road_and_run_in_gently():
    short, long = (rough("H", **{"road.length": length, **LONG}) for length in (40.0, 400.0))
    assert short.profile.pieces[0].nodes[0] == long.profile.pieces[0].nodes[0] == 2.75
    assert short.profile.pieces[-1].nodes[0] == pytest.approx(2.75 + 10, abs=0.1)
    assert long.profile.pieces[-1].nodes[0] == pytest.approx(2.75 + 22.5, abs=0.1)


def test_it_begins_level_ahead_of_the_first_wheel_and_repeats_itself():
    road = rough("E", **{"road.length": 50.0})
    h, h1, _ = road.derivatives(np.linspace(-10.0, 2.75, 200))
    np.testing.assert_array_equal(h, 0.0)
    np.testing.assert_array_equal(h1, 0.0)
    x = np.linspace(10.0, 60.0, 500)
    np.testing.assert_allclose(road.height(x + 50.0), road.height(x), atol=1e-12)
    assert road.height(x).std() > 0.01


def test_height_slope_and_curvature_are_continuous():
    road = rough("E", **{"road.length": 20.0})
    joints = np.unique(np.concatenate([piece.nodes for piece in road.profile.pieces]))
    for before, behind in zip(road.derivatives(joints - 1e-10), road.derivatives(joints + 1e-10), strict=True):
        np.testing.assert_allclose(before, behind, atol=1e-6)


def test_class_only_scales_the_road():
    x = np.linspace(0.0, 100.0, 500)
    np.testing.assert_allclose(rough("D").height(x), 2 * rough("C").height(x), atol=1e-12)


def test_larger_wheels_lose_the_finest_waves_only():
    x = np.linspace(20.0, 100.0, 8000)
    fine, coarse = (rough("C", **{f"{WHEELS}.radius": radius}).height(x) for radius in (0.1, 0.4))
    assert 0 < np.abs(fine - coarse).max() < 0.3 * np.abs(fine).max()
    assert highest(0.05) == HIGHEST


@pytest.mark.parametrize("roughness_class", list("ABCDEFGH"))
def test_nearest_point_on_random_roads(roughness_class):
    road = rough(roughness_class)
    rng = np.random.default_rng(ord(roughness_class))
    assert_nearest(road, centres_near(road, rng, rng.uniform(0.0, 60.0, 40)))


def test_the_rough_classes_need_the_search():
    """Above, all ways to the nearest point are judged: one minimum, one in the only stretch that can hold the nearest
    point, and the lowest of several.
    """
    safe = {letter: rough(letter).table.safe.mean() for letter in "BH"}
    assert safe["B"] > 0.9
    assert safe["H"] < 0.2
    table = rough("H").table
    searched = np.isfinite(table.bin[:, FLOOR])
    assert searched.mean() > 0.5
    cells = (table.stretch[:, 1] - table.stretch[:, 0] + 1).sum() / searched.sum()
    assert cells < 10  # of some twenty under a wheel
    guessed = table.bin[:, FINAL_STEP] > 0.0
    assert 0.5 < (guessed & ~table.safe).mean() < 0.9
    assert (~guessed).mean() > 0.1


def test_a_first_guess_that_leads_astray_is_not_trusted():
    """Between rough waves the iteration can leave the stretch where there is one minimum only."""
    road = rough("H", **{"road.seed": 3, f"{WHEELS}.radius": 0.06})
    assert_nearest(road, np.array([[14.37744915, 0.35959997]]))


@pytest.mark.parametrize("roughness_class", ["E", "G"])
def test_loads_on_rough_ground_are_exact_to_a_thousandth_of_their_peak(roughness_class):
    """Although errors may grow with the motion: against tolerances ten thousand times tighter, rms, the worst wheel."""
    ground = {"road.type": "random", "road.roughness_class": roughness_class, "simulation.duration": 5}
    run, exact = (simulate(PAPER.replace(ground | tighter)) for tighter in ({}, TIGHT))
    assert exact.complete
    error = np.sqrt(np.mean((run.normal_load - exact.normal_load) ** 2, axis=0)).max() / exact.normal_load.max()
    assert error < 1e-3
    assert run.statistics.evaluations < 0.2 * exact.statistics.evaluations
