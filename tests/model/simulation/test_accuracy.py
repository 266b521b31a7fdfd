"""Runs that are not exact say so, and what they advise gives a run that is."""

from dataclasses import replace

import numpy as np
import pytest

from model.analysis.ride_warnings import motion_warnings
from model.config.config import Config
from model.config.config_files import load_config
from model.simulation.accuracy import APART_ALLOWED, APART_NOTED, ENERGY_ALLOWED, advice, exacter
from model.simulation.drive import LiveDrive
from model.simulation.simulate import simulate

UNHELD = {"simulation.baumgarte_alpha": 0, "simulation.baumgarte_beta": 0}
LOOSE = {"simulation.rtol": 0.1, "simulation.atol": 0.1}
COARSE = {"simulation.integrator": "rk4", "simulation.step": 0.007}
ROUGH = {"road.type": "random", "road.roughness_class": "E", "drive.speed_kmh": 70}

# Joints that nothing holds, loose tolerances, both, a step at the edge of stability
INEXACT = {
    "loose": Config().replace({**ROUGH, **LOOSE}),
    "loose and unheld": Config().replace({**ROUGH, **LOOSE, **UNHELD}),
    "coarse": load_config("m113").replace({**COARSE, "simulation.duration": 10}),
}


@pytest.mark.parametrize("name", INEXACT)
def test_a_run_whose_joints_come_apart_is_not_complete_and_its_advice_helps(name):
    config = INEXACT[name]
    run = simulate(config)
    assert run.status.startswith("inaccurate at t = ")
    assert run.status.endswith(" mm apart")
    assert run.constraint_residual.max() <= APART_ALLOWED
    assert len(run.t) < config.simulation.duration * config.simulation.output_rate
    for key, value in exacter(config.simulation).items():
        assert f"{key} to {value:g}".replace("e-06", "e-6") in run.advice
    better = simulate(config.replace(exacter(config.simulation)))
    assert better.complete
    assert better.constraint_residual.max() < APART_NOTED


def test_the_other_advice_for_a_fixed_step_helps_too():
    config = INEXACT["coarse"]
    assert "stretched-rk43" in simulate(config).advice
    assert simulate(config.replace({"simulation.integrator": "stretched-rk43"})).complete


def test_scipys_solvers_stop_too():
    run = simulate(INEXACT["loose and unheld"].replace({"simulation.integrator": "scipy-rk45"}))
    assert run.status.startswith("inaccurate at t = ")
    assert run.constraint_residual.max() <= APART_ALLOWED


def test_a_run_that_loses_energy_is_not_complete(monkeypatch):
    monkeypatch.setattr("model.simulation.trajectory.Trajectory.energy_error", 1.01 * ENERGY_ALLOWED)
    run = simulate(Config().replace({"simulation.duration": 0.5}))
    assert run.status == "inaccurate: 5.1 % of the energy unaccounted for"
    assert run.advice == advice(run.config.simulation)
    assert len(run.t) == 101


def test_little_drift_is_a_warning():
    run = simulate(Config().replace({"simulation.duration": 0.5}))
    assert motion_warnings(run) == []
    run.constraint_residual[7] = 2 * APART_NOTED
    assert [warning.what for warning in motion_warnings(run)] == [
        "The run is not exact: joints 0.2 mm apart (t = 0.04 s)"
    ]
    run.work[9] += 0.01 * np.abs(run.work).max() + 1e3
    (warning,) = motion_warnings(replace(run))
    assert "joints 0.2 mm apart (t = 0.04 s) and " in warning.what
    assert warning.what.endswith(" of the energy unaccounted for")
    assert warning.meaning == advice(run.config.simulation)


def test_a_drive_whose_joints_come_apart_ends_there():
    drive = LiveDrive(INEXACT["loose and unheld"])
    while drive.time < 20 and drive.status.name == "RUNNING":
        drive.advance(drive.time + 0.5)
    assert drive.recent().status.startswith("inaccurate at t = ")
    assert drive.recent().advice


@pytest.mark.parametrize(
    ("settings", "expected"),
    [
        ({}, {"simulation.rtol": 1e-5, "simulation.atol": 1e-7}),
        (LOOSE, {"simulation.rtol": 1e-4, "simulation.atol": 1e-6}),
        (UNHELD, {"simulation.baumgarte_alpha": 20, "simulation.baumgarte_beta": 20}),
        ({"simulation.integrator": "rk4"}, {"simulation.step": 0.00025}),
        ({"simulation.rtol": 1e-12, "simulation.atol": 1e-14}, {}),
    ],
)
def test_what_is_changed_for_a_more_exact_run(settings, expected):
    changes = exacter(Config().replace(settings).simulation)
    assert changes == pytest.approx(expected)
    assert advice(Config().replace(settings).simulation)
    Config().replace({**settings, **changes})
