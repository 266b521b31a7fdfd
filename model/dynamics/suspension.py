"""Springs and dampers of all arms at once, for what looks at whole runs or at rest: energies and torques
(model/MODEL.md, "Suspension torques"; progression, rebound damping and stops go beyond the paper).

u = θ_i − θ_j, the turn of a spring from the design pose, positive while the wheel rises in the hull; arrays
(…, S) over springs, road arms first; rad, N m, J, W.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from model.dynamics.vehicle import System


class Elastic(NamedTuple):
    """What springs, preloads and stops do when they are turned slowly; each (…, S)."""

    energy: np.ndarray  # J, none at u = 0
    torque: np.ndarray  # its slope, N m
    stiffness: np.ndarray  # and the torque's, N m/rad


def elastic(system: System, u: np.ndarray) -> Elastic:
    """Springs with their preloads, and stops."""
    k, p = system.k_s, system.p
    if system.linear:
        return Elastic(energy=k * u**2 / 2 + system.tau_0 * u, torque=k * u + system.tau_0, stiffness=k)
    over = _into_stops(system, u)
    stop = np.where(over != 0.0, system.k_stop, 0.0)
    return Elastic(
        energy=k * u**2 * (1 / 2 + p * u**2 / 4) + system.tau_0 * u + stop * over**2 / 2,
        torque=k * u * (1 + p * u**2) + system.tau_0 + stop * over,
        stiffness=k * (1 + 3 * p * u**2) + stop,
    )


def dissipated_power(system: System, u: np.ndarray, u_dot: np.ndarray) -> np.ndarray:
    """W (…, S), that dampers and stops turn into heat."""
    power = np.where(u_dot < 0.0, system.c_rebound, system.c_s) * u_dot**2
    over = _into_stops(system, u)
    push = system.k_stop * over + system.c_stop * u_dot
    push = np.where(push * over > 0.0, push, 0.0)  # a stop never pulls
    return power + np.where(over != 0.0, (push - system.k_stop * over) * u_dot, 0.0)


def _into_stops(system: System, u: np.ndarray) -> np.ndarray:
    """(…, S) how far arms have turned into their bump (positive) or rebound stops; 0 without contact."""
    over = np.maximum(u - system.bump, 0.0) + np.minimum(u - system.rebound, 0.0)
    over[..., system.n :] = 0.0
    return over
