"""All cases of the independent engine (tests/reference), at default tolerances."""

from __future__ import annotations

import numpy as np
import pytest

from model import load_config, simulate
from tests.conftest import REFERENCE, REFERENCE_CASES

# A run on flat ground accelerates by next to nothing; below this rms, agreement is judged as if it had this.
# 0.5 % of it is a fifteenth of 0.015 m/s², the weakest vertical vibration that people feel (ISO 2631-1).
LEAST_ACCELERATION = 0.2  # m/s²


def rms(x: np.ndarray) -> float:
    return float(np.sqrt(np.mean(np.square(x))))


def worst_wheel(x: np.ndarray) -> float:
    """Largest rms of the columns of (N, W)."""
    return max(rms(column) for column in x.T)


def test_all_cases_are_there():
    assert len(REFERENCE_CASES) == 27


@pytest.mark.parametrize("case", REFERENCE_CASES)
def test_agrees_with_the_independent_engine(case):
    run = simulate(load_config(REFERENCE / f"{case}.yaml"))
    assert run.status == "complete"
    with np.load(REFERENCE / f"{case}.npz") as file:
        right = dict(file)
    n, hard = run.system.n, "peak_load" in right  # random draws and hard suspensions
    np.testing.assert_allclose(run.t, np.arange(len(right["chassis"])) / right["rate"], atol=1e-12)
    peak = right["normal_load"].max()
    load = run.normal_load - right["normal_load"]
    a_y = right["chassis_vertical_acceleration"]
    arm_angle = run.q[:, 1 : 1 + n, 2] - run.q[:, :1, 2]
    # Each difference, and what is allowed
    checks = {
        "static load": (np.abs(run.static_load / right["static_load"] - 1).max(), 5e-4),
        "normal load, rms": (worst_wheel(load), 1e-3 * peak),
        "normal load": (np.abs(load).max(), 2e-2 * peak),
        "vertical acceleration": (rms(run.a[:, 0, 1] - a_y), 5e-3 * max(rms(a_y), LEAST_ACCELERATION)),
        "heave": (np.abs(run.q[:, 0, 1] - right["chassis"][:, 1]).max(), 1e-4 if hard else 20e-6),
        "pitch": (np.abs(run.q[:, 0, 2] - right["chassis"][:, 2]).max(), 1e-4 if hard else 5e-5),
        "arm angles": (np.abs(arm_angle - right["road_arm_angle"]).max(), 1e-3 if hard else 2e-4),
        "speed": (np.abs(run.v[:, 0, 0] - right["chassis"][:, 3]).max(), 1e-3),
        "traction": (worst_wheel(run.traction[::2] - right["traction_100hz"]), 2e-3 * peak),
        "drive force": (rms(run.drive_force - right["drive_force"]), 2e-3 * peak),
        "drift": (run.constraint_residual.max(), 10e-6),
    }
    too_far = {name: pair for name, pair in checks.items() if not pair[0] <= pair[1]}
    assert not too_far
