"""A vehicle side by side: eight chains at a time, each in a lane of its own, as the processor's vector units want it.

A chain is what hangs on one pivot of the hull: road arm a, road wheel w, imaginary arm l and imaginary wheel v. Eight
of them make a block. All that the kernel keeps of a block stands in rows of eight numbers, one for each lane, so that
one instruction does the same for two, four or eight chains. Lanes without a body (the last wheel carries no imaginary
arm, and blocks are filled up) have no mass, no weight, no spring and no ground; what stands in their state stays zero.

Flat state: a head of x, y, θ, ẋ, ẏ, θ̇ of the chassis, ∫e and the work done, then the rows of each block in STATE's
order. The work is what all forces but weight and joints have done since the start, J: nothing depends on it, but the
kinetic energy must have grown by it.
"""

from __future__ import annotations

from collections import namedtuple
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from model.dynamics.ground import Ground
from model.dynamics.vehicle import Stops, System

LANES = 8
AT_ONCE = 4  # lanes are used by so many
HEAD = 8  # entries before the first block
SPEED, INT_E, WORK = 3, 6, 7  # of them: ẋ, ∫e, the work done

BODIES = ("a", "w", "l", "v")
COORDINATES = ("x", "y", "theta", "v_x", "v_y", "omega")
STATE = (*(f"{name}_{body}" for body in BODIES for name in COORDINATES), "xi_w", "xi_v")
CONSTANTS = (
    *("m_a", "I_a", "weight_a", "m_w", "over_I_w", "weight_w"),
    *("m_l", "I_l", "weight_l", "m_v", "over_I_v", "weight_v"),
    *("k_s", "c_s", "tau_0"),  # of the road arm's torsion bar
    *("p", "c_rebound"),  # … beyond linear
    *("k_sl", "c_sl", "tau_0l"),  # of the imaginary arm's spring
    "on_arm",  # 1: the imaginary arm's spring leans on the road arm, 0: on the chassis
    *("c_x", "c_y"),  # pivot in the chassis's frame, from its centre of mass
    *("p_x_a", "p_y_a", "tip_x_a", "tip_y_a"),  # the arm's pivot and the wheel's centre in the arm's frame
    *("p_x_l", "p_y_l", "tip_x_l", "tip_y_l"),  # the same of the imaginary arm
    *("road", "imaginary"),  # 1 where there is a road arm and wheel, an imaginary arm and wheel; else 0
)
CONTACT = (  # of a wheel
    *("X", "s", "u", "c_0", "c_1", "c_2", "c_3", "c_4", "c_5", "final"),  # what `approach` gives; then 1 if it sufficed
    *("f_n", "f_t", "F_x", "F_y", "z", "power"),
)
ARM = ("p_x", "p_y", "tip_x", "tip_y", "gamma_x", "gamma_y", "e_x", "e_y", "T", "at_pivot_x", "at_pivot_y")
SCRATCH = (
    *(f"{name}_{body}" for body in "wv" for name in CONTACT),
    *(f"{name}_{body}" for body in "al" for name in ARM),
    *("tau_a", "power", "c_x", "c_y", "drift"),
    *("M_xx", "M_xy", "M_yy", "M_xt", "M_yt", "M_tt", "Q_x", "Q_y", "Q_t"),  # what a chain adds to the chassis
)


def rows(names: tuple[str, ...]) -> Any:
    """Where each row begins in a block: a tuple of entries, which are constants to the compiler."""
    return namedtuple("Rows", names)(*range(0, LANES * len(names), LANES))


# Where rows begin: of the flat state, of the vehicle's constants, of scratch space, and of a wheel's part of that
Y, P, W, C = rows(STATE), rows(CONSTANTS), rows(SCRATCH), rows(CONTACT)
STATE_SIZE, CONSTANTS_SIZE, SCRATCH_SIZE = (LANES * len(names) for names in (STATE, CONSTANTS, SCRATCH))  # of a block


class Lanes(NamedTuple):
    """A System as the kernel computes with it; symbols and units are those of System."""

    n: int  # chains
    m: int  # of them with imaginary arm and wheel
    lanes: int  # of each block that are used; not a constant to the compiler, or it would unroll the loops over lanes
    constants: np.ndarray  # blocks of CONSTANTS' rows
    place: np.ndarray  # (B, 6) where the flat state has each body's x, y, θ, ẋ, ẏ, θ̇
    xi_place: np.ndarray  # (W,) and each wheel's ξ
    m_c: float
    I_c: float
    weight_c: float
    linear: bool
    stops: Stops
    r: float
    ground: Ground
    prescribed: bool
    x_0: float
    v_ref: float
    K_p: float
    K_i: float
    F_max: float
    two_alpha: float
    beta2: float


class Work(NamedTuple):
    """Scratch space of one right-hand side, and the contact forces it leaves behind."""

    blocks: np.ndarray  # SCRATCH's rows of each block
    F: np.ndarray  # (1,) drive force, N
    held: np.ndarray  # (1,) ±1 while the drive is held at that limit (steppers.py), else 0


def make_work(system: System) -> Work:
    """Scratch space for a system."""
    return Work(np.zeros(blocks(system.n) * SCRATCH_SIZE), np.zeros(1), np.zeros(1))


