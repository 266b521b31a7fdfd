"""The paper's equations (1)–(15), written as the paper writes them: dense matrices, plain NumPy. The kernel's judge.

Where the paper's signs or symbols are settled otherwise in the project (README, "What was settled beyond the paper"),
the line says so. State: q (B, 3) and v (B, 3) with rows (R_x, R_y, θ) of eq. 8, ξ (W,), ∫e. SI, radians, world frame.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from model.dynamics import ground
from model.dynamics.suspension import added_torque
from model.dynamics.vehicle import System
from model.road.road import Road


class State(NamedTuple):
    """Where everything is and how it moves."""

    q: np.ndarray  # (B, 3) m, rad
    v: np.ndarray  # (B, 3) m/s, rad/s
    xi: np.ndarray  # (W,) tangential displacement of the ground, the paper's x, m
    int_e: float  # ∫e dt of the cruise controller, m


class Rates(NamedTuple):
    """What the equations of motion give at a state."""

    v_dot: np.ndarray  # (B, 3)
    xi_dot: np.ndarray  # (W,)
    int_e_dot: float
    lam: np.ndarray  # (rows of C,) λ
    f_n: np.ndarray  # (W,) normal loads, N
    f_t: np.ndarray  # (W,) tractions, N
    F: float  # drive force, N


def rotation(theta: float) -> np.ndarray:
    """A(θ) of eq. 10: body frame to world frame, (2, 2)."""
    return np.array([[np.cos(theta), -np.sin(theta)], [np.sin(theta), np.cos(theta)]])


def rotation_rate(theta: float) -> np.ndarray:
    """dA/dθ, (2, 2)."""
    return np.array([[-np.sin(theta), -np.cos(theta)], [np.cos(theta), -np.sin(theta)]])


def suspension_torques(system: System, q: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Q_θ (B,): torques of all torsion bars, N m."""
    Q_theta = np.zeros(len(q))
    for s in range(len(system.spring_i)):
        i, j = system.spring_i[s], system.spring_j[s]
        u, u_dot = q[i, 2] - q[j, 2], v[i, 2] - v[j, 2]
        k, c = system.k_s[s], system.c_s[s]
        # Eq. (1), and eq. (2) with its sign turned: τ = k (θ_i − θ_j) + c (θ̇_i − θ̇_j) + τ_0; then beyond the paper
        tau = k * u + c * u_dot + system.tau_0[s]
        if s < system.n:
            tau += added_torque(system.stops, k, c, system.p[s], system.c_rebound[s], u, u_dot)
        # Eq. (3): the arm between takes the difference of both torques
        Q_theta[j] += tau
        Q_theta[i] -= tau
    return Q_theta


def nearest_point(road: Road, centre: np.ndarray) -> np.ndarray:
    """The point of the profile nearest to a wheel's centre, by brute force: (2,)."""
    from scipy.optimize import brentq  # here, since SciPy takes long to load and only tests come here

    X, Y = centre
    reach = 1.5 * road.radius
    s = np.union1d(X + np.linspace(-reach, reach, 1501), _corners(road, X, reach))

    def g(s: np.ndarray) -> np.ndarray:  # half the slope of the squared distance
        h, h1, _ = road.derivatives(s)
        return (s - X) + (h - Y) * h1

    a, b = s[:-1], np.nextafter(s[1:], -np.inf)  # from inside each interval: the slope may jump at its ends
    roots = [brentq(g, a[k], b[k], xtol=1e-15, rtol=1e-15) for k in np.flatnonzero((g(a) < 0.0) & (g(b) > 0.0))]
    s = np.append(s, roots)
    points = np.column_stack([s, road.height(s)])
    return points[np.argmin(((points - centre) ** 2).sum(axis=1))]


def _corners(road: Road, X: float, reach: float) -> np.ndarray:
    """Ends of the profile's pieces near X, where the slope may jump."""
    ends = np.concatenate([piece.nodes[[0, -1]] for piece in road.profile.pieces])
    return ends[np.abs(ends - X) <= reach]


def contact(
    system: System, road: Road, q_w: np.ndarray, v_w: np.ndarray, xi: float
) -> tuple[np.ndarray, np.ndarray, float, float, float]:
    """One wheel on the ground: n (2,), t (2,), f_n, f_t, ξ̇."""
    P = q_w[:2]
    point = nearest_point(road, P)
    below = P[1] < road.height(P[0])
    d = np.hypot(*(P - point)) * (-1.0 if below else 1.0)
    if abs(d) > 1e-9:
        n = (P - point) / d
    else:
        slope = road.derivatives(point[0])[1]
        n = np.array([-slope, 1.0]) / np.hypot(slope, 1.0)
    t = np.array([n[1], -n[0]])
    z = system.r - d
    z_dot = -v_w[:2] @ n
    p_dot = v_w[:2] @ t + system.r * v_w[2]
    # Eq. (4)–(7)
    f_n, f_t, xi_dot = ground.force(system.ground, z, z_dot, p_dot, xi)
    return n, t, f_n, f_t, xi_dot


