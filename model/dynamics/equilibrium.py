"""Rest pose on flat ground: the minimum of the potential energy over the free coordinates (model/MODEL.md, "Start").

At rest the ground only pushes upwards, so height y_0 of the chassis and the rotations of chassis and arms are enough.
Every body's height is y_0 + Σ_R sin θ_R E_x + cos θ_R E_y over the rotating bodies R between it and the chassis.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from model.dynamics.ground import depth, pressed
from model.dynamics.suspension import elastic
from model.dynamics.vehicle import System

FORCE_TOLERANCE = 1e-6  # N (or N m): what the rest pose must fulfil; rounding leaves up to half of it in heavy vehicles
GOOD_ENOUGH = 1e-8  # N (or N m): the search stops here
MAX_ITERATIONS = 200
LEAST_DAMPING = 1e-10  # of the Hessian's diagonal: keeps a spring of no stiffness from dividing by zero


class NoEquilibriumError(ValueError):
    """The vehicle has no stable rest pose; the message says what was found and what to try."""


def rest_pose(system: System) -> tuple[np.ndarray, np.ndarray]:
    """Poses q (B, 3) and normal loads (W,), N, at rest on flat ground, chassis at x = 0.

    Raises NoEquilibriumError when the springs cannot carry the vehicle in any pose near the design pose.
    """
    n, m, B = system.n, system.m, len(system.mass)
    rotating = np.concatenate([[0], np.arange(1, 1 + n), np.arange(1 + 2 * n, 1 + 2 * n + m)])
    E = _levers(system)
    E_x, E_y = E[:, rotating, 0], E[:, rotating, 1]
    size = 1 + len(rotating)
    column = np.zeros(B, dtype=int)
    column[rotating] = 1 + np.arange(len(rotating))

    spring = np.zeros((len(system.k_s), size))  # θ_i − θ_j
    spring[np.arange(len(spring)), column[system.spring_i]] += 1.0
    spring[np.arange(len(spring)), column[system.spring_j]] -= 1.0
    weight = system.weight
    touching = np.zeros(B, dtype=bool)
    touching[system.wheel] = True

    def terms(z: np.ndarray) -> tuple[float, np.ndarray, np.ndarray, np.ndarray]:
        sin, cos = np.sin(z[1:]), np.cos(z[1:])
        y = z[0] + E_x @ sin + E_y @ cos
        G = np.column_stack([np.ones(B), E_x * cos - E_y * sin])
        bend = -(E_x * sin + E_y * cos)
        sink = np.where(touching, np.maximum(system.r - y, 0.0), 0.0)
        under = pressed(system.ground, sink)
        force = weight - under.force
        held = elastic(system, spring @ z)
        V = weight @ y + under.energy.sum() + held.energy.sum()
        gradient = force @ G + held.torque @ spring
        hessian = (G.T * under.stiffness) @ G + (spring.T * held.stiffness) @ spring
        hessian[1:, 1:] += np.diag(force @ bend)
        return float(V), gradient, hessian, sink

    # A few millimetres into the ground, or no wheel would feel it
    z = np.zeros(size)
    z[0] = system.q_design[0, 1] - depth(system.ground, weight.sum() / len(system.wheel))
    z, gradient, hessian, sink = _minimise(terms, z)
    worst = np.abs(gradient).max()
    if np.linalg.eigvalsh(hessian)[0] <= 0.0:
        raise NoEquilibriumError(
            "The rest pose on flat ground is unstable: the vehicle would tip or its arms fold. "
            "Stiffen the suspension, move the wheels under the centre of mass, or lower the preload."
        )
    if not worst <= FORCE_TOLERANCE:
        raise NoEquilibriumError(
            f"No rest pose found on flat ground: {worst:.3g} N (or N m) stay unbalanced. "
            "Stiffen the suspension or the ground, or lower the preload of the imaginary wheels."
        )
    if np.abs(z[1:]).max() > np.pi / 2:
        raise NoEquilibriumError(
            "At rest the hull or an arm would have turned right over: the suspension cannot carry "
            "the vehicle near its design pose. Stiffen the suspension or lower the preload of the imaginary wheels."
        )
    return _poses(E, z[0], np.bincount(rotating, z[1:], B)), pressed(system.ground, sink).force[system.wheel]


Terms = Callable[[np.ndarray], tuple[float, np.ndarray, np.ndarray, np.ndarray]]


def _minimise(terms: Terms, z: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Newton's method with Levenberg damping: downhill in V until the gradient vanishes. Where, and the terms there."""
    V, gradient, hessian, sink = terms(z)
    damping = LEAST_DAMPING
    for _ in range(MAX_ITERATIONS):
        if np.abs(gradient).max() <= GOOD_ENOUGH:
            break
        step = -np.linalg.solve(hessian + damping * np.diag(np.abs(np.diag(hessian)) + 1.0), gradient)
        if not np.abs(step).max() < 0.3:  # rad or m
            step *= 0.3 / np.abs(step).max()
        V_next, *rest = terms(z + step)
        falls = V_next < V or np.abs(rest[0]).max() < np.abs(gradient).max()
        if falls and gradient @ step < 0.0:
            z, V, (gradient, hessian, sink) = z + step, V_next, rest
            damping = max(damping / 10.0, LEAST_DAMPING)
        else:
            damping = max(10.0 * damping, 1e-4)
            if damping > 1e12:
                break
    return z, gradient, hessian, sink


def _levers(system: System) -> np.ndarray:
    """E (B, B, 2): body b's centre is y_0 + Σ_R A(θ_R) E[b, R], m."""
    B = len(system.mass)
    E = np.zeros((B, B, 2))
    for i, j, u_i, u_j in zip(system.joint_i, system.joint_j, system.u_i, system.u_j, strict=True):
        E[j] = E[i]
        E[j, i] += u_i
        E[j, j] -= u_j
    return E


def _poses(E: np.ndarray, y_0: float, theta: np.ndarray) -> np.ndarray:
    """q (B, 3) from the levers, the chassis's height and all rotations (B,), chassis at x = 0."""
    sin, cos = np.sin(theta), np.cos(theta)
    x = E[..., 0] @ cos - E[..., 1] @ sin
    y = y_0 + E[..., 0] @ sin + E[..., 1] @ cos
    return np.column_stack([x, y, theta])
