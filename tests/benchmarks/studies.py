"""Studies: what figures and rows cost beside the bare runs, threads, memory, and a dask cluster on this machine.

Ratios are taken in turn within one run. `python -m tests.benchmarks.studies` prints these figures alone.
"""

from __future__ import annotations

import json
import os
import resource
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from statistics import median
from time import perf_counter, sleep

from model import load_config, simulate
from model.analysis.figures import figure_named
from model.analysis.ride import Summary
from model.simulation.batch import in_order
from model.simulation.simulate import simulate_motion
from model.study.design import Range, Study, make_study
from model.study.running import Outcome, Row, Spread, rows
from model.study.table import Made, TableWriter
from tests.benchmarks.model import cores

RUNS = 200  # in a round
ROUNDS = 3
MANY = 10_000
ON_CLUSTER = 1000


def measure() -> dict[str, tuple[float, str]]:
    """Name -> figure and its unit."""
    return _overhead() | _threads() | _memory() | _cluster()


def _study(runs: int, duration: float = 10.0) -> Study:
    base = load_config("paper").replace({"simulation.duration": duration})
    return make_study(base, [Range("vehicle.road_suspension.stiffness", 50000, 90000, runs)])


def _seconds(study: Study, spread: Spread) -> float:
    """With all figures and the table on disk."""
    with tempfile.TemporaryDirectory() as folder:
        began = perf_counter()
        table = TableWriter(Path(folder) / "table.parquet", study, Made.by(study, "", ""))
        for row in rows(study, spread=spread):
            table.add(row)
        table.finish()
        assert table.done == len(study.points)
        return perf_counter() - began


def _overhead() -> dict[str, tuple[float, str]]:
    study, one = _study(RUNS), partial(in_order, workers=1)
    configs = [study.base.replace(dict(zip(study.keys, point, strict=True))) for point in study.points]
    ratios, figures = [], []
    _seconds(study, one)
    for _ in range(ROUNDS):
        began = perf_counter()
        for config in configs:
            simulate(config)
        bare = perf_counter() - began
        ratios.append(_seconds(study, one) / bare)
    run = simulate_motion(study.base)
    for _ in range(RUNS):
        began, of = perf_counter(), Summary(run)
        for name in study.figures:
            figure_named(name, of)
        figures.append(perf_counter() - began)
    return {
        "a study's run, all figures and its row": (median(ratios), "times a bare run"),
        "all figures of a run": (1e3 * median(figures), "ms"),
    }


def _threads() -> dict[str, tuple[float, str]]:
    study = _study(RUNS)
    one, two = partial(in_order, workers=1), partial(in_order, workers=2)
    ratios, rates, alone = [], [], []
    for _ in range(ROUNDS):
        single, double = _seconds(study, one), _seconds(study, two)
        ratios.append(single / double)
        rates.append(RUNS / double)
        alone.append(RUNS / single)
    return {
        "runs of a study a second, 1 thread": (median(alone), "1/s"),
        "runs of a study a second, 2 threads": (median(rates), "1/s"),
        f"2 threads of a study, on {cores()} cores": (median(ratios), "times one"),
    }


def _memory() -> dict[str, tuple[float, str]]:
    """By how much the process grows from the 1000th to the last of many short runs."""
    kilobytes = {}
    for row in rows(_study(MANY, 0.5)):
        if row.run in (999, MANY - 1):
            kilobytes[row.run] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return {f"memory from the 1000th to the {MANY}th run": ((kilobytes[MANY - 1] - kilobytes[999]) / 1024, "MB more")}


def _cluster() -> dict[str, tuple[float, str]]:
    from model.study.cluster import on_cluster

    study = _study(ON_CLUSTER)
    seconds = {}
    for workers in (1, 2):
        with local_cluster(workers) as address, on_cluster(address) as spread:
            _seconds(_study(RUNS), spread)
            seconds[workers] = _seconds(study, spread)
            passing = _passing(spread)
    here = _seconds(study, partial(in_order, workers=2))
    return {
        f"{ON_CLUSTER} runs on dask, 2 workers of 1 thread": (seconds[2] / here, "times 2 threads"),
        f"2 workers on dask, on {cores()} cores": (seconds[1] / seconds[2], "times one"),
        "a row through dask into the table": (1e6 * passing, "µs"),
    }


def _passing(spread: Spread) -> float:
    """s that a row takes there, back and into the table when nothing is computed."""
    study = _study(MANY)
    give = partial(_given, next(rows(study)))
    list(spread(give, range(RUNS)))  # workers import this file
    with tempfile.TemporaryDirectory() as folder:
        table = TableWriter(Path(folder) / "table.parquet", study, Made.by(study, "", ""))
        began = perf_counter()
        for row in spread(give, range(MANY)):
            table.add(row)
        taken = perf_counter() - began
        table.close()
    return taken / MANY


def _given(row: Row, run: int) -> Row:
    """A row like another, with figures of its own."""
    figures = tuple(None if figure is None else figure + run for figure in row.outcome.figures)
    return Row(run, row.point, Outcome(row.outcome.status, figures))


@contextmanager
def local_cluster(workers: int) -> Iterator[str]:
    """Address of a scheduler with workers of one thread each, all processes here."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "scheduler.json"
        started = [_dask(folder, "scheduler", "--host", "127.0.0.1", "--port", "0", "--scheduler-file", str(file))]
        started += [
            _dask(folder, "worker", "--scheduler-file", str(file), "--nthreads", "1", "--no-nanny")
            for _ in range(workers)
        ]
        try:
            while not (file.exists() and file.read_text().strip()):
                sleep(0.05)
            address = json.loads(file.read_text())["address"]
            from distributed import Client

            with Client(address, set_as_default=False) as client:
                client.wait_for_workers(workers, timeout=60)
            yield address
        finally:
            for process in started:
                process.kill()
                process.wait()


def _dask(folder: str, kind: str, *arguments: str) -> subprocess.Popen[bytes]:
    root = str(Path(__file__).parents[2])
    return subprocess.Popen(
        [sys.executable, "-m", f"distributed.cli.dask_{kind}", "--no-dashboard", *arguments],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": root, "OPENBLAS_NUM_THREADS": "1"},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )


if __name__ == "__main__":
    for what, (value, unit) in measure().items():
        print(f"{what}: {value:.4g} {unit}")
