"""The vehicle's own motions: natural frequencies, damping and mode shapes, linearised at rest on flat ground.

Finite differences of the kernel, about the rest pose, with wheels that stick to the ground and the drive holding the
vehicle where it is. The state is reduced to what the joints leave free: the hull's x and y and all rotations, their
rates, ξ and ∫e. An eigenvalue with an imaginary part is a mode; a real one is a motion that creeps back (over-damped).
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from model.config.config import Config
from model.dynamics.equations import rotation_rate
from model.dynamics.equilibrium import rest_pose
from model.dynamics.kernel import rates
from model.dynamics.lanes import coordinates, in_lanes, make_work, pack
from model.dynamics.vehicle import System, build_system
from model.road.road import Road, build_road
from model.simulation.trajectory import RunStatistics, Trajectory, wheel_names

NUDGE = 1e-6  # m, rad, m/s, rad/s: step of the finite differences
NEUTRAL = 1e-3  # 1/s: smaller eigenvalues are zeros, of wheels that may stand turned anyhow
HULL_PART = 0.3  # of a mode's kinetic energy that heave or pitch of the hull must have to be called bounce or pitch
RATE = 100.0  # samples a second of a mode that is played

BOUNCE, PITCH, SURGE = "Bounce", "Pitch", "Fore and aft"  # of the hull
HOP, SPIN = "Hop of", "Spin of"  # a wheel with its arm up and down, or turning on the elastic ground


@dataclass(frozen=True)
class Mode:
    """A free oscillation: the rest pose + Re(amplitude · shape · exp(eigenvalue · t))."""

    name: str  # of what moves most: Bounce, Pitch, Fore and aft, Hop of R1…, Spin of I1…
    eigenvalue: complex  # 1/s, the one with a positive imaginary part
    shares: tuple[tuple[str, float], ...]  # parts of its kinetic energy by name, the largest first
    shape: np.ndarray = field(compare=False, repr=False)  # (B, 3) complex: x, y, θ of each body; the joint (along x or
    # y) or wheel's rim that moves furthest moves by 1 m, and is there at t = 0

    @property
    def frequency(self) -> float:
        """Hz, undamped: |eigenvalue| / 2π."""
        return abs(self.eigenvalue) / (2 * np.pi)

    @property
    def damping_ratio(self) -> float:
        """Part of the critical damping, below 1."""
        return -self.eigenvalue.real / abs(self.eigenvalue)


@dataclass(frozen=True)
class Creep:
    """An over-damped motion: it dies away without swinging."""

    name: str  # of what moves most, as of a mode
    decay: float  # 1/s, positive


@dataclass(frozen=True)
class Modes:
    """All free motions of a vehicle at rest, the slowest first."""

    swinging: tuple[Mode, ...]
    creeping: tuple[Creep, ...]
    fastest_decay: float  # 1/s, the most negative real part of all: what an explicit integrator must follow

    @property
    def bounce(self) -> Mode | None:
        """The hull's up and down; None where it is damped so much that it does not swing."""
        return next((mode for mode in self.swinging if mode.name == BOUNCE), None)

    @property
    def pitch(self) -> Mode | None:
        """The hull's nodding, likewise."""
        return next((mode for mode in self.swinging if mode.name == PITCH), None)


