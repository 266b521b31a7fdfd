"""Small faults put into force laws, checks and figures, one at a time: the tests must notice each.

`python -m tests.soak.mutants` tries all in copies of the tree (half an hour, since force laws are compiled anew each
time) and prints those that live. A mutant names the tests that are to notice it.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from queue import Queue

ROOT = Path(__file__).parents[2]
WORKERS = 2
LEFT_OUT = shutil.ignore_patterns(".git", ".venv", "build", "__pycache__", "*.egg-info")
LONGEST = 900.0  # s for the tests of one mutant


@dataclass(frozen=True)
class Mutant:
    """One fault."""

    file: str
    old: str  # stands there once
    new: str
    tests: tuple[str, ...]


GROUND, SUSPENSION = "model/dynamics/ground.py", "model/dynamics/suspension.py"
VALIDATION, COMFORT = "model/config/validation.py", "model/analysis/comfort.py"
SIGNALS, RIDE, FIGURES = "model/analysis/signals.py", "model/analysis/ride.py", "model/analysis/figures.py"
TRAJECTORY = "model/simulation/trajectory.py"
LAWS = ("tests/model/dynamics", "tests/model/simulation/test_reference.py")
CHECKS = ("tests/model/config",)
RIDES = ("tests/model/analysis", "tests/model/simulation/test_trajectory.py")

MUTANTS = (
    Mutant(GROUND, "z = max(z, 0.0)", "z = abs(z)", LAWS),
    Mutant(
        GROUND, "max(z * z * (ground.k_n + ground.c_n * z_dot), 0.0)", "z * z * (ground.k_n + ground.c_n * z_dot)", LAWS
    ),
    Mutant(
        GROUND,
        "max(z * z * (ground.k_n + ground.c_n * z_dot), 0.0)",
        "max(z * (ground.k_n + ground.c_n * z_dot), 0.0)",
        LAWS,
    ),
    Mutant(GROUND, "ground.k_n + ground.c_n * z_dot", "ground.k_n - ground.c_n * z_dot", LAWS),
    Mutant(GROUND, "limit = ground.mu * f_n", "limit = 2.0 * ground.mu * f_n", LAWS),
    Mutant(
        GROUND,
        "-(ground.k_t * xi + ground.c_t * p_dot), -limit",
        "-(ground.k_t * xi - ground.c_t * p_dot), -limit",
        LAWS,
    ),
    Mutant(
        GROUND,
        "xi_dot = -(ground.k_t * xi + f_t) / ground.c_t\n    return f_n",
        "xi_dot = -(ground.k_t * xi) / ground.c_t\n    return f_n",
        LAWS,
    ),
    Mutant(GROUND, "ground.k_n / 3 * z**3", "ground.k_n / 2 * z**3", LAWS),
    Mutant(GROUND, "stiffness=2 * ground.k_n * z", "stiffness=ground.k_n * z", LAWS),
    Mutant(GROUND, "np.sqrt(load / ground.k_n)", "load / ground.k_n", LAWS),
    Mutant(GROUND, "ground.k_t / 2 * xi**2", "ground.k_t * xi**2", LAWS),
    Mutant(GROUND, "friction=-f_t * (p_dot - xi_dot)", "friction=-f_t * p_dot", (*LAWS, *RIDES)),
    Mutant(SUSPENSION, "tau = k * p * u * u * u", "tau = k * p * u * u", LAWS),
    Mutant(SUSPENSION, "(c_rebound - c) * min(u_dot, 0.0)", "(c_rebound - c) * max(u_dot, 0.0)", LAWS),
    Mutant(
        SUSPENSION,
        "max(0.0, stops.k * (u - stops.bump) + stops.c * u_dot)",
        "stops.k * (u - stops.bump) + stops.c * u_dot",
        LAWS,
    ),
    Mutant(SUSPENSION, "elif u < stops.rebound:", "elif u < stops.bump:", LAWS),
    Mutant(SUSPENSION, "k * u**2 * (1 / 2 + p * u**2 / 4)", "k * u**2 * (1 / 2 + p * u**2 / 3)", LAWS),
    Mutant(SUSPENSION, "k * (1 + 3 * p * u**2) + stop", "k * (1 + p * u**2) + stop", LAWS),
    Mutant(SUSPENSION, "system.tau_0 * u + stop * over**2 / 2", "system.tau_0 * u + stop * over**2", LAWS),
    Mutant(SUSPENSION, "push * over > 0.0", "push > 0.0", LAWS),
    Mutant(VALIDATION, "if front > 0 > rear:", "if front > 0:", CHECKS),
    Mutant(VALIDATION, "len(value) != wheels:", "len(value) > wheels:", CHECKS),
    Mutant(
        VALIDATION,
        "length * (1 + math.sin(math.radians(angle_deg)))",
        "length * (1 - math.sin(math.radians(angle_deg)))",
        CHECKS,
    ),
    Mutant(VALIDATION, "output_rate * duration <= SAMPLE_LIMIT", "output_rate <= SAMPLE_LIMIT", CHECKS),
    Mutant(VALIDATION, "duration / step <= STEP_LIMIT", "step <= STEP_LIMIT", CHECKS),
    Mutant(VALIDATION, "if amplitude <= wavelength:", "if amplitude >= wavelength:", CHECKS),
    Mutant(VALIDATION, "start is None or start >= front", "start is None or start >= -front", CHECKS),
    Mutant(VALIDATION, "return None if height <= radius", "return None if height <= 2 * radius", CHECKS),
    Mutant(VALIDATION, "return None if top <= base", "return None if top <= 2 * base", CHECKS),
    Mutant(VALIDATION, "math.sqrt(height * (2 * radius - height))", "height", CHECKS),
    Mutant(
        VALIDATION,
        "if not parameter.low <= number <= parameter.high:",
        "if number < parameter.low or number > parameter.high:",
        CHECKS,
    ),
    Mutant(
        VALIDATION,
        "isinstance(value, bool) or not isinstance(value, numbers.Real | str)",
        "not isinstance(value, numbers.Real | str)",
        CHECKS,
    ),
    Mutant(VALIDATION, "if number.is_integer():", "if number == number:", CHECKS),
    Mutant(VALIDATION, "if np.abs(under).max() <= LEVEL:", "if np.abs(under).min() <= LEVEL:", CHECKS),
    Mutant(COMFORT, "if rate < LEAST_RATE:", "if rate < LEAST_RATE / 2:", RIDES),
    Mutant(COMFORT, "(s + 63) * (s**2 + 24 * s + 750)", "(s + 63) * (s**2 + 24 * s + 650)", RIDES),
    Mutant(COMFORT, "np.sum(felt**4) / rate) ** 0.25", "np.sum(felt**2) / rate) ** 0.5", RIDES),
    Mutant(COMFORT, "np.abs(felt).max()) / rms", "felt.max()) / rms", RIDES),
    Mutant(COMFORT, "SHOCK_LIMIT = 30.0", "SHOCK_LIMIT = 60.0", RIDES),
    Mutant(COMFORT, "RUNNING = 1.0", "RUNNING = 2.0", RIDES),
    Mutant(COMFORT, "(0.4, 100.0, transition)", "(0.8, 100.0, transition)", RIDES),
    Mutant(SIGNALS, "-growth * r_y - rate**2 * r_x", "-growth * r_y + rate**2 * r_x", RIDES),
    Mutant(SIGNALS, "SETTLED = 1e-3", "SETTLED = 1e-1", RIDES),
    Mutant(SIGNALS, "wheels.max(axis=1) + system.r >= uneven[0]", "wheels.max(axis=1) - system.r >= uneven[0]", RIDES),
    Mutant(RIDE, "load.std(axis=0) / np.where(static_load > 0", "load.std(axis=0) * np.where(static_load > 0", RIDES),
    Mutant(RIDE, "np.mean(share[grounded])", "np.mean(share)", RIDES),
    Mutant(FIGURES, "of.travel_up - of.travel_down", "of.travel_up + of.travel_down", RIDES),
    Mutant(FIGURES, "100 * (value / reference - 1)", "100 * value / reference", RIDES),
    Mutant(FIGURES, "max(wheels, default=None)", "min(wheels, default=None)", RIDES),
    Mutant(TRAJECTORY, "gained = kinetic + gravity - self.work", "gained = kinetic + gravity", RIDES),
)


def alive(mutant: Mutant, copy: Path) -> bool:
    """Whether all tests pass with the mutant in a copy of the tree, which is as before afterwards.

    Raises ValueError where the mutant's text does not stand once in its file.
    """
    path = copy / mutant.file
    text = path.read_text()
    if text.count(mutant.old) != 1:
        raise ValueError(f"{mutant.file} has {mutant.old!r} {text.count(mutant.old)} times, not once")
    command = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", *mutant.tests]
    path.write_text(text.replace(mutant.old, mutant.new))
    try:
        return subprocess.run(command, cwd=copy, capture_output=True, timeout=LONGEST).returncode == 0
    finally:
        path.write_text(text)


def main() -> int:
    living: list[Mutant] = []
    copies: Queue[Path] = Queue()

    def tried(mutant: Mutant) -> None:
        copy = copies.get()
        lives = alive(mutant, copy)
        copies.put(copy)
        living.extend([mutant] * lives)
        print(f"{'LIVES ' if lives else 'caught'} {mutant.file}: {mutant.old!r} -> {mutant.new!r}", flush=True)

    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(WORKERS) as pool:
        for number in range(WORKERS):
            copies.put(Path(folder) / str(number))
            shutil.copytree(ROOT, Path(folder) / str(number), ignore=LEFT_OUT)
        list(pool.map(tried, MUTANTS))
    print(f"{len(living)} of {len(MUTANTS)} live")
    return int(bool(living))


if __name__ == "__main__":
    sys.exit(main())
