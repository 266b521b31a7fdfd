"""The right-hand side of equations.py, compiled: the augmented system of eq. (15) solved in O(bodies), no allocation.

The joints form a tree: each of n chains hangs a road arm on the chassis, a road wheel on the arm, an imaginary arm on
the wheel's centre and an imaginary wheel on that. Eliminating from the leaves, everything beyond a joint acts on the
body before it like a mass matrix K (2×2) and a force f at the joint:

    λ = K a_P − f,    a_P: acceleration of the joint's point on the second body.

A wheel, jointed at its centre, gives K = m I and f = its force; its spin stands alone. An arm from its pivot p to its
tip that carries (K, f) gives what `_fold_arm` derives. With all chains folded the chassis is left with a 3×3
system; going back out, each arm's rotation follows from its pivot's acceleration. With the paper's joint rows
(first body minus second), a_P = acceleration of the point on the first body − γ.

Chains do not touch each other but through the chassis: they are computed side by side (lanes.py). Every loop
`for i in range(lanes.lanes)` is one that the compiler turns into instructions on several numbers: in it, all arrays are
slices of one block, rows begin at constants, and there is no branch. Letters after a quantity tell whose it is: chassis
c, road arm a, road wheel w, imaginary arm l, imaginary wheel v.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from model.compiled import compiled, inlined
from model.dynamics import suspension
from model.dynamics.kernel_contact import block, contact_forces
from model.dynamics.lanes import INT_E, LANES, SCRATCH_SIZE, SPEED, WORK, C, P, W, Y


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
    half = 0.5 * quarters
    odd = half != np.floor(half)
    quadrant = quarters - 4.0 * np.floor(0.25 * quarters)
    cos, sin = (sin if odd else cos), (cos if odd else sin)
    return (-cos if (quadrant == 1.0) | (quadrant == 2.0) else cos), (-sin if quadrant >= 2.0 else sin)


@inlined
def _fold_arm(m, I, p_x, p_y, tip_x, tip_y, K_xx, K_xy, K_yy, b_x, b_y, F_y, tau):
    """An arm that carries (K, b = K γ + f) at its tip, seen from its pivot p (both from its centre of mass).

    With d = tip − p, ⊥ a turn by +90°, a its centre's and a_P its pivot's acceleration, a = a_P − θ̈ p⊥ and
        force:            λ_p = m a + λ_w − F,        λ_w = K (a_P + θ̈ d⊥) − b
        moment about p:   I θ̈ + d⊥·λ_w − p⊥·(m a − F) = τ
    so that θ̈ = (T − e·a_P)/J and λ_p = K_p a_P − f_p with
        e = K d⊥ − m p⊥,  J = I + d⊥·K d⊥ + m p²,  T = τ + d⊥·b − p⊥·F
        K_p = m I + K − e eᵀ/J,  f_p = b + F − e T/J.
    """
    d_x, d_y = -(tip_y - p_y), tip_x - p_x  # d⊥
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


_added_torque = inlined(suspension.added_torque)


@inlined
def _torsion_bars(lanes, theta_c, omega_c, s, p, w):
    """Torque on the road arms of a block, eq. (1), and what progressive spring, rebound damping and stops add to it."""
    for i in range(lanes.lanes):
        u, u_dot = theta_c - s[i + Y.theta_a], omega_c - s[i + Y.omega_a]
        w[i + W.tau_a] = p[i + P.k_s] * u + p[i + P.c_s] * u_dot + p[i + P.tau_0]
    if not lanes.linear:
        for i in range(lanes.lanes):
            u, u_dot = theta_c - s[i + Y.theta_a], omega_c - s[i + Y.omega_a]
            k, c, c_rebound = p[i + P.k_s], p[i + P.c_s], p[i + P.c_rebound]
            w[i + W.tau_a] += _added_torque(lanes.stops, k, c, p[i + P.p], c_rebound, u, u_dot) * p[i + P.road]


@inlined
def _turned(cos, sin, x, y):
    """A(θ) of eq. (10) times a vector of the body's frame."""
    return cos * x - sin * y, sin * x + cos * y


