"""The right-hand side of equations.py, compiled: the augmented system of eq. (15) solved in O(bodies), no allocation.

The joints form a tree: each of n chains hangs a road arm on the chassis, a road wheel on the arm, an imaginary arm on
the wheel's centre and an imaginary wheel on that. Eliminating from the leaves, everything beyond a joint acts on the
body before it like a mass matrix K (2×2) and a force f at the joint:

    λ = K a_P − f,    a_P: acceleration of the joint's point on the second body.

A wheel, jointed at its centre, gives K = m I and f = its force; its spin stands alone. An arm from its pivot p to a
point w that carries (K, f) gives what `_fold_arm` derives. With all chains folded the chassis is left with a 3×3
system; going back out, each arm's rotation follows from its pivot's acceleration. With the paper's joint rows
(first body minus second), a_P = acceleration of the point on the first body − γ.

Flat state y: [x | y | θ | ẋ | ẏ | θ̇ | ξ | ∫e], with B, B, B, B, B, B, W and 1 entries, bodies in System's order.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from model.compiled import compiled, inlined
from model.road_table import nearest
from model.vehicle import System


class Work(NamedTuple):
    """Scratch space of one right-hand side, and the contact forces it leaves behind. W wheels, n + m arms."""

    f_n: np.ndarray  # (W,) normal loads, N
    f_t: np.ndarray  # (W,) tractions, N
    F: np.ndarray  # (1,) drive force, N
    wheel: np.ndarray  # (3, W) force x, y and torque on each wheel, N, N m
    tau: np.ndarray  # (n,) torque of the suspensions on each road arm, N m
    arm: np.ndarray  # (n + m, 18) each arm's folded quantities, road arms first


def make_work(system: System) -> Work:
    """Scratch space for a system."""
    wheels, arms = len(system.wheel), len(system.spring_j)
    return Work(
        np.zeros(wheels),
        np.zeros(wheels),
        np.zeros(1),
        np.zeros((3, wheels)),
        np.zeros(system.n),
        np.zeros((arms, 18)),
    )


def pack(q: np.ndarray, v: np.ndarray, xi: np.ndarray, int_e: float) -> np.ndarray:
    """The flat state of q, v (B, 3), ξ (W,), ∫e."""
    return np.concatenate([q.T.ravel(), v.T.ravel(), xi, [int_e]])


def unpack(y: np.ndarray, bodies: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, float]:
    """q, v (B, 3), ξ (W,), ∫e of a flat state."""
    q, v = y[: 3 * bodies].reshape(3, bodies).T, y[3 * bodies : 6 * bodies].reshape(3, bodies).T
    return q, v, y[6 * bodies : -1], float(y[-1])


@inlined
def cos_sin(angle):
    """Both, to 1e-16 for angles of a few turns: reduced to ±π/4, then the polynomials of fdlibm's k_cos and k_sin."""
    quarters = np.rint(angle * (2.0 / np.pi))
    x = angle - quarters * (0.5 * np.pi)
    z = x * x
    sin = x + x * z * (
        -1.66666666666666324348e-01
        + z
        * (
            8.33333333332248946124e-03
            + z
            * (
                -1.98412698298579493134e-04
                + z * (2.75573137070700676789e-06 + z * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10))
            )
        )
    )
    cos = (
        1.0
        - 0.5 * z
        + z
        * z
        * (
            4.16666666666666019037e-02
            + z
            * (
                -1.38888888888741095749e-03
                + z
                * (
                    2.48015872894767294178e-05
                    + z
                    * (-2.75573143513906633035e-07 + z * (2.08757232129817482790e-09 - z * 1.13596475577881948265e-11))
                )
            )
        )
    )
    quadrant = int(quarters) & 3
    swapped = quadrant & 1
    cos, sin = (sin if swapped else cos), (cos if swapped else sin)
    return (-cos if quadrant in (1, 2) else cos), (-sin if quadrant >= 2 else sin)


@inlined
def _beyond_linear(system, i, u, u_dot):
    """What a road arm's progressive spring, rebound damping and stops add to eq. (1)."""
    tau = system.k_s[i] * system.p[i] * u * u * u
    if u_dot < 0.0:
        tau += (system.c_rebound[i] - system.c_s[i]) * u_dot
    if u > system.bump:
        tau += max(0.0, system.k_stop * (u - system.bump) + system.c_stop * u_dot)
    elif u < system.rebound:
        tau += min(0.0, system.k_stop * (u - system.rebound) + system.c_stop * u_dot)
    return tau


