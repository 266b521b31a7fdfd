"""Springs, dampers and stops of the arms: torques, energies, and what they turn into heat (model/MODEL.md, "Suspension
torques"; progression, rebound damping and stops go beyond the paper).

u = θ_i − θ_j, the turn of a spring from the design pose, positive while the wheel rises in the hull; rad, N m, J, W.
Functions of a System take arrays (…, S) over all springs, road arms first.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from model.dynamics.vehicle import Stops, System

Values = Any  # a number, or an array with one for each spring, sample …


class Elastic(NamedTuple):
    """What springs, preloads and stops do when they are turned slowly; each (…, S)."""

    energy: np.ndarray  # J, none at u = 0
    torque: np.ndarray  # its slope, N m
    stiffness: np.ndarray  # and the torque's, N m/rad


def added_torque(stops: Stops, k: Values, c: Values, p: Values, c_rebound: Values, u: Values, u_dot: Values) -> Values:
    """What progression, rebound damping and stops add to the torque of a road arm's linear spring and damper, N m.

    The kernel compiles this function (kernel.py).
    """
    into_bump, into_rebound = u - stops.bump, u - stops.rebound
    # A stop pushes, it never pulls
    bump = np.maximum(stops.k * into_bump + stops.c * u_dot, 0.0) * (into_bump > 0.0)
    rebound = np.minimum(stops.k * into_rebound + stops.c * u_dot, 0.0) * (into_rebound < 0.0)
    return k * p * u * u * u + (c_rebound - c) * np.minimum(u_dot, 0.0) + bump + rebound


def torque(system: System, u: np.ndarray, u_dot: np.ndarray) -> np.ndarray:
    """τ (…, S), N m: on arm j; the body before it, i, gets −τ."""
    # Eq. (1), and eq. (2) with its sign turned
    tau = system.k_s * u + system.c_s * u_dot + system.tau_0
    arms = np.s_[..., : system.n]
    k, c, p, c_rebound = (values[: system.n] for values in (system.k_s, system.c_s, system.p, system.c_rebound))
    tau[arms] += added_torque(system.stops, k, c, p, c_rebound, u[arms], u_dot[arms])
    return tau


def elastic(system: System, u: np.ndarray) -> Elastic:
    """Springs with their preloads, and stops."""
    k, p = system.k_s, system.p
    if system.linear:
        return Elastic(energy=k * u**2 / 2 + system.tau_0 * u, torque=k * u + system.tau_0, stiffness=k)
    over = _into_stops(system, u)
    stop = np.where(over != 0.0, system.stops.k, 0.0)
    return Elastic(
        energy=k * u**2 * (1 / 2 + p * u**2 / 4) + system.tau_0 * u + stop * over**2 / 2,
        torque=k * u * (1 + p * u**2) + system.tau_0 + stop * over,
        stiffness=k * (1 + 3 * p * u**2) + stop,
    )


def dissipated_power(system: System, u: np.ndarray, u_dot: np.ndarray) -> np.ndarray:
    """W (…, S), that dampers and stops turn into heat."""
    return (torque(system, u, u_dot) - elastic(system, u).torque) * u_dot


def _into_stops(system: System, u: np.ndarray) -> np.ndarray:
    """(…, S) how far arms have turned into their bump (positive) or rebound stops; 0 without contact."""
    over = np.maximum(u - system.stops.bump, 0.0) + np.minimum(u - system.stops.rebound, 0.0)
    over[..., system.n :] = 0.0
    return over
