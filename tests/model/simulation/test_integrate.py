"""Steppers: order, dense output, agreement with SciPy's, drift, and runs that come to grief."""

from __future__ import annotations

import numpy as np
import pytest

from model import load_config, simulate
from model.config.config import Config
from model.config.parameters import INTEGRATORS
from model.dynamics.equilibrium import rest_pose
from model.dynamics.vehicle import build_system
from model.road.road import build_road
from model.simulation import integrate
from model.simulation.integrate import ADAPTIVE, ADVICE, REASON, SCIPY_METHODS, Integration, Status
from model.simulation.simulate import CHUNK, starting_state
from model.simulation.tableaus import Tableau
from tests.model.support import FLAT, PAPER, WHEELS, entries

COMPILED = [*ADAPTIVE, "rk4"]


def start(config: Config, **settings: object) -> Integration:
    """An integration of 0.5 s from the configuration's starting state."""
    system = build_system(config)
    return Integration(system, build_road(config).table, starting_state(system)[0], 0.5, 200.0, **settings)


def finish(run: Integration) -> Integration:
    while run.advance(run.t + 0.5) is Status.RUNNING:
        pass
    return run


# Order


def smooth_run(integrator: str, step: float, monkeypatch: pytest.MonkeyPatch) -> Integration:
    """Half a second on flat ground after a push, in steps of one size, sampled far inside the steps.

    All wheels stay on the ground and stick, so that the right-hand side is smooth.
    """
    monkeypatch.setattr(Integration, "_longest", lambda _: step)
    system = build_system(FLAT)
    y, _ = starting_state(system)
    y[entries(system, "v_y")] = -0.05  # everything moves down
    y[entries(system, "omega")[0]] = 0.02  # and the chassis pitches
    run = finish(Integration(system, build_road(FLAT).table, y, 0.5, 5000.0, integrator, rtol=1e6, atol=1e6, step=step))
    assert run.status is Status.COMPLETE
    assert run.rejected_steps == 0
    return run


def dense_error(integrator: str, step: float, monkeypatch: pytest.MonkeyPatch) -> float:
    """Largest error of poses and speeds at all samples."""
    right = smooth_run("dormand-prince", 1e-4, monkeypatch).samples
    found = smooth_run(integrator, step, monkeypatch).samples
    assert (right.f_n > 0.0).all()
    assert (np.abs(right.f_t) < 0.7 * right.f_n).all()
    return max(np.abs(found.q - right.q).max(), np.abs(found.v - right.v).max())


@pytest.mark.parametrize(("integrator", "order"), [("stretched-rk43", 4), ("dormand-prince", 5), ("rk4", 4)])
def test_order_of_the_stepper_and_of_its_dense_output(integrator, order, monkeypatch):
    """Half the step, 2^order times the accuracy, between the steps as well."""
    errors = [dense_error(integrator, step, monkeypatch) for step in (2e-3, 1e-3, 5e-4)]
    observed = np.log2(np.array(errors[:-1]) / errors[1:])
    assert errors[0] < 1e-4
    assert observed == pytest.approx([order, order], abs=0.6)


def order_conditions(tableau: Tableau, weights: np.ndarray) -> list[float]:
    """Elementary weights less what the exact solution has, of orders 1 to 4 (Hairer et al., table II.2.1)."""
    c, A = tableau.time, np.pad(tableau.stage, ((0, 0), (0, 1)))
    return [
        weights.sum() - 1,
        weights @ c - 1 / 2,
        weights @ c**2 - 1 / 3,
        weights @ A @ c - 1 / 6,
        weights @ c**3 - 1 / 4,
        weights @ (c * (A @ c)) - 1 / 8,
        weights @ A @ c**2 - 1 / 12,
        weights @ A @ A @ c - 1 / 24,
    ]


