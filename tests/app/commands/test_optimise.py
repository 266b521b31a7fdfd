"""`trackride optimise` from a shell."""

from __future__ import annotations

import csv

import pytest
from typer.testing import CliRunner

from app import cli
from model import load_config
from tests.app.commands.support import done_here

DAMPING = "vehicle.road_suspension.damping"
SHORT = ("--set", "simulation.duration=1", "--over", f"{DAMPING}=2000:20000", "--generations", "1", "--out", "found")


def test_the_best_is_written_as_a_configuration(tmp_path):
    status, told, said = done_here(
        "optimise", "paper", "--minimise", "acceleration_peak", "--subject-to", "peak_load<=60", "--roads",
        "half_round", *SHORT, folder=tmp_path,
    )  # fmt: skip
    assert (status, said) == (0, "")
    assert "The page is found/index.html" in told
    (row,) = csv.DictReader((tmp_path / "found" / "front.csv").open())
    best = load_config(tmp_path / "found" / "best.yaml")
    assert best.value(DAMPING) == pytest.approx(float(row[DAMPING]), rel=1e-5)
    assert float(row["bound peak_load"]) <= 60


def test_every_point_of_a_front_is_a_configuration(tmp_path):
    command = ("optimise", "paper", "--minimise", "absorbed_power", "--minimise", "peak_load", *SHORT)
    assert done_here(*command, folder=tmp_path)[0] == 0
    rows = list(csv.DictReader((tmp_path / "found" / "front.csv").open()))
    files = sorted((tmp_path / "found" / "front").iterdir())
    assert len(rows) == len(files) > 0
    goals = [(float(row["absorbed_power"]), float(row["peak_load"])) for row in rows]
    assert goals == sorted(goals)
    assert all(load_config(file).value(DAMPING) for file in files)
    first = (tmp_path / "found" / "front.csv").read_bytes()
    runs = (tmp_path / "found" / "runs.jsonl").read_bytes()
    assert done_here(*command, "--resume", folder=tmp_path)[0] == 0
    assert (tmp_path / "found" / "front.csv").read_bytes() == first
    assert (tmp_path / "found" / "runs.jsonl").read_bytes() == runs


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((), "nothing may change: give --over KEY=LO:HI"),
        (SHORT[2:4], "give --minimise FIGURE once, or twice"),
        ((*SHORT[2:4], "--minimise", "shok"), "--minimise shok: there is no such figure; the nearest one is shock"),
        ((*SHORT[2:4], "--minimise", "shock", "--subject-to", "pitch<3"), "--subject-to pitch<3: give FIGURE<=VALUE"),
        ((*SHORT[2:4], "--minimise", "shock", "--roads", "nowhere"), "nor a preset of that name"),
        (
            ("--over", "road.amplitude=0.01:0.1", "--minimise", "shock", "--roads", "half_round"),
            "--over road.amplitude: a road of type half_round has no such key; it belongs to sine",
        ),
    ],
)
def test_bad_input_is_refused(arguments, words, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    result = CliRunner().invoke(cli.cli, ["optimise", "paper", *arguments])
    assert result.exit_code == 2
    assert words in result.stderr
    assert not (tmp_path / "found").exists()


def test_where_no_point_keeps_the_bounds_the_runs_are_kept_for_other_bounds(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    command = ["optimise", "paper", *SHORT, "--minimise", "shock", "--subject-to"]
    result = CliRunner().invoke(cli.cli, [*command, "peak_load<=0.1"])
    assert result.exit_code == 2
    assert "no point can be run and keeps the bounds" in result.stderr
    assert "The runs are kept in found/runs.jsonl.part" in result.stderr
    kept = (tmp_path / "found" / "runs.jsonl.part").read_text()
    assert CliRunner().invoke(cli.cli, [*command, "peak_load<=60", "--resume"]).exit_code == 0
    assert (tmp_path / "found" / "runs.jsonl").read_text().startswith(kept)
