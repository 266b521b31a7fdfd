"""Runs that are remembered."""

from __future__ import annotations

import pytest

from model.study.memory import Memory, StoppedError
from model.study.running import Job, done
from tests.model.support import PAPER

BASE = PAPER.replace({"simulation.duration": 0.5})
JOBS = [Job(BASE, {"drive.speed_kmh": speed}, ("peak_load", "shock")) for speed in (10.0, 20.0, 30.0, 10.0)]


def test_runs_are_done_once_and_the_same_as_without_memory(tmp_path):
    ran = []
    memory = Memory(tmp_path / "runs", "1", on_run=lambda: ran.append(0))
    assert memory(JOBS) == [done(job) for job in JOBS]
    assert len(ran) == 3
    memory.finish()
    content = (tmp_path / "runs").read_text()
    again = Memory(tmp_path / "runs", "1", go_on=True, on_run=lambda: ran.append(0))
    assert again(JOBS) == [done(job) for job in JOBS]
    again.finish()
    assert len(ran) == 3
    assert (tmp_path / "runs").read_text() == content


def test_other_runs_are_not_taken_for_the_same(tmp_path):
    memory = Memory(tmp_path / "runs", "1")
    memory(JOBS[:1])
    memory.close()
    ran = []
    for version, job in (
        ("2", JOBS[0]),
        ("1", JOBS[0]._replace(figures=("peak_load",))),
        ("1", JOBS[0]._replace(base=BASE.replace({"road.amplitude": 0.05}))),
    ):
        again = Memory(tmp_path / "runs", version, go_on=True, on_run=lambda: ran.append(0))
        assert again([job]) == [done(job)]
        again.close()
    assert len(ran) == 3


def test_a_stop_keeps_what_is_done_and_a_half_written_line_is_done_again(tmp_path):
    ran = []
    memory = Memory(tmp_path / "runs", "1", on_run=lambda: ran.append(0), should_stop=lambda: len(ran) == 2)
    with pytest.raises(StoppedError):
        memory(JOBS)
    memory.close()
    content = (tmp_path / "runs.part").read_text()
    assert content.count("\n") == 2
    (tmp_path / "runs.part").write_text(content[:-5])
    again = Memory(tmp_path / "runs", "1", go_on=True, on_run=lambda: ran.append(0))
    assert again(JOBS) == [done(job) for job in JOBS]
    again.close()
    assert len(ran) == 4
