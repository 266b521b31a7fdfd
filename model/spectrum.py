"""Where the hull is shaken and where it likes to swing: spectra, and the modes of the vehicle at rest."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from model.config import Config, SineRoad
from model.equations import rotation_rate
from model.equilibrium import rest_pose
from model.kernel import make_work, pack, rates
from model.road import RAMP_AHEAD, Road, build_road
from model.trajectory import Trajectory
from model.vehicle import System, build_system

PADDING = 8  # points of the spectrum for each one that the signal's length resolves: a peak shows its full height
SETTLING = 2.0  # s after the last wheel has come to the full waves, in which the start dies away
NUDGE = 1e-6  # m, rad, m/s, rad/s: step of the finite differences
HULL_PART = 0.3  # of a mode's kinetic energy that heave or pitch of the hull must have to be called bounce or pitch


@dataclass(frozen=True)
class Mode:
    """A free oscillation of the vehicle at rest."""

    frequency: float  # Hz, undamped: |eigenvalue| / 2π
    damping_ratio: float  # part of the critical damping, below 1


@dataclass(frozen=True)
class Marks:
    """The frequencies to know when reading a spectrum."""

    excitation: float | None  # Hz, v/λ: waves met in a second; None where the road has no waves
    bounce: Mode | None  # up and down; None where it is damped so much that it does not swing
    pitch: Mode | None
    fastest_decay: float  # 1/s, the most negative real part of all eigenvalues: what an explicit integrator must follow


def acceleration_spectrum(trajectory: Trajectory) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies, Hz, and amplitudes, m/s², of the hull's vertical acceleration over the steady part of a run."""
    steady = trajectory.t >= steady_from(trajectory)
    signal = trajectory.a[steady, trajectory.system.chassis, 1]
    return amplitude_spectrum(signal, trajectory.config.simulation.output_rate)


def steady_from(trajectory: Trajectory) -> float:
    """When the last road wheel is on the full waves and the start has died away, s; at most half the run.

    0 on a road without waves, where all there is to see is what the start or an obstacle leaves behind.
    """
    config, system = trajectory.config, trajectory.system
    road = config.road
    if not isinstance(road, SineRoad):
        return 0.0
    x = config.vehicle.road_wheels.x
    start = x[0] + RAMP_AHEAD if road.start is None else road.start
    ramp = road.wavelength if road.ramp is None else road.ramp
    arrival = (start + ramp - x[-1]) / system.v_ref + SETTLING
    return float(min(arrival, trajectory.t[-1] / 2))


def amplitude_spectrum(signal: np.ndarray, rate: float) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies, Hz, and amplitudes of a signal (N,) with `rate` samples a second, its mean taken away.

    A sine of amplitude a shows a peak as high as a: Hann window, scaled by its mean, with finely spaced frequencies.
    Two peaks less than 2/T apart (T: how long the signal lasts) run into one.
    """
    count = len(signal)
    window = np.hanning(count + 1)[:-1] if count > 1 else np.ones(count)
    length = 2 ** int(np.ceil(np.log2(PADDING * max(count, 1))))
    spectrum = np.abs(np.fft.rfft((signal - np.average(signal, weights=window)) * window, length))
    return np.fft.rfftfreq(length, 1 / rate), 2 * spectrum / window.sum()


def marks(config: Config) -> Marks:
    """Excitation and natural frequencies of a configuration. Raises NoEquilibriumError."""
    system = build_system(config)._replace(v_ref=0.0)
    eigenvalues, heave, pitch = _modes(system, build_road(config.replace({"road.type": "flat"})))
    swings = (eigenvalues.imag > 0) & (heave + pitch > HULL_PART)
    hull = np.flatnonzero(swings)[np.argsort(-(heave + pitch)[swings])][:2]
    bounce = hull[np.argmax((heave - pitch)[hull])] if len(hull) else None
    rest = hull[hull != bounce]
    return Marks(
        excitation=_excitation(config),
        bounce=_mode(eigenvalues, bounce),
        pitch=_mode(eigenvalues, rest[0] if len(rest) else None),
        fastest_decay=float(eigenvalues.real.min()),
    )


def _excitation(config: Config) -> float | None:
    road = config.road
    if not isinstance(road, SineRoad) or road.amplitude == 0:
        return None
    return config.drive.speed_kmh / 3.6 / road.wavelength


def _mode(eigenvalues: np.ndarray, index: int | None) -> Mode | None:
    if index is None:
        return None
    size = abs(eigenvalues[index])
    return Mode(float(size / (2 * np.pi)), float(-eigenvalues[index].real / size))


def _modes(system: System, road: Road) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Eigenvalues (K,), 1/s, about the rest pose, and the parts of heave and pitch of the hull in kinetic energy (K,).

    The state is reduced to what the joints leave free: z, ż (the hull's x and y, all rotations), ξ and ∫e.
    """
    q, _ = rest_pose(system)
    bodies, wheels = len(system.mass), len(system.wheel)
    free, motion = _free_motions(system, q)
    free_rates = np.concatenate([free, 3 * bodies + free, np.arange(6 * bodies, 6 * bodies + wheels + 1)])
    basis = np.zeros((6 * bodies + wheels + 1, len(free_rates)))
    D = len(free)
    basis[: 3 * bodies, :D] = basis[3 * bodies : 6 * bodies, D : 2 * D] = motion
    basis[6 * bodies :, 2 * D :] = np.eye(wheels + 1)
    rest = pack(q, np.zeros_like(q), np.zeros(wheels), 0.0)
    work, table = make_work(system), road.table

    def rate(state: np.ndarray) -> np.ndarray:
        change = np.empty_like(state)
        rates(system, table, 0.0, state, change, work)
        return change[free_rates]

    columns = [(rate(rest + NUDGE * nudge) - rate(rest - NUDGE * nudge)) / (2 * NUDGE) for nudge in basis.T]
    eigenvalues, vectors = np.linalg.eig(np.column_stack(columns))
    energy = np.concatenate([system.mass, system.mass, system.inertia])[:, None] * np.abs(motion @ vectors[:D]) ** 2
    parts = energy / np.maximum(energy.sum(axis=0), np.finfo(float).tiny)
    return eigenvalues, parts[bodies + system.chassis], parts[2 * bodies + system.chassis]


def _free_motions(system: System, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The D coordinates that may move by themselves (D,), and how all of them then move (3 B, D), in the flat state."""
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
