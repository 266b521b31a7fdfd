"""Shared by all tests: the reference cases of the independent engine, and who runs what when two processes do."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import pytest
from xdist.scheduler import LoadScopeScheduling

# Read when NumPy is first imported: its threads make small matrices on a busy machine several times slower.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

REFERENCE = Path(__file__).parent / "reference"
ATTACK = Path(__file__).parent / "attack"  # configurations found at random that once came to grief
REFERENCE_CASES = sorted(path.stem for path in REFERENCE.glob("*.yaml"))


class BrowserApart(LoadScopeScheduling):
    """One process has all tests of the browser: they share one explorer and one tab. They come first, as the largest
    group; the other process takes the rest, one by one, and whoever is done helps."""

    def _split_scope(self, nodeid: str) -> str:
        return "browser" if nodeid.startswith("tests/browser/") else nodeid


def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> BrowserApart:
    """Asked for by pytest-xdist. Its own --dist loadgroup finds no groups: xdist 3.8 writes them where pytest 9.2 no
    longer reads them."""
    return BrowserApart(config, log)
