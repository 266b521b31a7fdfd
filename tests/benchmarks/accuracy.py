"""How far runs at the default tolerances are from the truth.

`python -m tests.benchmarks.accuracy`: from the independent engine's runs, case by case.
`python -m tests.benchmarks.accuracy rough`: on random roads of classes E to H, from runs at a tolerance of 1e-9;
`… rough 11 30`: with seeds 11 to 30 instead of 1 to 3; `… rough 11 30 GH`: of these classes only.
"""

from __future__ import annotations

import sys
from itertools import product

import numpy as np
from rich.console import Console
from rich.table import Table

from model import Trajectory, load_config, simulate
from tests.conftest import REFERENCE, REFERENCE_CASES

COLUMNS = ("load, rms", "heave", "pitch", "arms", "peak load", "peak acceleration", "energy")
UNITS = ("% of peak", "mm", "mrad", "mrad", "%", "%", "%")


def differences(run: Trajectory, right: dict[str, np.ndarray]) -> list[float]:
    """In COLUMNS' order, at worst over samples or wheels; NaN where the engine does not tell."""
    arms = run.q[:, run.system.road_arms, 2] - run.q[:, [run.system.chassis], 2]
    load = run.normal_load - right["normal_load"]
    chassis = run.q[:, run.system.chassis] - right["chassis"][:, :3]
    peak_load = np.abs(run.peaks.load / right["peak_load"] - 1).max() if "peak_load" in right else np.nan
    acceleration = float(right.get("peak_acceleration", np.nan))
    return [
        100 * float(np.sqrt(np.mean(load**2, axis=0)).max() / right["normal_load"].max()),
        1e3 * float(np.abs(chassis[:, 1]).max()),
        1e3 * float(np.abs(chassis[:, 2]).max()),
        1e3 * float(np.abs(arms - right["road_arm_angle"]).max()),
        100 * float(peak_load),
        100 * abs(float(run.peaks.acceleration) / acceleration - 1) if acceleration > 1e-3 else np.nan,
        100 * (run.energy_error or 0.0),
    ]


ROUGH = ("paper", "paper_0583", "m113", "m113_rs", "marder")
EXACT = {"simulation.rtol": 1e-9, "simulation.atol": 1e-11}

GOAL = (0.1, 0.1, 1.0, 0.1)  # heave, mm; pitch and arms, mrad; load, rms, % of the peak


def rough(first: str = "1", last: str = "3", classes: str = "EFGH") -> None:
    """Five vehicles on roads of each class and seed: how many runs miss the goal, and the largest differences."""
    table = Table("class", "miss the goal", "heave, mm", "pitch, mrad", "arms, mrad", "load, rms, %", "peak load, %")
    for roughness_class in classes:
        found = []
        for name, seed in product(ROUGH, range(int(first), int(last) + 1)):
            road = {"road.type": "random", "road.roughness_class": roughness_class, "road.seed": seed}
            config = load_config(name).replace(road | {"simulation.duration": 6})
            run, right = simulate(config), simulate(config.replace(EXACT))
            load = run.normal_load - right.normal_load
            pose = np.abs(run.q - right.q).max(axis=0)
            turn = run.q[:, run.system.road_arms, 2] - run.q[:, [run.system.chassis], 2]
            turn -= right.q[:, run.system.road_arms, 2] - right.q[:, [run.system.chassis], 2]
            found.append(
                (
                    1e3 * pose[run.system.chassis, 1],
                    1e3 * pose[run.system.chassis, 2],
                    1e3 * np.abs(turn).max(),
                    100 * np.sqrt(np.mean(load**2, axis=0)).max() / right.peaks.load.max(),
                    100 * np.abs(run.peaks.load / right.peaks.load - 1).max(),
                )
            )
        worst = np.max(found, axis=0)
        missed = sum(any(row[:4] > np.array(GOAL)) for row in np.array(found))
        table.add_row(roughness_class, f"{missed} of {len(found)}", *(f"{value:.2g}" for value in worst))
    Console(width=140).print(table)


def main() -> None:
    table = Table("case", *(f"{name}, {unit}" for name, unit in zip(COLUMNS, UNITS, strict=True)))
    found = []
    for case in REFERENCE_CASES:
        with np.load(REFERENCE / f"{case}.npz") as file:
            found.append(differences(simulate(load_config(REFERENCE / f"{case}.yaml")), dict(file)))
        table.add_row(case, *(f"{value:.2g}" for value in found[-1]))
    table.add_section()
    table.add_row("largest", *(f"{value:.2g}" for value in np.nanmax(found, axis=0)))
    Console(width=140).print(table)


if __name__ == "__main__":
    rough(*sys.argv[2:]) if sys.argv[1:2] == ["rough"] else main()
