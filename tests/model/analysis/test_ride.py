"""Figures and warnings, on hand-made runs whose answers are known, and on the paper's."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from model import load_config, simulate
from model.analysis.comfort import ride_comfort
from model.analysis.energy import energy_balance
from model.analysis.ride import (
    Summary,
    imaginary_share,
    motion_warnings,
    penetration,
    suspension_travel,
    warnings,
    wheel_state,
)
from model.analysis.signals import window
from model.config.config import Config
from model.dynamics.vehicle import build_system
from model.road.road import build_road
from model.simulation.trajectory import RunStatistics, Trajectory

FIELD = Path(__file__).parents[2] / "field"
RATE = 200.0
PAPER = Config()
FLAT = Config().replace({"road.type": "flat", "simulation.output_rate": RATE})


def standing(config: Config = FLAT, samples: int = 5, load: float = 5000.0) -> Trajectory:
    """A run in which nothing moves: the design pose, every wheel under the same load. Its arrays may be written to."""
    system = build_system(config)
    bodies, wheels = len(system.mass), len(system.wheel)
    still = np.zeros((samples, bodies, 3))
    return Trajectory(
        t=np.arange(samples) / config.simulation.output_rate,
        q=np.tile(system.q_design, (samples, 1, 1)),
        v=still.copy(),
        a=still.copy(),
        normal_load=np.full((samples, wheels), load),
        traction=np.zeros((samples, wheels)),
        tangential_displacement=np.zeros((samples, wheels)),
        drive_force=np.zeros(samples),
        multipliers=np.zeros((samples, 2 * len(system.joint_i))),
        constraint_residual=np.zeros(samples),
        static_load=np.full(wheels, load),
        config=config,
        status="complete",
        advice="",
        statistics=RunStatistics(10, 1, 70, 1e-3, seconds=0.02),
    )


def whats(run: Trajectory) -> list[str]:
    found = warnings(run)
    assert all(warning.meaning.endswith(".") and warning.what in str(warning) for warning in found)
    return [warning.what for warning in found]


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


def test_penetration_follows_the_road():
    run = standing()
    run.q[1, run.system.wheel, 1] -= 0.01
    run.q[2, run.system.wheel, 1] += 0.02
    depth = penetration(run)[:, 4]
    np.testing.assert_allclose(depth[:2], [0, 0.01], atol=1e-12)
    assert depth[2] < 0


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


def test_the_state_of_a_wheel():
    run = standing()
    run.normal_load[2] = [1000, 2000, 3000, 4000, 5000, 6000, 100, 200, 300, 400, 1000]
    run.traction[2, 2] = -50
    run.drive_force[2] = 2300
    run.q[2, 0, 2] = 0.05
    run.q[2, run.system.road_arms.start + 2, 2] = 0.15
    wheel = run.system.wheel[2]
    run.q[2, wheel, 1] -= 0.01
    run.v[2, wheel] = [4, 0, -10]
    state = wheel_state(run, 2, 2 / RATE)
    assert (state.name, state.time) == ("R3", 2 / RATE)
    assert state.normal_load == pytest.approx(3000)
    assert state.static_load == 5000
    assert state.load_share == pytest.approx(3000 / 23000)
    assert state.traction == pytest.approx(-50)
    assert state.penetration == pytest.approx(0.01)
    assert state.slip_velocity == pytest.approx(4 - 0.32 * 10)
    assert state.arm_angle == pytest.approx(np.degrees(0.1))
    assert state.torque_share == pytest.approx(3000 / 23000)
    assert state.drive_torque == pytest.approx(0.32 * 2300 * 3000 / 23000)


def test_between_samples_a_wheel_is_between_its_states_and_outside_at_an_end():
    run = standing()
    run.normal_load[:, 10] = [0, 100, 300, 500, 900]
    assert wheel_state(run, 10, 1.5 / RATE).normal_load == pytest.approx(200)
    assert wheel_state(run, 10, 7).normal_load == 900
    assert wheel_state(run, 10, 7).time == 4 / RATE
    assert wheel_state(run, 10, -1).normal_load == 0
    assert wheel_state(standing(samples=1), 0, 0.5).normal_load == 5000


def test_what_a_wheel_in_the_air_does_not_have():
    run = standing()
    run.q[:, run.system.wheel, 1] += 0.05
    run.normal_load[:] = 0
    state = wheel_state(run, 0, 0)
    assert (state.penetration, state.slip_velocity) == (None, None)
    assert (state.load_share, state.torque_share, state.drive_torque) == (None, None, None)


def test_a_prescribed_drive_gives_no_torque_to_wheels():
    state = wheel_state(standing(FLAT.replace({"drive.mode": "prescribed"})), 7, 0)
    assert (state.torque_share, state.drive_torque) == (None, None)
    assert state.load_share == pytest.approx(1 / 11)


def test_a_rolling_wheel_of_the_papers_run_hardly_slips():
    run = simulate(load_config("paper"))
    states = [wheel_state(run, wheel, 4.3217) for wheel in range(11)]
    assert sum(state.load_share for state in states) == pytest.approx(1)
    assert all(abs(state.slip_velocity) < 0.05 for state in states if state.normal_load > 1000)
    k = np.searchsorted(run.t, 4.3217)
    low, high = np.sort(run.normal_load[[k - 1, k], 3])
    assert low <= states[3].normal_load <= high


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