@pytest.mark.parametrize("tableau", ADAPTIVE.values(), ids=ADAPTIVE)
def test_the_order_conditions_of_a_tableau(tableau):
    new_state = np.append(tableau.stage[tableau.stages - 1], 0.0)
    np.testing.assert_allclose(tableau.stage.sum(axis=1)[: tableau.stages], tableau.time[: tableau.stages], 0.0, 1e-14)
    np.testing.assert_allclose(order_conditions(tableau, new_state), 0.0, atol=1e-14)
    estimate = order_conditions(tableau, new_state - tableau.error)
    exact = 4 if tableau.order == 4 else 8  # conditions that the embedded solution fulfils
    np.testing.assert_allclose(estimate[:exact], 0.0, atol=1e-14)


@pytest.mark.parametrize("tableau", ADAPTIVE.values(), ids=ADAPTIVE)
def test_a_tableaus_stability_reaches_as_far_as_it_says(tableau):
    def growth(z: complex) -> float:
        """|R(z)|: of y in one step of y' = z y, h = 1."""
        k = np.zeros(tableau.stages, dtype=complex)
        for stage in range(tableau.stages):
            y = 1 + tableau.stage[stage, :stage] @ k[:stage]
            k[stage] = z * y
        return abs(y)

    along = np.array([growth(-x) for x in np.linspace(0.01, tableau.reach, 200)])
    assert (along < 1.0).all()
    assert growth(-tableau.reach - 0.1) > 1.0


@pytest.mark.parametrize("tolerance", [1e-3, 1e-5, 1e-7])
def test_the_error_follows_the_tolerance(tolerance):
    config = PAPER.replace({"simulation.duration": 2.5})
    right = simulate(config.replace({"simulation.rtol": 1e-10, "simulation.atol": 1e-12}))
    found = simulate(config.replace({"simulation.rtol": tolerance, "simulation.atol": tolerance / 100}))
    error = np.abs(found.q - right.q).max()  # m or rad, of all bodies, after 2.5 s with slip and lift-off
    assert error < 20 * tolerance
    assert error > 0.01 * tolerance  # and not by taking far more steps than asked


# Output, chunks


@pytest.mark.parametrize("integrator", COMPILED)
def test_the_output_rate_does_not_change_the_steps(integrator):
    config = PAPER.replace({"simulation.integrator": integrator, "simulation.duration": 3})
    coarse, fine = (simulate(config.replace({"simulation.output_rate": rate})) for rate in (10, 2000))
    assert coarse.statistics.steps == fine.statistics.steps
    assert coarse.statistics.evaluations == fine.statistics.evaluations
    assert len(coarse.t) == 31
    assert len(fine.t) == 6001
    for name in ("q", "v", "a", "normal_load", "multipliers"):
        values = getattr(coarse, name)
        np.testing.assert_allclose(getattr(fine, name)[::200], values, atol=1e-11 * np.abs(values).max())


@pytest.mark.parametrize("integrator", COMPILED)
def test_chunks_do_not_change_the_run(integrator):
    whole, parts = start(PAPER, integrator=integrator), start(PAPER, integrator=integrator)
    whole.advance(0.5)
    while parts.advance(parts.t + 0.003) is Status.RUNNING:
        pass
    assert parts.steps == whole.steps
    np.testing.assert_array_equal(parts.y, whole.y)
    for one, other in zip(parts.samples, whole.samples, strict=True):
        np.testing.assert_array_equal(one, other)


def test_steps_are_far_longer_than_the_samples_of_a_fine_output():
    run = simulate(PAPER.replace({"simulation.output_rate": 2000}))
    assert run.statistics.steps < 2000
    assert len(run.t) == 20_001


@pytest.mark.parametrize("rate", [10, 199, 200, 1000])
@pytest.mark.parametrize("duration", [0.1, 0.37, 1.0])
def test_samples_stand_at_multiples_of_the_rate(rate, duration):
    for integrator in COMPILED:
        run = simulate(
            FLAT.replace(
                {"simulation.duration": duration, "simulation.output_rate": rate, "simulation.integrator": integrator}
            )
        )
        np.testing.assert_array_equal(run.t, np.arange(np.floor(duration * rate + 1e-9) + 1) / rate)
        assert run.complete


