"""The explorer with many tabs that come, drag and go, and a drive at eight times real time."""

from __future__ import annotations

import re
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tests.app.conftest import Tab
from tests.benchmarks.drive import measure
from tests.soak.outcome import Outcome, memory_of

START = 120.0  # s until a server listens on a machine that has to compile first
SOON = 20.0  # s in which a tab is answered, however busy the machine is
BETWEEN = 0.05  # s between two messages of a drag
GIVEN_BACK = 60.0  # s within which memory comes back
GROWTH = 200.0  # MB by which a server may have grown after all tabs are gone
DRIFT, DRIVE_GROWTH = 1000.0, 50.0  # µm; MB


@dataclass(frozen=True)
class Server:
    """An explorer in a process of its own, for raw-socket tabs."""

    process: subprocess.Popen[str]
    address: str
    errors: Path

    @property
    def memory(self) -> float:
        """MB."""
        return memory_of(self.process.pid)

    def said(self) -> str:
        """The last error that it printed; empty: none."""
        text = self.errors.read_text()
        return text[text.rfind("Traceback") :][-300:] if "Traceback" in text else ""


@contextmanager
def serving() -> Iterator[Server]:
    """A server of the paper's vehicle; it is ended by Ctrl+C."""
    with tempfile.TemporaryDirectory() as folder, open(Path(folder) / "errors", "w+") as errors:
        command = [sys.executable, "-m", "app", "explore", "--no-browser", "--port", "0"]
        with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=errors, text=True) as process:
            assert process.stdout is not None
            address = next(filter(None, (re.search(r"http://\S+", line) for line in process.stdout))).group()
            try:
                yield Server(process, address, Path(errors.name))
            finally:
                process.send_signal(signal.SIGINT)
                process.wait(START)


def connects(count: int, seed: int = 0) -> Outcome:
    """Tabs that open, move a slider and are gone, at any moment of their first second; one stays and is answered."""
    outcome = Outcome("Tabs that come and go", f"{count} tabs, one after the other, seed {seed}.")
    rng = np.random.default_rng(seed)
    with serving() as server:
        stays = _tab(server)
        _wait_for_run(stays)
        before = server.memory
        for number in range(count):
            tab = _tab(server)
            end = time.monotonic() + rng.exponential(0.2)
            while time.monotonic() < end:
                if "Speed, km/h" in _labels(tab):
                    tab.use("Speed, km/h", float(rng.uniform(5, 60)))
                time.sleep(BETWEEN)
            tab.close()
            outcome.endings["came and went"] += 1
            if number % 50 == 49 and not _answers(stays, 20.0 + number / 100):
                outcome.faults.append(f"after {number + 1} tabs the one that stays is not answered")
        _memory_comes_back(server, before, outcome)
        stays.close()
        outcome.faults += [said] if (said := server.said()) else []
    return outcome


def dragging(seconds: float, tabs: int = 8, seed: int = 0) -> Outcome:
    """So many tabs drag the speed at once; all end at the run of their last value, and memory comes back."""
    outcome = Outcome("Tabs dragging at once", f"{tabs} tabs drag for {seconds:.0f} s, seed {seed}.")
    rng = np.random.default_rng(seed)
    with serving() as server:
        stays = _tab(server)
        _wait_for_run(stays)
        before = server.memory
        dragged = [_tab(server) for _ in range(tabs)]
        for tab in dragged:
            _wait_for_run(tab)
        end, speed = time.monotonic() + seconds, np.full(tabs, 20.0)
        while time.monotonic() < end:
            speed = np.clip(speed + rng.normal(0.0, 0.5, tabs), 5.0, 60.0).round(1)
            for tab, value in zip(dragged, speed, strict=True):
                tab.use("Speed, km/h", float(value))
                tab.messages.clear()
                outcome.endings["moves of a slider"] += 1
            time.sleep(BETWEEN)
        outcome.notes.append(f"Memory: {before:.0f} MB with one tab, {server.memory:.0f} MB at the end of the drag.")
        for number, tab in enumerate(dragged):
            if not _answers(tab, 33.0 + number):
                outcome.faults.append(f"tab {number} is not answered after the drag")
            tab.close()
        _memory_comes_back(server, before, outcome)
        stays.close()
        outcome.faults += [said] if (said := server.said()) else []
    return outcome


def driving(seconds: float) -> Outcome:
    """Drive at eight times real time, its frames as fast as they can be computed."""
    outcome = Outcome("Drive at eight times real time", f"{seconds / 60:.0f} minutes of frames.")
    figures = measure(seconds)
    outcome.notes += [f"{name}: {value:.4g} {unit}".strip() for name, (value, unit) in figures.items()]
    if figures["joints apart at worst"][0] > DRIFT:
        outcome.faults.append("joints came apart")
    if figures["memory at the end"][0] > figures["memory after the first minute"][0] + DRIVE_GROWTH:
        outcome.faults.append("memory grew")
    return outcome


def _tab(server: Server) -> Tab:
    return Tab(server)  # type: ignore[arg-type]  # it needs no more than the address


def _wait_for_run(tab: Tab) -> None:
    assert _until(lambda: tab.shows_run(1), START), "the first run did not come"


def _until(condition: Callable[[], bool], seconds: float) -> bool:
    """Whether it comes true within so long."""
    end = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > end:
            return False
        time.sleep(0.01)
    return True


def _labels(tab: Tab) -> set[str]:
    return {(w["props"].get("label") or "").replace("\u00a0", " ") for w in tuple(tab.widgets.values())}


def _answers(tab: Tab, speed: float) -> bool:
    """Whether a move of the speed's slider leads to a new run."""
    before = tab.status
    tab.use("Speed, km/h", speed)
    return _until(lambda: tab.status != before and " in " in tab.status, SOON)


def _memory_comes_back(server: Server, before: float, outcome: Outcome) -> None:
    back = _until(lambda: server.memory < before + GROWTH, GIVEN_BACK)
    outcome.notes.append(f"Memory: {before:.0f} MB before, {server.memory:.0f} MB when all others were gone.")
    if not back:
        outcome.faults.append(f"{server.memory - before:.0f} MB have not come back after {GIVEN_BACK:.0f} s")
