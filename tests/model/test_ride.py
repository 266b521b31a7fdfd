"""Figures and warnings, on hand-made runs whose answers are known, and on the paper's."""

from __future__ import annotations

import numpy as np
import pytest

from model import load_config, simulate
from model.config import Config
from model.ride import imaginary_share, penetration, summary, suspension_travel, warnings
from model.road import build_road
from model.trajectory import RunStatistics, Trajectory
from model.vehicle import build_system

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
