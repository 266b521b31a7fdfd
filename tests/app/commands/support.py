"""Commands as a shell starts them, or in the process of the tests, which saves the seconds that a start takes."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from contextlib import chdir
from pathlib import Path

from typer.testing import CliRunner

from app import cli

PROGRESS = re.compile(r"^.*: \d+ of \d+ runs, .* left\n", re.MULTILINE)  # told where a machine is slow
ROOT = Path(__file__).parents[3]
PATIENCE = 240.0  # s for a command, on a busy machine


def waiting(runs: int) -> str:
    """Code after which a process does so many runs and waits with others for a file `go`: so no study ends too soon."""
    return f"""
import itertools, pathlib, time
from model.study import running
simulate, count = running.simulate, itertools.count()
def waiting(*args, **options):
    if next(count) >= {runs}:
        while not pathlib.Path("go").exists():
            time.sleep(0.01)
    return simulate(*args, **options)
running.simulate = waiting
"""


def started(*arguments: object, folder: Path, program: tuple[str, ...] = ("-m", "app")) -> subprocess.Popen[str]:
    """A command under way in a folder; program: what Python is to run in place of Trackride itself."""
    return subprocess.Popen(
        [sys.executable, *program, *map(str, arguments)],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def done(*arguments: object, folder: Path) -> tuple[int, str, str]:
    """Exit status, standard output and standard error of a command, but for its progress."""
    process = started(*arguments, folder=folder)
    told, said = process.communicate(timeout=PATIENCE)
    return process.returncode, told, PROGRESS.sub("", said)


def done_here(*arguments: object, folder: Path) -> tuple[int, str, str]:
    """As `done`, in this process."""
    with chdir(folder):
        result = CliRunner().invoke(cli.cli, [*map(str, arguments)])
    return result.exit_code, result.stdout, PROGRESS.sub("", result.stderr)
