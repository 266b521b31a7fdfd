"""The endless drive: the same motion as a run, changes under way, no drift however far."""

from __future__ import annotations

import numpy as np
import pytest

from model import load_config, simulate
from model.analysis.ride import Summary
from model.dynamics.equilibrium import NoEquilibriumError
from model.simulation.drive import AHEAD, JOIN_AHEAD, REBASE, LiveDrive
from model.simulation.integrate import ADVICE, REASON, Status

PAPER = load_config("paper")


def drive_on(drive: LiveDrive, seconds: float, frame: float = 1 / 30) -> None:
    end = drive.time + seconds
    while drive.time < end:
        drive.advance(min(drive.time + frame, end))


def test_an_endless_drive_is_the_run_gone_on():
    drive, run = LiveDrive(PAPER, remembered=6.0), simulate(PAPER)
    drive_on(drive, 5.0)
    recent = drive.recent()
    assert recent.t[0] == 0.0
    np.testing.assert_allclose(recent.normal_load, run.normal_load[: len(recent.t)], atol=0.005 * run.normal_load.max())
    np.testing.assert_allclose(recent.q[:, 0], run.q[: len(recent.t), 0], atol=1e-4)


def test_forces_and_speed_act_at_once_and_the_motion_stays_continuous():
    drive = LiveDrive(PAPER)
    drive_on(drive, 3.0)
    before = drive.recent()
    assert drive.change(PAPER.replace({"drive.speed_kmh": 25, "vehicle.road_suspension.stiffness": 40000}))
    drive_on(drive, 3.0)
    after = drive.recent()
    k = len(before.t)
    assert np.abs(np.diff(after.q[:, 0, :2], axis=0)[k - 2 : k + 2]).max() < 0.04
    assert np.all(np.diff(after.t) == pytest.approx(0.005))
    assert after.v[-1, 0, 0] * 3.6 == pytest.approx(25, abs=1.5)
    assert after.config.drive.speed_kmh == 25


@pytest.mark.parametrize("mode", ["cruise", "prescribed"])
def test_a_new_road_begins_ahead_of_the_first_wheel_and_is_smooth(mode):
    config = PAPER.replace({"drive.mode": mode})
    drive = LiveDrive(config)
    drive_on(drive, 4.0)
    x = np.linspace(-10, 30, 4001) + drive.recent().q[-1, 0, 0]
    before = drive.road().height(x)
    front = drive.recent().q[-1, drive.recent().system.road_wheels, 0].max()
    assert drive.change(config.replace({"road.amplitude": 0.2, "road.wavelength": 5.0}))
    height, slope, _ = drive.road().derivatives(x)
    under = x < front + JOIN_AHEAD
    np.testing.assert_allclose(height[under], before[under], atol=1e-12)
    assert np.abs(height[~under]).max() > 0.19
    assert np.abs(np.diff(slope)).max() < 0.02
    assert np.abs(np.diff(height) / np.diff(x) - slope[:-1]).max() < 0.01
    drive_on(drive, 6.0)
    assert drive.status is Status.RUNNING
    assert drive.recent().constraint_residual.max() < 1e-5


def test_dragging_a_road_slider_joins_shape_after_shape():
    drive = LiveDrive(PAPER)
    for k in range(40):
        drive.change(PAPER.replace({"road.amplitude": 0.1 + 0.002 * k}))
        drive.advance(drive.time + 0.05)
    drive_on(drive, 12.0)
    assert drive.status is Status.RUNNING
    assert drive.road().height(np.linspace(0, 20, 2001) + drive.recent().q[-1, 0, 0]).max() == pytest.approx(
        0.178, abs=1e-3
    )


def test_half_rounds_come_again_and_again():
    drive = LiveDrive(PAPER.replace({"road.type": "half_round"}))
    drive_on(drive, 20.0)
    x = np.linspace(0, AHEAD, 20001)[1:-1] + drive.recent().q[-1, 0, 0]
    height = drive.road().height(x)
    assert (np.diff((height > 0.05).astype(int)) == 1).sum() == pytest.approx(AHEAD / 20, abs=1)
    assert height.max() == pytest.approx(0.1, abs=1e-4)


