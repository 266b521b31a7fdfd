"""`trackride sweep` from a shell."""

from __future__ import annotations

import shutil
import signal
import time
from collections import namedtuple
from pathlib import Path

import pytest
from typer.testing import CliRunner

from app import cli
from model import Trajectory
from model.study.table import KEY, read_table
from tests.app.commands.support import PATIENCE, done, done_here, started, waiting

LONG = ("sweep", "--vary", "drive.speed_kmh=10:30:24", "--figures", "shock,peak_load.R2", "--out", "table.parquet")
SHORT = (*LONG[:2], "drive.speed_kmh=10:30:5", *LONG[3:], "--set", "simulation.duration=1")
ROWS = 6  # that a study has written when it is stopped


def refused(*arguments: object) -> str:
    """What a command says that is bad input."""
    result = CliRunner().invoke(cli.cli, ["sweep", *map(str, arguments)])
    assert result.exit_code == 2
    assert result.stdout == ""
    return result.stderr


def stopped(folder: Path, number: int) -> tuple[int, str]:
    """Exit status and words of a long study that gets a signal in its midst."""
    process = started(*LONG, folder=folder, program=("-c", waiting(ROWS + 2) + "from app.__main__ import main; main()"))
    part = folder / "table.parquet.part"
    end = time.monotonic() + PATIENCE
    while not part.exists() or part.read_text().count("\n") < ROWS:
        assert process.poll() is None, process.communicate()
        assert time.monotonic() < end
        time.sleep(0.01)
    process.send_signal(number)
    (folder / "go").touch()
    told, said = process.communicate(timeout=PATIENCE)
    (folder / "go").unlink()
    return process.returncode, told + said


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """The long study, done without a stop."""
    folder = tmp_path_factory.mktemp("whole")
    assert done_here(*LONG, folder=folder)[0] == 0
    return read_table(folder / "table.parquet")


def test_a_table_tells_what_made_it(tmp_path):
    status, told, said = done(*SHORT, "--figures", "pitch", "--keep-runs", "runs", folder=tmp_path)
    assert (status, told, said) == (0, "5 of 5 runs are in table.parquet.\n", "")
    table = read_table(tmp_path / "table.parquet")
    assert table.column_names == ["run", "drive.speed_kmh", "status", "shock", "peak_load.R2", "pitch"]
    assert table["drive.speed_kmh"].to_pylist() == [10, 15, 20, 25, 30]
    assert b"trackride sweep --vary drive.speed_kmh=10:30:5" in table.schema.metadata[KEY]
    run = Trajectory.load(tmp_path / "runs" / "run-000003.npz")
    assert run.config.drive.speed_kmh == 25
    assert run.peaks.load[1] == 1e3 * table["peak_load.R2"].to_pylist()[3]


def test_what_a_kill_leaves_goes_on_to_the_same_table(tmp_path, whole):
    assert stopped(tmp_path, signal.SIGKILL)[0] == -signal.SIGKILL
    assert [path.name for path in tmp_path.iterdir()] == ["table.parquet.part"]
    status, _, said = done_here(*LONG, folder=tmp_path)
    assert (status, said) == (
        2,
        "table.parquet.part: holds the runs of a study that was stopped; go on with --resume, or delete it\n",
    )
    status, told, said = done_here(*LONG, "--resume", folder=tmp_path)
    assert (status, told) == (0, "24 of 24 runs are in table.parquet.\n")
    assert said.endswith("of 24 runs are there already.\n")
    assert read_table(tmp_path / "table.parquet").equals(whole)
    assert [path.name for path in tmp_path.iterdir()] == ["table.parquet"]


def test_ctrl_c_keeps_what_is_done(tmp_path, whole):
    status, words = stopped(tmp_path, signal.SIGINT)
    assert status == 130
    assert "of 24 runs are in table.parquet." in words
    part = read_table(tmp_path / "table.parquet")
    assert ROWS - 2 <= part.num_rows < 24
    assert part.equals(whole.slice(0, part.num_rows))
    status, _, said = done_here(*LONG, folder=tmp_path)
    assert status == 2
    assert said.startswith(f"table.parquet: holds {part.num_rows} of 24 runs of a study that was stopped; go on with")
    assert read_table(tmp_path / "table.parquet").equals(part)
    assert done_here(*LONG, "--resume", folder=tmp_path)[0] == 0
    assert read_table(tmp_path / "table.parquet").equals(whole)


def test_a_study_of_which_no_run_comes_to_its_end(tmp_path):
    heavy = ("--set", "vehicle.imaginary_suspension.preload_force=60000")
    status, told, said = done_here(*SHORT, *heavy, folder=tmp_path)
    assert status == 3
    assert told == "5 of 5 runs are in table.parquet; incomplete: 5, see the column status.\n"
    assert said == "No run came to its end.\n"
    assert all(
        text.startswith("no rest pose: ") for text in read_table(tmp_path / "table.parquet")["status"].to_pylist()
    )


def test_bad_input_names_all_faults_and_writes_nothing(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    said = refused("--vary", "drive.sped_kmh=1:2:3", "--vary", "road.amplitude=0.2:0.1:3")
    assert said.splitlines() == [
        "--vary drive.sped_kmh: unknown key; the nearest known one is drive.speed_kmh",
        "--vary road.amplitude=0.2:0.1:3: the range is empty; give the smaller end first, and another one behind it",
    ]
    vary = ("--vary", "drive.speed_kmh=10:30:5")
    assert refused() == "nothing varies: give a key and its values\n"
    assert "--figures peak_loads: there is no such figure" in refused(*vary, "--figures", "peak_loads")
    assert "sobol:5: such a sample" in refused("--vary", "drive.speed_kmh=10:30", "--sample", "sobol:5")
    assert "must end in .parquet or .csv" in refused(*vary, "--out", "table.txt")
    (tmp_path / "other.csv").write_text("a,b\n")
    assert "is no table of a study" in refused(*vary, "--out", "other.csv", "--resume")
    assert [path.name for path in tmp_path.iterdir()] == ["other.csv"]


def test_more_runs_than_the_disk_holds_are_refused(tmp_path, monkeypatch):
    space = namedtuple("space", "total used free")
    monkeypatch.setattr(shutil, "disk_usage", lambda folder: space(1e9, 1e9 - 3e6, 3e6))
    monkeypatch.chdir(tmp_path)
    vary = ("--vary", "drive.speed_kmh=10:30:5")
    assert "5 runs take about 22 MB" in refused(*vary, "--keep-runs", "runs")
    assert "has 3 MB free: vary less, or write elsewhere" in refused("--vary", "drive.speed_kmh=10:30:9000")