def test_accelerations_and_loads_belong_to_the_samples_state():
    """a is the derivative of v, and v that of q, between samples."""
    tight = {"simulation.rtol": 1e-10, "simulation.atol": 1e-12}
    run = simulate(PAPER.replace({"simulation.output_rate": 2000, "simulation.duration": 1} | tight))
    within = np.arange(1, len(run.t) - 1)
    np.testing.assert_allclose((run.q[within + 1] - run.q[within - 1]) * 1000, run.v[within], atol=1e-5)
    np.testing.assert_allclose(
        (run.v[within + 1] - run.v[within - 1]) * 1000, run.a[within], atol=1e-3 * np.abs(run.a).max()
    )


# Agreement


def test_every_integrator_of_the_configuration_exists():
    assert set(INTEGRATORS) == {*COMPILED, *SCIPY_METHODS}


@pytest.mark.parametrize("integrator", ["dormand-prince", "rk4", *SCIPY_METHODS])
def test_integrators_agree(integrator):
    """On the first waves, at tight tolerances."""
    tight = {"simulation.duration": 1.5, "simulation.rtol": 1e-7, "simulation.atol": 1e-9, "simulation.step": 5e-4}
    config = PAPER.replace(tight)
    right = simulate(config)
    found = simulate(config.replace({"simulation.integrator": integrator}))
    assert found.complete
    assert len(found.t) == len(right.t)
    np.testing.assert_allclose(found.q, right.q, atol=3e-6)
    np.testing.assert_allclose(found.normal_load, right.normal_load, atol=2.0)
    assert found.statistics.steps > 0
    assert found.statistics.evaluations > found.statistics.steps


# Drift


def test_without_baumgarte_the_joints_drift_apart():
    plain = {"simulation.baumgarte_alpha": 0.0, "simulation.baumgarte_beta": 0.0, "simulation.duration": 20}
    drifting = simulate(PAPER.replace(plain)).constraint_residual
    held = simulate(PAPER.replace({"simulation.duration": 20})).constraint_residual
    assert held.max() < 10e-6
    assert drifting[-200:].max() > 5 * held.max()
    quarter = len(drifting) // 4
    growth = [drifting[part * quarter : (part + 1) * quarter].max() for part in range(4)]
    assert (np.diff(growth) > 0.0).all()


def test_baumgarte_closes_a_joint_that_has_been_pulled_open():
    run = start(FLAT)
    run.y[entries(run.system, "y")[run.system.road_wheels][0]] += 1e-4  # lift a road wheel off its arm
    finish(run)
    assert run.samples.residual[0] == pytest.approx(1e-4, rel=1e-6)
    assert run.samples.residual[-1] < 0.01e-4


@pytest.mark.parametrize("rate", [5.0, 100.0])
def test_the_motion_does_not_depend_on_baumgartes_constants(rate):
    usual = simulate(PAPER)
    other = simulate(PAPER.replace({"simulation.baumgarte_alpha": rate, "simulation.baumgarte_beta": rate}))
    assert np.abs(other.q[:, 0] - usual.q[:, 0]).max() < 50e-6
    assert np.abs(other.normal_load - usual.normal_load).max() < 0.01 * usual.normal_load.max()


# Runs that come to grief


def assert_good_part(run) -> None:  # type: ignore[no-untyped-def]
    """All arrays are as long as t and finite."""
    for name in ("q", "v", "a", "normal_load", "traction", "drive_force", "multipliers", "constraint_residual"):
        values = getattr(run, name)
        assert len(values) == len(run.t)
        assert np.isfinite(values).all(), name


@pytest.mark.parametrize("config", [PAPER, FLAT, PAPER.replace({"drive.mode": "prescribed"})])
@pytest.mark.parametrize("step", [0.01, 0.1])
def test_too_long_a_fixed_step_gives_the_good_part_and_says_why(config, step):
    run = simulate(config.replace({"simulation.integrator": "rk4", "simulation.step": step}))
    assert not run.complete
    assert run.status.startswith(("diverged at t = ", "inaccurate at t = "))
    assert "horten the step" in run.advice
    assert 0 < len(run.t) < 2001
    assert run.t[-1] <= float(run.status.split()[4]) + step
    assert_good_part(run)
    assert np.abs(run.v[..., :2]).max() < 2e3


