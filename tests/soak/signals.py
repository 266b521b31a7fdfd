"""Programs are interrupted and killed at any moment: files are whole or as before, and Ctrl+C ends within 2 s."""

from __future__ import annotations

import signal
import subprocess
import sys
import tempfile
import time
from functools import partial
from pathlib import Path

import numpy as np

from model.simulation.trajectory import Trajectory
from tests.soak.outcome import Outcome

INTERRUPTED = 130
SOON = 2.0  # s in which Ctrl+C ends the explorer…
BUSY = 3.0  # … times this, where the machine computes something else beside
LONG = "simulation.duration=20"  # s: a run that takes long enough to be interrupted, and a file to be written


def interruptions(count: int, seed: int = 0, busy: float = BUSY) -> Outcome:
    """A third each: kill -9 while a run is computed or written, Ctrl+C then, Ctrl+C while the explorer starts.

    busy: how many times longer than promised the explorer may take to end.
    """
    outcome = Outcome("Ctrl+C and kill -9", f"{count} programs, seed {seed}.")
    rng = np.random.default_rng(seed)
    checks = _killed, _interrupted, partial(_explorer, busy)
    with tempfile.TemporaryDirectory() as folder:
        for number in range(count):
            ending, fault = checks[number % 3](Path(folder), rng)
            if fault:
                outcome.faults.append(f"{number}: {fault}")
            else:
                outcome.endings[ending] += 1
    return outcome


def _started(*arguments: str) -> subprocess.Popen[bytes]:
    return subprocess.Popen(
        [sys.executable, "-m", "app", *arguments], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )


def _killed(folder: Path, rng: np.random.Generator) -> tuple[str, str]:
    out = folder / "killed.npz"
    with _started("run", "half_round", "--set", LONG, "--out", str(out)) as process:
        time.sleep(rng.uniform(0.5, 4.0))
        process.kill()
    return "killed: file " + ("there" if out.exists() else "not there"), _not_whole(out)


def _interrupted(folder: Path, rng: np.random.Generator) -> tuple[str, str]:
    out = folder / "interrupted.npz"
    out.unlink(missing_ok=True)
    with _started("run", "half_round", "--set", LONG, "--out", str(out)) as process:
        time.sleep(rng.uniform(0.5, 4.0))
        process.send_signal(signal.SIGINT)
        status = process.wait(60)
    left = [path.name for path in folder.iterdir() if path.name.startswith(".interrupted")]
    if status not in (0, INTERRUPTED, -signal.SIGINT) or left:
        return "", f"Ctrl+C: exit status {status}, left {left}"
    return f"Ctrl+C: exit status {status}, file {'there' if out.exists() else 'not there'}", _not_whole(out)


def _explorer(busy: float, folder: Path, rng: np.random.Generator) -> tuple[str, str]:
    with _started("explore", "--no-browser", "--port", "0") as process:
        time.sleep(rng.uniform(0.0, 4.0))
        process.send_signal(signal.SIGINT)
        began = time.monotonic()
        try:
            process.wait(3 * busy * SOON)
        except subprocess.TimeoutExpired:
            process.kill()
            return "", "explore: Ctrl+C was lost"
    took = time.monotonic() - began
    return "explore: ended", f"explore: Ctrl+C took {took:.1f} s" if took > busy * SOON else ""


def _not_whole(out: Path) -> str:
    if out.exists():
        try:
            Trajectory.load(out)
        except Exception as error:
            return f"the file is not whole: {error}"
    return ""