@inlined
def _fold_arm(m, I, p_x, p_y, w_x, w_y, K_xx, K_xy, K_yy, b_x, b_y, F_y, tau):
    """An arm that carries (K, b = K γ + f) at w, seen from its pivot p (both from its centre of mass).

    With d = w − p, ⊥ a turn by +90°, a its centre's and a_P its pivot's acceleration, a = a_P − θ̈ p⊥ and
        force:            λ_p = m a + λ_w − F,        λ_w = K (a_P + θ̈ d⊥) − b
        moment about p:   I θ̈ + d⊥·λ_w − p⊥·(m a − F) = τ
    so that θ̈ = (T − e·a_P)/J and λ_p = K_p a_P − f_p with
        e = K d⊥ − m p⊥,  J = I + d⊥·K d⊥ + m p²,  T = τ + d⊥·b − p⊥·F
        K_p = m I + K − e eᵀ/J,  f_p = b + F − e T/J.
    """
    d_x, d_y = -(w_y - p_y), w_x - p_x  # d⊥
    Kd_x, Kd_y = K_xx * d_x + K_xy * d_y, K_xy * d_x + K_yy * d_y
    e_x, e_y = Kd_x + m * p_y, Kd_y - m * p_x
    over_J = 1.0 / (I + d_x * Kd_x + d_y * Kd_y + m * (p_x * p_x + p_y * p_y))
    T = tau + d_x * b_x + d_y * b_y - p_x * F_y
    Ke_x, Ke_y, T = e_x * over_J, e_y * over_J, T * over_J
    return (
        m + K_xx - e_x * Ke_x,
        K_xy - e_x * Ke_y,
        m + K_yy - e_y * Ke_y,
        b_x - e_x * T,
        b_y + F_y - e_y * T,
        Ke_x,
        Ke_y,
        T,
    )


@inlined
def contact_forces(system, road, y, dy, work):
    """Eq. (4)–(7) for every wheel, and the drive's torques (section 2.2): fills work, ξ̇ and d/dt ∫e."""
    bodies, wheels = len(system.mass), len(system.wheel)
    r, k_t, c_t = system.r, system.k_t, system.c_t
    total = 0.0
    for k in range(wheels):
        w = system.wheel[k]
        _s, _h, n_x, n_y, d = nearest(road, y[w], y[bodies + w])
        v_x, v_y, theta_dot = y[3 * bodies + w], y[4 * bodies + w], y[5 * bodies + w]
        xi = y[6 * bodies + k]
        z = r - d
        f_n, f_t = 0.0, 0.0
        if z > 0.0:
            z_dot = -(v_x * n_x + v_y * n_y)
            f_n = max(0.0, z * z * (system.k_n + system.c_n * z_dot))  # eq. (4)
            p_dot = v_x * n_y - v_y * n_x + r * theta_dot
            f_stick = -(k_t * xi + c_t * p_dot)  # eq. (5)
            limit = system.mu * f_n
            f_t = min(max(f_stick, -limit), limit)  # eq. (6)
        dy[6 * bodies + k] = -(k_t * xi + f_t) / c_t  # eq. (7)
        work.f_n[k], work.f_t[k] = f_n, f_t
        work.wheel[0, k] = f_n * n_x + f_t * n_y
        work.wheel[1, k] = f_n * n_y - f_t * n_x
        work.wheel[2, k] = r * f_t
        total += f_n

    F, int_e_dot = 0.0, 0.0
    if not system.prescribed:
        e = system.v_ref - y[3 * bodies]
        F = system.K_p * e + system.K_i * y[-1]
        int_e_dot = e
        if abs(F) > system.F_max:
            F = np.copysign(system.F_max, F)
            int_e_dot = 0.0
        if total > 0.0:
            for k in range(wheels):
                work.wheel[2, k] -= r * F * work.f_n[k] / total
    dy[-1] = int_e_dot
    work.F[0] = F
    return total


