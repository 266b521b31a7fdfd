"""What a reader is warned of, on hand-made runs and on the paper's."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from model import load_config, simulate
from model.analysis.comfort import ride_comfort
from model.analysis.energy import energy_balance
from model.analysis.ride import Summary
from model.analysis.ride_warnings import motion_warnings, warnings
from model.analysis.wheel_contact import penetration
from model.config.config import Config
from model.dynamics.vehicle import build_system
from model.road.road import build_road
from tests.model.analysis.support import FLAT, RATE, standing, whats

FIELD = Path(__file__).parents[2] / "field"


PAPER = Config()


def test_an_arm_turned_beyond_45_degrees():
    run = standing()
    run.q[:, 0, 2] = 0.1  # hull and arm turn together: not the arm's turn
    run.q[:, run.system.road_arms, 2] = 0.1
    run.q[3, 2, 2] = 0.1 - np.radians(44)
    assert whats(run) == []
    run.q[3, 2, 2] = 0.1 - np.radians(50)
    assert whats(replace(run)) == [f"Road arm 2 turned by -50° (t = {3 / RATE:.2f} s)"]  # anew: a run keeps its peaks


def test_a_wheel_sunk_deeper_than_a_tenth_of_its_radius():
    run = standing()
    imaginary = run.system.imaginary_wheels.start
    run.q[2, imaginary, 1] -= 0.031
    assert whats(run) == []
    run.q[2, imaginary, 1] -= 0.002
    assert whats(run) == [f"Wheel I1 sank 33 mm into the ground (t = {2 / RATE:.2f} s)"]


def test_all_wheels_in_the_air():
    run = standing()
    run.normal_load[2:4] = 0
    run.normal_load[2, 10] = 1
    assert whats(run) == [f"All wheels were in the air for {1 / RATE:.2f} s (t = {3 / RATE:.2f} s)"]
    run.normal_load[3, 0] = 1
    assert whats(run) == []


@pytest.mark.parametrize(
    ("wavelength", "warned"), [(0.7, True), (0.71, True), (0.35, True), (0.75, False), (1.4, False), (7, False)]
)
def test_wheels_in_phase(wavelength, warned):
    changes = {"road.wavelength": wavelength, "road.amplitude": 0.001, "road.start": 50}
    run = standing(Config().replace(changes))
    phase = f"The wavelength, {wavelength:g} m, fits the wheel spacing"
    assert (phase in whats(run)) is warned
    assert phase not in whats(standing(Config().replace(changes | {"road.amplitude": 0})))


def test_uneven_wheels_are_in_phase_only_when_every_gap_fits():
    changes = {"road.wavelength": 0.5, "road.amplitude": 0.001, "road.start": 50}
    fits = Config().replace(changes | {"vehicle.road_wheels.positions": [1, 0.5, -0.5, -1]})
    one_does_not = Config().replace(changes | {"vehicle.road_wheels.positions": [1, 0.5, -0.25, -0.75]})
    phase = "The wavelength, 0.5 m, fits the wheel spacing"
    assert phase in whats(standing(fits))
    assert phase not in whats(standing(one_does_not))


def test_a_run_that_is_too_short_for_its_figures_says_so():
    run = simulate(load_config("half_round").replace({"simulation.duration": 2}))
    assert whats(run) == ["The run ends before the hull has settled behind the obstacle"]


def test_too_few_samples_for_comfort():
    run = simulate(PAPER.replace({"simulation.output_rate": 10}))
    assert Summary(run).seat is None
    assert "Comfort cannot be told from 10 samples a second" in whats(run)
    assert "200 1/s" in str(warnings(run)[-1])


def test_a_hull_that_leans_at_rest():
    run = standing()
    run.q[:, :, 2] = np.radians(-27.0)  # arms and all: no arm turns in the hull
    assert "The hull leans forwards by 27° at rest" in whats(run)
    run.t[:] += 1.0  # a stretch of a drive does not begin at rest
    assert not any("leans" in what for what in whats(run))


def test_a_crest_factor_above_nine():
    run = standing(samples=2001)
    run.a[1000, 0, 1] = 30.0
    felt = Summary(run).seat
    assert felt.crest_factor > 9
    assert whats(run) == [f"The crest factor at the driver's seat is {felt.crest_factor:.1f}"]
    meaning = warnings(run)[0].meaning
    assert "ISO 2631-1" in meaning
    assert f"MTVV, {felt.transient:.3g} m/s²" in meaning
    assert f"VDV, {felt.dose:.3g} m/s¹·⁷⁵" in meaning


def test_the_papers_vehicle_at_30_km_per_h_is_warned_about():
    assert any(
        "Road arm 1 turned by -" in what
        for what in whats(simulate(load_config("paper").replace({"drive.speed_kmh": 30})))
    )


@pytest.mark.parametrize(
    ("vehicle", "speed", "road", "enough"),
    [
        ("paper", 45, {}, None),
        ("paper", 60, {}, 55),
        ("paper", 60, {"road.longest_wave": 55}, None),
        ("paper", 60, {"road.longest_wave": 90, "road.length": 20}, 55),
        ("paper", 100, {}, 90),
        ("paper", 100, {"road.longest_wave": 90}, None),
        ("m113", 60, {}, None),
        ("m113", 100, {}, 65),
        ("paper", 60, {"road.type": "sum", "road.parts": [{"type": "random"}, {"type": "step"}]}, 55),
        ("paper", 60, {"road.type": "sine"}, None),
    ],
)
def test_a_random_road_without_waves_long_enough_for_the_speed(vehicle, speed, road, enough):
    """Pitch, rms, of the paper's vehicle is 1.2, 1.3, 1.9 times as large with waves of 90 m at 50, 60, 100 km/h."""
    changes = {"road.type": "random", "drive.speed_kmh": speed, "simulation.duration": 0.1} | road
    said = [
        str(each) for each in motion_warnings(simulate(load_config(vehicle).replace(changes))) if "longest" in each.what
    ]
    assert len(said) == (enough is not None)
    if enough is not None:
        assert f"Set longest_wave to {enough} m" in said[0]
        assert ("and the road's length, 20 m, to no less" in said[0]) == ("road.length" in road)


