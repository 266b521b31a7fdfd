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
from hypothesis import settings
from xdist.scheduler import LoadScopeScheduling

# Read when NumPy is first imported: its threads make small matrices on a busy machine several times slower.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

# Whoever starts the tests in the background has their children ignore interrupts, some of which must end by one.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

# A suite that passes passes again: looking for what nobody has thought of is the soak's.
settings.register_profile("same every time", derandomize=True)
settings.load_profile("same every time")

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


# Their tests take seconds, and those of a file share what took as long to make: each file is one process's.
LONG = "tests/app/commands/", "tests/app/reports/", "tests/soak/"


class BrowserApart(LoadScopeScheduling):
    """One process has all tests of the browser: they share one explorer and one tab. They come first, as the largest
    group, then the files with long tests; the other process takes the rest, one by one, and whoever is done helps."""

    def _split_scope(self, nodeid: str) -> str:
        if nodeid.startswith("tests/browser/"):
            return "browser"
        return nodeid.partition("::")[0] if nodeid.startswith(LONG) else nodeid


def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> BrowserApart:
    """Asked for by pytest-xdist. Its own --dist loadgroup finds no groups: xdist 3.8 writes them where pytest 9.2 no
    longer reads them."""
    return BrowserApart(config, log)
