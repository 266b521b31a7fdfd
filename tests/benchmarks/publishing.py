"""What a run, and a frame of its playback, cost in Python until they are on their way to the page, without a browser.

A drag: a row of runs that are there at once, each shown while the 3-D view plays. Times are of the processor, and of
the thread that draws alone: others that compute meanwhile do not count.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from functools import cache
from statistics import median, quantiles
from typing import Any

from app.panels.plot_panel import PlotPanel
from app.server import Explorer
from app.session.session import Session
from app.view3d.view import View3D
from model import load_config, simulate
from model.config.config import Config
from model.simulation.trajectory import Trajectory
from tests.app.conftest import Tab, wait_for

RUNS = 60
BETWEEN = 0.06  # s: about as often as a dragged slider sends
STEP = 0.5  # km/h
KINDS = 10  # different runs, again and again
REST = 2.0  # s after the drag, in which the tabs behind follow


@cache
def _run_of(config: Config) -> Trajectory:
    run = simulate(config)
    _ = run.system
    return run


def ready(config: Config, **_: Any) -> Trajectory:
    """A run that has been computed before."""
    return _run_of(config)


@contextmanager
def timed(owner: type, name: str, into: list[float]) -> Iterator[None]:
    """Notes how long each call of a method keeps its thread busy, ms."""
    method = getattr(owner, name)

    def timing(self: Any, *args: Any, **named: Any) -> Any:
        began = time.thread_time()
        try:
            return method(self, *args, **named)
        finally:
            into.append(1e3 * (time.thread_time() - began))

    setattr(owner, name, timing)
    try:
        yield
    finally:
        setattr(owner, name, method)


def measure() -> dict[str, tuple[float, str]]:
    """Name -> figure and its unit."""
    paper = load_config("paper")
    speeds = [paper.drive.speed_kmh + STEP * (1 + k % KINDS) for k in range(RUNS)]
    for speed in set(speeds):
        _run_of(paper.replace({"drive.speed_kmh": speed}))
    curves: list[float] = []
    frames: list[float] = []
    everything: list[float] = []
    behind: list[float] = []
    server = Explorer(paper, "paper", port=0, run=ready)
    tab = Tab(server, 1280, 720)
    try:
        wait_for(lambda: tab.shows_run(1), "the first run")
        time.sleep(REST)
        session = server.sessions[0]
        with ExitStack() as timing:
            for method in (
                (PlotPanel, "show", curves),
                (View3D, "draw", frames),
                (Session, "_attempt", everything),
            ):
                timing.enter_context(timed(*method))
            for speed in speeds:
                session.change("drive.speed_kmh", speed)
                time.sleep(BETWEEN)
        with timed(PlotPanel, "settle", behind):
            time.sleep(REST)
    finally:
        tab.close()
        server.stop()
    return {
        "Python for the curves of a run": (median(curves), "ms"),
        "Python for the curves of a run, 95 %": (quantiles(curves, n=20)[-1], "ms"),
        "Python for a frame of the 3-D view": (median(frames), "ms"),
        "Python for a frame of the 3-D view, 95 %": (quantiles(frames, n=20)[-1], "ms"),
        "Python for all that is shown during a drag, each run": (sum(everything) / len(curves), "ms"),
        "Python for what follows once a drag is over": (sum(behind), "ms"),
        "Python for what follows once a drag is over, at a stretch": (max(behind), "ms"),
    }


if __name__ == "__main__":
    for what, (value, unit) in measure().items():
        print(f"{what:60} {value:8.2f} {unit}")