def profile(points: str) -> Config:
    return FLAT.replace({"road.type": "profile", "road.points": points})


def test_a_profile_that_is_not_reached():
    """One warning, whatever there is besides it."""
    for points in ("500 0, 501 0.1, 600 0", "0 0, 500 0, 501 0.1, 600 0"):
        run = standing(profile(points))
        (said,) = whats(run)
        felt = ride_comfort(run)
        assert felt is not None
        assert felt.reaction == "not reached"
        assert said == (
            "The run ends before a wheel comes to the profile: it begins at x = 499.95 m, the wheels came to 1.75 m"
        )
    besides = {"type": "profile", "points": "500 0, 501 0.1, 600 0"}, {"type": "random"}
    assert whats(standing(FLAT.replace({"road.type": "sum", "road.parts": besides})))[0] == (
        "The profile was not reached: it begins at x = 500 m, the wheels came to 1.75 m"
    )


def test_a_profile_that_ends_under_way():
    run = simulate(load_config(FIELD / "profile_runs_out.yaml"))
    assert whats(run)[0] == "The points of the profile end at x = 43 m; all wheels were past that at t = 10.78 s"
    short = simulate(run.config.replace({"simulation.duration": 10}))
    assert whats(short) == []


def test_who_slides_away_is_judged_by_the_road_that_he_slid_on():
    """On ice, much further than the speed to be kept would lead."""
    run = simulate(load_config(FIELD / "icy_descent.yaml"))
    assert run.q[-1, 0, 0] > build_road(run.config).reach
    assert not any("sank" in what for what in whats(run))
    assert penetration(run).max() == pytest.approx(0.015, abs=0.002)
    assert energy_balance(run).closing_error < 0.01


def floor_warnings(belly: float, drop: float, turn: float = 0.0, x: float = 0.0, **road: object) -> list[str]:
    """Warnings of the hull's floor: a belly so high, the hull at x, in the middle sample dropped and turned."""
    keys = {f"road.{key}": value for key, value in road.items()}
    run = standing(FLAT.replace({"vehicle.chassis.belly_height": belly, **keys}))
    run.q[..., 0] += x
    run.q[2, 0, 1:] += [-drop, turn]
    return [what for what in whats(run) if "floor" in what]


def test_a_floor_that_would_meet_the_ground():
    assert floor_warnings(0.4, 0.399) == []
    (what,) = floor_warnings(0.4, 0.42)
    assert what.startswith("The hull's floor would be 20 mm in the ground at x = ")
    assert what.endswith("(t = 0.01 s)")


def test_a_floor_over_an_obstacle_between_the_wheels():
    obstacle = {"type": "half_round", "position": 4, "height": 0.2, "radius": 0.2}
    assert floor_warnings(0.25, 0.04, x=3.5, **obstacle) == []
    (what,) = floor_warnings(0.25, 0.06, x=3.5, **obstacle)
    depth, x = map(float, re.findall(r"[\d.]+(?= mm| m )", what))
    assert (depth, x) == (pytest.approx(10, abs=0.2), pytest.approx(4, abs=0.02))
    assert floor_warnings(0.25, 0.06, x=1.5, **obstacle) == []  # ahead of the first wheel


def test_a_floor_that_tips():
    """Nose down by 0.1 rad about the centre of mass, 0.95 m up: the first wheel is 1.75 m ahead of it."""
    low = 0.95 - 0.55 * np.cos(0.1) - 1.75 * np.sin(0.1)
    (what,) = floor_warnings(0.4, low + 0.03, turn=-0.1)
    place = 1.75 * np.cos(0.1) - 0.55 * np.sin(0.1)
    assert what.startswith(f"The hull's floor would be 30 mm in the ground at x = {place:.2f} m")
    assert floor_warnings(0.4, low - 0.01, turn=-0.1) == []


def test_a_belly_that_is_not_given_is_under_the_pivots():
    system = build_system(PAPER)
    pivot = system.q_design[0, 1] + system.u_i[0, 1]
    assert pivot - 0.1 < system.belly < pivot
    assert build_system(PAPER.replace({"vehicle.chassis.belly_height": 0.33})).belly == 0.33
