"""The command line: what it prints, writes and returns."""

from __future__ import annotations

import errno
import signal
import subprocess
import sys
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console
from typer.testing import CliRunner, Result

import app.server
import model
from app import cli
from app.commands import common
from app.format.markup import Html
from app.reports import run_report
from app.web.admission import MAX_TABS
from model import Config, Trajectory, load_config
from model.config.config_files import parse_config, preset_names
from model.config.parameters import PARAMETER

SHORT = ("--set", "simulation.duration=1")


def trackride(*arguments: object) -> Result:
    return CliRunner().invoke(cli.cli, [str(argument) for argument in arguments], prog_name="trackride")


# Help


def test_help_and_version():
    assert {"explore", "run", "show"} <= set(trackride("--help").output.split())
    assert trackride("--version").output.startswith("trackride")
    assert trackride("--version").exit_code == 0


@pytest.mark.parametrize("command", ["explore", "run", "show", "sweep", "sensitivity", "limits", "optimise", "fit"])
def test_every_command_helps_with_an_example_that_can_be_run(command):
    words = trackride(command, "--help").output.partition("Example: trackride ")[2].split()
    assert words[0] == command
    assert words[1] in preset_names()
    for option, value in pairwise(words):
        if option == "--set":
            assert value.partition("=")[0] in PARAMETER


def test_help_does_not_wait_for_the_model_or_the_viewer():
    code = "import sys, app.cli; sys.exit(bool({'numba', 'scipy', 'viser', 'pydantic', 'pyarrow'} & set(sys.modules)))"
    assert subprocess.run([sys.executable, "-c", code], cwd=Path(__file__).parents[2]).returncode == 0


# Show


def test_show_prints_all_of_a_configuration():
    assert parse_config(trackride("show").output) == load_config("paper")
    changed = trackride("show", "half_round", "--set", "drive.speed_kmh=7", "--set", "name=Slow: one")
    assert parse_config(changed.output) == load_config("half_round").replace(
        {"drive.speed_kmh": 7, "name": "Slow: one"}
    )


def test_what_show_prints_can_be_given_back(tmp_path):
    path = tmp_path / "mine.yaml"
    path.write_text(trackride("show", "--set", "vehicle.road_wheels.positions=[1.5, 0, -1.5]").output)
    again = trackride("show", path, "--set", "vehicle.road_wheels.count=5")
    assert again.exit_code == 0
    assert parse_config(again.output).vehicle.road_wheels.spacing == 1.5


# Run


def test_run_writes_what_it_shows(tmp_path):
    out = tmp_path / "run.npz"
    result = trackride("run", "paper", *SHORT, "--set", "drive.speed_kmh=20", "--out", out)
    assert result.exit_code == 0
    assert "Warning: The start has died away only after" in result.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["run.npz"]
    run = Trajectory.load(out)
    assert (run.status, run.config.drive.speed_kmh, run.t[-1]) == ("complete", 20, 1)
    rows = [line.replace("│", " ").split() for line in result.stdout.splitlines()]
    load = run.normal_load
    counts = run.t >= 0.5
    assert ["R1", f"{load[:, 0].min():.0f}", f"{load[counts, 0].mean():.0f}", f"{run.peaks.load[0]:.0f}"] in rows
    assert len([row for row in rows if row and row[0][:1] in ("R", "I") and row[0][1:].isdigit()]) == 11
    rms = np.sqrt(np.mean(run.a[counts, 0, 1] ** 2))
    for words in (f"rms {rms:.4g} m/s²", "peak ", "imaginary wheels 1", "drift", "Shock at the seat 0",
                  "(VDV)", "(MTVV)", "Peak load, worst wheel", "from 0.5 s on", "Steps (rejected)",
                  "Time taken", "Real-time factor"):  # fmt: skip
        assert words in " ".join(" ".join(row) for row in rows)


def test_run_writes_the_columns_that_are_asked_for(tmp_path):
    out = tmp_path / "run.csv"
    assert trackride("run", *SHORT, "--out", out, "--channels", "seat,travel").exit_code == 0
    heads = out.read_text().splitlines()[0].split(",")
    assert heads[:2] == ["t [s]", "travel R1 [m]"]
    assert heads[-1] == "seat vertical acceleration [m/s2]"


@pytest.mark.parametrize(
    ("out", "channels", "said"),
    [("run.csv", "seat,heat", "'heat' is none; give some of motion,loads"), ("run.npz", "seat", "ends in .csv")],
)
def test_columns_that_cannot_be_are_said_before_computing(tmp_path, monkeypatch, out, channels, said):
    monkeypatch.setattr(model, "simulate", lambda *_: pytest.fail("it was computed"))
    result = trackride("run", "--out", tmp_path / out, "--channels", channels)
    assert result.exit_code == 2
    assert said in result.stderr


