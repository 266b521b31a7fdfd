"""Each equation on its own: against finite differences, hand figures and Newton's laws."""

from __future__ import annotations

import numpy as np
import pytest

from model.dynamics import equations
from model.dynamics.equations import State
from model.dynamics.vehicle import System, build_system
from model.road.road import Road, build_road
from tests.model.support import FLAT, IMAGINARY, OPTIONS, PAPER, across, admissible_state, random_state, turned

G = 9.81
KINDS = ["paper", "prescribed", "uneven positions", "without imaginary wheels", "reacts on chassis", "two wheels"]


def system_and_state(option: str, seed: int = 0) -> tuple[System, Road, float, State]:
    config = PAPER.replace(OPTIONS[option])
    system = build_system(config)
    t, state = random_state(system, np.random.default_rng(seed))
    return system, build_road(config), t, state


# Constraints: eq. (9)–(11), (13), (14)


@pytest.mark.parametrize("option", KINDS)
def test_jacobian_is_the_derivative_of_the_constraints(option):
    system, _, t, state = system_and_state(option)
    C_q = equations.jacobian(system, state.q)
    h = 1e-6
    for column in range(state.q.size):
        step = np.zeros(state.q.size)
        step[column] = h
        step = step.reshape(state.q.shape)
        difference = equations.constraints(system, state.q + step, t) - equations.constraints(system, state.q - step, t)
        np.testing.assert_allclose(C_q[:, column], difference / (2 * h), atol=1e-8)


@pytest.mark.parametrize("option", KINDS)
def test_constraint_rate_is_the_derivative_of_C_along_the_motion(option):
    system, _, t, (q, v, *_) = system_and_state(option)
    h = 1e-6
    difference = equations.constraints(system, q + h * v, t + h) - equations.constraints(system, q - h * v, t - h)
    np.testing.assert_allclose(equations.constraint_rate(system, q, v), difference / (2 * h), atol=1e-7)


@pytest.mark.parametrize("option", KINDS)
def test_acceleration_side_is_what_the_second_derivative_leaves(option):
    """d²C/dt² = C_q a − γ along q + v h + a h²/2, for any a; without Baumgarte's terms."""
    system, _, t, (q, v, *_) = system_and_state(option)
    plain = system._replace(alpha=0.0, beta=0.0)
    a = np.random.default_rng(1).normal(size=q.shape)
    h = 1e-5

    def C_dot(h: float) -> np.ndarray:
        return equations.constraint_rate(plain, q + h * v + h**2 / 2 * a, v + h * a)

    second = (C_dot(h) - C_dot(-h)) / (2 * h)
    gamma = equations.jacobian(plain, q) @ a.ravel() - second
    np.testing.assert_allclose(equations.acceleration_side(plain, q, v, t), gamma, atol=1e-7 * np.abs(gamma).max())


@pytest.mark.parametrize("option", ["paper", "prescribed"])
def test_baumgarte_adds_its_two_terms(option):
    system, _, t, (q, v, *_) = system_and_state(option)
    system = system._replace(alpha=7.0, beta=3.0)
    plain = system._replace(alpha=0.0, beta=0.0)
    added = equations.acceleration_side(system, q, v, t) - equations.acceleration_side(plain, q, v, t)
    expected = -14.0 * equations.constraint_rate(system, q, v) - 9.0 * equations.constraints(system, q, t)
    np.testing.assert_allclose(added, expected, rtol=1e-9, atol=1e-9)


def test_prescribed_row_holds_the_speed():
    """Eq. (11): R_x − v_ref t, so its rate is Ṙ_x − v_ref and its γ has no other part."""
    system, _, t, (q, v, *_) = system_and_state("prescribed")
    assert equations.constraint_rate(system, q, v)[-1] == pytest.approx(v[0, 0] - 15 / 3.6)
    assert equations.acceleration_side(system._replace(alpha=0.0, beta=0.0), q, v, t)[-1] == 0.0


# Suspension torques: eq. (1)–(3)


def torques(option: str, body: int, angle: float = 0.0, rate: float = 0.0) -> np.ndarray:
    """What the torques (B,) change by when one body is turned, or turns, N m."""
    system = build_system(PAPER.replace(OPTIONS[option]))
    q, v = system.q_design.copy(), np.zeros_like(system.q_design)
    at_rest = equations.suspension_torques(system, q, v)
    q[body, 2], v[body, 2] = angle, rate
    return equations.suspension_torques(system, q, v) - at_rest


