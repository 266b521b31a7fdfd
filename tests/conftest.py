"""Shared by all tests: the reference cases of the independent engine."""

from __future__ import annotations

import os
from pathlib import Path

# Read when NumPy is first imported: its threads make small matrices on a busy machine several times slower.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

REFERENCE = Path(__file__).parent / "reference"
REFERENCE_CASES = sorted(path.stem for path in REFERENCE.glob("*.yaml"))