@inlined
def _joint(two_alpha, beta2, C_x, C_y, C_x_dot, C_y_dot, bend_x, bend_y):
    """γ of one joint, eq. (14) with Baumgarte's terms, and how far the joint is apart: (γ_x, γ_y, max |C|).

    C: eq. (10), the point on the first body minus that on the second. bend: −(C_q q̇)_q q̇, which is +θ̇² times the way to
    the joint from the first body's centre, and −θ̇² times that from the second's.
    """
    gamma_x = bend_x - two_alpha * C_x_dot - beta2 * C_x
    gamma_y = bend_y - two_alpha * C_y_dot - beta2 * C_y
    return gamma_x, gamma_y, max(abs(C_x), abs(C_y))


class Chassis(NamedTuple):
    """The chassis now."""

    x: float
    y: float
    theta: float
    v_x: float
    v_y: float
    omega: float
    cos: float
    sin: float


@inlined
def _fold_chains(lanes, c, s, p, w):
    """Each chain of a block, leaves first, down to its pivot, and what it adds to the chassis's equations."""
    two_alpha, beta2 = lanes.two_alpha, lanes.beta2
    for i in range(lanes.lanes):
        x_a, y_a, v_x_a, v_y_a = s[i + Y.x_a], s[i + Y.y_a], s[i + Y.v_x_a], s[i + Y.v_y_a]
        x_w, y_w, v_x_w, v_y_w = s[i + Y.x_w], s[i + Y.y_w], s[i + Y.v_x_w], s[i + Y.v_y_w]
        x_l, y_l, v_x_l, v_y_l = s[i + Y.x_l], s[i + Y.y_l], s[i + Y.v_x_l], s[i + Y.v_y_l]
        theta_a, omega_a = s[i + Y.theta_a], s[i + Y.omega_a]
        theta_l, omega_l = s[i + Y.theta_l], s[i + Y.omega_l]
        tau_a, on_arm = w[i + W.tau_a], p[i + P.on_arm]

        # Spring of the imaginary arm, eq. (2), and what leans on it, eq. (3)
        u = c.theta + on_arm * (theta_a - c.theta) - theta_l
        u_dot = c.omega + on_arm * (omega_a - c.omega) - omega_l
        tau_l = p[i + P.k_sl] * u + p[i + P.c_sl] * u_dot + p[i + P.tau_0l]
        w[i + W.power] = tau_a * (omega_a - c.omega) - tau_l * u_dot
        tau_c = -tau_a - (1.0 - on_arm) * tau_l
        tau_a -= on_arm * tau_l

        # Imaginary arm – imaginary wheel
        cos, sin = cos_sin(theta_l)
        p_x, p_y = _turned(cos, sin, p[i + P.p_x_l], p[i + P.p_y_l])
        tip_x, tip_y = _turned(cos, sin, p[i + P.tip_x_l], p[i + P.tip_y_l])
        C_x, C_y = x_l + tip_x - s[i + Y.x_v], y_l + tip_y - s[i + Y.y_v]
        C_x_dot, C_y_dot = v_x_l - omega_l * tip_y - s[i + Y.v_x_v], v_y_l + omega_l * tip_x - s[i + Y.v_y_v]
        bend_x, bend_y = omega_l * omega_l * tip_x, omega_l * omega_l * tip_y
        gamma_x, gamma_y, drift_l = _joint(two_alpha, beta2, C_x, C_y, C_x_dot, C_y_dot, bend_x, bend_y)
        m_v = p[i + P.m_v]
        b_x = m_v * gamma_x + w[i + W.F_x_v]
        b_y = m_v * gamma_y + w[i + W.F_y_v] - p[i + P.weight_v]
        K_xx, K_xy, K_yy, f_x, f_y, e_x, e_y, T = _fold_arm(
            p[i + P.m_l], p[i + P.I_l], p_x, p_y, tip_x, tip_y, m_v, 0.0, m_v, b_x, b_y, -p[i + P.weight_l], tau_l
        )
        w[i + W.p_x_l], w[i + W.p_y_l], w[i + W.tip_x_l], w[i + W.tip_y_l] = p_x, p_y, tip_x, tip_y
        w[i + W.gamma_x_l], w[i + W.gamma_y_l] = gamma_x, gamma_y
        w[i + W.e_x_l], w[i + W.e_y_l], w[i + W.T_l] = e_x, e_y, T

        # Road wheel – imaginary arm
        C_x, C_y = x_w - x_l - p_x, y_w - y_l - p_y
        C_x_dot, C_y_dot = v_x_w - v_x_l + omega_l * p_y, v_y_w - v_y_l - omega_l * p_x
        bend_x, bend_y = -omega_l * omega_l * p_x, -omega_l * omega_l * p_y
        gamma_x, gamma_y, apart = _joint(two_alpha, beta2, C_x, C_y, C_x_dot, C_y_dot, bend_x, bend_y)
        drift_l = max(drift_l, apart)
        w[i + W.at_pivot_x_l], w[i + W.at_pivot_y_l] = gamma_x, gamma_y
        f_x += K_xx * gamma_x + K_xy * gamma_y + w[i + W.F_x_w]
        f_y += K_xy * gamma_x + K_yy * gamma_y + w[i + W.F_y_w] - p[i + P.weight_w]
        K_xx, K_yy = K_xx + p[i + P.m_w], K_yy + p[i + P.m_w]

        # Road arm – road wheel
        cos, sin = cos_sin(theta_a)
        p_x, p_y = _turned(cos, sin, p[i + P.p_x_a], p[i + P.p_y_a])
        tip_x, tip_y = _turned(cos, sin, p[i + P.tip_x_a], p[i + P.tip_y_a])
        C_x, C_y = x_a + tip_x - x_w, y_a + tip_y - y_w
        C_x_dot, C_y_dot = v_x_a - omega_a * tip_y - v_x_w, v_y_a + omega_a * tip_x - v_y_w
        bend_x, bend_y = omega_a * omega_a * tip_x, omega_a * omega_a * tip_y
        gamma_x, gamma_y, drift_a = _joint(two_alpha, beta2, C_x, C_y, C_x_dot, C_y_dot, bend_x, bend_y)
        b_x = K_xx * gamma_x + K_xy * gamma_y + f_x
        b_y = K_xy * gamma_x + K_yy * gamma_y + f_y
        K_xx, K_xy, K_yy, f_x, f_y, e_x, e_y, T = _fold_arm(
            p[i + P.m_a], p[i + P.I_a], p_x, p_y, tip_x, tip_y, K_xx, K_xy, K_yy, b_x, b_y, -p[i + P.weight_a], tau_a
        )
        w[i + W.p_x_a], w[i + W.p_y_a], w[i + W.tip_x_a], w[i + W.tip_y_a] = p_x, p_y, tip_x, tip_y
        w[i + W.gamma_x_a], w[i + W.gamma_y_a] = gamma_x, gamma_y
        w[i + W.e_x_a], w[i + W.e_y_a], w[i + W.T_a] = e_x, e_y, T

        # Chassis – road arm
        c_x, c_y = _turned(c.cos, c.sin, p[i + P.c_x], p[i + P.c_y])
        C_x, C_y = c.x + c_x - x_a - p_x, c.y + c_y - y_a - p_y
        C_x_dot = c.v_x - c.omega * c_y - v_x_a + omega_a * p_y
        C_y_dot = c.v_y + c.omega * c_x - v_y_a - omega_a * p_x
        bend_x = c.omega * c.omega * c_x - omega_a * omega_a * p_x
        bend_y = c.omega * c.omega * c_y - omega_a * omega_a * p_y
        gamma_x, gamma_y, apart = _joint(two_alpha, beta2, C_x, C_y, C_x_dot, C_y_dot, bend_x, bend_y)
        drift_a = max(drift_a, apart)
        w[i + W.at_pivot_x_a], w[i + W.at_pivot_y_a], w[i + W.c_x], w[i + W.c_y] = gamma_x, gamma_y, c_x, c_y
        w[i + W.drift] = max(drift_a * p[i + P.road], drift_l * p[i + P.imaginary])

        # λ_p = K (a + θ̈ c⊥) − b on the chassis at c
        b_x = K_xx * gamma_x + K_xy * gamma_y + f_x
        b_y = K_xy * gamma_x + K_yy * gamma_y + f_y
        Kc_x, Kc_y = -K_xx * c_y + K_xy * c_x, -K_xy * c_y + K_yy * c_x
        w[i + W.M_xx], w[i + W.M_xy], w[i + W.M_yy] = K_xx, K_xy, K_yy
        w[i + W.M_xt], w[i + W.M_yt], w[i + W.M_tt] = Kc_x, Kc_y, c_x * Kc_y - c_y * Kc_x
        w[i + W.Q_x], w[i + W.Q_y], w[i + W.Q_t] = b_x, b_y, tau_c - c_y * b_x + c_x * b_y


