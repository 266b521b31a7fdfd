"""Energy and symmetry: what no integrator and no force law may break."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import simpson

from model.config.config import Config
from model.dynamics import equations, kernel
from model.dynamics.lanes import WORK, in_lanes, make_work, pack, unpack
from model.dynamics.vehicle import System, build_system
from model.road.road import Road, build_road
from model.simulation.integrate import Integration, Samples, Status
from model.simulation.simulate import starting_state
from tests.model.support import FLAT, IMAGINARY, OPTIONS, PAPER, ROAD_SPRING, WHEELS, admissible_state, entries

UNDAMPED = {f"{ROAD_SPRING}.damping": 0.0, f"{IMAGINARY}.damping": 0.0, "contact.normal_damping": 0.0}
UNDRIVEN = {"drive.force_limit": 0.0}
FRICTIONLESS = {"contact.friction": 0.0}
RATE = 2000.0  # samples a second: fine enough for Simpson's rule


def run(system: System, road: Road, y: np.ndarray, duration: float = 1.5) -> Samples:
    """A run at tight tolerances."""
    integration = Integration(system, road.table, y, duration, RATE, rtol=1e-9, atol=1e-11)
    while integration.advance(duration) is Status.RUNNING:
        pass
    assert integration.status is Status.COMPLETE
    return integration.samples


def pushed(system: System) -> np.ndarray:
    """The starting state, and everything moves down at 0.1 m/s."""
    q, v, xi, int_e = unpack(system, starting_state(system)[0])
    v = v.copy()
    v[:, 1] -= 0.1
    return pack(system, q, v, xi, int_e)


def contacts(system: System, road: Road, s: Samples) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Penetration z (N, W), 0 in the air; ż and slip velocity ṗ (N, W), from the road's nearest points."""
    centres, v = s.q[:, system.wheel, :2], s.v[:, system.wheel]
    _, n, d = (part.reshape(*centres.shape[:2], -1) for part in road.nearest(centres.reshape(-1, 2)))
    z = np.maximum(system.r - d[..., 0], 0.0)
    z_dot = -(v[..., :2] * n).sum(axis=-1)
    p_dot = v[..., 0] * n[..., 1] - v[..., 1] * n[..., 0] + system.r * v[..., 2]
    return z, z_dot, p_dot


def energy(system: System, road: Road, s: Samples) -> np.ndarray:
    """Motion, height, torsion bars with their preload, ground pressed in and sheared: (N,), J."""
    inertia = np.column_stack([system.mass, system.mass, system.inertia])
    motion = (inertia * s.v**2).sum(axis=(1, 2)) / 2
    height = (system.weight * s.q[..., 1]).sum(axis=1)
    turn = s.q[:, system.spring_i, 2] - s.q[:, system.spring_j, 2]
    springs = (system.k_s / 2 * turn**2 + system.tau_0 * turn).sum(axis=1)
    z, _, _ = contacts(system, road, s)
    ground = (system.ground.k_n / 3 * z**3).sum(axis=1) + (system.ground.k_t / 2 * s.xi**2).sum(axis=1)
    return motion + height + springs + ground


def lost_power(system: System, road: Road, s: Samples) -> np.ndarray:
    """What dampers, ground damping and friction take: (N,), W. Each part must be positive."""
    turning = s.v[:, system.spring_i, 2] - s.v[:, system.spring_j, 2]
    dampers = (system.c_s * turning**2).sum(axis=1)
    z, z_dot, p_dot = contacts(system, road, s)
    normal = ((s.f_n - system.ground.k_n * z**2) * z_dot).sum(axis=1)
    xi_dot = -(system.ground.k_t * s.xi + s.f_t) / system.ground.c_t
    shear = -(s.f_t * p_dot + system.ground.k_t * s.xi * xi_dot).sum(axis=1)
    for part in (dampers, normal, shear):
        assert part.min() >= -1e-9 * max(part.max(), 1.0)
    return dampers + normal + shear


def drive_power(system: System, s: Samples) -> np.ndarray:
    """Work of the drive each second: (N,), W."""
    if system.prescribed:
        return s.F * s.v[:, 0, 0]
    share = s.f_n / s.f_n.sum(axis=1, keepdims=True)
    return system.r * s.F * (s.v[:, 0, 2] - (share * s.v[:, system.wheel, 2]).sum(axis=1))


def prepared(config: Config) -> tuple[System, Road]:
    return build_system(config), build_road(config)


@pytest.mark.parametrize("imaginary", [True, False])
def test_energy_is_conserved_without_damping_and_friction(imaginary):
    system, road = prepared(
        FLAT.replace(UNDAMPED | UNDRIVEN | FRICTIONLESS | {"vehicle.imaginary_wheels.enabled": imaginary})
    )
    s = run(system, road, pushed(system), 3.0)
    E = energy(system, road, s)
    swing = np.ptp((system.weight * s.q[..., 1]).sum(axis=1))
    assert swing > 500.0  # J go to and fro
    assert np.abs(E - E[0]).max() < 1e-5 * swing


def test_energy_is_conserved_while_wheels_stick():
    """The sheared ground gives back what it takes, but for c_t, at its smallest here."""
    system, road = prepared(FLAT.replace(UNDAMPED | UNDRIVEN | {"contact.friction": 2.0}))
    system = system._replace(ground=system.ground._replace(c_t=1e-3))
    y = pushed(system)
    y[entries(system, "v_x")] += 0.02  # everything is pushed ahead, against the wheels' spin
    s = run(system, road, y)
    assert (np.abs(s.f_t) < system.ground.mu * s.f_n).all()
    assert (system.ground.k_t / 2 * s.xi**2).sum(axis=1).max() > 0.1  # J
    E = energy(system, road, s)
    assert np.abs(E - E[0]).max() < 1e-4