def test_run_writes_csv_and_needs_no_file(tmp_path):
    out = tmp_path / "run.csv"
    assert trackride("run", *SHORT, "--out", out).exit_code == 0
    table = np.genfromtxt(out, delimiter=",", skip_header=1)
    assert table.shape[0] == 201
    assert np.isfinite(table).all()
    assert trackride("run", *SHORT).exit_code == 0


def test_run_warns():
    result = trackride("run", "short_waves", *SHORT)
    assert result.exit_code == 0
    assert "Warning: The wavelength, 0.7 m, fits the wheel spacing. All road wheels rise and fall" in result.stderr


def test_a_profile_is_read_where_the_command_is_given(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("bump.csv").write_text("x,y\n3,0\n4,0.1\n")
    profile = ("--set", "road.type=profile", "--set", "road.file=bump.csv")
    assert parse_config(trackride("show", "paper", *profile).stdout).value("road.points") == "3.0 0.0, 4.0 0.1"
    assert trackride("show", "paper", *profile).stderr == (
        "bump.csv: 2 points, 3 to 4 m, heights 0 to 100 mm; no unit named, read as m.\n"
    )
    in_mm = trackride("show", "paper", *profile, "--set", "road.units={x: m, y: mm}", "--set", "road.columns=[1, 2]")
    assert parse_config(in_mm.stdout).value("road.points") == "3.0 0.0, 4.0 0.0001"
    assert in_mm.stderr.endswith("heights 0 to 0.1 mm; x read as m, heights as mm; columns x and y.\n")
    Path("mine.yaml").write_text("road: {type: profile, file: bump.csv, columns: [y, x], start: 3}")
    told = trackride("show", "mine.yaml", "--set", "road.columns=[x, y]", "--set", "road.units=[ft, in]")
    assert parse_config(told.stdout).value("road.units") == ("ft", "in")
    assert parse_config(told.stdout).value("road.columns") == ("x", "y")
    assert "2 points, 0.91 to 1.22 m, heights 0 to 2.54 mm; x read as ft, heights as in" in told.stderr
    assert trackride("show", "mine.yaml", "--set", "road.columns=[[]]").exit_code == 2
    Path("bump.csv").write_text("3,0\n4,high\n")
    failed = trackride("show", "paper", *profile)
    assert failed.exit_code == 2
    assert "road.file: line 2: 'high' is no number" in failed.stderr


def test_bad_input_names_all_faults_and_writes_nothing(tmp_path):
    path, out = tmp_path / "bad.yaml", tmp_path / "run.npz"
    path.write_text("drive: {speed: 3, speed_kmh: fast}\nvehicle: {chassis: {mass: -1}}")
    result = trackride("run", path, "--set", "oops", "--set", "road.start=[1", "--set", "=5", "--out", out)
    assert result.exit_code == 2
    assert result.stdout == ""
    assert result.stderr.splitlines() == [
        "--set oops: give KEY=VALUE, such as drive.speed_kmh=25",
        "--set road.start=[1: line 1, column 3: expected ',' or ']', but got '<stream end>'",
        "--set =5: give KEY=VALUE, such as drive.speed_kmh=25",
        f"{path}: drive.speed: unknown key; the nearest known one is drive.speed_kmh",
        f"{path}: drive.speed_kmh: 'fast' is not allowed; give a number from 0.5 to 100 km/h",
        f"{path}: vehicle.chassis.mass: -1 is not allowed; give a number from 1 to 100000 kg",
    ]
    assert not out.exists()


@pytest.mark.parametrize("command", ["run", "show", "explore"])
def test_every_command_refuses_bad_input(command):
    result = trackride(command, "--set", "drive.speed_kmh=500", "--set", "road.heigth=1")
    assert result.exit_code == 2
    assert "drive.speed_kmh: 500 is not allowed" in result.stderr
    assert "road.heigth: unknown key; the nearest known one is road.height" in result.stderr
    assert "nor a preset of that name (paper" in trackride(command, "papr").stderr


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("run.txt", "the name must end in .npz or .csv"),
        ("run", "the name must end in .npz or .csv"),
        ("missing/run.npz", "No such file or directory"),
        ("file/run.csv", "Not a directory"),
        ("folder.npz", "is a folder"),
        ("x" * 300 + ".npz", "File name too long"),
    ],
)
def test_where_nothing_can_be_written_nothing_is_computed(tmp_path, monkeypatch, name, words):
    (tmp_path / "file").touch()
    (tmp_path / "folder.npz").mkdir()
    monkeypatch.setattr(model, "simulate", lambda *_: pytest.fail("it was computed"))
    result = trackride("run", "--out", tmp_path / name)
    assert result.exit_code == 2
    assert words in result.stderr


def test_a_vehicle_without_rest_pose_is_bad_input(tmp_path):
    out = tmp_path / "run.npz"
    result = trackride("run", "--set", "vehicle.imaginary_suspension.preload_force=60000", "--out", out)
    assert result.exit_code == 2
    assert "rest pose" in result.stderr
    assert not out.exists()