def constraints(system: System, q: np.ndarray, t: float) -> np.ndarray:
    """C(q, t) of eq. (9)–(11), two rows a joint; prescribed drive adds R_x,chassis − (x_0 + v_ref t)."""
    rows = []
    for i, j, u_i, u_j in zip(system.joint_i, system.joint_j, system.u_i, system.u_j, strict=True):
        # Eq. (10)
        rows.append(q[i, :2] + rotation(q[i, 2]) @ u_i - q[j, :2] - rotation(q[j, 2]) @ u_j)
    if system.prescribed:
        rows.append(np.array([q[0, 0] - system.x_0 - system.v_ref * t]))
    return np.concatenate(rows)


def jacobian(system: System, q: np.ndarray) -> np.ndarray:
    """C_q (rows of C, 3 B)."""
    joints = len(system.joint_i)
    C_q = np.zeros((2 * joints + system.prescribed, q.size))
    for row, (i, j, u_i, u_j) in enumerate(zip(system.joint_i, system.joint_j, system.u_i, system.u_j, strict=True)):
        rows = slice(2 * row, 2 * row + 2)
        C_q[rows, 3 * i : 3 * i + 2] = np.eye(2)
        C_q[rows, 3 * i + 2] = rotation_rate(q[i, 2]) @ u_i
        C_q[rows, 3 * j : 3 * j + 2] = -np.eye(2)
        C_q[rows, 3 * j + 2] = -rotation_rate(q[j, 2]) @ u_j
    if system.prescribed:
        C_q[-1, 0] = 1.0
    return C_q


def constraint_rate(system: System, q: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Ċ = C_q q̇ + C_t: eq. (13) as it must read, for velocities."""
    C_dot = jacobian(system, q) @ v.ravel()
    if system.prescribed:
        C_dot[-1] -= system.v_ref
    return C_dot


def acceleration_side(system: System, q: np.ndarray, v: np.ndarray, t: float) -> np.ndarray:
    """γ = −(C_q q̇)_q q̇ − 2 C_qt q̇ − C_tt of eq. (14), with Baumgarte's −2 α Ċ − β² C; here C_qt = C_tt = 0."""
    quadratic = []
    for i, j, u_i, u_j in zip(system.joint_i, system.joint_j, system.u_i, system.u_j, strict=True):
        # d²A/dθ² = −A, so (C_q q̇)_q q̇ = −θ̇_i² A_i u_i + θ̇_j² A_j u_j
        quadratic.append(-(v[i, 2] ** 2) * rotation(q[i, 2]) @ u_i + v[j, 2] ** 2 * rotation(q[j, 2]) @ u_j)
    if system.prescribed:
        quadratic.append(np.zeros(1))
    C, C_dot = constraints(system, q, t), constraint_rate(system, q, v)
    return -np.concatenate(quadratic) - 2 * system.alpha * C_dot - system.beta**2 * C


def accelerations(system: System, C_q: np.ndarray, Q: np.ndarray, gamma: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """q̈ (B, 3) and λ of eq. (15), [M C_qᵀ; C_q 0] {q̈; λ} = {Q; γ}, for any mechanism, closed loops included."""
    M = np.diag(np.column_stack([system.mass, system.mass, system.inertia]).ravel())
    rows = len(gamma)
    augmented = np.block([[M, C_q.T], [C_q, np.zeros((rows, rows))]])
    solution = np.linalg.solve(augmented, np.concatenate([Q.ravel(), gamma]))
    return solution[: Q.size].reshape(Q.shape), solution[Q.size :]


def drive(system: System, v_x: float, int_e: float) -> tuple[float, float]:
    """Cruise control (section 2.2): drive force F, N, and d/dt ∫e; the integral stands still while F is limited."""
    e = system.v_ref - v_x
    F = system.K_p * e + system.K_i * int_e
    if abs(F) > system.F_max:
        return system.F_max * np.sign(F), 0.0
    return F, e


def rates(system: System, road: Road, t: float, state: State) -> Rates:
    """The right-hand side: forces first, then the augmented system of eq. (12)–(15)."""
    q, v, xi, int_e = state
    bodies, wheels = len(q), system.wheel
    Q = np.zeros((bodies, 3))
    Q[:, 1] -= system.weight
    Q[:, 2] += suspension_torques(system, q, v)

    f_n, f_t, xi_dot = np.zeros(len(wheels)), np.zeros(len(wheels)), np.zeros(len(wheels))
    for k, w in enumerate(wheels):
        n, tangent, f_n[k], f_t[k], xi_dot[k] = contact(system, road, q[w], v[w], xi[k])
        Q[w, :2] += f_n[k] * n + f_t[k] * tangent
        Q[w, 2] += system.r * f_t[k]

    # Section 2.2: every wheel gets a share of the driving torque in proportion to its normal load
    F, int_e_dot = 0.0, 0.0
    if not system.prescribed:
        F, int_e_dot = drive(system, v[0, 0], int_e)
        if f_n.sum() > 0.0:
            Q[wheels, 2] -= system.r * F * f_n / f_n.sum()
            Q[0, 2] += system.r * F

    v_dot, lam = accelerations(system, jacobian(system, q), Q, acceleration_side(system, q, v, t))
    if system.prescribed:
        F = -lam[-1]
    return Rates(v_dot, xi_dot, int_e_dot, lam, f_n, f_t, F)
