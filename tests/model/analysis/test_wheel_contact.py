"""Where wheels meet the road, on hand-made runs whose answers are known, and on the paper's."""

from __future__ import annotations

import numpy as np
import pytest

from model import load_config, simulate
from model.analysis.wheel_contact import penetration, wheel_state
from tests.model.analysis.support import FLAT, RATE, standing


def test_penetration_follows_the_road():
    run = standing()
    run.q[1, run.system.wheel, 1] -= 0.01
    run.q[2, run.system.wheel, 1] += 0.02
    depth = penetration(run)[:, 4]
    np.testing.assert_allclose(depth[:2], [0, 0.01], atol=1e-12)
    assert depth[2] < 0


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