def test_a_run_that_comes_to_grief_keeps_its_good_part(tmp_path):
    out = tmp_path / "run.npz"
    coarse = ("--set", "simulation.integrator=rk4", "--set", "simulation.step=0.02")
    result = trackride("run", *coarse, "--out", out)
    assert result.exit_code == 3
    run = Trajectory.load(out)
    assert run.status.startswith("inaccurate at t = ")
    assert f"The run is not complete: {run.status}." in result.stderr
    assert run.advice in result.stderr
    assert f"The good part, up to t = {run.t[-1]:g} s, is in {out}." in result.stderr
    assert "is in" not in trackride("run", *coarse).stderr


def test_ctrl_c_keeps_the_good_part(tmp_path, monkeypatch):
    before = signal.getsignal(signal.SIGINT)
    simulate = model.simulate

    def interrupted(config: Config, on_progress, should_stop) -> Trajectory:
        def stop() -> bool:
            assert not should_stop()
            signal.raise_signal(signal.SIGINT)
            return should_stop()

        return simulate(config, on_progress, stop)

    monkeypatch.setattr(model, "simulate", interrupted)
    out = tmp_path / "run.npz"
    result = trackride("run", "--out", out)
    assert result.exit_code == 130
    run = Trajectory.load(out)
    assert run.status == "cancelled"
    assert 0 < run.t[-1] < 10
    assert "The run is not complete: cancelled." in result.stderr
    assert signal.getsignal(signal.SIGINT) is before


@pytest.mark.parametrize("times", [1, 2])
def test_ctrl_c_while_the_file_is_written_lets_it_be_finished_and_the_second_does_not(tmp_path, monkeypatch, times):
    before, to_bytes = signal.getsignal(signal.SIGINT), Trajectory.to_bytes

    def interrupted(run: Trajectory, suffix: str) -> bytes:
        for _ in range(times):
            signal.raise_signal(signal.SIGINT)
        return to_bytes(run, suffix)

    monkeypatch.setattr(Trajectory, "to_bytes", interrupted)
    out = tmp_path / "run.npz"
    out.write_text("the old one")
    result = trackride("run", *SHORT, "--out", out)
    assert result.exit_code == 130
    assert "Interrupted" in result.stderr
    assert list(tmp_path.iterdir()) == [out]
    if times == 1:
        assert Trajectory.load(out).complete
    else:
        assert out.read_text() == "the old one"
    assert signal.getsignal(signal.SIGINT) is before


def test_a_progress_bar_stands_on_a_terminal(monkeypatch):
    monkeypatch.setattr(common, "errors", Console(stderr=True, force_terminal=True))
    result = trackride("run", *SHORT, "--set", "name=[red]Tricky")
    assert result.exit_code == 0
    assert "[red]Tricky" in result.stderr
    assert "%" in result.stderr
    assert "Tricky" not in trackride("run", *SHORT).stdout


# Report


def test_a_report_that_cannot_be_written_leaves_the_old_one(tmp_path, full_disk, monkeypatch):
    monkeypatch.setattr(run_report, "picture", lambda *drawn, **words: Html())  # they take most of the time
    out = tmp_path / "report.html"
    out.write_text("the old one")
    with full_disk():
        result = trackride("report", *SHORT, "--out", out)
    assert result.exit_code == 1
    assert f"cannot write {out}: File too large" in result.stderr
    assert out.read_text() == "the old one"
    assert list(tmp_path.iterdir()) == [out]


def test_standard_output_that_cannot_be_written(monkeypatch, capsys):
    """As `trackride show > FILE` on a full disk."""

    def full(prog_name: str) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(cli, "cli", full)
    with pytest.raises(SystemExit) as left:
        cli.main()
    assert left.value.code == 1
    assert capsys.readouterr().err == "cannot go on: No space left on device\n"


# Explore


def test_explore_hands_over_to_the_server(monkeypatch, tmp_path):
    served = []
    monkeypatch.setattr(app.server, "serve", lambda *given, **options: served.append((given, options)))
    path = tmp_path / "mine.yaml"
    path.write_text("drive: {speed_kmh: 12}")
    assert trackride("explore").exit_code == 0
    there = "--host", "0.0.0.0", "--port", "8090", "--no-browser"
    let_in = "--max-tabs", 3, "--no-token", "--allow-origin", "https://a.b", "--allow-origin", "http://c:9"
    assert trackride("explore", path, *there, *let_in).exit_code == 0
    (given, here), (other, elsewhere) = served
    assert given == (load_config("paper"), "paper")
    assert here == {
        "host": "127.0.0.1", "port": 8080, "open_browser": True,
        "max_tabs": MAX_TABS, "allowed_origins": (), "with_token": True,
    }  # fmt: skip
    assert other == (load_config(path), "mine.yaml")
    assert elsewhere == {
        "host": "0.0.0.0", "port": 8090, "open_browser": False,
        "max_tabs": 3, "allowed_origins": ["https://a.b", "http://c:9"], "with_token": False,
    }  # fmt: skip
