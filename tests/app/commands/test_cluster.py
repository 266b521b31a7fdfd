"""Studies on a real dask scheduler with two worker processes on the loopback."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from typer.testing import CliRunner

from app import cli
from model.study.table import read_table
from tests.app.commands.support import PATIENCE, ROOT, done_here, started

pytest.importorskip("distributed")
STUDY = (
    "sweep", "--vary", "drive.speed_kmh=10:30:60", "--figures", "peak_load,energy_error", "--set",
    "simulation.duration=20", "--out",
)  # fmt: skip


def wait_until(condition: Callable[[], bool]) -> None:
    end = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.02)


class Cluster:
    """A scheduler and its workers, each a process."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.file = folder / "scheduler.json"
        self.scheduler = self._start("scheduler", "--host", "127.0.0.1", "--port", "0", "--scheduler-file", self.file)
        self.workers = [self.add_worker() for _ in range(2)]
        wait_until(lambda: self.file.exists() and bool(self.file.read_text().strip()))
        self.address = json.loads(self.file.read_text())["address"]

    def add_worker(self) -> subprocess.Popen[bytes]:
        return self._start("worker", "--scheduler-file", self.file, "--nthreads", "1", "--no-nanny")

    def _start(self, kind: str, *arguments: object) -> subprocess.Popen[bytes]:
        return subprocess.Popen(
            [sys.executable, "-m", f"distributed.cli.dask_{kind}", "--no-dashboard", *map(str, arguments)],
            cwd=self.folder,
            env=os.environ | {"PYTHONPATH": str(ROOT), "OPENBLAS_NUM_THREADS": "1"},
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )

    def wait_for_workers(self) -> None:
        from distributed import Client

        with Client(self.address, set_as_default=False) as client:
            client.wait_for_workers(len(self.workers), timeout=PATIENCE)

    def close(self) -> None:
        for process in (*self.workers, self.scheduler):
            process.kill()
            process.wait()


@pytest.fixture
def cluster(tmp_path) -> Iterator[Cluster]:
    started_here = Cluster(tmp_path)
    try:
        started_here.wait_for_workers()
        yield started_here
    finally:
        started_here.close()


def test_a_study_on_a_cluster_is_the_same_to_the_last_digit_though_a_worker_is_killed(cluster, tmp_path):
    assert done_here(*STUDY, "here.parquet", folder=tmp_path)[0] == 0
    process = started(*STUDY, "there.parquet", "--scheduler", cluster.address, folder=tmp_path)
    part = tmp_path / "there.parquet.part"
    wait_until(lambda: process.poll() is not None or (part.exists() and part.read_text().count("\n") > 3))
    cluster.workers[0].send_signal(signal.SIGSTOP)  # so that the study cannot end before it is killed
    assert process.poll() is None, process.communicate()
    cluster.workers[0].kill()
    told, said = process.communicate(timeout=PATIENCE)
    assert (process.returncode, told) == (0, "60 of 60 runs are in there.parquet.\n"), said
    here, there = (read_table(tmp_path / f"{name}.parquet") for name in ("here", "there"))
    assert there.equals(here)
    assert here["status"].to_pylist() == ["complete"] * 60


def test_a_cluster_that_cannot_work_is_refused(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("model.study.cluster.PATIENCE", 1.0)
    vary = ("sweep", "--vary", "drive.speed_kmh=10:30:3", "--out", "table.csv")
    result = CliRunner().invoke(cli.cli, [*vary, "--scheduler", "tcp://127.0.0.1:1"])
    assert result.exit_code == 2
    assert "--scheduler tcp://127.0.0.1:1: no scheduler answers there" in result.stderr
    assert list(tmp_path.iterdir()) == []
    result = CliRunner().invoke(cli.cli, [*vary, "--scheduler", "tcp://127.0.0.1:1", "--keep-runs", "runs"])
    assert "the runs of a cluster are not here" in result.stderr
