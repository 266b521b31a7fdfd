"""The contact law of wheel and ground, eq. (4)–(7), in one place: force, energy, stiffness, what becomes heat.

z: how deep a wheel is in the ground, m, not at all where z ≤ 0; ṗ: how fast its rim slips along the ground, m/s; ξ (the
paper's x): how far the ground is sheared under it, m. All functions but `force` also take arrays of one shape. Another
kind of ground is another law with the same functions.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

Values = Any  # a number, or an array with one for each wheel, sample …


class Ground(NamedTuple):
    """What the law is made of."""

    k_n: float  # N/m²
    c_n: float  # N s/m³
    k_t: float  # N/m
    c_t: float  # N s/m
    mu: float


class Pressed(NamedTuple):
    """What the ground does when a wheel is pressed into it slowly."""

    energy: Values  # J, none at z = 0
    force: Values  # its slope, N
    stiffness: Values  # and the force's, N/m


class Losses(NamedTuple):
    """What becomes heat, W; neither is negative."""

    damping: Values
    friction: Values


def force(ground: Ground, z: float, z_dot: float, p_dot: float, xi: float) -> tuple[float, float, float]:
    """Normal load f_n and traction f_t on a wheel, N, and ξ̇, m/s. kernel_contact.py compiles this function."""
    z = max(z, 0.0)
    # Eq. (4), cut at zero: the ground never pulls
    f_n = max(z * z * (ground.k_n + ground.c_n * z_dot), 0.0)
    # Eq. (5) with the sign of a force on the wheel, limited as eq. (6) says
    limit = ground.mu * f_n
    f_t = min(max(-(ground.k_t * xi + ground.c_t * p_dot), -limit), limit)
    # Eq. (7) with the limited force
    xi_dot = -(ground.k_t * xi + f_t) / ground.c_t
    return f_n, f_t, xi_dot


def pressed(ground: Ground, z: Values) -> Pressed:
    """Eq. (4) without damping, and what follows from it."""
    z = np.maximum(z, 0.0)
    return Pressed(energy=ground.k_n / 3 * z**3, force=ground.k_n * z**2, stiffness=2 * ground.k_n * z)


def depth(ground: Ground, load: Values) -> Values:
    """How deep a wheel sinks in slowly under a load, N; m."""
    return np.sqrt(load / ground.k_n)


def shear_energy(ground: Ground, xi: Values) -> Values:
    """J, in ground that is sheared by ξ."""
    return ground.k_t / 2 * xi**2


def losses(ground: Ground, z: Values, z_dot: Values, p_dot: Values, xi: Values, f_n: Values, f_t: Values) -> Losses:
    """What the ground's damping and the slipping between ground and track turn into heat under the force f_n, f_t."""
    xi_dot = -(ground.k_t * xi + f_t) / ground.c_t
    pressing = (f_n - pressed(ground, z).force) * np.where(z > 0.0, z_dot, 0.0)
    return Losses(damping=pressing + ground.c_t * xi_dot**2, friction=-f_t * (p_dot - xi_dot))
