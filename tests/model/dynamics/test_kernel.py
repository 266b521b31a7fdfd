"""The compiled right-hand side against the paper's equations, at random states, with every option."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest
from numba.core.runtime import _nrt_python, rtsys

from model.dynamics import equations, kernel
from model.dynamics.equations import Rates, State
from model.dynamics.lanes import in_lanes, make_work, pack, unpack
from model.dynamics.vehicle import System, build_system
from model.road.road import Road, build_road
from model.simulation.integrate import Integration
from model.simulation.simulate import starting_state
from tests.model.support import OPTIONS, PAPER, random_state

STATES = 15  # for each option: with more, the dense equations take half a minute and meet no other regime
AGREEMENT = 1e-9  # relative to the largest value of its kind


def kernel_rates(system: System, road: Road, t: float, state: State) -> Rates:
    """What the kernel gives, in the form of equations.py. Its scratch space starts full of NaN."""
    lanes, y = in_lanes(system), pack(system, *state)
    before = y.copy()
    dy = np.full(len(y), np.nan)
    work = make_work(system)
    for scratch in work:
        scratch.fill(np.nan)
    f_n, f_t = np.full((2, len(system.wheel)), np.nan)
    lam = np.full(2 * len(system.joint_i) + system.prescribed, np.nan)
    kernel.rates(lanes, road.table, t, y, dy, work)
    kernel.multipliers(lanes, dy, work, lam)
    kernel.loads(lanes, work, f_n, f_t)
    np.testing.assert_array_equal(y, before)
    v, v_dot, xi_dot, int_e_dot = unpack(system, dy)
    np.testing.assert_array_equal(v, state.v)
    return Rates(v_dot, xi_dot, int_e_dot, lam, f_n, f_t, float(work.F[0]))


def worst_difference(found: Rates, right: Rates) -> dict[str, float]:
    """Largest difference of each quantity, relative to the largest value of its kind."""
    differences = {}
    for name, value in right._asdict().items():
        size = np.abs(value).max()
        difference = np.abs(getattr(found, name) - value).max()
        differences[name] = float(difference / size) if size > 0.0 else float(difference)
    return differences


@pytest.mark.parametrize("option", OPTIONS)
def test_agrees_with_the_equations(option):
    config = PAPER.replace(OPTIONS[option])
    system, road = build_system(config), build_road(config)
    rng = np.random.default_rng(list(OPTIONS).index(option))
    for _ in range(STATES if system.n < 10 else 6):
        t, state = random_state(system, rng)
        differences = worst_difference(kernel_rates(system, road, t, state), equations.rates(system, road, t, state))
        assert max(differences.values()) <= AGREEMENT, differences


def test_the_random_states_reach_every_regime():
    """Otherwise the agreement above would say little: each regime must be met often."""
    met: Counter[str] = Counter()
    for index, changes in enumerate(OPTIONS.values()):
        config = PAPER.replace(changes)
        system, road = build_system(config), build_road(config)
        rng = np.random.default_rng(index)
        for _ in range(STATES if system.n < 10 else 6):
            t, state = random_state(system, rng)
            rates = kernel_rates(system, road, t, state)
            touching = rates.f_n > 0.0
            slipping = touching & (np.abs(rates.f_t) >= system.ground.mu * rates.f_n * (1 - 1e-12))
            met["in the air"] += int((~touching).sum())
            met["sticking"] += int((touching & ~slipping).sum())
            met["slipping forwards"] += int((slipping & (rates.f_t < 0.0)).sum())
            met["slipping backwards"] += int((slipping & (rates.f_t > 0.0)).sum())
            met["no wheel touches"] += int(not touching.any())
            met["drive limited"] += int(not system.prescribed and abs(rates.F) == system.F_max)
            met["drive free"] += int(not system.prescribed and abs(rates.F) < system.F_max)
            # A damped contact that rebounds too fast to be pushed: z > 0, f_n = 0
            centres = state.q[system.wheel, :2]
            _, _, d = road.nearest(centres)
            met["rebounding"] += int(((d < system.r) & ~touching).sum())
    assert min(met.values()) >= 10, met
    assert len(met) == 8


@pytest.mark.parametrize("option", ["paper", "prescribed", "two wheels"])
def test_constraint_residual_is_the_largest_entry_of_C(option):
    config = PAPER.replace(OPTIONS[option])
    system, table = build_system(config), build_road(config).table
    rng = np.random.default_rng(0)
    for _ in range(10):
        t, state = random_state(system, rng)
        if system.prescribed:
            state.q[:, 0] += system.v_ref * t  # near enough for the joints to show
        right = np.abs(equations.constraints(system, state.q, t)).max()
        lanes, y, work = in_lanes(system), pack(system, *state), make_work(system)
        kernel.rates(lanes, table, t, y, np.empty_like(y), work)
        assert kernel.constraint_residual(lanes, t, y, work) == pytest.approx(right, rel=1e-12)


def test_pack_and_unpack_are_inverse():
    system = build_system(PAPER)
    _, state = random_state(system, np.random.default_rng(0))
    unpacked = unpack(system, pack(system, *state))
    for one, other in zip(state, unpacked, strict=True):
        np.testing.assert_array_equal(one, other)


def test_a_step_allocates_nothing():
    """Numba's own count of allocations is the same for a hundred steps as for a thousand."""
    config = PAPER
    system, table = build_system(config), build_road(config).table
    y, _ = starting_state(system)
    _nrt_python.memsys_enable_stats()

    def allocations(duration: float) -> tuple[int, int]:
        run = Integration(system, table, y, 5.0, 100.0)
        run.advance(0.01)
        before = rtsys.get_allocation_stats()
        run.advance(duration)
        after = rtsys.get_allocation_stats()
        return run.steps, after.mi_alloc - before.mi_alloc

    few_steps, few = allocations(0.1)
    many_steps, many = allocations(4.0)
    assert many_steps > few_steps + 200
    assert many == few
