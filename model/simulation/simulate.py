"""Config -> Trajectory: rest pose, then the run in chunks, with progress and a way to stop it.

Compiled modules are imported by what runs them: Numba takes a third of a second, and the explorer listens without it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields, replace
from functools import cache
from time import perf_counter
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from model.config.config import Config
from model.dynamics.equilibrium import rest_pose
from model.dynamics.lanes import pack
from model.dynamics.vehicle import System, build_system
from model.simulation.accuracy import APART_ALLOWED, ENERGY_ALLOWED, advice, energy_missing
from model.simulation.trajectory import Motion, RunStatistics, Trajectory

if TYPE_CHECKING:
    from model.simulation.steppers import Samples

M = TypeVar("M", bound=Motion)
CHUNK = 1.0  # s of simulated time between two looks at should_stop: about 1 ms


def starting_state(system: System) -> tuple[np.ndarray, np.ndarray]:
    """Flat state at t = 0 (rest pose, moving at v_ref with rolling wheels) and static loads (W,), N.

    Raises NoEquilibriumError.
    """
    q, static_load = rest_pose(system)
    v = np.zeros_like(q)
    v[:, 0] = system.v_ref
    v[system.wheel, 2] = -system.v_ref / system.r
    return pack(system, q, v, np.zeros(len(system.wheel)), 0.0), static_load


@cache
def warm_up(integrator: str = Config().simulation.integrator) -> None:
    """Compile what an integrator needs, or load it compiled: once a process, half a minute the very first time."""
    from model.road.road import build_road
    from model.simulation.integrate import Integration

    config = Config()
    system = build_system(config)
    y, _ = starting_state(system)
    Integration(system, build_road(config).table, y, duration=1e-3, rate=1.0, integrator=integrator).advance(1e-3)


def sampled_arrays(samples: Samples, count: int | None = None) -> dict[str, np.ndarray]:
    """The arrays of a Trajectory that are samples, the first so many, by their names there."""
    named = {
        "q": samples.q,
        "v": samples.v,
        "a": samples.a,
        "normal_load": samples.f_n,
        "traction": samples.f_t,
        "tangential_displacement": samples.xi,
        "drive_force": samples.F,
        "multipliers": samples.lam,
        "constraint_residual": samples.residual,
        "work": samples.work,
    }
    return {name: values[:count] for name, values in named.items()}


def simulate(
    config: Config,
    on_progress: Callable[[float], None] | None = None,
    should_stop: Callable[[], bool] | None = None,
    apart_allowed: float = APART_ALLOWED,
) -> Trajectory:
    """The whole run of a configuration.

    on_progress: gets the part done, 0…1, when the model is compiled and after each chunk. should_stop: asked after each
    chunk, and at least every 0.1 s; true ends the run.
    apart_allowed: m that joints may be apart; infinite for who wants to see them drift.
    A run that diverges, whose joints come apart or that is stopped is returned as far as it was good, with a status
    and advice; one that does not account for its energy says so too.
    Raises NoEquilibriumError when the vehicle has no rest pose to start from.
    """
    return _run(Trajectory, config, on_progress, should_stop, apart_allowed)


def simulate_motion(config: Config, should_stop: Callable[[], bool] | None = None) -> Motion:
    """The same run, to the last digit, without what no figure is read off. Raises NoEquilibriumError."""
    return _run(Motion, config, should_stop=should_stop)


def _run(
    kind: type[M],
    config: Config,
    on_progress: Callable[[float], None] | None = None,
    should_stop: Callable[[], bool] | None = None,
    apart_allowed: float = APART_ALLOWED,
) -> M:
    from model.road.road import SPARE, build_road
    from model.simulation import relief
    from model.simulation.integrate import Integration, Status

    warm_up(config.simulation.integrator)
    if on_progress is not None:
        on_progress(0.0)
    began = perf_counter()
    system, road = build_system(config), build_road(config)
    y, static_load = starting_state(system)
    settings = config.simulation
    run = Integration.of(settings, system, road.table, y, settings.duration, figures_only=kind is Motion)
    run.apart_allowed = apart_allowed
    stopped = False
    while not stopped and run.advance(run.t + CHUNK, should_stop) is Status.RUNNING:
        if on_progress is not None:
            on_progress(min(run.t / settings.duration, 1.0))
        stopped = should_stop is not None and should_stop()
        if run.y[0] > road.reach - SPARE / 2:  # rolled away downhill
            road = build_road(config, 2 * road.reach)
            run.change(system, road.table)
    if on_progress is not None and run.status is Status.COMPLETE:
        on_progress(1.0)

    status, to_try = ("cancelled", "") if run.status is Status.RUNNING else run.ending(settings)
    if run.status in (Status.TOO_MANY_STEPS, Status.STEP_TOO_SMALL):
        to_try = relief.advice(config, run) or to_try
    n, wanted = run.samples_done, {field.name for field in fields(kind)}
    t, arrays = np.arange(n) / settings.output_rate, sampled_arrays(run.samples, n)
    motion = kind(
        t=t,
        **{name: values for name, values in arrays.items() if name in wanted},
        tracked=run.peaks().beside(t, arrays["normal_load"], arrays["a"][:, 0, 1]) if n else run.peaks(),
        static_load=static_load,
        config=config,
        status=status,
        advice=to_try,
        statistics=RunStatistics(
            steps=run.steps,
            rejected_steps=run.rejected_steps,
            evaluations=run.evaluations,
            smallest_step=run.smallest_step,
            seconds=perf_counter() - began,
        ),
    )
    vars(motion)["system"] = system  # what it would build when it is asked for
    missing = motion.energy_error or 0.0
    if motion.complete and missing > ENERGY_ALLOWED:
        return replace(motion, status=f"inaccurate: {energy_missing(missing)}", advice=advice(settings))
    return motion
