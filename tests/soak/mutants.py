"""Small faults put into force laws, checks and figures, one at a time: the tests must notice each.

`python -m tests.soak.mutants` tries all in a copy of the tree and writes what came of it to MUTANTS.txt. A mutant is
tried on the tests of its own file: LAWS run as plain Python, since compiling them takes a minute each time.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import date
from pathlib import Path
from time import perf_counter

ROOT = Path(__file__).parents[2]
REPORT = Path(__file__).with_name("MUTANTS.txt")
LEFT_OUT = shutil.ignore_patterns(".git", ".venv", "build", "__pycache__", "*.egg-info")
LONGEST = 900.0  # s for the tests of one mutant


@dataclass(frozen=True)
class Mutant:
    """One fault."""

    file: str
    old: str  # stands there once
    new: str


GROUND, SUSPENSION = "model/dynamics/ground.py", "model/dynamics/suspension.py"
VALIDATION, COMFORT = "model/config/validation.py", "model/analysis/comfort.py"
SIGNALS, RIDE, FIGURES = "model/analysis/signals.py", "model/analysis/ride.py", "model/analysis/figures.py"
TRAJECTORY = "model/simulation/trajectory.py"
LAWS = (GROUND, SUSPENSION)
TESTS = {
    GROUND: ("tests/model/dynamics/test_ground.py",),
    SUSPENSION: ("tests/model/dynamics/test_suspension.py",),
    VALIDATION: ("tests/model/config/test_validation.py", "tests/model/config/test_config.py"),
    COMFORT: ("tests/model/analysis/test_comfort.py",),
    SIGNALS: tuple(f"tests/model/analysis/test_{name}.py" for name in ("signals", "comfort", "ride")),
    RIDE: ("tests/model/analysis/test_ride.py", "tests/model/analysis/test_figures.py"),
    FIGURES: ("tests/model/analysis/test_figures.py",),
    TRAJECTORY: ("tests/model/simulation/test_trajectory.py",),
}

MUTANTS = (
    Mutant(GROUND, "z = max(z, 0.0)", "z = abs(z)"),
    Mutant(GROUND, "max(z * z * (ground.k_n + ground.c_n * z_dot), 0.0)", "z * z * (ground.k_n + ground.c_n * z_dot)"),
    Mutant(
        GROUND, "max(z * z * (ground.k_n + ground.c_n * z_dot), 0.0)", "max(z * (ground.k_n + ground.c_n * z_dot), 0.0)"
    ),
    Mutant(GROUND, "ground.k_n + ground.c_n * z_dot", "ground.k_n - ground.c_n * z_dot"),
    Mutant(GROUND, "limit = ground.mu * f_n", "limit = 2.0 * ground.mu * f_n"),
    Mutant(
        GROUND, "-(ground.k_t * xi + ground.c_t * p_dot), -limit", "-(ground.k_t * xi - ground.c_t * p_dot), -limit"
    ),
    Mutant(
        GROUND,
        "xi_dot = -(ground.k_t * xi + f_t) / ground.c_t\n    return f_n",
        "xi_dot = -(ground.k_t * xi) / ground.c_t\n    return f_n",
    ),
    Mutant(GROUND, "ground.k_n / 3 * z**3", "ground.k_n / 2 * z**3"),
    Mutant(GROUND, "stiffness=2 * ground.k_n * z", "stiffness=ground.k_n * z"),
    Mutant(GROUND, "np.sqrt(load / ground.k_n)", "load / ground.k_n"),
    Mutant(GROUND, "ground.k_t / 2 * xi**2", "ground.k_t * xi**2"),
    Mutant(GROUND, "friction=-f_t * (p_dot - xi_dot)", "friction=-f_t * p_dot"),
    Mutant(SUSPENSION, "tau = k * p * u * u * u", "tau = k * p * u * u"),
    Mutant(SUSPENSION, "(c_rebound - c) * min(u_dot, 0.0)", "(c_rebound - c) * max(u_dot, 0.0)"),
    Mutant(
        SUSPENSION,
        "max(0.0, stops.k * (u - stops.bump) + stops.c * u_dot)",
        "stops.k * (u - stops.bump) + stops.c * u_dot",
    ),
    Mutant(SUSPENSION, "elif u < stops.rebound:", "elif u < stops.bump:"),
    Mutant(SUSPENSION, "k * u**2 * (1 / 2 + p * u**2 / 4)", "k * u**2 * (1 / 2 + p * u**2 / 3)"),
    Mutant(SUSPENSION, "k * (1 + 3 * p * u**2) + stop", "k * (1 + p * u**2) + stop"),
    Mutant(SUSPENSION, "system.tau_0 * u + stop * over**2 / 2", "system.tau_0 * u + stop * over**2"),
    Mutant(SUSPENSION, "push * over > 0.0", "push > 0.0"),
    Mutant(VALIDATION, "if front > 0 > rear:", "if front > 0:"),
    Mutant(VALIDATION, "len(value) != wheels:", "len(value) > wheels:"),
    Mutant(
        VALIDATION,
        "length * (1 + math.sin(math.radians(angle_deg)))",
        "length * (1 - math.sin(math.radians(angle_deg)))",
    ),
    Mutant(VALIDATION, "output_rate * duration <= SAMPLE_LIMIT", "output_rate <= SAMPLE_LIMIT"),
    Mutant(VALIDATION, "duration / step <= STEP_LIMIT", "step <= STEP_LIMIT"),
    Mutant(VALIDATION, "if amplitude <= wavelength:", "if amplitude >= wavelength:"),
    Mutant(VALIDATION, "start is None or start >= front", "start is None or start >= -front"),
    Mutant(VALIDATION, "return None if height <= radius", "return None if height <= 2 * radius"),
    Mutant(VALIDATION, "return None if top <= base", "return None if top <= 2 * base"),
    Mutant(VALIDATION, "math.sqrt(height * (2 * radius - height))", "height"),
    Mutant(
        VALIDATION,
        "if not parameter.low <= number <= parameter.high:",
        "if number < parameter.low or number > parameter.high:",
    ),
    Mutant(
        VALIDATION,
        "isinstance(value, bool) or not isinstance(value, numbers.Real | str)",
        "not isinstance(value, numbers.Real | str)",
    ),
    Mutant(VALIDATION, "if number.is_integer():", "if number == number:"),
    Mutant(VALIDATION, "if np.abs(under).max() <= LEVEL:", "if np.abs(under).min() <= LEVEL:"),
    Mutant(COMFORT, "output_rate < LEAST_RATE:", "output_rate < LEAST_RATE / 2:"),
    Mutant(COMFORT, "(s + 63) * (s**2 + 24 * s + 750)", "(s + 63) * (s**2 + 24 * s + 650)"),
    Mutant(COMFORT, "(np.sum(self._energy**2) / self._rate) ** 0.25", "(np.sum(self._energy) / self._rate) ** 0.5"),
    Mutant(COMFORT, "np.abs(self._felt).max()) / self.vertical", "self._felt.max()) / self.vertical"),
    Mutant(COMFORT, "SHOCK_LIMIT = 30.0", "SHOCK_LIMIT = 60.0"),
    Mutant(COMFORT, "RUNNING = 1.0", "RUNNING = 2.0"),
    Mutant(COMFORT, "(0.4, 100.0, transition)", "(0.8, 100.0, transition)"),
    Mutant(SIGNALS, "along - growth * r_y - square * r_x", "along - growth * r_y + square * r_x"),
    Mutant(SIGNALS, "SETTLED = 1e-3", "SETTLED = 1e-1"),
    Mutant(SIGNALS, "wheels.max(axis=1) + system.r >= uneven[0]", "wheels.max(axis=1) - system.r >= uneven[0]"),
    Mutant(RIDE, "load.std(axis=0) / np.where(static_load > 0", "load.std(axis=0) * np.where(static_load > 0"),
    Mutant(RIDE, "np.mean(share[grounded])", "np.mean(share)"),
    Mutant(FIGURES, "of.travel_up - of.travel_down", "of.travel_up + of.travel_down"),
    Mutant(FIGURES, "100 * (value / reference - 1)", "100 * value / reference"),
    Mutant(FIGURES, "max(wheels.values(), default=None)", "min(wheels.values(), default=None)"),
    Mutant(TRAJECTORY, "gained = kinetic + gravity - self.work", "gained = kinetic + gravity"),
)


def passes(file: str, copy: Path) -> bool:
    """Whether the tests of a file of the tree pass in a copy."""
    command = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", *TESTS[file]]
    # A fault may be as long as what it replaces, and be written in the same second: no compiled Python is kept
    settings = os.environ | {"PYTHONDONTWRITEBYTECODE": "1"} | ({"NUMBA_DISABLE_JIT": "1"} if file in LAWS else {})
    return subprocess.run(command, cwd=copy, env=settings, capture_output=True, timeout=LONGEST).returncode == 0


def alive(mutant: Mutant, copy: Path) -> bool:
    """Whether all tests pass with the mutant in a copy of the tree, which is as before afterwards."""
    path = copy / mutant.file
    text = path.read_text()
    path.write_text(text.replace(mutant.old, mutant.new))
    try:
        return passes(mutant.file, copy)
    finally:
        path.write_text(text)


def report(living: Sequence[Mutant], seconds: float) -> str:
    """What came of it, in Markdown."""
    commit = subprocess.run(["git", "rev-parse", "--short", "HEAD"], capture_output=True, text=True).stdout.strip()
    count = Counter(mutant.file for mutant in MUTANTS)
    lives = Counter(mutant.file for mutant in living)
    rows = [f"| {file} | {count[file]} | {count[file] - lives[file]} | {' '.join(TESTS[file])} |" for file in TESTS]
    head = (
        f"# Mutants\n\nWritten by `python -m tests.soak.mutants` on {date.today()} at {commit or 'no commit'}. "
        f"{len(MUTANTS) - len(living)} of {len(MUTANTS)} faults are caught; {seconds / 60:.0f} minutes.\n\n"
        "| File | Faults | Caught | By |\n| --- | --- | --- | --- |\n"
    )
    return head + "\n".join(rows + [f"\nLives: {one.file}: `{one.old}` -> `{one.new}`" for one in living]) + "\n"


def main() -> int:
    began = perf_counter()
    living: list[Mutant] = []
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / "tree"
        shutil.copytree(ROOT, copy, ignore=LEFT_OUT)
        subprocess.run([sys.executable, "-c", "from app.server import prepare; prepare()"], cwd=copy, check=True)
        for file in TESTS:
            if not passes(file, copy):
                print(f"The tests of {file} fail without any fault.")
                return 2
            for mutant in (one for one in MUTANTS if one.file == file):
                lives = alive(mutant, copy)
                living.extend([mutant] * lives)
                print(f"{'LIVES ' if lives else 'caught'} {file}: {mutant.old!r} -> {mutant.new!r}", flush=True)
    REPORT.write_text(report(living, perf_counter() - began))
    print(f"{len(living)} of {len(MUTANTS)} live")
    return int(bool(living))


if __name__ == "__main__":
    sys.exit(main())