@inlined
def _back_out(lanes, a_x_c, a_y_c, alpha_c, turning, s, ds, p, w):
    """All accelerations of a block from the chassis's; `turning`: the drive's torque for each newton of load, m."""
    for i in range(lanes.lanes):
        road, imaginary = p[i + P.road], p[i + P.imaginary]
        A_x = a_x_c - alpha_c * w[i + W.c_y] - w[i + W.at_pivot_x_a]
        A_y = a_y_c + alpha_c * w[i + W.c_x] - w[i + W.at_pivot_y_a]
        alpha = w[i + W.T_a] - w[i + W.e_x_a] * A_x - w[i + W.e_y_a] * A_y
        a_x, a_y = A_x + alpha * w[i + W.p_y_a], A_y - alpha * w[i + W.p_x_a]
        ds[i + Y.v_x_a], ds[i + Y.v_y_a], ds[i + Y.omega_a] = road * a_x, road * a_y, road * alpha
        a_x -= alpha * w[i + W.tip_y_a] + w[i + W.gamma_x_a]
        a_y += alpha * w[i + W.tip_x_a] - w[i + W.gamma_y_a]
        ds[i + Y.v_x_w], ds[i + Y.v_y_w] = road * a_x, road * a_y
        ds[i + Y.omega_w] = (lanes.r * w[i + W.f_t_w] - turning * w[i + W.f_n_w]) * p[i + P.over_I_w]

        A_x, A_y = a_x - w[i + W.at_pivot_x_l], a_y - w[i + W.at_pivot_y_l]
        alpha = w[i + W.T_l] - w[i + W.e_x_l] * A_x - w[i + W.e_y_l] * A_y
        a_x, a_y = A_x + alpha * w[i + W.p_y_l], A_y - alpha * w[i + W.p_x_l]
        ds[i + Y.v_x_l], ds[i + Y.v_y_l], ds[i + Y.omega_l] = imaginary * a_x, imaginary * a_y, imaginary * alpha
        a_x -= alpha * w[i + W.tip_y_l] + w[i + W.gamma_x_l]
        a_y += alpha * w[i + W.tip_x_l] - w[i + W.gamma_y_l]
        ds[i + Y.v_x_v], ds[i + Y.v_y_v] = imaginary * a_x, imaginary * a_y
        ds[i + Y.omega_v] = (lanes.r * w[i + W.f_t_v] - turning * w[i + W.f_n_v]) * p[i + P.over_I_v]
    for i in range(lanes.lanes):
        ds[i + Y.x_a], ds[i + Y.y_a], ds[i + Y.theta_a] = s[i + Y.v_x_a], s[i + Y.v_y_a], s[i + Y.omega_a]
        ds[i + Y.x_w], ds[i + Y.y_w], ds[i + Y.theta_w] = s[i + Y.v_x_w], s[i + Y.v_y_w], s[i + Y.omega_w]
        ds[i + Y.x_l], ds[i + Y.y_l], ds[i + Y.theta_l] = s[i + Y.v_x_l], s[i + Y.v_y_l], s[i + Y.omega_l]
        ds[i + Y.x_v], ds[i + Y.y_v], ds[i + Y.theta_v] = s[i + Y.v_x_v], s[i + Y.v_y_v], s[i + Y.omega_v]


