"""`trackride limits` from a shell, on few grounds and speeds, and what its search finds."""

from __future__ import annotations

import csv
from math import log

import numpy as np
import pytest
from typer.testing import CliRunner

from app import cli
from model import load_config
from model.config.config_files import dump_config
from model.study import limits as found
from model.study.limits import AT_ONCE, GRIEF, NEVER, Ground, half_round_grounds, iso_grounds, limits, profile_grounds
from model.study.running import Outcome

PAPER = load_config("paper")
GROUND = Ground("ISO 8608", "class C", 0.01, {}, 50.0)


def limit_of(power) -> found.Limit:
    """The limit of a vehicle whose absorbed power at each speed is given."""

    def evaluate(jobs):
        values = [power(job.changes["drive.speed_kmh"]) for job in jobs]
        return [Outcome("complete" if value is not None else "diverged at t = 1 s", (value,)) for value in values]

    return limits([(PAPER, [GROUND])], evaluate)[0]


def test_the_first_crossing_from_below_counts_and_one_that_comes_down_again_is_told():
    rising = limit_of(lambda v: 6 * (v / 25) ** 2)
    assert rising.speed == pytest.approx(25, rel=1e-6)
    assert rising.down_again is None
    peaked = limit_of(lambda v: 8 * np.exp(-((log(v / 8) / 0.5) ** 2)))
    assert peaked.speed == pytest.approx(8 * np.exp(-0.5 * np.sqrt(np.log(8 / 6))), rel=0.02)
    assert peaked.down_again == 11
    assert list(peaked.speeds) == sorted(peaked.speeds)


@pytest.mark.parametrize(
    ("power", "why"), [(lambda v: 7, AT_ONCE), (lambda v: 1, NEVER), (lambda v: 1 if v < 20 else None, GRIEF)]
)
def test_where_there_is_no_limit_it_is_said_why(power, why):
    limit = limit_of(power)
    assert (limit.speed, limit.why) == (None, why)
    assert limit.drawn == (80.0 if why == NEVER else None)


def test_slow_runs_are_left_out_where_the_figure_is_far_below_its_bound():
    assert limit_of(lambda v: 6 * (v / 40) ** 2).speeds[0] == 15
    assert limit_of(lambda v: 6 * (v / 3.5) ** 2).speeds[0] == 2
    hump = limit_of(lambda v: 7 if v == 6 else 5 if 6 < v < 20 else 1)
    assert (hump.speeds[0], hump.down_again) == (4, 8)


def test_over_half_rounds_a_short_rise_at_high_speed_is_found():
    def evaluate(jobs):
        return [Outcome("complete", (3.0 if 64 < job.changes["drive.speed_kmh"] < 70 else 1.0,)) for job in jobs]

    limit = limits([(PAPER, half_round_grounds(PAPER)[:1])], evaluate)[0]
    assert 62 < limit.speed < 68


def test_what_diverges_beyond_the_limit_does_no_harm():
    assert limit_of(lambda v: 6 * (v / 10) if v < 50 else None).speed == pytest.approx(10, rel=1e-3)


def test_grounds_of_iso_grow_and_those_half_way_are_half_way():
    grounds = iso_grounds(PAPER, [4])
    sizes = {ground.name: ground.size for ground in grounds}
    assert list(sizes.values()) == sorted(sizes.values())
    assert sizes["class D"] == pytest.approx(2 * sizes["class C"])
    assert sizes["class C"] == pytest.approx(np.sqrt(16 * 16e-6 * 0.01 * (1 / 0.05 - 1 / 2.8)), rel=0.03)
    x = np.linspace(20, 100, 200)
    by_name = {ground.name: PAPER.replace(ground.changes) for ground in grounds}
    from model.road.road import build_road

    whole, half = (build_road(by_name[name]).height(x) for name in ("class E", "class E, heights times 1.5"))
    np.testing.assert_allclose(half, 1.5 * whole, atol=1e-6)


def test_a_profile_is_used_without_its_level_lead_in():
    points = ", ".join(f"{x:g} {0.02 * np.sin(x) if x > 100 else 0:.6f}" for x in np.arange(0, 400, 0.1))
    grounds = profile_grounds(PAPER, "course.csv", points)
    measured = next(ground for ground in grounds if ground.as_measured)
    assert measured.size == pytest.approx(0.02 / np.sqrt(2), rel=0.02)
    assert grounds[0].size == pytest.approx(measured.size / 4)
    assert measured.distance == pytest.approx(150 + 1 + 3.5, abs=0.5)
    PAPER.replace(measured.changes)


@pytest.mark.parametrize("vehicle", ["paper", "m113", "marder", "robot"])
def test_half_rounds_lie_ahead_of_any_vehicle(vehicle):
    base = load_config(vehicle)
    for ground in half_round_grounds(base):
        assert base.replace(ground.changes).value("road.height") == ground.size


def test_figure_tables_and_page_are_written(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(found, "SPEEDS", (20.0, 60.0))
    monkeypatch.setattr(found, "ROUNDS", 1)
    monkeypatch.setattr(found, "HEIGHTS", (0.2,))
    monkeypatch.setattr(found, "STRETCH", 10.0)
    monkeypatch.setattr(found, "CLASSES", "CF")
    (tmp_path / "mine.yaml").write_text(dump_config(PAPER.replace({"name": "Mine", "vehicle.chassis.mass": 4000})))
    (tmp_path / "course.csv").write_text("x [m],z [mm]\n" + "".join(f"{x},{9 * (x % 3)}\n" for x in range(20)))
    arguments = ["limits", "paper", "mine.yaml", "--seeds", "1", "--profile", "course.csv", "--out", "found"]
    result = CliRunner().invoke(cli.cli, arguments)
    assert result.exit_code == 0, result.output
    assert "course.csv: 20 points, 0 to 19 m" in result.stderr
    folder = tmp_path / "found"
    assert {path.name for path in folder.iterdir()} == {
        "index.html", "figure.png", "figure.svg", "table.csv", "curves.csv", "runs.jsonl",
    }  # fmt: skip
    rows = list(csv.DictReader((folder / "table.csv").open()))
    assert {(row["vehicle"], row["ground"]) for row in rows} == {
        (name, ground) for name in (PAPER.name, "Mine") for ground in ("ISO 8608", "course.csv", "half-round")
    }
    assert all(row["speed_kmh"] or row["note"] for row in rows)
    page = (folder / "index.html").read_text()
    assert "Published curves of these vehicles could not be had" in page
    before = (folder / "runs.jsonl").read_bytes()
    again = CliRunner().invoke(cli.cli, [*arguments, "--resume"])
    assert again.stdout == result.stdout
    assert (folder / "runs.jsonl").read_bytes() == before


def test_a_profile_that_cannot_be_read_is_refused(tmp_path):
    result = CliRunner().invoke(cli.cli, ["limits", "paper", "--profile", "none.csv", "--out", str(tmp_path / "found")])
    assert result.exit_code == 2
    assert "none.csv cannot be read" in result.stderr