def vehicle_modes(config: Config) -> Modes:
    """The free motions of a configuration's vehicle at rest. Raises NoEquilibriumError."""
    system = build_system(config)._replace(v_ref=0.0)
    q, _ = rest_pose(system)
    eigenvalues, motions = _eigen(system, q, build_road(config.replace({"road.type": "flat"})))
    moving = np.abs(eigenvalues) > NEUTRAL
    order = np.argsort(np.where(moving, np.abs(eigenvalues), np.inf))[: moving.sum()]
    eigenvalues, motions = eigenvalues[order], motions[order]
    names, parts = _energy_parts(system, motions)
    titles = [names[k] for k in parts.argmax(axis=1)]
    for k, title in _hull_titles(names, parts, eigenvalues.imag > 0).items():
        titles[k] = title
    swinging, creeping = [], []
    for k, eigenvalue in enumerate(eigenvalues):
        if eigenvalue.imag > 0:
            shares = tuple((names[i], float(parts[k, i])) for i in np.argsort(-parts[k]))
            swinging.append(Mode(titles[k], complex(eigenvalue), shares, _scaled(system, q, motions[k])))
        elif eigenvalue.imag == 0:
            creeping.append(Creep(titles[k], float(-eigenvalue.real)))
    return Modes(tuple(swinging), tuple(creeping), float(eigenvalues.real.min()))


def mode_trajectory(config: Config, mode: Mode, amplitude: float, period: float = 1.0, x: float = 0.0) -> Trajectory:
    """One swing of a mode as a run on flat ground, without its decay: to be looked at, again and again.

    config: the one the mode is of; amplitude: largest excursion, m; period: what the swing takes here, s, however
    quick it really is; x: where the hull's centre of mass is at rest, m. Angles and the hull's centre of mass follow
    the mode, the joints hold; v and a are of first order, the loads stay those at rest.
    """
    flat = config.replace({"road.type": "flat", "simulation.output_rate": RATE})
    system = build_system(flat)
    rest, static_load = rest_pose(system)
    t = np.arange(int(np.ceil(period * RATE)) + 1) / RATE
    turning = 2j * np.pi / period
    swing = amplitude * np.exp(turning * t)[:, None, None] * mode.shape
    q = rest + swing.real
    q[..., 0] += x
    _close_joints(system, q)
    still, each = np.zeros(len(t)), (len(t), 1)
    return Trajectory(
        t=t,
        q=q,
        v=(turning * swing).real,
        a=(turning**2 * swing).real,
        normal_load=np.tile(static_load, each),
        traction=np.zeros((len(t), len(static_load))),
        tangential_displacement=np.zeros((len(t), len(static_load))),
        drive_force=still,
        multipliers=np.zeros((len(t), 2 * len(system.joint_i) + system.prescribed)),
        constraint_residual=still,
        static_load=static_load,
        config=flat,
        status="complete",
        advice="",
        statistics=RunStatistics(steps=0, rejected_steps=0, evaluations=0, smallest_step=0.0, seconds=0.0),
    )


def _eigen(system: System, q: np.ndarray, road: Road) -> tuple[np.ndarray, np.ndarray]:
    """Eigenvalues (K,), 1/s, about the rest pose q, and how all bodies move then (K, B, 3), complex."""
    bodies, wheels = len(system.mass), len(system.wheel)
    free, motion = _free_motions(system, q)
    free_rates = np.concatenate([free, 3 * bodies + free, np.arange(6 * bodies, 6 * bodies + wheels + 1)])
    basis = np.zeros((6 * bodies + wheels + 1, len(free_rates)))
    D = len(free)
    basis[: 3 * bodies, :D] = basis[3 * bodies : 6 * bodies, D : 2 * D] = motion
    basis[6 * bodies :, 2 * D :] = np.eye(wheels + 1)
    rest = pack(system, q, np.zeros_like(q), np.zeros(wheels), 0.0)
    lanes, work, table, place = in_lanes(system), make_work(system), road.table, coordinates(system)

    def rate(nudge: np.ndarray) -> np.ndarray:
        state, change = rest.copy(), np.empty_like(rest)
        state[place] += nudge
        rates(lanes, table, 0.0, state, change, work)
        return change[place][free_rates]

    columns = [(rate(NUDGE * nudge) - rate(-NUDGE * nudge)) / (2 * NUDGE) for nudge in basis.T]
    eigenvalues, vectors = np.linalg.eig(np.column_stack(columns))
    return eigenvalues, (motion @ vectors[:D]).T.reshape(-1, 3, bodies).swapaxes(1, 2)


