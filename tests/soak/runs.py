"""Random configurations are run, and each run is checked."""

from __future__ import annotations

from dataclasses import fields
from io import BytesIO
from time import perf_counter

import numpy as np

from model.config.config_files import dump_config, parse_config
from model.config.validation import ConfigError
from model.dynamics.equilibrium import NoEquilibriumError
from model.simulation.simulate import simulate, warm_up
from model.simulation.trajectory import Trajectory
from tests.soak.draws import KINDS, drawn
from tests.soak.outcome import Outcome, try_all

PATIENCE = 5.0  # s of computing, then the run is stopped
HEEDED = 3.0  # s after that in which it ends: looks are 0.1 s apart, and the machine may be busy
DRIFT, ENERGY = 1e-3, 0.05  # m; share: a run that is called complete is better
PEAKS = 0.01  # share by which the peak of a motion may be missed
CLOSER = 20  # every so many configurations are run, saved and read twice


def random_runs(count: int, first: int = 0) -> Outcome:
    """So many configurations, of every kind in turn."""
    outcome = Outcome("Random configurations")
    outcome.tried = f"{count} configurations ({', '.join(KINDS)}), numbers {first} to {first + count - 1}."
    try_all(outcome, check_run, range(first, first + count))
    return outcome


def check_run(number: int) -> tuple[str, str]:
    """How a configuration's run ended, and what is wrong with it."""
    try:
        config = drawn(number)
    except ConfigError:
        return "refused configuration", ""
    if parse_config(dump_config(config)) != config:
        return "", "is not the same after dumping and parsing"
    warm_up(config.simulation.integrator)
    began = perf_counter()
    try:
        run = simulate(config, should_stop=lambda: perf_counter() - began > PATIENCE)
    except NoEquilibriumError as error:
        return "no rest pose", "" if str(error) else "no rest pose, without a reason"
    took = perf_counter() - began
    if took > PATIENCE + HEEDED:
        return "", f"was to be stopped after {PATIENCE:g} s and took {took:.1f} s"
    kind = KINDS[number % len(KINDS)]
    fault = _fault(run) or (_second_look(run) if number % CLOSER == 0 and run.complete else "")
    return f"{kind}: {_ending(run.status)}", fault


def _ending(status: str) -> str:
    """A run's status without its numbers."""
    if status.startswith("inaccurate"):
        return "joints apart" if " at t" in status else "energy missing"
    return " ".join(status.rpartition(": ")[2].split(" ", 2)[:2])


def _fault(run: Trajectory) -> str:
    """What is wrong with a run; empty: nothing."""
    for part in fields(run):
        values = getattr(run, part.name)
        if isinstance(values, np.ndarray) and not np.isfinite(values).all():
            return f"{part.name} holds what is not finite ({run.status})"
    if run.normal_load.min(initial=0.0) < 0.0:
        return "a wheel pulls at the ground"
    if run.complete:
        drift, energy = float(run.constraint_residual.max()), run.energy_error or 0.0
        if drift > DRIFT or energy > ENERGY:
            return f"is called complete: joints {1e3 * drift:.3g} mm apart, energy {100 * energy:.3g} % off"
        swing = np.abs(run.a[:, run.system.chassis, 1]).max() * (1 - PEAKS)
        if (run.peaks.load < run.normal_load.max(axis=0) * (1 - PEAKS)).any() or run.peaks.acceleration < swing:
            return "a peak is lower than a sample"
    elif run.status != "cancelled" and not run.advice:
        return f"no advice: {run.status}"
    return ""


def _second_look(run: Trajectory) -> str:
    """The same run again, and from a file."""
    again, read = simulate(run.config), Trajectory.load(BytesIO(run.to_bytes(".npz")), "run.npz")
    for name in ("q", "v", "normal_load", "drive_force"):
        if not np.array_equal(getattr(run, name), getattr(again, name)):
            return f"{name} is another at a second run"
        if not np.array_equal(getattr(run, name), getattr(read, name)):
            return f"{name} is another after saving and loading"
    return ""