def test_a_contact_too_stiff_for_the_smallest_step():
    """A wheel of 100 g and 4 m across on ground of 10⁸ N s/m: its rim comes to rest within 10⁻¹² s."""
    stiff = {
        "contact.tangential_damping": 1e8,
        f"{WHEELS}.mass": 0.1,
        f"{WHEELS}.inertia": 1e-4,
        f"{WHEELS}.radius": 2.0,
        "simulation.duration": 1,
    }
    run = simulate(PAPER.replace(stiff))
    assert run.status.endswith(REASON[Status.STEP_TOO_SMALL])
    assert run.advice == ADVICE[Status.STEP_TOO_SMALL]
    assert_good_part(run)


def test_too_many_steps():
    stiff = {"contact.tangential_damping": 1e8, f"{WHEELS}.mass": 1.0, "simulation.duration": 0.3}
    run = simulate(PAPER.replace(stiff))
    assert run.status.endswith(REASON[Status.TOO_MANY_STEPS])
    assert run.advice.startswith("Set contact.tangential_damping to ")
    assert run.statistics.steps + run.statistics.rejected_steps < 0.3 * 50_000 + 6_000
    assert_good_part(run)


@pytest.mark.parametrize("integrator", [*COMPILED, *SCIPY_METHODS])
@pytest.mark.parametrize("entry", ["x", "speed", "angle"])
def test_a_state_that_is_no_number_ends_the_run(integrator, entry):
    """From the first moment on; nothing raises, nothing hangs, and no such value reaches a sample."""
    run = start(FLAT, integrator=integrator)
    coordinate, body = {"x": ("x", -1), "speed": ("v_y", 0), "angle": ("theta", 0)}[entry]
    run.y[entries(run.system, coordinate)[body]] = np.nan
    finish(run)
    assert run.status in (Status.NOT_FINITE, Status.SOLVER_FAILED)
    assert run.samples_done == 0
    assert run.status in REASON
    assert run.status in ADVICE


@pytest.mark.parametrize("integrator", COMPILED)
def test_a_runaway_is_stopped(integrator):
    run = start(FLAT, integrator=integrator)
    run.y[entries(run.system, "v_y")[0]] = 5e4  # m/s upwards
    assert finish(run).status in (Status.RUNAWAY, Status.NOT_FINITE)
    assert run.t < 0.1


def test_every_end_has_a_reason_and_advice():
    assert set(REASON) == set(ADVICE) == set(Status) - {Status.RUNNING, Status.COMPLETE, Status.JOINTS_APART}
    assert all(text.endswith(".") for text in ADVICE.values())


# Progress and stopping


@pytest.mark.parametrize("integrator", [*COMPILED, "scipy-rk45"])
def test_progress_grows_from_nothing_to_one(integrator):
    seen: list[float] = []
    simulate(FLAT.replace({"simulation.integrator": integrator, "simulation.duration": 5}), seen.append)
    assert len(seen) >= 6
    assert seen == sorted(seen)
    assert seen[0] == 0.0  # the model is compiled
    assert 0.0 < seen[1] < 0.5
    assert seen[-1] == 1.0
    assert seen.count(1.0) == 1


@pytest.mark.parametrize("integrator", [*COMPILED, "scipy-rk45"])
def test_a_run_can_be_stopped_between_chunks(integrator, monkeypatch):
    monkeypatch.setattr(integrate, "LOOK", 60.0)  # else a busy machine makes more chunks
    asked = 0

    def third_time() -> bool:
        nonlocal asked
        asked += 1
        return asked == 3

    run = simulate(FLAT.replace({"simulation.integrator": integrator}), should_stop=third_time)
    assert asked == 3
    assert run.status == "cancelled"
    assert run.advice == ""
    assert 2.8 * CHUNK < run.t[-1] < 4 * CHUNK
    assert_good_part(run)
    whole = simulate(FLAT.replace({"simulation.integrator": integrator, "simulation.duration": 5}))
    np.testing.assert_array_equal(run.q, whole.q[: len(run.t)])


def test_a_stiff_run_is_stopped_as_soon():
    """The stepper looks up after so many steps, however little time they make."""
    stiff = {"contact.tangential_damping": 1e8, f"{WHEELS}.mass": 1.0}
    run = simulate(PAPER.replace(stiff), should_stop=lambda: True)
    assert run.status == "cancelled"
    assert run.statistics.steps + run.statistics.rejected_steps <= 1_000