def _free_motions(system: System, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The D coordinates that may move by themselves (D,), and how all of them then move (3 B, D): all x, y, θ."""
    bodies = len(q)
    x, y, theta = np.split(np.arange(3 * bodies), 3)
    motion = np.eye(3 * bodies)
    for i, j, u_i, u_j in zip(system.joint_i, system.joint_j, system.u_i, system.u_j, strict=True):
        lever_i, lever_j = rotation_rate(q[i, 2]) @ u_i, rotation_rate(q[j, 2]) @ u_j  # eq. (10), differentiated
        for axis, k in ((x, 0), (y, 1)):
            motion[axis[j]] = motion[axis[i]] + lever_i[k] * motion[theta[i]] - lever_j[k] * motion[theta[j]]
    hull = [y[system.chassis]] if system.prescribed else [x[system.chassis], y[system.chassis]]
    free = np.concatenate([hull, theta])
    return free, motion[:, free]


def _energy_parts(system: System, motions: np.ndarray) -> tuple[list[str], np.ndarray]:
    """What can move, by name, and its part in the kinetic energy of motions (K, B, 3): (K, names)."""
    inertia = np.column_stack([system.mass, system.mass, system.inertia])
    energy = inertia * np.abs(motions) ** 2
    energy /= np.maximum(energy.sum(axis=(1, 2), keepdims=True), np.finfo(float).tiny)
    wheels = wheel_names(system)
    hop = energy[:, system.wheel, :2].sum(axis=2) + energy[:, system.spring_j].sum(axis=2)
    names = [SURGE, BOUNCE, PITCH, *(f"{HOP} {name}" for name in wheels), *(f"{SPIN} {name}" for name in wheels)]
    return names, np.hstack([energy[:, system.chassis], hop, energy[:, system.wheel, 2]])


def _hull_titles(names: list[str], parts: np.ndarray, swings: np.ndarray) -> dict[int, str]:
    """Which of the swinging motions are bounce and pitch, and what the others are when not taken for one of these."""
    heave, pitch = parts[:, names.index(BOUNCE)], parts[:, names.index(PITCH)]
    hull = np.flatnonzero(swings & (heave + pitch > HULL_PART))
    hull = hull[np.argsort(-(heave + pitch)[hull])][:2]
    hull = hull[np.argsort((pitch - heave)[hull])]  # where they mix, the one with more heave is bounce
    rest = [k for k, name in enumerate(names) if name not in (BOUNCE, PITCH)]
    titles = {int(k): names[rest[parts[k, rest].argmax()]] for k in np.flatnonzero(swings)}
    return titles | dict(zip(hull.tolist(), (BOUNCE, PITCH), strict=False))


def _scaled(system: System, q: np.ndarray, motion: np.ndarray) -> np.ndarray:
    """A motion (B, 3) so that the largest excursion of all joints and rims is 1."""
    levers = np.array([rotation_rate(q[i, 2]) @ u for i, u in zip(system.joint_i, system.u_i, strict=True)])
    joints = motion[system.joint_i, :2] + motion[system.joint_i, 2:] * levers
    excursions = np.concatenate([joints.ravel(), system.r * motion[system.wheel, 2]])
    return motion / excursions[np.abs(excursions).argmax()]


def _close_joints(system: System, q: np.ndarray) -> None:
    """Move bodies (N, B, 3) to where the joints hold them, with the hull and all angles as they are."""
    point, turn = q[..., 0] + 1j * q[..., 1], np.exp(1j * q[..., 2])
    u_i, u_j = system.u_i @ [1, 1j], system.u_j @ [1, 1j]
    for k, (i, j) in enumerate(zip(system.joint_i, system.joint_j, strict=True)):
        point[:, j] = point[:, i] + turn[:, i] * u_i[k] - turn[:, j] * u_j[k]
    q[..., 0], q[..., 1] = point.real, point.imag
