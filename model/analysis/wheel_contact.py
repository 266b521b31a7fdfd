"""Where wheels meet the road: what the card of a wheel shows, and how deep and how fast wheels move there."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from model.dynamics.vehicle import System
from model.road.road import Road
from model.simulation.trajectory import Trajectory, wheel_names


@dataclass(frozen=True)
class WheelState:
    """One wheel at one time: what its card shows. None where the word does not apply."""

    name: str
    time: float  # s
    normal_load: float  # N
    static_load: float  # N, at rest on flat ground
    load_share: float | None  # of all wheels' load, 0…1; None with all wheels in the air
    traction: float  # N, along the road, forward
    penetration: float | None  # m; None in the air
    slip_velocity: float | None  # m/s, ṗ of the rim over the ground, forward; None in the air
    arm_angle: float  # °, of its arm in the hull, from the design pose; counter-clockwise
    torque_share: float | None  # of the driving torque, 0…1; None where no torque drives (prescribed, all in the air)
    drive_torque: float | None  # N m, of the drive on this wheel, positive drives forward


class ContactMotion(NamedTuple):
    """Where wheels meet the road and how they move there; leading dimensions as given."""

    normal: np.ndarray  # (..., W, 2) n, unit vector from the ground to the wheel's centre; upright in the air
    depth: np.ndarray  # (..., W) z, m; negative, and −∞ high up, in the air
    sinking: np.ndarray  # (..., W) ż, m/s
    slip: np.ndarray  # (..., W) ṗ of the rim along the road, m/s


def wheel_state(trajectory: Trajectory, wheel: int, time: float, road: Road | None = None) -> WheelState:
    """A wheel, counted from 0 with road wheels first, at a time, s; between samples in proportion.

    A time outside the run gives its start or its end. road: where it is at hand, or another than the run's own.
    """
    system = trajectory.system
    t = trajectory.t
    before = min(max(int(np.searchsorted(t, time, side="right")) - 1, 0), len(t) - 1)
    after = min(before + 1, len(t) - 1)
    part = np.clip((time - t[before]) / (t[after] - t[before]), 0, 1) if after > before else 0.0

    def at_time(samples: np.ndarray) -> np.ndarray:
        return (1 - part) * samples[before] + part * samples[after]

    q, load = at_time(trajectory.q), at_time(trajectory.normal_load)
    touch = contact_motion(system, road or trajectory.road, q, at_time(trajectory.v))
    touching = touch.depth[wheel] > 0
    total = float(load.sum())
    share = float(load[wheel]) / total if total > 0 else None
    torque_share = None if system.prescribed else share
    force = float(at_time(trajectory.drive_force))
    return WheelState(
        name=wheel_names(system)[wheel],
        time=float(np.clip(time, t[0], t[-1])),
        normal_load=float(load[wheel]),
        static_load=float(trajectory.static_load[wheel]),
        load_share=share,
        traction=float(at_time(trajectory.traction)[wheel]),
        penetration=float(touch.depth[wheel]) if touching else None,
        slip_velocity=float(touch.slip[wheel]) if touching else None,
        arm_angle=float(np.degrees(q[system.spring_j[wheel], 2] - q[system.chassis, 2])),
        torque_share=torque_share,
        drive_torque=None if torque_share is None else torque_share * system.r * force,
    )


def contact_motion(system: System, road: Road, q: np.ndarray, v: np.ndarray) -> ContactMotion:
    """Contact of all wheels in poses q and velocities v (..., B, 3)."""
    centres, velocity = q[..., system.wheel, :2], v[..., system.wheel, :]
    _, normal, distance = road.nearest(centres.reshape(-1, 2))
    normal, distance = normal.reshape(centres.shape), distance.reshape(centres.shape[:-1])
    n_x, n_y = normal[..., 0], normal[..., 1]
    return ContactMotion(
        normal=normal,
        depth=system.r - distance,
        sinking=-(velocity[..., 0] * n_x + velocity[..., 1] * n_y),
        slip=velocity[..., 0] * n_y - velocity[..., 1] * n_x + system.r * velocity[..., 2],
    )


def penetration(trajectory: Trajectory, road: Road | None = None) -> np.ndarray:
    """(N, W) m: how deep each wheel is in the ground; negative, and −∞ high up, in the air.

    road: another than the run's own.
    """
    return contact_motion(trajectory.system, road or trajectory.road, trajectory.q, trajectory.v).depth