K_S, C_S = (rate * (0.35 * np.cos(np.radians(20))) ** 2 for rate in (75530, 4732))
K_SL, C_SL = 10000 * 0.35**2, 5000 * 0.35**2
ARM_2, WHEEL_2, LINK_2 = 2, 8, 14


def test_road_torsion_bar_turns_its_arm_back_and_the_chassis_along():
    change = torques("without imaginary wheels", ARM_2, angle=0.1)
    assert change[ARM_2] == pytest.approx(-0.1 * K_S)
    assert change[0] == pytest.approx(0.1 * K_S)
    assert np.count_nonzero(change) == 2
    change = torques("without imaginary wheels", ARM_2, rate=2.0)
    assert change[ARM_2] == pytest.approx(-2.0 * C_S)
    assert change[0] == pytest.approx(2.0 * C_S)


def test_imaginary_spring_leans_on_the_road_arm_not_on_the_wheel():
    for kind, rate in ({"angle": 0.1}, 0.1 * K_SL), ({"rate": 2.0}, 2.0 * C_SL):
        change = torques("paper", LINK_2, **kind)
        assert change[LINK_2] == pytest.approx(-rate)
        assert change[ARM_2] == pytest.approx(rate)
        assert np.count_nonzero(change) == 2
    assert np.count_nonzero(torques("paper", WHEEL_2, angle=0.3, rate=9.0)) == 0


def test_road_arm_in_between_takes_both_torques():
    change = torques("paper", ARM_2, angle=0.1)
    assert change[ARM_2] == pytest.approx(-0.1 * (K_S + K_SL))
    assert change[0] == pytest.approx(0.1 * K_S)
    assert change[LINK_2] == pytest.approx(0.1 * K_SL)


def test_imaginary_spring_can_lean_on_the_chassis():
    change = torques("reacts on chassis", LINK_2, angle=0.1)
    assert change[LINK_2] == pytest.approx(-0.1 * K_SL)
    assert change[0] == pytest.approx(0.1 * K_SL)
    assert np.count_nonzero(change) == 2


def test_preload_presses_the_imaginary_wheel_down_and_carries_the_chassis():
    """+τ'_0 turns an arm that runs back so that its wheel goes down; −τ'_0 acts on the road arm."""
    system = build_system(PAPER)
    torque = equations.suspension_torques(system, system.q_design, np.zeros_like(system.q_design))
    np.testing.assert_allclose(torque[system.imaginary_arms], 350.0)
    np.testing.assert_allclose(torque[1:6], system.tau_0[:5] - 350.0)
    np.testing.assert_allclose(torque[6], system.tau_0[5])
    np.testing.assert_allclose(torque[0], -system.tau_0[:6].sum())
    assert (system.tau_0[:6] > 0.0).all()
    np.testing.assert_allclose(torque.sum(), 0.0, atol=1e-9)


# Contact: eq. (4)–(7)

SYSTEM, GROUND = build_system(FLAT), build_road(FLAT)


def contact(
    z: float, v: tuple[float, float, float] = (0.0, 0.0, 0.0), xi: float = 0.0, system: System = SYSTEM
) -> tuple[float, float, float]:
    """f_n, f_t, ξ̇ of a wheel that has sunk into level ground by z."""
    n, t, f_n, f_t, xi_dot = equations.contact(system, GROUND, np.array([5.0, 0.32 - z, 0.0]), np.array(v), xi)
    np.testing.assert_allclose(n, [0.0, 1.0])
    np.testing.assert_allclose(t, [1.0, 0.0])
    return f_n, f_t, xi_dot


def test_normal_force_grows_with_the_square_of_the_penetration():
    assert contact(0.01)[0] == pytest.approx(6000.0)
    assert contact(0.02)[0] == pytest.approx(24000.0)


def test_normal_force_grows_while_the_wheel_sinks_in():
    assert contact(0.01, (0.0, -0.5, 0.0))[0] == pytest.approx(6000.0 + 1500.0)
    assert contact(0.01, (0.0, 0.5, 0.0))[0] == pytest.approx(6000.0 - 1500.0)


def test_the_ground_never_pulls():
    assert contact(0.01, (0.0, 2.5, 0.0))[0] == 0.0
    assert contact(-0.01, (0.0, -9.0, 0.0)) == (0.0, 0.0, 0.0)


def test_a_rolling_wheel_feels_no_traction():
    f_n, f_t, xi_dot = contact(0.01, (2.0, 0.0, -2.0 / 0.32))
    assert f_n > 0.0
    assert f_t == pytest.approx(0.0, abs=1e-9)
    assert xi_dot == pytest.approx(0.0, abs=1e-12)


