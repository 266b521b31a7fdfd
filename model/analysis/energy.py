"""What a run's samples say about its own correctness: balance of energy, and of vertical forces. Pure functions."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from model.analysis.wheel_contact import contact_motion
from model.dynamics.ground import losses, pressed, shear_energy
from model.dynamics.suspension import dissipated_power, elastic
from model.simulation.trajectory import Trajectory


@dataclass(frozen=True)
class EnergyBalance:
    """Where the energy of a run is and goes, N samples. Energies in J, powers in W."""

    t: np.ndarray  # (N,) s
    kinetic: np.ndarray  # (N,) of all bodies, spinning included
    gravity: np.ndarray  # (N,) m g y
    springs: np.ndarray  # (N,) of the torsion bars, preloads included
    ground: np.ndarray  # (N,) in the ground pressed in and sheared by the wheels
    drive_power: np.ndarray  # (N,) what the drive puts in
    suspension_power: np.ndarray  # (N,) what the dampers of both suspensions take out; ≥ 0
    ground_power: np.ndarray  # (N,) what the ground's damping takes out; ≥ 0
    friction_power: np.ndarray  # (N,) what slipping takes out; ≥ 0
    residual: np.ndarray  # (N,) J: energy that is there at t beyond what was at t = 0 and came and went since
    turned_over: float  # J: the motion at the start, + what the drive moved in or out, + what was dissipated, + every
    # rise and fall of gravity's and the springs' energy

    @property
    def stored(self) -> np.ndarray:
        """(N,) J, all of it."""
        return self.kinetic + self.gravity + self.springs + self.ground

    @property
    def dissipated_power(self) -> np.ndarray:
        """(N,) W, all that is taken out."""
        return self.suspension_power + self.ground_power + self.friction_power

    @property
    def closing_error(self) -> float:
        """Largest |residual|, % of the energy turned over; NaN where none is."""
        return 100 * float(np.abs(self.residual).max()) / self.turned_over if self.turned_over > 0 else np.nan


@dataclass(frozen=True)
class LoadBalance:
    """Both sides of the vertical momentum balance of the whole vehicle, N."""

    contact_force: np.ndarray  # (N,) Σ vertical force of the ground on all wheels, tractions included
    weight_and_inertia: np.ndarray  # (N,) Σ m (g + a_y) over all bodies

    @property
    def residual(self) -> np.ndarray:
        """(N,) N; rounding alone, in a run that obeys Newton's law."""
        return self.contact_force - self.weight_and_inertia


def energy_balance(trajectory: Trajectory) -> EnergyBalance:
    """The energies and powers of a run, and how well they add up.

    The closing error tells how far the motion breaks the laws it was computed from. Powers are known at the samples
    only and integrated between them by the trapezoidal rule, so that at 200 samples a second it tells less where
    loads jump: the paper's run (smooth) closes to 0.004 %, most of which are the integrator's tolerances; a half-round
    obstacle, at whose foot the contact point jumps, to 0.12 %, which falls to 0.009 % at 2000 samples a second.
    """
    system, q, v = trajectory.system, trajectory.q, trajectory.v
    touch = contact_motion(system, trajectory.road, q, v)
    xi = trajectory.tangential_displacement

    turn = q[:, system.spring_i, 2] - q[:, system.spring_j, 2]
    turn_rate = v[:, system.spring_i, 2] - v[:, system.spring_j, 2]
    inertia = np.column_stack([system.mass, system.mass, system.inertia])
    kinetic = (inertia * v**2).sum(axis=(1, 2)) / 2
    gravity = q[:, :, 1] @ system.weight
    springs = elastic(system, turn).energy.sum(axis=1)
    ground = (pressed(system.ground, touch.depth).energy + shear_energy(system.ground, xi)).sum(axis=1)

    drive_power = _drive_power(trajectory)
    suspension_power = dissipated_power(system, turn, turn_rate).sum(axis=1)
    load, traction = trajectory.normal_load, trajectory.traction
    lost = losses(system.ground, touch.depth, touch.sinking, touch.slip, xi, load, traction)
    ground_power, friction_power = lost.damping.sum(axis=1), lost.friction.sum(axis=1)

    dissipated = suspension_power + ground_power + friction_power
    stored = kinetic + gravity + springs + ground
    residual = stored - stored[0] - _integral(trajectory.t, drive_power - dissipated)
    turned_over = kinetic[0] + _integral(trajectory.t, np.abs(drive_power) + dissipated)[-1]
    turned_over += np.abs(np.diff(gravity)).sum() + np.abs(np.diff(springs)).sum()
    return EnergyBalance(
        t=trajectory.t,
        kinetic=kinetic,
        gravity=gravity,
        springs=springs,
        ground=ground,
        drive_power=drive_power,
        suspension_power=suspension_power,
        ground_power=ground_power,
        friction_power=friction_power,
        residual=residual,
        turned_over=float(turned_over),
    )


def load_balance(trajectory: Trajectory) -> LoadBalance:
    """Σ vertical contact force of a run beside the vehicle's weight and inertia."""
    system = trajectory.system
    normal = contact_motion(system, trajectory.road, trajectory.q, trajectory.v).normal
    force = trajectory.normal_load * normal[..., 1] - trajectory.traction * normal[..., 0]
    return LoadBalance(force.sum(axis=1), trajectory.a[:, :, 1] @ system.mass + system.weight.sum())


def _drive_power(trajectory: Trajectory) -> np.ndarray:
    """(N,) W: of the torques on wheels and hull, or of the force that pulls the hull (prescribed)."""
    system, v, force = trajectory.system, trajectory.v, trajectory.drive_force
    if system.prescribed:
        return force * v[:, system.chassis, 0]
    total = trajectory.normal_load.sum(axis=1)
    share = trajectory.normal_load / np.where(total > 0, total, 1.0)[:, None]
    over_hull = v[:, [system.chassis], 2] - v[:, system.wheel, 2]  # how fast wheels roll forward in the hull
    return system.r * force * (share * over_hull).sum(axis=1)


def _integral(t: np.ndarray, power: np.ndarray) -> np.ndarray:
    """(N,) ∫ power dt from the start to each sample."""
    return np.concatenate([[0.0], np.cumsum(np.diff(t) * (power[1:] + power[:-1]) / 2)])