@compiled
def rates(lanes, road, t, y, dy, work):
    """dy/dt of the flat state at time t; leaves loads, tractions and drive force in work."""
    count = len(work.blocks) // SCRATCH_SIZE
    total = contact_forces(lanes, road, y, dy, work)

    # The drive (section 2.2): a force F by speed, as torques on the wheels in proportion to their loads
    F, e, int_e_dot, turning, tau_c = 0.0, 0.0, 0.0, 0.0, 0.0
    if not lanes.prescribed:
        e = lanes.v_ref - y[SPEED]
        F, int_e_dot = lanes.K_p * e + lanes.K_i * y[INT_E], e
        if abs(F) > lanes.F_max:
            F, int_e_dot = np.copysign(lanes.F_max, F), 0.0
        if total > 0.0:
            turning, tau_c = lanes.r * F / total, lanes.r * F
    work.F[0] = F

    cos, sin = cos_sin(y[2])
    c = Chassis(y[0], y[1], y[2], y[3], y[4], y[5], cos, sin)
    M_xx, M_xy, M_yy, M_xt, M_yt, M_tt = lanes.m_c, 0.0, lanes.m_c, 0.0, 0.0, lanes.I_c
    Q_x, Q_y, Q_t = 0.0, -lanes.weight_c, tau_c
    power = 0.0
    for b in range(count):  # in a loop of its own, or the compiler entangles it with the next and leaves the lanes
        s, _, p, w = block(lanes, b, y, dy, work)
        _torsion_bars(lanes, c.theta, c.omega, s, p, w)
    for b in range(count):
        s, _, p, w = block(lanes, b, y, dy, work)
        _fold_chains(lanes, c, s, p, w)
        for i in range(lanes.lanes):
            M_xx, M_xy, M_yy = M_xx + w[i + W.M_xx], M_xy + w[i + W.M_xy], M_yy + w[i + W.M_yy]
            M_xt, M_yt, M_tt = M_xt + w[i + W.M_xt], M_yt + w[i + W.M_yt], M_tt + w[i + W.M_tt]
            Q_x, Q_y, Q_t = Q_x + w[i + W.Q_x], Q_y + w[i + W.Q_y], Q_t + w[i + W.Q_t]
            power += w[i + W.power] + w[i + W.power_w] + w[i + W.power_v]
            power -= turning * (w[i + W.f_n_w] * s[i + Y.omega_w] + w[i + W.f_n_v] * s[i + Y.omega_v])

    # The root: 3×3 for the chassis; with prescribed drive its a_x is given by eq. (14) and λ_45 balances that row
    if lanes.prescribed:
        a_x = -lanes.two_alpha * (c.v_x - lanes.v_ref) - lanes.beta2 * (c.x - lanes.x_0 - lanes.v_ref * t)
    else:
        # Schur complement of the lower 2×2 block on the x row
        over = 1.0 / (M_yy * M_tt - M_yt * M_yt)
        s_y, s_t = (M_xy * M_tt - M_xt * M_yt) * over, (M_xt * M_yy - M_xy * M_yt) * over
        a_x = (Q_x - s_y * Q_y - s_t * Q_t) / (M_xx - s_y * M_xy - s_t * M_xt)
    Q_y -= M_xy * a_x
    Q_t -= M_xt * a_x
    over = 1.0 / (M_yy * M_tt - M_yt * M_yt)
    a_y, alpha = (Q_y * M_tt - Q_t * M_yt) * over, (Q_t * M_yy - Q_y * M_yt) * over

    dy[0], dy[1], dy[2] = y[3], y[4], y[5]
    dy[3], dy[4], dy[5] = a_x, a_y, alpha
    if work.held[0] != 0.0:  # as fast as the demand stays at the limit, between standing still and running freely
        int_e_dot = work.held[0] * min(max(work.held[0] * lanes.K_p * a_x / lanes.K_i, 0.0), work.held[0] * e)
    dy[INT_E] = int_e_dot
    power += tau_c * c.omega
    if lanes.prescribed:
        power += (M_xx * a_x + M_xy * a_y + M_xt * alpha - Q_x) * c.v_x
    dy[WORK] = power
    for b in range(count):
        s, ds, p, w = block(lanes, b, y, dy, work)
        _back_out(lanes, a_x, a_y, alpha, turning, s, ds, p, w)


