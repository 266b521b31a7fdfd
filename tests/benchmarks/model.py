"""Figures of the model: the right-hand side, the paper's run, and the same with dense equations and SciPy."""

from __future__ import annotations

import os
from collections.abc import Callable
from statistics import median
from time import perf_counter

import numpy as np
from scipy.integrate import solve_ivp

from model import load_config, simulate
from model.compiled import compiled
from model.config.config import Config
from model.dynamics.equations import State, rates
from model.dynamics.kernel import rates as kernel_rates
from model.dynamics.lanes import in_lanes, make_work, pack, places, unpack
from model.dynamics.vehicle import build_system
from model.road.road import build_road
from model.simulation.integrate import error_scale
from model.simulation.simulate import starting_state

REPEATS = 15
ROAD_REPEATS = 25
ROADS: dict[str, dict[str, object]] = {
    "half_round": {"road.type": "half_round"},
    "trapezoid": {"road.type": "trapezoid"},
    "step": {"road.type": "step"},
    **{f"random, class {c}": {"road.type": "random", "road.roughness_class": c} for c in "ABCDEFGH"},
    "profile, every 5 cm": {
        "road.type": "profile",
        "road.start": 3.0,
        "road.points": ", ".join(f"{0.05 * k:g} {0.03 * np.sin(0.09 * k) * np.sin(0.05 * k):.5f}" for k in range(4000)),
    },
    "sum of random, class C, and half_round": {
        "road.type": "sum",
        "road.parts": [{"type": "random"}, {"type": "half_round", "position": 10}],
    },
}
DENSE_TIME = 0.02  # s of simulated time with the dense equations, which are far too slow for the whole run


def cores() -> int:
    """Cores this process may use."""
    return len(os.sched_getaffinity(0))


def measure() -> dict[str, tuple[float, str]]:
    """All figures: name -> (median, unit)."""
    config = load_config("paper")
    system, road = build_system(config), build_road(config)
    y, _ = starting_state(system)
    body, _ = places(system.n, system.m)
    y[body[:, 0]] += 20.0  # on the waves
    y[body[:, 1]] += float(road.height(np.array(20.0)))
    lanes, work, dy, table = in_lanes(system), make_work(system), np.zeros_like(y), road.table

    evaluations = 20_000
    kernel = _seconds(lambda: _evaluate(lanes, table, y, dy, work, evaluations)) / evaluations
    q, v, xi, int_e = unpack(system, y)
    dense = _seconds(lambda: rates(system, road, 0.0, State(q, v, xi, int_e)), repeats=5)
    run = _seconds(lambda: simulate(config))
    duration = config.simulation.duration
    rk45 = _seconds(lambda: simulate(config.replace({"simulation.integrator": "scipy-rk45"})), repeats=3)
    slow = _seconds(lambda: _dense_run(system, road, y, config.simulation), repeats=1) * duration / DENSE_TIME
    return {
        "right-hand side, kernel": (kernel * 1e6, "µs"),
        "right-hand side, dense equations": (dense * 1e3, "ms"),
        "kernel faster than dense equations": (dense / kernel, "times"),
        "paper's 10 s": (run * 1e3, "ms"),
        "paper's 10 s, real-time factor": (duration / run, "times real time"),
        "paper's 10 s, SciPy RK45 on the kernel": (rk45 * 1e3, "ms"),
        f"paper's 10 s, SciPy RK45 on the dense equations (scaled up from {DENSE_TIME} s)": (slow, "s"),
        "paper's 10 s faster than that": (slow / run, "times"),
        **{f"10 s on road {name}": (_ratio(config, changes), "times the sine") for name, changes in ROADS.items()},
    }


def _ratio(config: Config, changes: dict[str, object]) -> float:
    """Time of a run on another road to that on the paper’s, each right after the other; the tables of both are kept."""
    other = config.replace(changes)
    simulate(other)
    ratios = []
    for _ in range(ROAD_REPEATS):
        began = perf_counter()
        simulate(config)
        middle = perf_counter()
        simulate(other)
        ratios.append((perf_counter() - middle) / (middle - began))
    return median(ratios)


@compiled
def _evaluate(lanes, road, y, dy, work, count):  # type: ignore[no-untyped-def]
    for _ in range(count):
        kernel_rates(lanes, road, 0.0, y, dy, work)
        y[0] += 1e-15 * dy[-1]  # so that no evaluation can be left out


def _dense_run(system, road, y, settings) -> None:  # type: ignore[no-untyped-def]
    def right_hand_side(t: float, y: np.ndarray) -> np.ndarray:
        q, v, xi, int_e = unpack(system, y)
        found = rates(system, road, t, State(q, v, xi, int_e))
        return pack(system, v, found.v_dot, found.xi_dot, found.int_e_dot)

    scale = error_scale(system, settings.rtol, settings.atol)
    solve_ivp(right_hand_side, (0.0, DENSE_TIME), y, method="RK45", rtol=settings.rtol, atol=scale)


def _seconds(work: Callable[[], object], repeats: int = REPEATS) -> float:
    """Median time of one call, s, after one call that does not count."""
    work()
    times = []
    for _ in range(repeats):
        began = perf_counter()
        work()
        times.append(perf_counter() - began)
    return median(times)