def test_a_sticking_wheel_is_held_by_the_grounds_spring_and_damper():
    """f_t = −(k_t ξ + c_t ṗ), ξ̇ = ṗ."""
    assert contact(0.01, xi=0.004)[1:] == (pytest.approx(-2000.0), pytest.approx(0.0, abs=1e-12))
    assert contact(0.01, (0.1, 0.0, 0.0))[1:] == (pytest.approx(-1000.0), pytest.approx(0.1))
    assert contact(0.01, (0.0, 0.0, 0.5))[1:] == (pytest.approx(-1600.0), pytest.approx(0.16))


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_slipping_wheel_is_held_by_friction(sign):
    """±μ f_n against the slip; ξ̇ follows from the limited force."""
    f_n, f_t, xi_dot = contact(0.01, (sign * 3.0, 0.0, 0.0), xi=sign * 0.002)
    assert f_t == pytest.approx(-sign * 0.7 * f_n)
    assert xi_dot == pytest.approx(-(5e5 * sign * 0.002 - sign * 4200.0) / 1e4)


def test_the_grounds_displacement_relaxes_in_the_air():
    assert contact(-0.05, (3.0, 0.0, 0.0), xi=0.004) == (0.0, 0.0, pytest.approx(-50.0 * 0.004))


def test_contact_acts_along_the_normal_of_a_slope():
    """At the steepest point of the sine: n across the slope, t along it, ż and ṗ the velocity's parts."""
    road = build_road(PAPER)
    s = 2.75 + 14.0
    slope = 0.1 * 2 * np.pi / 7.0
    n = np.array([-slope, 1.0]) / np.hypot(slope, 1.0)
    t = np.array([1.0, slope]) / np.hypot(slope, 1.0)
    centre = np.array([s, 0.0]) + 0.31 * n
    v = -0.2 * n + 0.05 * t
    found = equations.contact(SYSTEM, road, np.append(centre, 0.0), np.append(v, 0.5), 0.0)
    np.testing.assert_allclose(found[0], n, atol=1e-9)
    np.testing.assert_allclose(found[1], t, atol=1e-9)
    assert found[2] == pytest.approx(1e-4 * (6e7 + 3e7 * 0.2), rel=1e-6)
    assert found[3] == pytest.approx(-1e4 * (0.05 + 0.16), rel=1e-6)


def test_a_centre_below_the_ground_is_still_pushed_up():
    n, t, f_n, _, _ = equations.contact(SYSTEM, GROUND, np.array([5.0, -0.05, 0.0]), np.array([0.0, -1.0, 0.0]), 0.0)
    np.testing.assert_allclose(n, [0.0, 1.0], atol=1e-12)
    np.testing.assert_allclose(t, [1.0, 0.0], atol=1e-12)
    assert f_n == pytest.approx(0.37**2 * (6e7 + 3e7))


# Drive: section 2.2


def test_cruise_control_is_proportional_and_integral():
    v_ref = 15 / 3.6
    assert equations.drive(SYSTEM, v_ref, 0.0) == (0.0, 0.0)
    assert equations.drive(SYSTEM, v_ref - 0.5, 0.0) == (pytest.approx(10000.0), pytest.approx(0.5))
    assert equations.drive(SYSTEM, v_ref, 0.3) == (pytest.approx(3000.0), 0.0)
    assert equations.drive(SYSTEM, v_ref + 0.1, 0.3) == (pytest.approx(1000.0), pytest.approx(-0.1))


def test_cruise_control_is_limited_and_its_integral_then_stands_still():
    v_ref = 15 / 3.6
    assert equations.drive(SYSTEM, v_ref - 2.5, 0.0) == (40000.0, 0.0)
    assert equations.drive(SYSTEM, v_ref + 2.5, 0.0) == (-40000.0, 0.0)


def accelerations(state: State, option: str, changes: dict[str, float]) -> tuple[System, equations.Rates]:
    config = PAPER.replace(OPTIONS[option]).replace(changes)
    system = build_system(config)
    return system, equations.rates(system, build_road(config), 0.0, state)


def test_drive_torque_is_shared_in_proportion_to_the_load():
    """−r F f_n,k/Σf_n on wheel k, + r F on the chassis: wheels' spins show the first, moments the second."""
    system = build_system(PAPER)
    state = admissible_state(system, np.random.default_rng(3))
    _, driven = accelerations(state, "paper", {})
    _, idle = accelerations(state, "paper", {"drive.force_limit": 0.0})
    assert abs(driven.F) > 1000.0
    assert idle.F == 0.0
    share = (driven.v_dot - idle.v_dot)[system.wheel, 2] * system.inertia[system.wheel]
    np.testing.assert_allclose(share, -system.r * driven.F * driven.f_n / driven.f_n.sum(), atol=1e-6)