@compiled
def multipliers(lanes, dy, work, lam):
    """λ (rows of C) from the accelerations that `rates` left in dy: Newton's law from the leaves inwards."""
    n, m = lanes.n, lanes.m
    sum_x = 0.0
    for b in range(len(work.blocks) // SCRATCH_SIZE):
        _, ds, p, w = block(lanes, b, dy, dy, work)
        for i in range(min(n - b * LANES, LANES)):
            chain = b * LANES + i
            l_x, l_y = 0.0, 0.0
            if chain < m:
                l_x = p[i + P.m_v] * ds[i + Y.v_x_v] - w[i + W.F_x_v]
                l_y = p[i + P.m_v] * ds[i + Y.v_y_v] + p[i + P.weight_v] - w[i + W.F_y_v]
                row = 2 * (2 * n + m + chain)
                lam[row], lam[row + 1] = l_x, l_y
                l_x += p[i + P.m_l] * ds[i + Y.v_x_l]
                l_y += p[i + P.m_l] * ds[i + Y.v_y_l] + p[i + P.weight_l]
                row = 2 * (2 * n + chain)
                lam[row], lam[row + 1] = l_x, l_y
            l_x += p[i + P.m_w] * ds[i + Y.v_x_w] - w[i + W.F_x_w]
            l_y += p[i + P.m_w] * ds[i + Y.v_y_w] + p[i + P.weight_w] - w[i + W.F_y_w]
            row = 2 * (n + chain)
            lam[row], lam[row + 1] = l_x, l_y
            l_x += p[i + P.m_a] * ds[i + Y.v_x_a]
            l_y += p[i + P.m_a] * ds[i + Y.v_y_a] + p[i + P.weight_a]
            lam[2 * chain], lam[2 * chain + 1] = l_x, l_y
            sum_x += l_x
    if lanes.prescribed:
        lam[-1] = -lanes.m_c * dy[SPEED] - sum_x
        work.F[0] = -lam[-1]


@compiled
def constraint_residual(lanes, t, y, work):
    """max |C(q, t)|, m, of the state whose rates were computed last."""
    worst = 0.0
    for b in range(len(work.blocks) // SCRATCH_SIZE):
        for i in range(lanes.lanes):
            worst = max(worst, work.blocks[b * SCRATCH_SIZE + W.drift + i])
    if lanes.prescribed:
        worst = max(worst, abs(y[0] - lanes.x_0 - lanes.v_ref * t))
    return worst


@compiled
def loads(lanes, work, f_n, f_t):
    """Normal loads and tractions (W,), N, that `rates` left in work."""
    for wheel in range(lanes.n + lanes.m):
        chain = wheel if wheel < lanes.n else wheel - lanes.n
        at = chain // LANES * SCRATCH_SIZE + chain % LANES + (W.X_w if wheel < lanes.n else W.X_v)
        f_n[wheel], f_t[wheel] = work.blocks[at + C.f_n], work.blocks[at + C.f_t]
