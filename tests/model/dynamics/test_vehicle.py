"""The multibody system of a configuration: counts, order, design pose, rates and preloads (model/MODEL.md)."""

from __future__ import annotations

import numpy as np
import pytest

from model.dynamics import equations
from model.dynamics.vehicle import System, build_system
from tests.model.support import ARMS, IMAGINARY, OPTIONS, PAPER, ROAD_SPRING, WHEELS

G = 9.81


def test_counts_of_the_papers_vehicle():
    system = build_system(PAPER)
    assert (len(system.mass), system.q_design.size, len(system.joint_i)) == (23, 69, 22)
    rows = len(equations.constraints(system, system.q_design, 0.0))
    assert rows == 44
    assert np.linalg.matrix_rank(equations.jacobian(system, system.q_design)) == 44  # so 25 degrees of freedom


@pytest.mark.parametrize("n", [2, 3, 20])
def test_counts_follow_from_the_number_of_road_wheels(n):
    config = PAPER.replace({f"{WHEELS}.count": n})
    assert len(build_system(config).mass) == 1 + 2 * n + 2 * (n - 1)
    assert len(build_system(config).joint_i) == 2 * n + 2 * (n - 1)
    alone = build_system(config.replace({"vehicle.imaginary_wheels.enabled": False}))
    assert len(alone.mass) == 1 + 2 * n
    assert len(alone.joint_i) == 2 * n


def test_prescribed_drive_adds_the_45th_row():
    system = build_system(PAPER.replace({"drive.mode": "prescribed"}))
    q = system.q_design.copy()
    q[0, 0] = 3.0
    C = equations.constraints(system, q, 0.5)
    assert len(C) == 45
    assert C[-1] == pytest.approx(3.0 - 0.5 * 15 / 3.6)


def test_bodies_stand_in_order():
    """Chassis; road arms front first; road wheels; imaginary arms; imaginary wheels."""
    system = build_system(PAPER)
    x, y = system.q_design[:, 0], system.q_design[:, 1]
    road = [1.75, 1.05, 0.35, -0.35, -1.05, -1.75]
    L = 0.35 * np.array([np.cos(np.radians(20)), np.sin(np.radians(20))])
    np.testing.assert_allclose([x[0], y[0]], [0.0, 0.95])
    np.testing.assert_allclose(x[1:7], np.array(road) + L[0] / 2)
    np.testing.assert_allclose(y[1:7], 0.32 + L[1] / 2)
    np.testing.assert_allclose(x[7:13], road)
    np.testing.assert_allclose(x[13:18], np.array(road[:-1]) - 0.175)
    np.testing.assert_allclose(x[18:23], [1.4, 0.7, 0.0, -0.7, -1.4], atol=1e-12)
    np.testing.assert_allclose(y[7:23], 0.32)
    np.testing.assert_array_equal(system.q_design[:, 2], 0.0)
    np.testing.assert_array_equal(system.mass, [5125] + 6 * [30] + 6 * [75] + 5 * [5] + 5 * [75])
    np.testing.assert_array_equal(system.wheel, [*range(7, 13), *range(18, 23)])


def test_joints_stand_in_order():
    """All of the first kind, then all of the second…: chassis – arm, arm – wheel, wheel – imaginary arm – wheel."""
    system = build_system(PAPER)
    pairs = list(zip(system.joint_i, system.joint_j, strict=True))
    assert pairs == (
        [(0, 1 + i) for i in range(6)]
        + [(1 + i, 7 + i) for i in range(6)]
        + [(7 + i, 13 + i) for i in range(5)]
        + [(13 + i, 18 + i) for i in range(5)]
    )


@pytest.mark.parametrize("option", OPTIONS)
def test_the_design_pose_fulfils_the_constraints(option):
    system = build_system(PAPER.replace(OPTIONS[option]))
    np.testing.assert_allclose(equations.constraints(system, system.q_design, 0.0), 0.0, atol=1e-14)
    np.testing.assert_allclose(system.q_design[system.wheel, 1], system.r)


def test_offset_shifts_the_wheels_and_positions_replace_them():
    shifted = build_system(PAPER.replace({f"{WHEELS}.offset": 0.2}))
    np.testing.assert_allclose(shifted.q_design[7:13, 0], 1.95 - 0.7 * np.arange(6))
    uneven = build_system(PAPER.replace({f"{WHEELS}.positions": (2.0, 1.1, -1.9)}))
    np.testing.assert_allclose(uneven.q_design[4:7, 0], [2.0, 1.1, -1.9])
    np.testing.assert_allclose(uneven.q_design[9:11, 0], [1.55, -0.4])  # half-way between


def test_pivots_lie_ahead_and_above_of_the_wheels():
    system = build_system(PAPER.replace({f"{ARMS}.length": 0.5, f"{ARMS}.angle_deg": 30.0}))
    pivots = system.q_design[0, :2] + system.u_i[:6]
    wheels = system.q_design[7:13, :2]
    np.testing.assert_allclose(pivots - wheels, np.tile([0.5 * np.cos(np.pi / 6), 0.25], (6, 1)), atol=1e-12)