def test_the_driver_may_move_and_the_hull_be_drawn_otherwise_under_way():
    drive = LiveDrive(PAPER)
    drive.advance(0.1)
    assert drive.change(PAPER.replace({"vehicle.seat.x": -1.0, "vehicle.hull": "carrier"}))


def test_other_bodies_start_anew():
    drive = LiveDrive(PAPER)
    drive_on(drive, 1.0)
    assert not drive.change(PAPER.replace({"vehicle.road_wheels.count": 5}))
    assert drive.time == 0.0
    drive_on(drive, 0.5)
    assert drive.recent().normal_load.shape[1] == 9


def test_the_origin_moves_along_and_nothing_is_seen_of_it():
    config = PAPER.replace({"drive.speed_kmh": 70, "road.wavelength": 10, "road.amplitude": 0.03})
    drive = LiveDrive(config)
    drive_on(drive, 1.05 * REBASE / (70 / 3.6), frame=0.1)
    recent = drive.recent()
    assert drive.distance == REBASE
    assert recent.q[-1, 0, 0] < REBASE
    assert np.abs(np.diff(recent.q[:, 0, 0])).max() < 0.11  # 19.4 m/s at 200 Hz
    assert recent.constraint_residual.max() < 1e-5
    wave = recent.normal_load[-400:, 0]
    period = round(10 / (70 / 3.6) * 200)
    np.testing.assert_allclose(wave[:-period].mean(), wave[period:].mean(), rtol=0.1)


def test_memory_does_not_grow():
    drive = LiveDrive(PAPER, remembered=2.0)
    drive_on(drive, 5.0)
    early = len(drive.recent().t)
    drive_on(drive, 60.0, frame=0.1)
    assert len(drive.recent().t) < early + 30
    assert drive.recent().t[-1] == pytest.approx(65, abs=0.1)


def test_the_last_moments_are_the_end_of_the_past():
    drive = LiveDrive(PAPER)
    drive_on(drive, 2.0)
    recent, last = drive.recent(), drive.recent(0.1)
    assert last.t[-1] - last.t[0] == pytest.approx(0.1, abs=1 / 30 + 0.01)
    np.testing.assert_array_equal(last.q, recent.q[-len(last.t) :])


def test_frames_shorter_than_a_sample_do_no_harm():
    drive = LiveDrive(PAPER, remembered=0.05)
    drive_on(drive, 0.2, frame=0.001)
    recent = drive.recent()
    assert np.diff(recent.t) == pytest.approx(0.005)
    assert recent.t[-1] == pytest.approx(0.2, abs=0.01)


def test_a_drive_that_became_too_stiff_ends_and_says_why():
    """A run has a bound on its steps; a drive without end must not hold its thread for ever either."""
    light = PAPER.replace({"vehicle.road_wheels.mass": 1.0})
    drive = LiveDrive(light)
    drive_on(drive, 0.5)
    assert drive.change(light.replace({"contact.tangential_damping": 1e8}))
    drive.advance(drive.time + 1 / 30)
    assert drive.status is Status.TOO_MANY_STEPS
    assert drive.recent().status.endswith(REASON[Status.TOO_MANY_STEPS])
    assert drive.recent().advice == ADVICE[Status.TOO_MANY_STEPS]
    assert not drive.change(PAPER)
    drive_on(drive, 0.1)
    assert drive.status is Status.RUNNING


def test_a_vehicle_that_cannot_rest_leaves_the_drive_as_it_was():
    drive = LiveDrive(PAPER)
    drive_on(drive, 0.2)
    with pytest.raises(NoEquilibriumError):
        drive.change(PAPER.replace({"vehicle.road_wheels.count": 2}))
    drive_on(drive, 0.2)
    assert drive.recent().config == PAPER
    assert drive.recent().t[0] == 0.0
    assert Summary(drive.recent()).names[-1] == "I5"
