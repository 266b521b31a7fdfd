"""Shared by all tests: the reference cases of the independent engine, and who runs what when two processes do."""

from __future__ import annotations

import os
import resource
import signal
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from typing import Any

import pytest
from xdist.scheduler import LoadScopeScheduling

# Read when NumPy is first imported: its threads make small matrices on a busy machine several times slower.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

# Whoever starts the tests in the background has their children ignore interrupts, some of which must end by one.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

REFERENCE = Path(__file__).parent / "reference"
ATTACK = Path(__file__).parent / "attack"  # configurations found at random that once came to grief
REFERENCE_CASES = sorted(path.stem for path in REFERENCE.glob("*.yaml"))


@pytest.fixture
def full_disk() -> Callable[[], AbstractContextManager[None]]:
    """While it is entered, no file can grow beyond 4 kB."""

    @contextmanager
    def limited() -> Iterator[None]:
        before = resource.getrlimit(resource.RLIMIT_FSIZE)
        resource.setrlimit(resource.RLIMIT_FSIZE, (4096, before[1]))
        try:
            yield
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, before)

    return limited


class BrowserApart(LoadScopeScheduling):
    """One process has all tests of the browser: they share one explorer and one tab. They come first, as the largest
    group; the other process takes the rest, one by one, and whoever is done helps."""

    def _split_scope(self, nodeid: str) -> str:
        return "browser" if nodeid.startswith("tests/browser/") else nodeid


def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> BrowserApart:
    """Asked for by pytest-xdist. Its own --dist loadgroup finds no groups: xdist 3.8 writes them where pytest 9.2 no
    longer reads them."""
    return BrowserApart(config, log)