def test_inertias_follow_from_mass_and_size_unless_given():
    I = build_system(PAPER).inertia
    np.testing.assert_allclose(I[0], 14630)
    np.testing.assert_allclose(I[1:7], 30 * 0.35**2 / 12)
    np.testing.assert_allclose(I[7:13], 75 * 0.32**2 / 2)
    np.testing.assert_allclose(I[13:18], 5 * 0.35**2 / 12)
    np.testing.assert_allclose(I[18:23], 75 * 0.32**2 / 2)
    given = build_system(PAPER.replace(OPTIONS["given inertias"])).inertia
    np.testing.assert_allclose(given[1:7], 1.5)
    np.testing.assert_allclose(given[7:13], 5.0)
    np.testing.assert_allclose(given[18:23], 2.0)


# Rates and preloads


def test_rates_at_the_wheel_become_torsional():
    system = build_system(PAPER)
    lever = 0.35 * np.cos(np.radians(20))
    np.testing.assert_allclose(system.k_s, [75530 * lever**2] * 6 + [10000 * 0.35**2] * 5)
    np.testing.assert_allclose(system.c_s, [4732 * lever**2] * 6 + [5000 * 0.35**2] * 5)


def test_torsional_rates_are_taken_as_they_are():
    system = build_system(PAPER.replace(OPTIONS["torsion basis"]))
    np.testing.assert_allclose(system.k_s, [9000.0] * 6 + [1300.0] * 5)
    np.testing.assert_allclose(system.c_s, [500.0] * 6 + [600.0] * 5)


def test_a_list_gives_each_wheel_its_rate():
    system = build_system(PAPER.replace(OPTIONS["a value for each wheel"]))
    lever = 0.35 * np.cos(np.radians(20))
    np.testing.assert_allclose(system.k_s[:6] / lever**2, [9e4, 6e4, 7e4, 8e4, 5e4, 1e5])
    np.testing.assert_allclose(system.c_s[:6] / lever**2, [5e3, 1e3, 0, 2e3, 3e3, 6e3])


def test_uneven_links_get_their_own_torsional_rates():
    system = build_system(PAPER.replace({f"{WHEELS}.positions": (2.0, 1.1, -1.9)}))
    np.testing.assert_allclose(system.k_s[3:], [10000 * 0.45**2, 10000 * 1.5**2])


def test_imaginary_preload_is_a_deflection_or_a_force_at_the_wheel():
    """τ'_0 = k_sl δ/L_im, so a stiffer spring presses harder; or T L_im."""
    tau = build_system(PAPER).tau_0[6:]
    np.testing.assert_allclose(tau, 10000 * 0.1 * 0.35)
    stiffer = build_system(PAPER.replace({f"{IMAGINARY}.stiffness": 30000.0})).tau_0[6:]
    np.testing.assert_allclose(stiffer, 3 * tau)
    force = build_system(PAPER.replace({f"{IMAGINARY}.preload_force": 2500.0, f"{IMAGINARY}.stiffness": 3e4}))
    np.testing.assert_allclose(force.tau_0[6:], 2500 * 0.35)


def imaginary_loads(system: System) -> np.ndarray:
    """Normal loads (m,) under imaginary wheels in the design pose: moments of arm and wheel about the joint."""
    L_im = 2 * system.u_j[2 * system.n : 2 * system.n + system.m, 0]
    links = system.mass[system.imaginary_arms] * G
    wheels = system.mass[system.imaginary_wheels] * G
    return system.tau_0[system.n :] / L_im + wheels + links / 2


@pytest.mark.parametrize(
    "changes",
    [
        *OPTIONS.values(),
        {f"{ROAD_SPRING}.stiffness": 500.0},
        {f"{ROAD_SPRING}.stiffness": 1e7, f"{IMAGINARY}.stiffness": 1e6},
        {f"{IMAGINARY}.reacts_on": "chassis", f"{WHEELS}.positions": (3.0, 1.0, 0.4, -1.0), f"{ARMS}.angle_deg": -20.0},
    ],
)
def test_the_preload_holds_the_design_pose_whatever_the_stiffness(changes):
    """With linear loads V_i = a + b x_i on the axles, all forces lie in the range of C_qᵀ: nothing accelerates."""
    system = build_system(PAPER.replace(changes))
    q, wheels = system.q_design, 3 * (1 + system.n + np.arange(system.n)) + 1
    Q = np.zeros(q.shape)
    Q[:, 1] -= system.mass * G
    Q[:, 2] += equations.suspension_torques(system, q, np.zeros_like(q))
    Q[system.imaginary_wheels, 1] += imaginary_loads(system)
    # What the imaginary arm takes off its road wheel; the last wheel carries none
    links = np.zeros(system.n)
    links[: system.m] = (
        system.mass[system.imaginary_arms] + system.mass[system.imaginary_wheels]
    ) * G - imaginary_loads(system)
    Q = Q.ravel()
    Q[wheels] += system.mass[system.road_wheels] * G + links
    # Unknown: λ, and a, b of the road wheels' loads
    axle = np.zeros((q.size, 2))
    axle[wheels, 0] = 1.0
    axle[wheels, 1] = q[system.road_wheels, 0]
    joints = equations.jacobian(system, q)[: 2 * len(system.joint_i)]
    unknown, *_ = np.linalg.lstsq(np.hstack([joints.T, -axle]), Q, rcond=None)
    residual = np.hstack([joints.T, -axle]) @ unknown - Q
    assert np.abs(residual).max() <= 1e-7
    a, b = unknown[-2:]
    V = a + b * q[system.road_wheels, 0]
    carried = system.mass[0] + system.mass[system.road_arms].sum()
    assert V.sum() == pytest.approx(carried * G, rel=1e-9)