def blocks(n: int) -> int:
    return -(-n // LANES)


@lru_cache(maxsize=64)
def places(n: int, m: int) -> tuple[np.ndarray, np.ndarray]:
    """Where the flat state has each body's x, y, θ, ẋ, ẏ, θ̇: (B, 6), and each wheel's ξ: (W,)."""

    def entries(count: int, name: str) -> np.ndarray:
        chain = np.arange(count)
        return HEAD + chain // LANES * STATE_SIZE + LANES * STATE.index(name) + chain % LANES

    counts = {"a": n, "w": n, "l": m, "v": m}
    bodies = [
        np.column_stack([entries(count, f"{name}_{body}") for name in COORDINATES]) for body, count in counts.items()
    ]
    body = np.concatenate([np.arange(len(COORDINATES))[None], *bodies])
    xi = np.concatenate([entries(n, "xi_w"), entries(m, "xi_v")])
    for array in (body, xi):
        array.setflags(write=False)
    return body, xi


def state_size(n: int) -> int:
    """Entries of the flat state of a vehicle with n road wheels."""
    return HEAD + blocks(n) * STATE_SIZE


def pack(system: System, q: np.ndarray, v: np.ndarray, xi: np.ndarray, int_e: float) -> np.ndarray:
    """The flat state of q, v (B, 3), ξ (W,), ∫e."""
    body, wheel = places(system.n, system.m)
    y = np.zeros(state_size(system.n))
    y[body[:, :3]], y[body[:, 3:]], y[wheel], y[INT_E] = q, v, xi, int_e
    return y


def unpack(system: System, y: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, float]:
    """q, v (B, 3), ξ (W,), ∫e of a flat state."""
    body, wheel = places(system.n, system.m)
    return y[body[:, :3]], y[body[:, 3:]], y[wheel], float(y[INT_E])


def coordinates(system: System) -> np.ndarray:
    """Where the flat state has all x, then all y, θ, ẋ, ẏ, θ̇, ξ, and ∫e: (6 B + W + 1,). The rest is empty lanes."""
    body, wheel = places(system.n, system.m)
    return np.concatenate([body.T.ravel(), wheel, [INT_E]])


def wheel_positions(system: System, y: np.ndarray) -> np.ndarray:
    """x of all wheels (W,), m, in a flat state."""
    return y[places(system.n, system.m)[0][system.wheel, 0]]


def in_lanes(system: System) -> Lanes:
    """The System in lanes."""
    n, m = system.n, system.m
    values = {
        "k_s": system.k_s[:n],
        "c_s": system.c_s[:n],
        "tau_0": system.tau_0[:n],
        "p": system.p[:n],
        "c_rebound": system.c_rebound[:n],
        "k_sl": system.k_s[n:],
        "c_sl": system.c_s[n:],
        "tau_0l": system.tau_0[n:],
        "on_arm": system.spring_i[n:] != system.chassis,
        "I_a": system.inertia[system.road_arms],
        "I_l": system.inertia[system.imaginary_arms],
        "over_I_w": 1.0 / system.inertia[system.road_wheels],
        "over_I_v": 1.0 / system.inertia[system.imaginary_wheels],
        "road": np.ones(n),
        "imaginary": np.ones(m),
    }
    groups = (system.road_arms, system.road_wheels, system.imaginary_arms, system.imaginary_wheels)
    for body, group in zip(BODIES, groups, strict=True):
        values[f"m_{body}"], values[f"weight_{body}"] = system.mass[group], system.weight[group]
    points = {
        "c_{}": system.u_i[:n],
        "p_{}_a": system.u_j[:n],
        "tip_{}_a": system.u_i[n : 2 * n],
        "p_{}_l": system.u_j[2 * n : 2 * n + m],
        "tip_{}_l": system.u_i[2 * n + m :],
    }
    for name, point in points.items():
        values[name.format("x")], values[name.format("y")] = point.T

    along = np.zeros((len(CONSTANTS), blocks(n) * LANES))
    along[[CONSTANTS.index("I_a"), CONSTANTS.index("I_l")]] = 1.0  # empty lanes divide by it
    for row, name in zip(along, CONSTANTS, strict=True):
        row[: len(values[name])] = values[name]
    constants = along.reshape(len(CONSTANTS), -1, LANES).swapaxes(0, 1).ravel()
    constants.setflags(write=False)

    place, xi_place = places(n, m)
    return Lanes(
        n=n,
        m=m,
        lanes=min(-(-n // AT_ONCE) * AT_ONCE, LANES),
        constants=constants,
        place=place,
        xi_place=xi_place,
        m_c=float(system.mass[0]),
        I_c=float(system.inertia[0]),
        weight_c=float(system.weight[0]),
        linear=system.linear,
        stops=system.stops,
        r=system.r,
        ground=system.ground,
        prescribed=system.prescribed,
        x_0=system.x_0,
        v_ref=system.v_ref,
        K_p=system.K_p,
        K_i=system.K_i,
        F_max=system.F_max,
        two_alpha=2.0 * system.alpha,
        beta2=system.beta**2,
    )