@inlined
def rates(system, road, t, y, dy, work):
    """dy/dt of the flat state at time t; leaves loads, tractions and drive force in work."""
    n, m = system.n, system.m
    B = len(system.mass)
    two_alpha, beta2 = 2.0 * system.alpha, system.beta * system.beta
    x, h, theta = y[:B], y[B : 2 * B], y[2 * B : 3 * B]
    v_x, v_y, omega = y[3 * B : 4 * B], y[4 * B : 5 * B], y[5 * B : 6 * B]
    a_x, a_y, omega_dot = dy[3 * B : 4 * B], dy[4 * B : 5 * B], dy[5 * B : 6 * B]
    for i in range(3 * B):
        dy[i] = y[3 * B + i]
    total = contact_forces(system, road, y, dy, work)

    # Torsion bars of the road arms, eq. (1)
    tau_chassis = 0.0
    if not system.prescribed and total > 0.0:
        tau_chassis = system.r * work.F[0]
    for i in range(n):
        arm = 1 + i
        u, u_dot = theta[0] - theta[arm], omega[0] - omega[arm]
        tau = system.k_s[i] * u + system.c_s[i] * u_dot + system.tau_0[i]
        if not system.linear:
            tau += _beyond_linear(system, i, u, u_dot)
        work.tau[i] = tau
        tau_chassis -= tau

    # Leaves first: fold imaginary wheel i into imaginary arm i
    for i in range(m):
        link, end = 1 + 2 * n + i, 1 + 2 * n + m + i
        s, base = n + i, system.spring_i[n + i]
        tau = (
            system.k_s[s] * (theta[base] - theta[link]) + system.c_s[s] * (omega[base] - omega[link]) + system.tau_0[s]
        )  # eq. (2)
        if base == 0:
            tau_chassis -= tau
        else:
            work.tau[i] -= tau  # eq. (3)
        cos, sin = cos_sin(theta[link])
        u = system.u_j[2 * n + i]
        p_x, p_y = cos * u[0] - sin * u[1], sin * u[0] + cos * u[1]
        u = system.u_i[2 * n + m + i]
        w_x, w_y = cos * u[0] - sin * u[1], sin * u[0] + cos * u[1]
        # γ at the imaginary wheel's centre: first body the arm
        w = omega[link]
        C_x, C_y = x[link] + w_x - x[end], h[link] + w_y - h[end]
        C_x_dot, C_y_dot = v_x[link] - w * w_y - v_x[end], v_y[link] + w * w_x - v_y[end]
        gamma_x = w * w * w_x - two_alpha * C_x_dot - beta2 * C_x
        gamma_y = w * w * w_y - two_alpha * C_y_dot - beta2 * C_y
        m_v, m_l = system.mass[end], system.mass[link]
        b_x = m_v * gamma_x + work.wheel[0, n + i]
        b_y = m_v * gamma_y + work.wheel[1, n + i] - system.weight[end]
        K_xx, K_xy, K_yy, f_x, f_y, e_x, e_y, T = _fold_arm(
            m_l, system.inertia[link], p_x, p_y, w_x, w_y, m_v, 0.0, m_v, b_x, b_y, -system.weight[link], tau
        )
        _remember(work.arm[n + i], p_x, p_y, w_x, w_y, gamma_x, gamma_y, e_x, e_y, T, K_xx, K_xy, K_yy, f_x, f_y)

    # Fold each chain into its road arm, and the road arms into the chassis
    cos, sin = cos_sin(theta[0])
    w0 = omega[0]
    M_xx, M_xy, M_yy = system.mass[0], 0.0, system.mass[0]
    M_xt, M_yt, M_tt = 0.0, 0.0, system.inertia[0]
    Q_x, Q_y, Q_t = 0.0, -system.weight[0], tau_chassis
    for i in range(n):
        arm, wheel = 1 + i, 1 + n + i
        m_w, m_a = system.mass[wheel], system.mass[arm]
        K_xx, K_xy, K_yy = m_w, 0.0, m_w
        f_x, f_y = work.wheel[0, i], work.wheel[1, i] - system.weight[wheel]
        if i < m:
            link = 1 + 2 * n + i
            held = work.arm[n + i]
            # γ at the road wheel's centre: first body the wheel
            w = omega[link]
            p_x, p_y = held[0], held[1]
            C_x, C_y = x[wheel] - x[link] - p_x, h[wheel] - h[link] - p_y
            C_x_dot, C_y_dot = v_x[wheel] - v_x[link] + w * p_y, v_y[wheel] - v_y[link] - w * p_x
            gamma_x = -w * w * p_x - two_alpha * C_x_dot - beta2 * C_x
            gamma_y = -w * w * p_y - two_alpha * C_y_dot - beta2 * C_y
            held[14], held[15] = gamma_x, gamma_y
            K_xx, K_xy, K_yy = K_xx + held[9], held[10], K_yy + held[11]
            f_x += held[9] * gamma_x + held[10] * gamma_y + held[12]
            f_y += held[10] * gamma_x + held[11] * gamma_y + held[13]
        c, s_ = cos_sin(theta[arm])
        u = system.u_j[i]
        p_x, p_y = c * u[0] - s_ * u[1], s_ * u[0] + c * u[1]
        u = system.u_i[n + i]
        w_x, w_y = c * u[0] - s_ * u[1], s_ * u[0] + c * u[1]
        # γ at the wheel's centre: first body the arm
        w = omega[arm]
        C_x, C_y = x[arm] + w_x - x[wheel], h[arm] + w_y - h[wheel]
        C_x_dot, C_y_dot = v_x[arm] - w * w_y - v_x[wheel], v_y[arm] + w * w_x - v_y[wheel]
        gamma_x = w * w * w_x - two_alpha * C_x_dot - beta2 * C_x
        gamma_y = w * w * w_y - two_alpha * C_y_dot - beta2 * C_y
        b_x = K_xx * gamma_x + K_xy * gamma_y + f_x
        b_y = K_xy * gamma_x + K_yy * gamma_y + f_y
        K_xx, K_xy, K_yy, f_x, f_y, e_x, e_y, T = _fold_arm(
            m_a, system.inertia[arm], p_x, p_y, w_x, w_y, K_xx, K_xy, K_yy, b_x, b_y, -system.weight[arm], work.tau[i]
        )
        held = work.arm[i]
        _remember(held, p_x, p_y, w_x, w_y, gamma_x, gamma_y, e_x, e_y, T, K_xx, K_xy, K_yy, f_x, f_y)
        # γ at the pivot: first body the chassis
        u = system.u_i[i]
        c_x, c_y = cos * u[0] - sin * u[1], sin * u[0] + cos * u[1]
        C_x, C_y = x[0] + c_x - x[arm] - p_x, h[0] + c_y - h[arm] - p_y
        C_x_dot = v_x[0] - w0 * c_y - v_x[arm] + w * p_y
        C_y_dot = v_y[0] + w0 * c_x - v_y[arm] - w * p_x
        gamma_x = w0 * w0 * c_x - w * w * p_x - two_alpha * C_x_dot - beta2 * C_x
        gamma_y = w0 * w0 * c_y - w * w * p_y - two_alpha * C_y_dot - beta2 * C_y
        held[14], held[15], held[16], held[17] = gamma_x, gamma_y, c_x, c_y
        # λ_p = K (a + θ̈ c⊥) − b on the chassis at c
        b_x = K_xx * gamma_x + K_xy * gamma_y + f_x
        b_y = K_xy * gamma_x + K_yy * gamma_y + f_y
        Kc_x, Kc_y = -K_xx * c_y + K_xy * c_x, -K_xy * c_y + K_yy * c_x
        M_xx, M_xy, M_yy = M_xx + K_xx, M_xy + K_xy, M_yy + K_yy
        M_xt, M_yt, M_tt = M_xt + Kc_x, M_yt + Kc_y, M_tt - c_y * Kc_x + c_x * Kc_y
        Q_x, Q_y, Q_t = Q_x + b_x, Q_y + b_y, Q_t - c_y * b_x + c_x * b_y

    # The root: 3×3 for the chassis; with prescribed drive its a_x is given by eq. (14) and λ_45 balances that row
    if system.prescribed:
        a0_x = -two_alpha * (v_x[0] - system.v_ref) - beta2 * (x[0] - system.x_0 - system.v_ref * t)
    else:
        # Schur complement of the lower 2×2 block on the x row
        over = 1.0 / (M_yy * M_tt - M_yt * M_yt)
        s_y, s_t = (M_xy * M_tt - M_xt * M_yt) * over, (M_xt * M_yy - M_xy * M_yt) * over
        a0_x = (Q_x - s_y * Q_y - s_t * Q_t) / (M_xx - s_y * M_xy - s_t * M_xt)
    Q_y -= M_xy * a0_x
    Q_t -= M_xt * a0_x
    over = 1.0 / (M_yy * M_tt - M_yt * M_yt)
    a0_y = (Q_y * M_tt - Q_t * M_yt) * over
    alpha_0 = (Q_t * M_yy - Q_y * M_yt) * over
    a_x[0], a_y[0], omega_dot[0] = a0_x, a0_y, alpha_0

    # Back out along the chains
    for i in range(n):
        arm, wheel = 1 + i, 1 + n + i
        held = work.arm[i]
        A_x = a0_x - alpha_0 * held[17] - held[14]
        A_y = a0_y + alpha_0 * held[16] - held[15]
        A_x, A_y = _back_out(held, A_x, A_y, arm, wheel, a_x, a_y, omega_dot)
        omega_dot[wheel] = work.wheel[2, i] / system.inertia[wheel]
        if i < m:
            link, end = 1 + 2 * n + i, 1 + 2 * n + m + i
            held = work.arm[n + i]
            _back_out(held, A_x - held[14], A_y - held[15], link, end, a_x, a_y, omega_dot)
            omega_dot[end] = work.wheel[2, n + i] / system.inertia[end]


