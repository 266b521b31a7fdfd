"""Two benchmarks of the IFToMM library of multibody problems: A01, a pendulum, by the dense equations and by the
compiled kernel; A03, Andrews' squeezer, whose closed loops no tree holds, by the dense equations.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from model.dynamics import equations
from model.dynamics.lanes import pack
from model.dynamics.vehicle import System, build_system
from model.road.road import build_road
from model.simulation.integrate import ADAPTIVE, Integration, Status
from tests.model.support import FLAT, WHEELS

# A01: point mass at 1 m, from x = −1 m, y = 0; IFToMM benchmark library, with g = 9.81 m/s²
PERIOD = 2.367841948  # s
AFTER_TEN = (-0.2750875, -0.9614192)  # m

# A03: angles after 0.03 s; Schiehlen, "Multibody Systems Handbook", and Hairer & Wanner, "Solving ODEs II", VI.9
ANDREWS = {
    "beta": 15.81077119629904,
    "Theta": -15.75637105984298,
    "gamma": 0.04082224013073101,
    "Phi": -0.5347301163226948,
    "delta": 0.5244099658805304,
    "Omega": 0.5347301163226948,
    "epsilon": 1.048080741042263,
}
ANDREWS_START = dict(
    zip(
        ANDREWS,
        (
            -0.0617138900142764496,
            0.0,
            0.455279819163070380,
            0.222668390165885884,
            0.487364979543842550,
            -0.222668390165885884,
            1.23054744454982119,
        ),
        strict=True,
    )
)
HEAVY, LIGHT = 1e12, 1e-9  # kg: what is held fast, and what weighs nothing


def mechanism(
    mass: list[float], inertia: list[float], joints: list[tuple[int, int, tuple, tuple]], weight: list[float]
) -> System:
    """Bodies and revolute joints (first body, second body, the joint in the frame of each), without springs."""
    joint_i, joint_j, u_i, u_j = zip(*joints, strict=True)
    return build_system(FLAT)._replace(
        mass=np.array(mass),
        inertia=np.array(inertia),
        weight=np.array(weight),
        joint_i=np.array(joint_i),
        joint_j=np.array(joint_j),
        u_i=np.array(u_i, dtype=float),
        u_j=np.array(u_j, dtype=float),
    )


def right_hand_side(system: System, forces: Callable[[np.ndarray, np.ndarray], np.ndarray]) -> Callable:
    """d/dt of (q, v), flat, with body 0 held fast by three rows of its own."""
    bodies = len(system.mass)
    ground = np.eye(3, 3 * bodies)

    def rates(_: float, y: np.ndarray) -> np.ndarray:
        q, v = y.reshape(2, bodies, 3)
        C_q = np.vstack([equations.jacobian(system, q), ground])
        gamma = np.append(equations.acceleration_side(system, q, v, 0.0), np.zeros(3))
        v_dot, _ = equations.accelerations(system, C_q, forces(q, v), gamma)
        return np.concatenate([v.ravel(), v_dot.ravel()])

    return rates


# A01


def test_the_pendulum_by_the_dense_equations():
    """Ground and a bob of 1 kg at the end of a bar that weighs nothing."""
    system = mechanism([1.0, 1.0], [1.0, LIGHT], [(0, 1, (0, 0), (1, 0))], [0.0, 9.81])
    weight = np.array([[0, 0, 0], [0, -9.81, 0]], dtype=float)
    start = np.concatenate([[0, 0, 0, -1, 0, 0], np.zeros(6)])
    found = solve_ivp(
        right_hand_side(system, lambda q, v: weight),
        (0, 10),
        start,
        method="DOP853",
        rtol=1e-8,
        atol=1e-10,
        t_eval=[0, PERIOD, 10],
    )
    np.testing.assert_allclose(found.y[3:5, 1], (-1, 0), atol=1e-6)
    np.testing.assert_allclose(found.y[3:5, 2], AFTER_TEN, atol=1e-6)


@pytest.mark.parametrize("integrator", ADAPTIVE)
def test_the_pendulum_by_the_kernel(integrator):
    """A vehicle whose hull is held fast in the air by its mass, with arms that weigh nothing and wheels that hang."""
    two = build_system(FLAT.replace({f"{WHEELS}.count": 2, "vehicle.imaginary_wheels.enabled": False}))
    zero, at_centre = np.zeros(2), np.zeros((2, 2))
    system = two._replace(
        mass=np.array([HEAVY, LIGHT, LIGHT, 1.0, 1.0]),
        inertia=np.array([HEAVY, LIGHT, LIGHT, 1.0, 1.0]),
        weight=np.array([0.0, 0.0, 0.0, 9.81, 9.81]),
        u_i=np.vstack([at_centre, [[-1.0, 0.0]] * 2]),  # pivots at the hull's centre, wheels 1 m behind
        u_j=np.vstack([at_centre, at_centre]),
        k_s=zero,
        c_s=zero,
        tau_0=zero,
        K_p=0.0,
        K_i=0.0,
    )
    for array in (system.mass, system.inertia, system.weight, system.u_i, system.u_j, zero):
        array.setflags(write=False)  # as a vehicle's: numba compiles anew for others
    q = np.zeros((5, 3))
    q[:, 1] = 5.0  # m, out of the ground's reach
    q[3:, 0] = -1.0
    y = pack(system, q, np.zeros((5, 3)), zero, 0.0)
    run = Integration(system, build_road(FLAT).table, y, 10.0, 100.0, integrator, rtol=1e-10, atol=1e-12)
    while run.advance(10.0) is Status.RUNNING:
        pass
    assert run.status is Status.COMPLETE
    np.testing.assert_allclose(run.samples.q[-1, 3:, :2] - (0, 5), [AFTER_TEN] * 2, atol=1e-6)
    np.testing.assert_allclose(run.samples.q[-1, 0], (0, 5, 0), atol=1e-9)


# A03


def andrews() -> tuple[System, Callable[[np.ndarray, np.ndarray], np.ndarray]]:
    """The seven bars, and their forces: a torque on the crank, a spring from the ground to bar 3."""
    A, B, C = (-0.06934, -0.00227), (-0.03635, 0.03273), (0.014, 0.072)
    d, da, e, ea, rr, ra = 0.028, 0.0115, 0.02, 0.01421, 0.007, 0.00092
    ss, sa, sb, sc, sd, ta, tb = 0.035, 0.01874, 0.01043, 0.018, 0.02, 0.02308, 0.00916
    u, ua, ub, zf, zt, fa = 0.04, 0.01228, 0.00449, 0.02, 0.04, 0.01421
    c0, l0, torque = 4530.0, 0.07785, 0.033
    mass = [1.0, 0.04325, 0.00365, 0.02373, 0.00706, 0.07050, 0.00706, 0.05498]
    inertia = [1.0, 2.194e-6, 4.410e-7, 5.255e-6, 5.667e-7, 1.169e-5, 5.667e-7, 1.912e-5]
    E2 = (da - d, 0)
    joints = [
        (0, 1, (0, 0), (-ra, 0)),
        (1, 2, (rr - ra, 0), (da, 0)),
        (2, 3, E2, (-sb, sa - ss)),
        (0, 3, B, (-sb, sa)),
        (2, 4, E2, (0, -ea)),
        (4, 5, (0, e - ea), (zt - ta, -tb)),
        (0, 5, A, (-ta, -tb)),
        (2, 6, E2, (fa, 0)),
        (6, 7, (fa - zf, 0), (ub, ua - u)),
        (0, 7, A, (ub, ua)),
    ]
    D = np.array([sd - sb, sa - sc])

    def forces(q: np.ndarray, v: np.ndarray) -> np.ndarray:
        Q = np.zeros_like(q)
        Q[1, 2] = torque
        arm = equations.rotation(q[3, 2]) @ D
        reach = q[3, :2] + arm - C
        length = np.hypot(*reach)
        pull = -c0 * (length - l0) / length * reach
        Q[3, :2] = pull
        Q[3, 2] = arm[0] * pull[1] - arm[1] * pull[0]
        return Q

    return mechanism(mass, inertia, joints, [0.0] * 8), forces


def assembled(system: System, angles: dict[str, float]) -> np.ndarray:
    """q (8, 3) of the bars at these angles, each centre from its joint with a body before it."""
    a = angles
    q = np.zeros((8, 3))
    q[1:, 2] = (
        a["beta"],
        a["beta"] + a["Theta"],
        a["gamma"],
        a["Phi"] + a["delta"],
        a["delta"],
        a["Omega"] + a["epsilon"],
        a["epsilon"],
    )
    for joint in (0, 1, 3, 6, 9, 4, 7):
        i, j = system.joint_i[joint], system.joint_j[joint]
        q[j, :2] = q[i, :2] + equations.rotation(q[i, 2]) @ system.u_i[joint]
        q[j, :2] -= equations.rotation(q[j, 2]) @ system.u_j[joint]
    return q


def test_andrews_squeezer_by_the_dense_equations():
    system, forces = andrews()
    q = assembled(system, ANDREWS_START)
    np.testing.assert_allclose(equations.constraints(system, q, 0.0), 0.0, atol=1e-12)
    start = np.concatenate([q.ravel(), np.zeros(24)])
    found = solve_ivp(right_hand_side(system, forces), (0, 0.03), start, method="DOP853", rtol=1e-8, atol=1e-10)
    q = found.y[:24, -1].reshape(8, 3)
    beta, second, gamma, fourth, delta, sixth, epsilon = q[1:, 2]
    angles = (beta, second - beta, gamma, fourth - delta, delta, sixth - epsilon, epsilon)
    np.testing.assert_allclose(angles, list(ANDREWS.values()), rtol=1e-6)
    assert np.abs(equations.constraints(system, q, 0.03)).max() < 1e-7
