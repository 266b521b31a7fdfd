"""The balances close for runs that obey the laws, and show it when a run does not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from model import simulate
from model.analysis.energy import energy_balance, load_balance
from model.simulation.trajectory import Trajectory
from tests.model.analysis.support import standing
from tests.model.support import FLAT, OPTIONS, PAPER

JUMPY = {"half round": 0.2, "bridging": 0.15}  # %, where the contact point jumps: limited by the output rate
SMOOTH = 0.01  # %


@pytest.fixture(scope="module")
def paper_run() -> Trajectory:
    return simulate(PAPER.replace({"simulation.rtol": 1e-6, "simulation.atol": 1e-8}))


@pytest.mark.parametrize("option", OPTIONS)
def test_both_balances_close_with_every_option(option):
    run = simulate(PAPER.replace({**OPTIONS[option], "simulation.duration": 6, "simulation.rtol": 2e-5}))
    energy = energy_balance(run)
    assert energy.closing_error < JUMPY.get(option, SMOOTH)
    for power in (energy.suspension_power, energy.ground_power, energy.friction_power):
        assert power.min() > -1e-9 * energy.turned_over
    assert np.abs(load_balance(run).residual).max() < 1e-6


def test_what_is_left_open_is_the_integrators_and_the_output_rates():
    def error(**simulation: float) -> float:
        changes = {f"simulation.{key}": value for key, value in simulation.items()}
        return np.abs(energy_balance(simulate(PAPER.replace(changes))).residual).max()

    loose, tight = error(output_rate=2000), error(output_rate=2000, rtol=1e-8, atol=1e-10)
    assert tight < 0.05 < 0.3 < loose < 30  # J, of more than 100 kJ
    assert error(output_rate=50, rtol=1e-8, atol=1e-10) > 20 * tight


def test_without_any_damping_energy_is_only_exchanged():
    changes = {
        "road.amplitude": 0.05,
        "vehicle.road_suspension.damping": 0,
        "vehicle.imaginary_suspension.damping": 0,
        "contact.normal_damping": 0,
        "contact.tangential_damping": 1e-3 * 1e4,
        "drive.proportional_gain": 0,
        "drive.integral_gain": 0,
        "simulation.rtol": 1e-7,
        "simulation.duration": 3,
    }
    energy = energy_balance(simulate(PAPER.replace(changes)))
    assert not energy.drive_power.any()
    assert not energy.suspension_power.any()
    assert np.ptp(energy.kinetic) > 500
    exchanged = np.ptp(energy.stored)
    assert exchanged < 0.02 * np.ptp(energy.kinetic)
    assert energy.closing_error < SMOOTH


def test_the_drive_pays_for_what_the_dampers_take(paper_run):
    energy = energy_balance(paper_run)
    period = 7 / (15 / 3.6)
    whole = paper_run.t > paper_run.t[-1] - 2 * period  # two waves, after which all is as it was
    assert energy.drive_power[whole].mean() == pytest.approx(energy.dissipated_power[whole].mean(), rel=0.02)
    assert energy.suspension_power[whole].mean() > 1000


@pytest.mark.parametrize(
    "wrong",
    [
        lambda run: replace(run, normal_load=1.05 * run.normal_load),
        lambda run: replace(run, drive_force=1.01 * run.drive_force),
        lambda run: replace(run, traction=0.95 * run.traction),
        lambda run: replace(run, v=run.v * (1.0005, 1, 1)),
        lambda run: replace(run, q=run.q * (1, 1, 1.01)),
        lambda run: replace(run, config=run.config.replace({"vehicle.road_suspension.damping": 4800})),
    ],
    ids=["loads", "drive", "traction", "speed", "turns", "damping"],
)
def test_a_wrong_run_does_not_close(paper_run, wrong):
    right = energy_balance(paper_run).closing_error
    assert energy_balance(wrong(paper_run)).closing_error > 5 * right


def test_loads_that_do_not_carry_the_vehicle_are_seen(paper_run):
    mass = paper_run.system.mass.sum()
    heavier = load_balance(replace(paper_run, a=paper_run.a + np.array([0, 0.01, 0])))
    assert heavier.residual == pytest.approx(-0.01 * mass, abs=1e-6)
    assert load_balance(paper_run).weight_and_inertia.mean() == pytest.approx(9.81 * mass, rel=0.01)
    slack = replace(paper_run, traction=np.zeros_like(paper_run.traction))
    assert np.abs(load_balance(slack).residual).max() > 10  # on slopes, traction carries too


def test_a_vehicle_at_rest_turns_over_nothing():
    energy = energy_balance(standing(FLAT))
    assert energy.turned_over == 0
    assert np.isnan(energy.closing_error)
    assert not energy.residual.any()