@inlined
def _remember(held, p_x, p_y, w_x, w_y, gamma_x, gamma_y, e_x, e_y, T, K_xx, K_xy, K_yy, f_x, f_y):
    held[0], held[1], held[2], held[3] = p_x, p_y, w_x, w_y
    held[4], held[5], held[6], held[7], held[8] = gamma_x, gamma_y, e_x, e_y, T
    held[9], held[10], held[11], held[12], held[13] = K_xx, K_xy, K_yy, f_x, f_y


@inlined
def _back_out(held, A_x, A_y, arm, wheel, a_x, a_y, omega_dot):
    """From the pivot's acceleration: the arm's, and that of the wheel at its end (returned too)."""
    theta_ddot = held[8] - held[6] * A_x - held[7] * A_y
    a_x[arm], a_y[arm] = A_x + theta_ddot * held[1], A_y - theta_ddot * held[0]
    omega_dot[arm] = theta_ddot
    a_x[wheel] = a_x[arm] - theta_ddot * held[3] - held[4]
    a_y[wheel] = a_y[arm] + theta_ddot * held[2] - held[5]
    return a_x[wheel], a_y[wheel]


@compiled
def multipliers(system, dy, work, lam):
    """λ (rows of C) from the accelerations that `rates` left in dy: Newton's law from the leaves inwards."""
    n, m = system.n, system.m
    B = len(system.mass)
    a_x, a_y = dy[3 * B : 4 * B], dy[4 * B : 5 * B]
    sum_x = 0.0
    for i in range(n):
        arm, wheel = 1 + i, 1 + n + i
        l_x, l_y = 0.0, 0.0
        if i < m:
            link, end = 1 + 2 * n + i, 1 + 2 * n + m + i
            l_x = system.mass[end] * a_x[end] - work.wheel[0, n + i]
            l_y = system.mass[end] * a_y[end] + system.weight[end] - work.wheel[1, n + i]
            row = 2 * (2 * n + m + i)
            lam[row], lam[row + 1] = l_x, l_y
            l_x += system.mass[link] * a_x[link]
            l_y += system.mass[link] * a_y[link] + system.weight[link]
            row = 2 * (2 * n + i)
            lam[row], lam[row + 1] = l_x, l_y
        l_x += system.mass[wheel] * a_x[wheel] - work.wheel[0, i]
        l_y += system.mass[wheel] * a_y[wheel] + system.weight[wheel] - work.wheel[1, i]
        row = 2 * (n + i)
        lam[row], lam[row + 1] = l_x, l_y
        l_x += system.mass[arm] * a_x[arm]
        l_y += system.mass[arm] * a_y[arm] + system.weight[arm]
        lam[2 * i], lam[2 * i + 1] = l_x, l_y
        sum_x += l_x
    if system.prescribed:
        lam[-1] = -system.mass[0] * a_x[0] - sum_x
        work.F[0] = -lam[-1]


@inlined
def _turned(angle, u):
    """u turned by an angle; wheels, jointed at their centres (u = 0), may have turned far."""
    if u[0] == 0.0 and u[1] == 0.0:
        return 0.0, 0.0
    cos, sin = cos_sin(angle)
    return cos * u[0] - sin * u[1], sin * u[0] + cos * u[1]


@compiled
def constraint_residual(system, t, y):
    """max |C(q, t)|, m."""
    B = len(system.mass)
    worst = 0.0
    for joint in range(len(system.joint_i)):
        i, j = system.joint_i[joint], system.joint_j[joint]
        i_x, i_y = _turned(y[2 * B + i], system.u_i[joint])
        j_x, j_y = _turned(y[2 * B + j], system.u_j[joint])
        C_x, C_y = y[i] + i_x - y[j] - j_x, y[B + i] + i_y - y[B + j] - j_y
        worst = max(worst, abs(C_x), abs(C_y))
    if system.prescribed:
        worst = max(worst, abs(y[0] - system.x_0 - system.v_ref * t))
    return worst
