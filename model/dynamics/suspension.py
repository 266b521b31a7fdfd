"""Springs, dampers and stops of the arms: torques, energies, and what they turn into heat (model/MODEL.md, "Suspension
torques"; progression, rebound damping and stops go beyond the paper).

u = θ_i − θ_j, the turn of a spring from the design pose, positive while the wheel rises in the hull; rad, N m, J, W.
Arrays are (…, S) over all springs, road arms first.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from model.dynamics.vehicle import Stops, System


class Elastic(NamedTuple):
    """What springs, preloads and stops do when they are turned slowly; each (…, S)."""

    energy: np.ndarray  # J, none at u = 0
    torque: np.ndarray  # its slope, N m
    stiffness: np.ndarray  # and the torque's, N m/rad


def added_torque(stops: Stops, k: float, c: float, p: float, c_rebound: float, u: float, u_dot: float) -> float:
    """What progression, rebound damping and stops add to the torque of one road arm's linear spring and damper, N m.

    The kernel compiles this function (kernel.py).
    """
    tau = k * p * u * u * u + (c_rebound - c) * min(u_dot, 0.0)
    # A stop pushes, it never pulls
    if u > stops.bump:
        tau += max(0.0, stops.k * (u - stops.bump) + stops.c * u_dot)
    elif u < stops.rebound:
        tau += min(0.0, stops.k * (u - stops.rebound) + stops.c * u_dot)
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
    power = np.where(u_dot < 0.0, system.c_rebound, system.c_s) * u_dot**2
    over = _into_stops(system, u)
    push = system.stops.k * over + system.stops.c * u_dot
    push = np.where(push * over > 0.0, push, 0.0)  # a stop never pulls
    return power + np.where(over != 0.0, (push - system.stops.k * over) * u_dot, 0.0)


def _into_stops(system: System, u: np.ndarray) -> np.ndarray:
    """(…, S) how far arms have turned into their bump (positive) or rebound stops; 0 without contact."""
    over = np.maximum(u - system.stops.bump, 0.0) + np.minimum(u - system.stops.rebound, 0.0)
    over[..., system.n :] = 0.0
    return over
