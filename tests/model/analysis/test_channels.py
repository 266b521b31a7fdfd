"""The columns of a CSV file, by choice."""

from __future__ import annotations

import io

import numpy as np
import pytest

from model.analysis.channels import CHANNELS, USUAL, run_csv
from model.analysis.wheel_contact import wheel_state
from model.config.config_files import load_config
from model.simulation.simulate import simulate
from model.simulation.trajectory import Trajectory


@pytest.fixture(scope="module")
def run() -> Trajectory:
    return simulate(load_config("half_round").replace({"simulation.duration": 1.5}))


def table(run: Trajectory, *channels: str) -> np.ndarray:
    return np.genfromtxt(io.BytesIO(run_csv(run, channels)), delimiter=",", names=True, deletechars="")


def test_the_usual_ones_are_the_file_that_is_saved(run: Trajectory) -> None:
    assert run_csv(run, USUAL) == run.to_bytes(".csv")
    assert run_csv(run, USUAL[::-1]) == run.to_bytes(".csv")


def test_columns_come_in_one_order_with_their_units(run: Trajectory) -> None:
    heads = run_csv(run, list(CHANNELS)[::-1]).decode().splitlines()[0].split(",")
    firsts = [
        next(k for k, head in enumerate(heads) if head.startswith(word))
        for word in (
            "t [s]",
            "hull x [m]",
            "normal load R1 [N]",
            "traction R1 [N]",
            "travel R1 [m]",
            "seat forward",
            "arm angle R1 [rad]",
        )
    ]
    assert firsts == sorted(firsts)
    assert len(heads) == len(set(heads)) == 1 + 6 + 11 + 11 + 6 + 2 + 6


def test_travel_seat_and_arms_are_what_other_places_say(run: Trajectory) -> None:
    found = table(run, "travel", "seat", "arms")
    k = len(run.t) // 2
    assert found["travel_R2_[m]"][0] == 0.0
    assert np.ptp(found["travel_R2_[m]"]) > 0.005
    state = wheel_state(run, 1, float(run.t[k]))
    assert state is not None
    assert np.degrees(found["arm_angle_R2_[rad]"][k]) == pytest.approx(state.arm_angle, abs=1e-5)
    hull = run.a[:, run.system.chassis]
    assert found["seat_vertical_acceleration_[m/s2]"] != pytest.approx(hull[:, 1], abs=1e-3)


def test_the_time_stands_in_every_file(run: Trajectory) -> None:
    assert run_csv(run, ()).startswith(b"t [s]\n0\n")


def test_another_name_is_refused(run: Trajectory) -> None:
    with pytest.raises(ValueError, match="'heat' is no channel; give some of motion, loads"):
        run_csv(run, ["loads", "heat"])
