"""`trackride fit` from a shell."""

from __future__ import annotations

import csv

import numpy as np
import pytest
from typer.testing import CliRunner

from app import cli
from model import load_config, simulate
from tests.app.commands.support import done_here

DAMPING = "vehicle.road_suspension.damping"
SETTINGS = {"simulation.duration": 3, "drive.speed_kmh": 25}
SET = [word for key, value in SETTINGS.items() for word in ("--set", f"{key}={value}")]


@pytest.fixture
def record(tmp_path):
    """A file with a made record of a damper of 6000 N s/m."""
    run = simulate(load_config("paper").replace({**SETTINGS, DAMPING: 6000}))
    noise = np.random.default_rng(0).normal(0, 0.2, len(run.t))
    rows = zip(run.t + 1.5, run.a[:, 0, 1] / 9.80665 + noise / 9.80665, strict=True)
    path = tmp_path / "record.csv"
    path.write_text("# made\nt [s],acceleration [g]\n" + "".join(f"{t:.4f},{a:.6f}\n" for t, a in rows))
    return path


def test_a_damper_is_found_with_its_interval(record, tmp_path):
    status, told, said = done_here(
        "fit", "paper", *SET, "--measured", record.name, "--over", f"{DAMPING}=2000:20000", "--out", "found",
        folder=tmp_path,
    )  # fmt: skip
    assert (status, said) == (0, "")
    assert "beside it: figure.png, figure.svg, table.csv, curves.csv, fitted.yaml." in told
    rows = {row["name"]: row for row in csv.DictReader((tmp_path / "found" / "table.csv").open())}
    assert float(rows[DAMPING]["low"]) < 6000 < float(rows[DAMPING]["high"])
    assert float(rows["lag of the record, s"]["value"]) == pytest.approx(1.5, abs=0.02)
    assert load_config(tmp_path / "found" / "fitted.yaml").value(DAMPING) == pytest.approx(6000, rel=0.1)
    assert "0.2" in (tmp_path / "found" / "index.html").read_text().partition("are left (rms)")[0][-20:]


def test_what_is_doubtful_is_told_beside_the_value_and_on_the_page(record, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    command = ["fit", "paper", *SET, "--measured", record.name, "--over", f"{DAMPING}=12000:20000", "--out", "found"]
    result = CliRunner().invoke(cli.cli, command)
    assert result.exit_code == 0
    doubt = "lies at an end of its range: widen it, or do not trust its interval"
    assert f"{DAMPING}: {doubt}." in result.stderr
    assert doubt in result.stdout
    assert "s into the record" in result.stdout
    assert doubt in (tmp_path / "found" / "index.html").read_text()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((), "give --measured FILE"),
        (("--measured", "none.csv"), "--measured none.csv: No such file or directory"),
        (("--measured", "bad.csv"), "--measured bad.csv: column 't' has no unit"),
        (("--measured", "record.csv", "--columns", "t,b"), "has the columns t, acceleration; name that of time"),
    ],
)
def test_bad_input_is_refused(arguments, words, record, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "bad.csv").write_text("t,a\n0,1\n")
    result = CliRunner().invoke(cli.cli, ["fit", "paper", "--over", f"{DAMPING}=2000:20000", *arguments])
    assert result.exit_code == 2
    assert words in result.stderr
