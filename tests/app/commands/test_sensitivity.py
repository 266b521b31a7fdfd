"""`trackride sensitivity` from a shell."""

from __future__ import annotations

from contextlib import contextmanager

import pytest
from typer.testing import CliRunner

from app import cli
from app.commands import analysis
from tests.app.commands.support import done_here

COMMAND = (
    "sensitivity", "paper", "--set", "simulation.duration=2", "--over", "drive.speed_kmh=10:20",
    "--over", "road.amplitude=0.05:0.1", "--trajectories", "2", "--samples", "2", "--out", "found",
)  # fmt: skip


def test_page_figure_and_table_are_written_and_a_second_time_takes_no_runs(tmp_path):
    status, told, said = done_here(*COMMAND, folder=tmp_path)
    assert (status, said) == (0, "")
    assert "The page is found/index.html; beside it: figure.png, figure.svg, table.csv." in told
    folder = tmp_path / "found"
    first = {path.name: path.read_bytes() for path in folder.iterdir()}
    assert b"Share of the variance" in first["figure.svg"] or first["figure.svg"].startswith(b"<?xml")
    assert first["runs.jsonl"].count(b"\n") == 14
    lines = first["table.csv"].decode().splitlines()
    assert lines[0].startswith("figure,key,total,total_low,total_high,first")
    assert {tuple(line.split(",")[:2]) for line in lines[1:]} == {
        (figure, key) for figure in ("absorbed_power", "peak_load") for key in ("drive.speed_kmh", "road.amplitude")
    }
    assert done_here(*COMMAND, "--resume", folder=tmp_path)[0] == 0
    assert (folder / "table.csv").read_bytes() == first["table.csv"]
    assert (folder / "runs.jsonl").read_bytes() == first["runs.jsonl"]


OVER = ("--over", "drive.speed_kmh=10:20", "--over", "road.amplitude=0.05:0.1")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((), "nothing may change: give --over KEY=LO:HI"),
        (("--over", "drive.speed_kmh=10,20"), "--over drive.speed_kmh: give a range, KEY=LO:HI"),
        (("--over", "drive.speed=10:20"), "the nearest known one is drive.speed_kmh"),
        (("--over", "drive.speed_kmh=10:20", "--over", "drive.speed_kmh=10:20"), "is given twice"),
        (("--over", "drive.speed_kmh=10:20"), "give two keys or more"),
        (("--over", "drive.speed_kmh=10:20:5"), "not 5 of them; give KEY=LO:HI"),
        (("--samples", "12"), "give a power of 2, such as 16"),
        ((*OVER, "--samples", "1073741824"), "4294967326 runs are more than 1000000"),
        (("--over", "drive.speed_kmh=10:20", "--figures", "shok"), "the nearest one is shock"),
    ],
)
def test_bad_input_is_refused(arguments, words, tmp_path):
    result = CliRunner().invoke(cli.cli, ["sensitivity", "paper", *arguments, "--out", str(tmp_path / "found")])
    assert result.exit_code == 2
    assert words in result.stderr
    assert not (tmp_path / "found").exists()


def test_ctrl_c_keeps_the_runs(tmp_path, monkeypatch):
    @contextmanager
    def interrupted():
        yield lambda: True

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(analysis, "interrupt", interrupted)
    result = CliRunner().invoke(cli.cli, COMMAND)
    assert result.exit_code == 130
    assert "Interrupted: what was done is kept in found/runs.jsonl.part; go on with --resume." in result.stderr
    assert [path.name for path in (tmp_path / "found").iterdir()] == ["runs.jsonl.part"]
    kept = (tmp_path / "found" / "runs.jsonl.part").read_bytes()
    assert kept.count(b"\n") == 1
    again = CliRunner().invoke(cli.cli, COMMAND)
    assert again.exit_code == 2
    assert "found/runs.jsonl.part: holds the runs of a study that was stopped; go on with --resume" in again.stderr
    assert (tmp_path / "found" / "runs.jsonl.part").read_bytes() == kept
    (tmp_path / "found" / "runs.jsonl.part").write_text("no runs\n")
    other = CliRunner().invoke(cli.cli, [*COMMAND, "--resume"])
    assert other.exit_code == 2
    assert "holds no runs of a study; delete it" in other.stderr