@pytest.mark.parametrize("integrator", SCIPY_METHODS)
def test_scipys_solvers_look_up_as_well(integrator, monkeypatch):
    """After so much wall time; then they go on as if nothing had been, and have a bound."""
    whole = finish(start(FLAT, integrator=integrator))
    np.testing.assert_allclose(whole.samples.q, finish(start(FLAT)).samples.q, atol=1e-4)
    monkeypatch.setattr(integrate, "LOOK", 0.0)
    run = start(FLAT, integrator=integrator)
    assert run.advance(0.5) is Status.RUNNING
    assert run.steps == 1
    assert finish(run).status is Status.COMPLETE
    np.testing.assert_array_equal(run.samples.q, whole.samples.q)
    monkeypatch.setattr(integrate, "STEPS_PER_SECOND", 20)
    assert finish(start(FLAT, integrator=integrator)).status is Status.TOO_MANY_STEPS


def test_an_integration_leaves_its_starting_state_alone():
    system = build_system(PAPER)
    y, _ = starting_state(system)
    before = y.copy()
    finish(Integration(system, build_road(PAPER).table, y, 0.5, 200.0))
    np.testing.assert_array_equal(y, before)


def test_a_run_starts_at_the_rest_pose_rolling():
    """Everything moves at v_ref, wheels roll; no traction, no drive, and the static loads."""
    run = simulate(PAPER.replace({"simulation.duration": 0.1}))
    q, load = rest_pose(run.system)
    v_ref = 15 / 3.6
    np.testing.assert_allclose(run.q[0], q, atol=1e-15)
    np.testing.assert_array_equal(run.v[0, :, 0], v_ref)
    np.testing.assert_array_equal(run.v[0, :, 1], 0.0)
    np.testing.assert_allclose(run.v[0, run.system.wheel, 2], -v_ref / 0.32)
    np.testing.assert_array_equal(np.delete(run.v[0, :, 2], run.system.wheel), 0.0)
    np.testing.assert_allclose(run.normal_load[0], load, rtol=1e-12)
    np.testing.assert_allclose(run.static_load, load, rtol=1e-12)
    np.testing.assert_allclose(run.traction[0], 0.0, atol=1e-9)
    np.testing.assert_allclose(run.tangential_displacement[0], 0.0)
    assert run.drive_force[0] == 0.0


@pytest.mark.parametrize("integrator", SCIPY_METHODS)
def test_scipys_solvers_look_up_inside_a_step(integrator, monkeypatch):
    """A step that takes longer than a look is given up, and the run stands where it stood."""
    monkeypatch.setattr(integrate, "LOOK", 0.0)
    run = start(FLAT, integrator=integrator)
    run.advance(0.5)
    stood, state = run.t, run.y.copy()
    assert run.advance(0.5, should_stop=lambda: True) is Status.RUNNING
    assert run.t == stood > 0.0
    np.testing.assert_array_equal(run.y, state)
    assert finish(run).status is Status.COMPLETE


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_a_run_that_ends_in_its_first_step_has_its_start(integrator):
    run = start(PAPER, integrator=integrator)
    run.y[entries(run.system, "v_y")] = -2000.0
    begin = run.y.copy()
    finish(run)
    assert run.status in REASON
    assert run.samples_done == 1
    np.testing.assert_array_equal(run.samples.v[0, :, 1], -2000.0)
    np.testing.assert_array_equal(run.y, begin)
    assert np.isfinite(run.samples.a[0]).all()


def test_a_drive_force_at_its_limit_does_not_stop_a_run_at_a_tight_tolerance():
    """In the air the force stays where the controller's integral begins to stand still: it ended at 4.68 s."""
    road = {"road.type": "random", "road.roughness_class": "H", "road.seed": 5}
    tight = {"simulation.rtol": 1e-9, "simulation.atol": 1e-11}
    run = simulate(load_config("m113_rs").replace(road | tight | {"drive.speed_kmh": 20, "simulation.duration": 5}))
    assert run.status == "complete"
