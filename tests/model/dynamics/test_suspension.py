"""Springs beyond the paper's linear ones: progression, rebound damping, stops; each on its own and in whole runs."""

from __future__ import annotations

import numpy as np
import pytest

from model import ConfigError, simulate
from model.dynamics.equations import suspension_torques
from model.dynamics.suspension import added_torque, dissipated_power, elastic
from model.dynamics.vehicle import System, build_system
from tests.model.support import OPTIONS, PAPER, ROAD_SPRING, turned

WITH_ALL = OPTIONS["progressive, asymmetric, with stops"]


def with_road(**changes: float | None) -> System:
    return build_system(PAPER.replace({f"{ROAD_SPRING}.{key}": value for key, value in changes.items()}))


def road_torque(system: System, u: float, u_dot: float) -> float:
    """On the first road arm turned by u from the design pose, less its preload."""
    q, v = np.zeros_like(system.q_design), np.zeros_like(system.q_design)
    q[1, 2], v[1, 2] = -u, -u_dot
    q[1 + 2 * system.n, 2], v[1 + 2 * system.n, 2] = -u, -u_dot  # the imaginary arm turns along
    lone = suspension_torques(system, q, v)[1]
    return lone - suspension_torques(system, np.zeros_like(q), np.zeros_like(q))[1]


@pytest.mark.parametrize("travel", [0.05, 0.2])
def test_an_arm_meets_its_stop_at_the_travel_given(travel):
    system = with_road(bump_travel=travel, rebound_travel=travel)
    axle = -(system.u_j[0] - system.u_i[system.n])  # from pivot to axle in the design pose
    for u, rise in ((system.stops.bump, travel), (system.stops.rebound, -travel)):
        assert turned(axle, -u)[1] - axle[1] == pytest.approx(rise, abs=1e-12)


def test_without_stops_nothing_is_beyond_the_paper():
    system = with_road()
    assert system.linear
    assert np.isinf([system.stops.bump, system.stops.rebound]).all()
    assert road_torque(system, 0.3, -2.0) == pytest.approx(system.k_s[0] * 0.3 - system.c_s[0] * 2.0)


def test_a_progressive_spring_stiffens_with_the_square_of_its_deflection():
    lever = 0.35 * np.cos(np.radians(20))
    system = with_road(progression=50.0)
    z = 0.1  # m at the wheel: k_s z (1 + p z²), at the lever
    expected = 75530 * z * (1 + 50 * z**2) * lever
    assert road_torque(system, z / lever, 0.0) == pytest.approx(expected)
    assert road_torque(system, -z / lever, 0.0) == pytest.approx(-expected)


def test_rebound_is_damped_by_the_ratio():
    soft, hard = with_road(), with_road(rebound_ratio=3.0)
    assert road_torque(hard, 0.0, 1.0) == pytest.approx(road_torque(soft, 0.0, 1.0))
    assert road_torque(hard, 0.0, -1.0) == pytest.approx(3 * road_torque(soft, 0.0, -1.0))


def test_a_stop_pushes_and_never_pulls():
    system = with_road(bump_travel=0.1, rebound_travel=0.08)
    deep = 0.01

    def stop_torque(system: System, u: float, u_dot: float) -> float:
        return added_torque(system.stops, 0.0, 0.0, 0.0, 0.0, u, u_dot)

    assert stop_torque(system, system.stops.bump - 1e-9, 5.0) == 0.0
    assert stop_torque(system, system.stops.bump + deep, 0.0) == pytest.approx(system.stops.k * deep)
    assert stop_torque(system, system.stops.bump + deep, 1.0) == pytest.approx(system.stops.k * deep + system.stops.c)
    assert stop_torque(system, system.stops.bump + deep, -100.0) == 0.0
    assert stop_torque(system, system.stops.rebound - deep, 0.0) == pytest.approx(-system.stops.k * deep)
    assert stop_torque(system, system.stops.rebound - deep, 100.0) == 0.0


def test_energy_torque_and_stiffness_belong_together():
    system = build_system(PAPER.replace(WITH_ALL))
    rng, step = np.random.default_rng(0), 1e-6
    for _ in range(50):
        u = rng.uniform(-0.4, 0.4, len(system.k_s))
        if np.abs(u - system.stops.bump).min() < 2 * step or np.abs(u - system.stops.rebound).min() < 2 * step:
            continue
        here, ahead, behind = (elastic(system, u + side) for side in (0.0, step, -step))
        np.testing.assert_allclose((ahead.energy - behind.energy) / (2 * step), here.torque, rtol=1e-6, atol=1e-3)
        np.testing.assert_allclose((ahead.torque - behind.torque) / (2 * step), here.stiffness, rtol=1e-6)


def test_all_torque_is_elastic_or_dissipated():
    system = build_system(PAPER.replace(WITH_ALL))
    rng = np.random.default_rng(1)
    for u, u_dot in zip(rng.uniform(-0.4, 0.4, 200), rng.normal(0.0, 3.0, 200), strict=True):
        springs, speeds = np.full(len(system.k_s), u), np.full(len(system.k_s), u_dot)
        whole = road_torque(system, u, u_dot) + system.tau_0[0]
        power = dissipated_power(system, springs, speeds)[0]
        assert whole * u_dot == pytest.approx(elastic(system, springs).torque[0] * u_dot + power, rel=1e-9, abs=1e-6)
        assert power >= 0.0


def test_stops_keep_the_arms_of_a_fast_vehicle_from_turning_far():
    fast = PAPER.replace({"drive.speed_kmh": 30, "simulation.duration": 6})
    stops = {
        f"{ROAD_SPRING}.bump_travel": 0.12,
        f"{ROAD_SPRING}.rebound_travel": 0.08,
        f"{ROAD_SPRING}.stop_stiffness": 5e6,
    }

    def reach(changes: dict[str, float]) -> tuple[float, float]:
        run = simulate(fast.replace(changes))
        assert run.complete
        u = run.q[:, :1, 2] - run.q[:, 1:7, 2]
        return float(u.min()), float(u.max())

    system = build_system(fast.replace(stops))
    free, held = reach({}), reach(stops)
    assert free[0] < system.stops.rebound - 0.2
    assert held[0] > system.stops.rebound - 0.08
    assert held[1] < system.stops.bump + 0.2 < free[1]


def test_dampers_on_some_wheels_only():
    run = simulate(PAPER.replace({f"{ROAD_SPRING}.damping": (4732, 4732, 0, 0, 4732, 4732), "simulation.duration": 3}))
    assert run.complete
    assert not run.system.c_s[2:4].any()


def test_a_stop_beyond_the_arms_reach_is_refused():
    with pytest.raises(ConfigError, match=r"bump_travel.*less than 0\.4697 m"):
        PAPER.replace({f"{ROAD_SPRING}.bump_travel": 0.5})
    with pytest.raises(ConfigError, match=r"rebound_travel.*less than 0\.2303 m"):
        PAPER.replace({f"{ROAD_SPRING}.rebound_travel": 0.25})
