"""Config -> System: the multibody system as frozen arrays.

As model/MODEL.md says in "Frames and bodies", "Design pose" and "Suspension torques".

Frame: x forward, y up, angles counter-clockwise; SI units and radians throughout.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from model.config.config import Config
from model.dynamics.ground import Ground

GRAVITY = 9.81  # m/s², along −y
# Of the wheels' radius, for a hull's floor that is not given: how far it is under the arms' pivots, its least and its
# greatest height above the ground
UNDER_PIVOT, LOWEST_BELLY, HIGHEST_BELLY = 0.15625, 0.9375, 1.875


class Stops(NamedTuple):
    """Where a road arm is stopped, as θ_i − θ_j, and how hard."""

    bump: float  # rad; infinite without a stop
    rebound: float  # rad, negative
    k: float  # N m/rad, of both
    c: float  # N m s/rad


class System(NamedTuple):
    """One vehicle, ready to be computed with. Arrays are read-only; nothing changes them later.

    B bodies, J joints, S springs, W wheels. Body order: chassis; road arms 1…n; road wheels 1…n; imaginary arms
    1…m; imaginary wheels 1…m (m = n − 1, or 0 without imaginary wheels). Wheels: road 1…n, then imaginary 1…m.
    """

    n: int  # road wheels
    m: int  # imaginary wheels
    mass: np.ndarray  # (B,) kg
    inertia: np.ndarray  # (B,) kg m², about the centre of mass
    q_design: np.ndarray  # (B, 3) x, y, θ of each centre of mass in the design pose
    joint_i: np.ndarray  # (J,) first body of each revolute joint, eq. 10
    joint_j: np.ndarray  # (J,) second body
    u_i: np.ndarray  # (J, 2) joint in the first body's frame, from its centre of mass, m
    u_j: np.ndarray  # (J, 2) the same in the second body's frame
    spring_i: np.ndarray  # (S,) body that takes −τ: chassis, or the road arm under an imaginary arm
    spring_j: np.ndarray  # (S,) arm that takes +τ; road arms 1…n, then imaginary arms 1…m
    k_s: np.ndarray  # (S,) torsional stiffness, N m/rad (k_sl for imaginary arms)
    c_s: np.ndarray  # (S,) torsional damping, N m s/rad
    linear: bool  # the paper's springs: progression, rebound damping and stops change nothing
    p: np.ndarray  # (S,) progression, 1/rad²
    c_rebound: np.ndarray  # (S,) torsional damping while θ_i − θ_j falls (the wheel moves down in the hull), N m s/rad
    stops: Stops  # of the road arms
    tau_0: np.ndarray  # (S,) preload torque, N m
    wheel: np.ndarray  # (W,) body of each wheel
    r: float  # wheel radius, m
    belly: float  # height of the hull's floor in the design pose, m; no force acts on it
    ground: Ground
    prescribed: bool  # drive by the rheonomic constraint instead of torques
    x_0: float  # m, where the prescribed drive is at t = 0
    v_ref: float  # m/s
    K_p: float  # N s/m
    K_i: float  # N/m
    F_max: float  # N
    alpha: float  # Baumgarte, 1/s
    beta: float  # 1/s
    weight: np.ndarray  # (B,) N, along −y

    @property
    def chassis(self) -> int:
        return 0

    @property
    def road_arms(self) -> slice:
        return slice(1, 1 + self.n)

    @property
    def road_wheels(self) -> slice:
        return slice(1 + self.n, 1 + 2 * self.n)

    @property
    def imaginary_arms(self) -> slice:
        return slice(1 + 2 * self.n, 1 + 2 * self.n + self.m)

    @property
    def imaginary_wheels(self) -> slice:
        return slice(1 + 2 * self.n + self.m, 1 + 2 * (self.n + self.m))


def kinetic_energy(system: System, v: np.ndarray) -> np.ndarray:
    """J (...,) of all bodies with velocities v (..., B, 3), spinning included."""
    inertia = np.column_stack([system.mass, system.mass, system.inertia]).ravel()
    return (v**2).reshape(*v.shape[:-2], -1) @ (inertia / 2)  # one product: many times as fast as a sum over both axes


def build_system(config: Config) -> System:
    """The System that a configuration describes, with the preloads that hold the design pose at rest."""
    vehicle = config.vehicle
    x = np.array(vehicle.road_wheels.x)
    n = len(x)
    m = n - 1 if vehicle.imaginary_wheels.enabled else 0
    r = vehicle.road_wheels.radius
    L = vehicle.road_arms.length
    phi = np.radians(vehicle.road_arms.angle_deg)
    L_im = (x[:-1] - x[1:])[:m] / 2

    # Design pose (all θ = 0): wheels touch flat ground, arms run down and back at φ, imaginary arms run level.
    wheel_centre = np.column_stack([x, np.full(n, r)])
    half_arm = L / 2 * np.array([np.cos(phi), np.sin(phi)])
    half_link = np.column_stack([L_im / 2, np.zeros(m)])
    pivot = wheel_centre + 2 * half_arm
    link_centre = wheel_centre[:m] - half_link
    chassis_centre = np.array([0.0, vehicle.chassis.cg_height])
    centres = np.concatenate(
        [chassis_centre[None], wheel_centre + half_arm, wheel_centre, link_centre, link_centre - half_link]
    )

    m_a, m_w = vehicle.road_arms.mass, vehicle.road_wheels.mass
    m_l, m_v = vehicle.imaginary_arms.mass, vehicle.imaginary_wheels.mass
    mass = np.concatenate([[vehicle.chassis.mass], np.full(n, m_a), np.full(n, m_w), np.full(m, m_l), np.full(m, m_v)])
    rod = _given(vehicle.road_arms.inertia, m_a * L**2 / 12)
    disc = _given(vehicle.road_wheels.inertia, m_w * r**2 / 2)
    imaginary_disc = _given(vehicle.imaginary_wheels.inertia, m_v * r**2 / 2)
    inertia = np.concatenate(
        [
            [vehicle.chassis.pitch_inertia],
            np.full(n, rod),
            np.full(n, disc),
            m_l * (2 * half_link[:, 0]) ** 2 / 12,
            np.full(m, imaginary_disc),
        ]
    )

    arms, wheels = 1 + np.arange(n), 1 + n + np.arange(n)
    links, imaginary = 1 + 2 * n + np.arange(m), 1 + 2 * n + m + np.arange(m)
    at_centre = np.zeros((n, 2))
    joint_i = np.concatenate([np.zeros(n, int), arms, wheels[:m], links])
    joint_j = np.concatenate([arms, wheels, links, imaginary])
    u_i = np.concatenate([pivot - chassis_centre, np.tile(-half_arm, (n, 1)), at_centre[:m], -half_link])
    u_j = np.concatenate([np.tile(half_arm, (n, 1)), at_centre, half_link, at_centre[:m]])

    # Springs: rates at the wheel become torsional at the design pose.
    road, imag = vehicle.road_suspension, vehicle.imaginary_suspension
    lever = np.full(n, L * np.cos(phi))
    at_wheel = (L * np.cos(phi)) ** 2 if road.basis == "wheel" else 1.0
    k_s, c_s = (_per_wheel(value, n) * at_wheel for value in (road.stiffness, road.damping))
    bump, rebound = _stops(L, phi, road.bump_travel, road.rebound_travel)
    k_sl, c_sl = np.full(m, imag.stiffness), np.full(m, imag.damping)
    if imag.basis == "wheel":
        k_sl, c_sl = k_sl * L_im**2, c_sl * L_im**2
    preload = k_sl * imag.preload_deflection / L_im**2 if imag.preload_force is None else imag.preload_force
    tau_l = preload * L_im
    on_chassis = imag.reacts_on == "chassis"
    tau_0 = _road_preload(pivot[:, 0], x, vehicle.chassis.mass, m_a, lever, tau_l, on_chassis)

    contact, drive, simulation = config.contact, config.drive, config.simulation
    system = System(
        n=n,
        m=m,
        mass=mass,
        inertia=inertia,
        q_design=np.column_stack([centres, np.zeros(len(centres))]),
        joint_i=joint_i,
        joint_j=joint_j,
        u_i=u_i,
        u_j=u_j,
        spring_i=np.concatenate([np.zeros(n, int), np.zeros(m, int) if on_chassis else arms[:m]]),
        spring_j=np.concatenate([arms, links]),
        k_s=np.concatenate([k_s, k_sl]),
        c_s=np.concatenate([c_s, c_sl]),
        linear=road.progression == 0.0 and road.rebound_ratio == 1.0 and bump == np.inf and rebound == -np.inf,
        p=np.concatenate([np.full(n, road.progression * at_wheel), np.zeros(m)]),
        c_rebound=np.concatenate([c_s * road.rebound_ratio, c_sl]),
        stops=Stops(bump, rebound, road.stop_stiffness * at_wheel, road.stop_damping * at_wheel),
        tau_0=np.concatenate([tau_0, tau_l]),
        wheel=np.concatenate([wheels, imaginary]),
        r=r,
        belly=_belly(vehicle.chassis.belly_height, float(pivot[0, 1]), r),
        ground=Ground(
            k_n=contact.normal_stiffness,
            c_n=contact.normal_damping,
            k_t=contact.tangential_stiffness,
            c_t=contact.tangential_damping,
            mu=contact.friction,
        ),
        prescribed=drive.mode == "prescribed",
        x_0=0.0,
        v_ref=drive.speed_kmh / 3.6,
        K_p=drive.proportional_gain,
        K_i=drive.integral_gain,
        F_max=drive.force_limit,
        alpha=simulation.baumgarte_alpha,
        beta=simulation.baumgarte_beta,
        weight=mass * GRAVITY,
    )
    for array in system:
        if isinstance(array, np.ndarray):
            array.setflags(write=False)
    return system


def _road_preload(
    pivot_x: np.ndarray,
    x: np.ndarray,
    m_c: float,
    m_a: float,
    lever: np.ndarray,
    tau_l: np.ndarray,
    on_chassis: bool,
) -> np.ndarray:
    """τ_0 (n,), N m: holds the design pose at rest, with axle forces V_i = a + b x_i from the chassis's equilibrium."""
    n, g = len(x), GRAVITY
    # τ_0,i = V_i ℓ − m_a g ℓ/2 + carried_i, with carried_i = τ'_0,i where the imaginary arm leans on the road arm
    carried = np.zeros(n)
    if not on_chassis:
        carried[: len(tau_l)] = tau_l
    fixed = -m_a * g * lever / 2 + carried
    # Σ(V_i − m_a g) = m_c g;  Σ[pivot_i (V_i − m_a g) − τ_0,i] − [chassis option] Σ τ'_0 = 0.  Unknown: a, b.
    arm = pivot_x - lever  # what V_i's moment is left with after its part of τ_0,i
    lhs = np.array([[n, x.sum()], [arm.sum(), (arm * x).sum()]])
    rhs = np.array(
        [
            (m_c + n * m_a) * g,
            (pivot_x * m_a * g + fixed).sum() + (tau_l.sum() if on_chassis else 0.0),
        ]
    )
    a, b = np.linalg.solve(lhs, rhs)
    return (a + b * x) * lever + fixed


def _stops(L: float, phi: float, bump_travel: float | None, rebound_travel: float | None) -> tuple[float, float]:
    """θ_i − θ_j (u), rad, at both stops: an arm that has turned by u holds its wheel L (sin φ − sin(φ − u)) higher."""
    bump = np.inf if bump_travel is None else phi - np.arcsin(np.sin(phi) - bump_travel / L)
    rebound = -np.inf if rebound_travel is None else phi - np.arcsin(np.sin(phi) + rebound_travel / L)
    return float(bump), float(rebound)


def _belly(given: float | None, pivot: float, r: float) -> float:
    """Height of the hull's floor, m; pivot: height of the road arms' pivots, m."""
    if given is not None:
        return given
    return min(max(pivot - UNDER_PIVOT * r, LOWEST_BELLY * r), HIGHEST_BELLY * r)


def _per_wheel(value: float | tuple[float, ...], n: int) -> np.ndarray:
    return np.broadcast_to(np.asarray(value, dtype=float), (n,)).copy()


def _given(value: float | None, otherwise: float) -> float:
    return otherwise if value is None else value
