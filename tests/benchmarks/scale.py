"""Many runs at once, vehicles of 2 to 20 wheels, memory, and how soon the explorer is there."""

from __future__ import annotations

import os
import resource
import subprocess
import sys
import tempfile
from statistics import median
from time import perf_counter

from model import load_config, simulate, simulate_many
from tests.benchmarks.model import cores
from tests.browser.driver import Explorer, chromium, running, running_explorer

RUNS = 200
WHEELS = (2, 4, 6, 10, 20)


def measure() -> dict[str, tuple[float, str]]:
    """Name -> figure and its unit."""
    return _batch() | _wheels() | _start()


def _batch() -> dict[str, tuple[float, str]]:
    config = load_config("paper")
    configs = [config.replace({"vehicle.road_suspension.stiffness": 50000 + 200 * k}) for k in range(RUNS)]
    figures = {}
    for workers in {1, cores()}:
        began = perf_counter()
        done = sum(simulate_many(configs, lambda run: run.complete, workers))
        assert done == RUNS
        figures[f"paper's runs a second, {workers} at a time"] = (RUNS / (perf_counter() - began), "1/s")
    figures["memory after them"] = (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024, "MB at most")
    return figures


def _wheels() -> dict[str, tuple[float, str]]:
    figures = {}
    for count in WHEELS:
        config = load_config("paper").replace(
            {"vehicle.road_wheels.count": count, "vehicle.road_wheels.spacing": 3.5 / (count - 1)}
        )
        runs = [simulate(config) for _ in range(9)]
        evaluations = runs[0].statistics.evaluations + len(runs[0].t)
        bodies = len(runs[0].system.mass)
        cost = median(run.statistics.seconds for run in runs[1:]) / evaluations / bodies
        figures[f"all of a run, each evaluation and body, {count} road wheels"] = (1e9 * cost, "ns")
    return figures


def _start() -> dict[str, tuple[float, str]]:
    figures = {"import model": (_seconds_of("import model"), "s"), "trackride --help": (_seconds_of(HELP), "s")}
    figures["an empty viser page"] = (median(_empty_page() for _ in range(3)), "s")
    for name, environment in (("warm", {}), ("nothing compiled yet", {"NUMBA_CACHE_DIR": tempfile.mkdtemp()})):
        before = dict(os.environ)
        os.environ.update(environment)
        try:
            with chromium("--disable-gpu-compositing") as browser:
                page = browser.new_page(viewport={"width": 1280, "height": 720})
                began = perf_counter()
                with running_explorer() as address:
                    figures[f"explorer: listens, {name}"] = (perf_counter() - began, "s")
                    page.goto(f"{address}/?fixedDpr=0.5")
                    page.locator(".trackride-status").wait_for(timeout=60_000)
                    figures[f"explorer: interface, {name}"] = (perf_counter() - began, "s")
                    Explorer(page).open(f"{address}/?fixedDpr=0.5")
                    figures[f"explorer: first run, {name}"] = (perf_counter() - began, "s")
        finally:
            os.environ.clear()
            os.environ.update(before)
    return figures


def _empty_page() -> float:
    """Seconds from starting viser, with nothing but a line of text to show, until that line is seen."""
    with chromium("--disable-gpu-compositing") as browser:
        page = browser.new_page(viewport={"width": 1280, "height": 720})
        began = perf_counter()
        with running([sys.executable, "-c", EMPTY]) as address:
            page.goto(f"{address}/?fixedDpr=0.5")
            page.locator(".empty").wait_for(timeout=60_000)
            return perf_counter() - began


EMPTY = """
import viser
server = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
server.gui.add_html('<p class="empty">Empty</p>')
print(f"http://127.0.0.1:{server.get_port()}", flush=True)
server.sleep_forever()
"""
HELP = "import sys; sys.argv = ['trackride', '--help']; from app.cli import main; main()"


def _seconds_of(code: str) -> float:
    times = []
    for _ in range(3):
        began = perf_counter()
        subprocess.run([sys.executable, "-c", code], check=True, stdout=subprocess.DEVNULL)
        times.append(perf_counter() - began)
    return median(times)
