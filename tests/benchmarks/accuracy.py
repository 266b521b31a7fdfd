"""How far runs at the default tolerances are from the independent engine's: `python -m tests.benchmarks.accuracy`."""

from __future__ import annotations

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
    main()
