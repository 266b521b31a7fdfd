"""Commands as a shell starts them."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

PROGRESS = re.compile(r"^.*: \d+ of \d+ runs, .* left\n", re.MULTILINE)  # told where a machine is slow
ROOT = Path(__file__).parents[3]


def started(*arguments: object, folder: Path) -> subprocess.Popen[str]:
    """A command under way in a folder."""
    return subprocess.Popen(
        [sys.executable, "-m", "app", *map(str, arguments)],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def done(*arguments: object, folder: Path) -> tuple[int, str, str]:
    """Exit status, standard output and standard error of a command, but for its progress."""
    process = started(*arguments, folder=folder)
    told, said = process.communicate(timeout=120)
    return process.returncode, told, PROGRESS.sub("", said)