def test_nothing_is_driven_in_the_air():
    system = build_system(PAPER)
    state = admissible_state(system, np.random.default_rng(3))
    state.q[:, 1] += 1.0
    _, rates = accelerations(state, "paper", {})
    _, idle = accelerations(state, "paper", {"drive.force_limit": 0.0})
    assert not rates.f_n.any()
    np.testing.assert_allclose(rates.v_dot, idle.v_dot, rtol=1e-12, atol=1e-12)


# Equations of motion: eq. (12)–(15), by Newton's laws for the whole vehicle


@pytest.mark.parametrize("option", KINDS)
@pytest.mark.parametrize("seed", range(3))
def test_whole_vehicle_obeys_newtons_laws(option, seed):
    """Joints and torsion bars act in pairs: momentum changes by weight, ground and (prescribed) drive force alone."""
    config = PAPER.replace(OPTIONS[option])
    system, road = build_system(config), build_road(config)
    state = admissible_state(system, np.random.default_rng(seed))
    rates = equations.rates(system, road, 0.0, state)
    _, normals, _ = road.nearest(state.q[system.wheel, :2])
    tangents = np.column_stack([normals[:, 1], -normals[:, 0]])
    ground = rates.f_n[:, None] * normals + rates.f_t[:, None] * tangents
    centres = state.q[system.wheel, :2]
    assert rates.f_n.sum() > 0.0

    a, m = rates.v_dot[:, :2], system.mass[:, None]
    force = ground.sum(axis=0) - [0.0, system.mass.sum() * G]
    # Traction acts at the rim: r f_t about the centre
    moment = (centres[:, 0] * ground[:, 1] - centres[:, 1] * ground[:, 0] + system.r * rates.f_t).sum()
    moment -= (system.mass * G * state.q[:, 0]).sum()
    if system.prescribed:
        force[0] += rates.F
        moment -= rates.F * state.q[0, 1]
    spin = (system.mass * (state.q[:, 0] * a[:, 1] - state.q[:, 1] * a[:, 0])).sum()
    spin += (system.inertia * rates.v_dot[:, 2]).sum()
    scale = np.abs(ground).sum()
    np.testing.assert_allclose((m * a).sum(axis=0), force, atol=1e-9 * scale)
    assert spin == pytest.approx(moment, abs=1e-9 * scale * (1 + np.abs(state.q[:, 0]).max()))


@pytest.mark.parametrize("option", KINDS)
def test_joints_stay_together(option):
    """The points of both bodies at a joint have the same acceleration when C = Ċ = 0."""
    config = PAPER.replace(OPTIONS[option])
    system = build_system(config)
    state = admissible_state(system, np.random.default_rng(5))
    a = equations.rates(system, build_road(config), 0.0, state).v_dot

    def of_point(body: int, u: np.ndarray) -> np.ndarray:
        arm = turned(u, state.q[body, 2])
        return a[body, :2] + a[body, 2] * across(arm) - state.v[body, 2] ** 2 * arm

    for i, j, u_i, u_j in zip(system.joint_i, system.joint_j, system.u_i, system.u_j, strict=True):
        np.testing.assert_allclose(of_point(i, u_i), of_point(j, u_j), atol=1e-9 * np.abs(a).max())


def test_prescribed_drive_force_is_the_multiplier_of_its_row():
    config = PAPER.replace({"drive.mode": "prescribed"})
    system = build_system(config)
    state = admissible_state(system, np.random.default_rng(6))
    state.q[:, 0] -= state.q[0, 0]
    state.v[:, 0] += system.v_ref - state.v[0, 0]
    rates = equations.rates(system, build_road(config), 0.0, state)
    assert rates.F == -rates.lam[44]
    assert rates.v_dot[0, 0] == pytest.approx(0.0, abs=1e-9)
    assert rates.int_e_dot == 0.0


def test_imaginary_damper_passes_the_road_wheels_spin_by():
    """However fast road wheels spin in the air, no arm feels it: the joint at the axle passes no torque."""
    config = FLAT.replace({f"{IMAGINARY}.damping": 1e5})
    system = build_system(config)
    state = admissible_state(system, np.random.default_rng(7))
    state.q[:, 1] += 1.0
    calm = equations.rates(system, build_road(config), 0.0, state)
    state.v[system.wheel, 2] += 100.0
    spinning = equations.rates(system, build_road(config), 0.0, state)
    np.testing.assert_allclose(spinning.v_dot, calm.v_dot, rtol=1e-10, atol=1e-10)
