"""Rest pose on flat ground: the minimum of the potential energy over the free coordinates (model/MODEL.md, "Start").

At rest the ground only pushes upwards, so height y_0 of the chassis and the rotations of chassis and arms are enough.
Every body's height is y_0 + Σ_R sin θ_R E_x + cos θ_R E_y over the rotating bodies R between it and the chassis.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

import numpy as np

from model.dynamics.ground import depth, pressed
from model.dynamics.suspension import elastic
from model.dynamics.vehicle import System

FORCE_TOLERANCE = 1e-6  # N (or N m): what the rest pose must fulfil; rounding leaves up to half of it in heavy vehicles
GOOD_ENOUGH = 1e-8  # N (or N m): the search stops here
MAX_ITERATIONS = 200
MOST_LEAN = np.radians(75)  # of the hull at rest: leaning further it has turned over
NEAR_LEAN = np.radians(25)  # further, a pose that Newton's method finds at once may be beyond a nearer one
MOST_TURN = np.pi / 2  # of an arm in the hull: further, it has turned right over
LONGEST_STEP = 0.05  # m or rad: of the search that follows the energy downhill …
MOST_DESCENT = 600  # … in so many steps …
CLOSE = 1e-3  # N (or N m): … to where Newton's method takes over …
PAST_USE = 2.0  # rad: … or where the hull, or an arm in it, has turned so far
STARTS = ((0.0, 0.0), (0.1, 0.2), (0.1, -0.2))  # m that the vehicle is lifted and rad that it leans, as it begins
# Of a System: what does nothing at rest; and what does so in part
MOVING = {"c_s", "c_rebound", "belly", "prescribed", "x_0", "v_ref", "K_p", "K_i", "F_max", "alpha", "beta"}
MOVING |= {"ground", "stops"}
LEAST_DAMPING = 1e-10  # of the Hessian's diagonal: keeps a spring of no stiffness from dividing by zero


class NoEquilibriumError(ValueError):
    """The vehicle has no stable rest pose; the message says what was found and what to try."""


def rest_pose(system: System) -> tuple[np.ndarray, np.ndarray]:
    """Poses q (B, 3) and normal loads (W,), N, at rest on flat ground, chassis at x = 0.

    Raises NoEquilibriumError when the vehicle, let down from the design pose, finds no pose to stand in: it turns over,
    or an arm does.
    """
    q, load = _rest_pose(_Standing(system))
    return q.copy(), load.copy()


class _Standing:
    """A System, equal to others with the same rest pose: runs of a study often have the vehicle in common."""

    def __init__(self, system: System) -> None:
        self.system = system
        still = (value for name, value in zip(system._fields, system, strict=True) if name not in MOVING)
        key = (value.tobytes() if isinstance(value, np.ndarray) else value for value in still)
        self._key = (*key, system.ground.k_n, *system.stops[:3])

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Standing) and self._key == other._key

    def __hash__(self) -> int:
        return hash(self._key)


@lru_cache(maxsize=8)
def _rest_pose(standing: _Standing) -> tuple[np.ndarray, np.ndarray]:
    system = standing.system
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

    turning = np.arange(1, size)

    def terms(z: np.ndarray) -> tuple[float, np.ndarray, np.ndarray, np.ndarray]:
        sin, cos = np.sin(z[1:]), np.cos(z[1:])
        y = z[0] + E_x @ sin + E_y @ cos
        G = np.ones((B, size), order="F")
        G[:, 1:] = E_x * cos - E_y * sin
        bend = -(E_x * sin + E_y * cos)
        sink = np.where(touching, np.maximum(system.r - y, 0.0), 0.0)
        under = pressed(system.ground, sink)
        force = weight - under.force
        held = elastic(system, spring @ z)
        V = weight @ y + under.energy.sum() + held.energy.sum()
        gradient = force @ G + held.torque @ spring
        hessian = (G.T * under.stiffness) @ G + (spring.T * held.stiffness) @ spring
        hessian[turning, turning] += force @ bend
        return float(V), gradient, hessian, sink

    # A few millimetres into the ground, or no wheel would feel it
    z = np.zeros(size)
    z[0] = system.q_design[0, 1] - depth(system.ground, weight.sum() / len(system.wheel))
    found = _minimise(terms, z)
    if abs(found[0][1]) > NEAR_LEAN or not _stands(found):
        found = _let_down(terms, z, n)
    z, _, _, sink = found
    return _poses(E, z[0], np.bincount(rotating, z[1:], B)), pressed(system.ground, sink).force[system.wheel]


Terms = Callable[[np.ndarray], tuple[float, np.ndarray, np.ndarray, np.ndarray]]
Found = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]  # where, and the terms there but V


def _stands(found: Found) -> bool:
    """Whether the vehicle can stand in a pose: nothing is turned over, forces balance, and it is stable."""
    z, gradient, hessian, _ = found
    if abs(z[1]) > MOST_LEAN or np.abs(z[2:] - z[1]).max() > MOST_TURN:
        return False
    return bool(np.abs(gradient).max() <= FORCE_TOLERANCE and np.linalg.eigvalsh(hessian)[0] > 0.0)


def _let_down(terms: Terms, z: np.ndarray, n: int) -> Found:
    """Where the vehicle comes to rest when it is let down slowly from the pose z, or leaning a little; n: road arms.

    Newton's method can run past a minimum or end at a saddle; this follows the energy downhill in short steps.
    Raises NoEquilibriumError with what happens to the vehicle instead.
    """
    ways = []
    for lift, pitch in STARTS:
        start = z.copy()
        start[:2] += lift, pitch
        ways.append(_descend(terms, start))
        found = _minimise(terms, ways[-1])
        if _stands(found):
            return found
    raise NoEquilibriumError(_trouble(terms, ways[0], n))


def _trouble(terms: Terms, z: np.ndarray, n: int) -> str:
    """What happens to a vehicle that comes to z on its way down, where it cannot stand, and what to try."""
    hull, arms = z[1], z[2:] - z[1]
    if abs(hull) > MOST_LEAN:
        way = "backwards" if hull > 0 else "forwards"
        return (
            f"The vehicle has no stable rest pose on flat ground: it tips over {way}, as "
            "its springs right it less than its weight tips it. Stiffen the suspension, set the first and the last "
            "wheel further apart, or lower the centre of mass."
        )
    arm = int(np.abs(arms).argmax())
    if abs(arms[arm]) <= MOST_TURN:
        return (
            f"No rest pose found on flat ground: {np.abs(terms(z)[1]).max():.3g} N (or N m) stay unbalanced. "
            "Stiffen the suspension or the ground, or lower the preload of the imaginary wheels."
        )
    name, number = ("road", arm + 1) if arm < n else ("imaginary", arm - n + 1)
    return (
        f"The vehicle has no rest pose on flat ground: the arm of {name} wheel {number} turns right over, its wheel "
        f"{'upwards' if arms[arm] < 0 else 'downwards'}, as the springs hold it less than weight and preload turn it. "
        f"Stiffen the suspension (vehicle.{name}_suspension.stiffness), lower the preload of the imaginary wheels, or "
        "lower the masses."
    )


def _descend(terms: Terms, z: np.ndarray) -> np.ndarray:
    """Downhill in V in steps of at most LONGEST_STEP to where Newton's method can take over, or a pose past all use.

    Along each eigenvector of the Hessian the step is Newton's, with the sign of the slope: it leaves saddles.
    """
    V, gradient, hessian, _ = terms(z)
    longest = LONGEST_STEP
    for _ in range(MOST_DESCENT):
        curvature, ways = np.linalg.eigh(hessian)
        arrived = curvature[0] > 0.0 and np.abs(gradient).max() <= CLOSE
        if arrived or abs(z[1]) > PAST_USE or np.abs(z[2:] - z[1]).max() > PAST_USE:
            break
        least = LEAST_DAMPING * np.abs(curvature).max()
        slope = gradient @ ways
        if curvature[0] < 0.0 and np.abs(slope[0]) < CLOSE:  # on a saddle: either way is down
            slope[0] = CLOSE if slope[0] >= 0.0 else -CLOSE
        step = -ways @ (slope / np.maximum(np.abs(curvature), least))
        if curvature[0] < 0.0 or np.abs(step).max() > longest:
            step *= longest / np.abs(step).max()
        V_next, *rest = terms(z + step)
        if V_next < V:
            z, V, (gradient, hessian, _) = z + step, V_next, rest
            longest = min(2.0 * longest, LONGEST_STEP)
        else:
            longest = np.abs(step).max() / 4.0
            if longest < 1e-12:
                break
    return z


def _minimise(terms: Terms, z: np.ndarray) -> Found:
    """Newton's method with Levenberg damping: downhill in V until the gradient vanishes."""
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
