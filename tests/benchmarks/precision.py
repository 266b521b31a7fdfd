"""Work and precision: how long each stepper takes for the paper's run, and how far the loads are then off."""

from __future__ import annotations

from pathlib import Path
from statistics import median

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from model import load_config, simulate
from model.config.config import Config
from model.simulation.trajectory import Trajectory

PICTURE = Path(__file__).parents[2] / "assets" / "pictures" / "precision.png"
TOLERANCES = {  # of each stepper, with how often a run is timed
    "stretched-rk43": ((1e-3, 3e-4, 1e-4, 3e-5, 1e-5, 1e-6), 15),
    "dormand-prince": ((1e-2, 1e-3, 1e-4, 1e-5, 1e-6), 15),
    "scipy-rk45": ((1e-3, 1e-4, 1e-5), 1),
    "scipy-dop853": ((1e-3, 1e-4, 1e-5), 1),
    "scipy-lsoda": ((1e-3, 1e-4, 1e-5), 1),
    "scipy-bdf": ((1e-3, 1e-4), 1),
    "scipy-radau": ((1e-3, 1e-4), 1),
}
STEPS = (4e-3, 2e-3, 1e-3)  # s, of rk4
WANTED = 0.1  # % of the peak load, rms of the worst wheel

Points = dict[str, list[tuple[float, float]]]  # stepper -> (seconds, error in % of the peak load)


def measure() -> tuple[dict[str, tuple[float, str]], Points]:
    """Figures for the table, and all points."""
    config = load_config("paper")
    right = simulate(config.replace({"simulation.rtol": 1e-11, "simulation.atol": 1e-13}))
    points: Points = {}
    for name, (tolerances, repeats) in TOLERANCES.items():
        runs = [{"simulation.integrator": name, "simulation.rtol": r, "simulation.atol": r / 100} for r in tolerances]
        points[name] = [_point(config.replace(changes), right, repeats) for changes in runs]
    runs = [{"simulation.integrator": "rk4", "simulation.step": step} for step in STEPS]
    points["rk4"] = [_point(config.replace(changes), right, 5) for changes in runs]
    usual = points["stretched-rk43"][TOLERANCES["stretched-rk43"][0].index(config.simulation.rtol)]
    figures = {"paper's 10 s, error of the loads": (usual[1], "% of the peak")}
    for name, found in points.items():
        fast = [seconds for seconds, error in found if error < WANTED]
        if fast:
            figures[f"paper's 10 s to {WANTED} % of the peak load, {name}"] = (1e3 * min(fast), "ms")
    return figures, points


def _point(config: Config, right: Trajectory, repeats: int) -> tuple[float, float]:
    simulate(config)
    runs = [simulate(config) for _ in range(repeats)]
    off = np.sqrt(np.mean((runs[0].normal_load - right.normal_load) ** 2, axis=0)).max()
    return median(run.statistics.seconds for run in runs), 100 * float(off / right.normal_load.max())


def draw(points: Points, machine: str) -> None:
    """The points as a picture for the README."""
    figure = Figure(figsize=(7, 4.2), dpi=150, layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    for name, found in points.items():
        seconds, errors = zip(*found, strict=True)
        own = name in ("stretched-rk43", "dormand-prince", "rk4")
        axes.loglog(1e3 * np.array(seconds), errors, "o-" if own else "s--", label=name, alpha=1 if own else 0.6)
    axes.axhline(WANTED, color="0.6", linewidth=0.8, linestyle=":")
    axes.set(xlabel="Time for the paper's 10 s, ms", ylabel="Error of the loads, % of the peak")
    axes.set_title(f"Work and precision, {machine}", fontsize=9)
    axes.grid(alpha=0.3)
    axes.legend(fontsize=8)
    figure.savefig(PICTURE)