@pytest.mark.parametrize(
    "changes",
    [
        {"road.type": "flat"},
        {},
        {"drive.mode": "prescribed"},
        {"drive.speed_kmh": 30.0},
        {f"{IMAGINARY}.reacts_on": "chassis"},
        {"vehicle.imaginary_wheels.enabled": False},
        {f"{WHEELS}.positions": (1.9, 1.0, 0.3, -1.5)},
        {"contact.friction": 0.1, "road.amplitude": 0.2},
        {"road.wavelength": 3.0, "road.amplitude": 0.05},
    ],
)
def test_power_balance(changes):
    """Change of energy = drive's work − losses, with wheels slipping and leaving the ground."""
    system, road = prepared(PAPER.replace(changes))
    s = run(system, road, pushed(system), 2.0)
    lost = lost_power(system, road, s)
    E, work = energy(system, road, s), simpson(drive_power(system, s), dx=1 / RATE)
    dissipated = simpson(lost, dx=1 / RATE)
    assert dissipated > 20.0
    assert E[-1] - E[0] == pytest.approx(work - dissipated, abs=2e-4 * (dissipated + abs(work)))


def test_a_vehicle_at_rest_stays_at_rest():
    system, road = prepared(FLAT)
    system = system._replace(v_ref=0.0)
    s = run(system, road, starting_state(system)[0], 5.0)
    assert np.abs(s.v).max() < 1e-7
    np.testing.assert_allclose(s.f_n, np.tile(s.f_n[0], (len(s.f_n), 1)), atol=1e-5)


# Symmetry


@pytest.mark.parametrize("shift", [0.3, 900.0])
@pytest.mark.parametrize(
    ("changes", "key", "place"),
    [({}, "road.start", 2.75), ({"road.type": "half_round"}, "road.position", 4.0)],
)
def test_the_same_road_elsewhere_gives_the_same_loads(changes, key, place, shift):
    """State and road moved along by the same stretch: everything happens as before, moved."""
    config = PAPER.replace(changes)
    system, road = prepared(config.replace({key: place}))
    moved_road = build_road(config.replace({key: place + shift}), reach=shift + 100)
    y, _ = starting_state(system)
    moved_y = y.copy()
    moved_y[entries(system, "x")] += shift
    here, there = run(system, road, y), run(system, moved_road, moved_y)
    np.testing.assert_allclose(there.f_n, here.f_n, atol=0.5)
    np.testing.assert_allclose(there.v, here.v, atol=1e-4)  # a wheel spins up quickly where it lands
    np.testing.assert_allclose(there.q - [shift, 0, 0], here.q, atol=1e-6)


def test_a_period_further_on_gives_the_same_loads():
    """On the full waves, one wave or a thousand further along."""
    system, road = prepared(PAPER)
    y, _ = starting_state(system)
    y[entries(system, "x")] += 20.0
    y[entries(system, "y")] += 0.3
    near = run(system, road, y)
    y[entries(system, "x")] += 7000.0
    far = run(system, road, y)
    np.testing.assert_allclose(far.f_n, near.f_n, atol=1.0)


def test_standing_still_and_driving_on_flat_ground_look_the_same():
    """Rolling on level ground at constant speed loads the wheels as standing does."""
    system, road = prepared(FLAT)
    s = run(system, road, starting_state(system)[0], 3.0)
    np.testing.assert_allclose(s.f_n, np.tile(s.f_n[0], (len(s.f_n), 1)), atol=1e-3)
    assert np.abs(s.F).max() < 1e-3


def test_kinetic_energy_changes_by_the_power_of_the_forces():
    """At one state: Σ m v·a + I θ̇ θ̈ = power of weight, bars and ground; joints take none."""
    for seed in range(5):
        system, road = prepared(PAPER)
        state = admissible_state(system, np.random.default_rng(seed))
        rates = equations.rates(system, road, 0.0, state)
        inertia = np.column_stack([system.mass, system.mass, system.inertia])
        gained = (inertia * state.v * rates.v_dot).sum()
        bars = (equations.suspension_torques(system, state.q, state.v) * state.v[:, 2]).sum()
        one = Samples(
            *(np.asarray(part)[None] for part in (state.q, state.v, rates.v_dot, rates.f_n, rates.f_t, state.xi)),
            np.array([rates.F]),
            rates.lam[None],
            np.zeros(1),
            np.zeros(1),
        )
        _, z_dot, p_dot = contacts(system, road, one)
        weight = -(system.weight * state.v[:, 1]).sum()
        ground = (-rates.f_n * z_dot + rates.f_t * p_dot).sum()
        power = bars + weight + ground + drive_power(system, one)[0]
        assert gained == pytest.approx(power, rel=1e-8)


@pytest.mark.parametrize("changes", [{}, *OPTIONS.values(), {"drive.mode": "prescribed"}])
def test_the_work_in_the_state_is_that_of_all_forces_but_weight(changes):
    """At one state: what the kernel says the work grows by is what the kinetic energy does, less the weight's power."""
    system, road = prepared(PAPER.replace(changes))
    for seed in range(3):
        state = admissible_state(system, np.random.default_rng(seed))
        y = pack(system, *state)
        dy, work = np.empty_like(y), make_work(system)
        kernel.rates(in_lanes(system), road.table, 0.0, y, dy, work)
        v_dot = equations.rates(system, road, 0.0, state).v_dot
        inertia = np.column_stack([system.mass, system.mass, system.inertia])
        gained = (inertia * state.v * v_dot).sum() + (system.weight * state.v[:, 1]).sum()
        assert dy[WORK] == pytest.approx(gained, rel=1e-8)
