"""Figures and warnings, on hand-made runs whose answers are known, and on the paper's."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from model import load_config, simulate
from model.analysis.energy import energy_balance
from model.analysis.ride import (
    Row,
    comparison,
    imaginary_share,
    penetration,
    summary,
    suspension_travel,
    warnings,
    wheel_state,
)
from model.config.config import Config
from model.dynamics.vehicle import build_system
from model.road.road import build_road
from model.simulation.trajectory import RunStatistics, Trajectory

FIELD = Path(__file__).parents[2] / "field"
RATE = 100.0
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
    figures = summary(standing())
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
    assert figures.real_time_factor == pytest.approx(0.04 / 0.02)
    assert whats(standing()) == []


def test_loads_and_time_in_the_air():
    run = standing()
    run.normal_load[:, 2] = [0, 1000, 2000, 0, 7000]
    figures = summary(run)
    assert (figures.load_min[2], figures.load_mean[2], figures.load_max[2]) == (0, 2000, 7000)
    assert figures.air_time[2] == pytest.approx(2 / RATE)
    assert figures.air_time[3] == 0


def test_share_of_imaginary_wheels_is_a_mean_over_time_and_leaves_jumps_out():
    run = standing(samples=3)
    run.normal_load[0, 6:] = 0  # none
    run.normal_load[1, :6] = 0  # all
    run.normal_load[2] = 0  # in the air
    assert imaginary_share(run) == pytest.approx(0.5)
    run.normal_load[:] = 0
    assert imaginary_share(run) == 0
    assert imaginary_share(standing(FLAT.replace({"vehicle.imaginary_wheels.enabled": False}))) == 0


def test_acceleration_is_the_hulls_vertical_one():
    run = standing(samples=4)
    run.a[:, 0, 1] = [3, -4, 0, 0]
    run.a[:, 0, 0] = 100
    run.a[:, 1:] = 100
    figures = summary(run)
    assert figures.acceleration_rms == pytest.approx(2.5)
    assert figures.acceleration_peak == 4


def test_dynamic_load_coefficient_is_the_spread_of_the_load_over_that_at_rest():
    run = standing(samples=4)
    run.normal_load[:, 2] = [4000, 6000, 4000, 6000]
    run.normal_load[:, 3] = 8000
    run.static_load[7] = 0
    found = summary(run).load_coefficient
    assert found[2] == pytest.approx(0.2)
    assert found[3] == 0
    assert np.isnan(found[7])
    labels = {row.label: row.now for row in comparison(run, None)}
    assert labels["Dynamic load coefficient, R3"] == pytest.approx(20)
    assert "Dynamic load coefficient, I2" not in labels


def test_pitch_and_drift():
    run = standing(samples=3)
    run.q[:, 0, 2] = [0, 0.1, -0.2]
    run.constraint_residual[:] = [0, 3e-6, 1e-6]
    figures = summary(run)
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
    figures = summary(run)
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
    assert whats(run) == ["Road arm 2 turned by -50° (t = 0.03 s)"]


def test_a_wheel_sunk_deeper_than_a_tenth_of_its_radius():
    run = standing()
    imaginary = run.system.imaginary_wheels.start
    run.q[2, imaginary, 1] -= 0.031
    assert whats(run) == []
    run.q[2, imaginary, 1] -= 0.002
    assert whats(run) == ["Wheel I1 sank 33 mm into the ground (t = 0.02 s)"]


def test_all_wheels_in_the_air():
    run = standing()
    run.normal_load[2:4] = 0
    run.normal_load[2, 10] = 1
    assert whats(run) == ["All wheels were in the air for 0.01 s (t = 0.03 s)"]
    run.normal_load[3, 0] = 1
    assert whats(run) == []


@pytest.mark.parametrize(
    ("wavelength", "warned"), [(0.7, True), (0.71, True), (0.35, True), (0.75, False), (1.4, False), (7, False)]
)
def test_wheels_in_phase(wavelength, warned):
    changes = {"road.wavelength": wavelength, "road.amplitude": 0.001, "road.start": 50}
    run = standing(Config().replace(changes))
    assert (f"The wavelength, {wavelength:g} m, fits the wheel spacing" in whats(run)) is warned
    assert whats(standing(Config().replace(changes | {"road.amplitude": 0}))) == []


def test_uneven_wheels_are_in_phase_only_when_every_gap_fits():
    changes = {"road.wavelength": 0.5, "road.amplitude": 0.001, "road.start": 50}
    fits = Config().replace(changes | {"vehicle.road_wheels.positions": [1, 0.5, -0.5, -1]})
    one_does_not = Config().replace(changes | {"vehicle.road_wheels.positions": [1, 0.5, -0.25, -0.75]})
    assert len(whats(standing(fits))) == 1
    assert whats(standing(one_does_not)) == []


def test_one_sample_is_enough():
    assert summary(standing(samples=1)).acceleration_rms == 0
    assert whats(standing(samples=1)) == []


def test_the_papers_run():
    run = simulate(load_config("paper"))
    figures = summary(run)
    steady = run.t > 5
    assert np.sqrt(np.mean(run.a[steady, 0, 1] ** 2)) == pytest.approx(0.66, abs=0.02)
    assert figures.imaginary_share == pytest.approx(0.15, abs=0.01)
    assert figures.load_min[0] == 0
    assert figures.load_max[0] == pytest.approx(19000, rel=0.02)
    contact = build_road(run.config).nearest(run.q[0, run.system.wheel, :2])[2]
    np.testing.assert_allclose(penetration(run)[0], run.system.r - contact)
    assert penetration(run)[0, :6].max() == pytest.approx(0.0127, abs=0.0008)
    assert whats(run) == []


def test_the_papers_vehicle_at_30_km_per_h_is_warned_about():
    assert any(
        "Road arm 1 turned by -" in what
        for what in whats(simulate(load_config("paper").replace({"drive.speed_kmh": 30})))
    )


def rows(now: Trajectory, baseline: Trajectory | None) -> dict[str, Row]:
    found = {row.label: row for row in comparison(now, baseline)}
    assert len(found) == len(comparison(now, baseline))
    return found


def test_a_comparison_gives_now_baseline_and_change_in_readers_units():
    now, before = standing(), standing()
    before.a[:, 0, 1], now.a[:, 0, 1] = [2, -2, 2, -2, 2], [1, -1, 1, -1, 1]
    before.q[3, 0, 2], now.q[3, 0, 2] = np.radians(4), np.radians(-5)
    before.normal_load[1:3, 1], now.normal_load[1:4, 1] = 0, 0
    now.normal_load[0, 6] = 7500
    third = now.system.road_wheels.start + 2
    before.q[1, third, 1] += 0.02
    now.q[1, third, 1] += 0.02
    now.q[2, third, 1] -= 0.01
    found = rows(now, before)

    def row(label: str) -> tuple[str, float, float, float | None]:
        return found[label].unit, found[label].now, found[label].baseline, found[label].change

    assert row("Vertical acceleration, rms") == ("m/s²", 1, 2, -50)
    assert row("Vertical acceleration, peak") == ("m/s²", 1, 2, -50)
    assert row("Weighted acceleration at the seat")[:2] == ("m/s²", pytest.approx(summary(now).seat.total))
    assert row("Absorbed power at the seat")[3] == pytest.approx(-75, abs=0.5)
    assert row("Pitch, peak to peak") == ("°", pytest.approx(5), pytest.approx(4), pytest.approx(25))
    assert row("Peak load, I1") == ("kN", 7.5, 5, pytest.approx(50))
    assert row("Peak load, R1") == ("kN", 5, 5, 0)
    assert row("Load, rms, R2") == (
        "kN",
        *(pytest.approx(5 * np.sqrt(k / 5)) for k in (2, 3)),
        pytest.approx(-18.35, abs=0.01),
    )
    assert row("Time in the air, R2") == ("s", pytest.approx(0.03), pytest.approx(0.02), pytest.approx(50))
    # R3: the hull's pitch of sample 3 moves its wheels too, so the figures are those of the summary
    up, down = summary(now).travel_up[2], summary(now).travel_down[2]
    assert row("Suspension travel, R3")[:2] == ("mm", pytest.approx(1000 * (up - down)))
    share = found["Load on imaginary wheels"]
    assert share.unit == "%"
    assert share.now == pytest.approx(100 * imaginary_share(now))
    assert share.change == pytest.approx(100 * (imaginary_share(now) / imaginary_share(before) - 1))


def test_changes_that_mean_nothing_are_left_out():
    quiet, shaken = standing(), standing()
    quiet.a[:, 0, 1], shaken.a[:, 0, 1] = 1e-9, 1
    shaken.normal_load[2, 0] = 0
    found = rows(shaken, quiet)
    assert found["Vertical acceleration, rms"].change is None
    assert found["Time in the air, R1"].change is None  # before: never
    assert found["Time in the air, R1"].now == pytest.approx(1 / RATE)
    assert found["Time in the air, R1"].resolution == pytest.approx(1 / RATE)
    assert found["Peak load, R1"].resolution == 0
    assert found["Suspension travel, R1"].change is None
    longer = standing(samples=9)
    longer.normal_load[2, 0] = 0
    assert rows(longer, shaken)["Time in the air, R1"].change is None
    assert rows(shaken, shaken)["Time in the air, R1"].change == 0


def test_without_a_baseline_there_is_only_now():
    assert all(
        row.now is not None and row.baseline is None and row.change is None for row in comparison(standing(), None)
    )


def test_vehicles_with_different_wheels_are_compared_wheel_by_wheel():
    four = standing(FLAT.replace({"vehicle.road_wheels.count": 4}))
    bare = standing(FLAT.replace({"vehicle.imaginary_wheels.enabled": False}))
    found = rows(four, bare)
    peaks = [row.wheel for row in found.values() if row.figure == "Peak load"]
    assert peaks == ["R1", "R2", "R3", "R4", "R5", "R6", "I1", "I2", "I3"]
    assert (found["Peak load, R5"].now, found["Peak load, R5"].baseline) == (None, 5)
    assert (found["Peak load, I3"].now, found["Peak load, I3"].baseline) == (5, None)
    assert found["Peak load, I3"].change is None
    assert "Suspension travel, I1" not in found
    assert next(iter(found)) == "Vertical acceleration, rms"


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
    state = wheel_state(run, 2, 0.02)
    assert (state.name, state.time) == ("R3", 0.02)
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
    assert wheel_state(run, 10, 0.015).normal_load == pytest.approx(200)
    assert wheel_state(run, 10, 7).normal_load == 900
    assert wheel_state(run, 10, 7).time == 0.04
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


def profile(points: str) -> Config:
    return FLAT.replace({"road.type": "profile", "road.points": points})


def test_a_profile_that_is_not_reached():
    assert whats(standing(profile("500 0, 501 0.1, 600 0"))) == [
        "The profile was not reached: it begins at x = 500 m, the wheels came to 1.75 m"
    ]
    assert whats(standing(profile("0 0, 501 0, 600 0.1"))) == []


def test_a_profile_that_ends_under_way():
    run = simulate(load_config(FIELD / "profile_runs_out.yaml"))
    assert whats(run)[0] == "The points of the profile end at x = 43 m; all wheels were past that at t = 10.78 s"
    short = simulate(run.config.replace({"simulation.duration": 10}))
    assert whats(short) == []


def test_who_slides_away_is_judged_by_the_road_that_he_slid_on():
    """On ice, much further than the speed to be kept would lead."""
    run = simulate(load_config(FIELD / "icy_descent.yaml"))
    assert run.q[-1, 0, 0] > build_road(run.config).reach
    assert whats(run) == []
    assert penetration(run).max() == pytest.approx(0.015, abs=0.002)
    assert energy_balance(run).closing_error < 0.01
