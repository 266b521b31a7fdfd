"""`trackride report`: one page that says everything about a run, and nothing that it should not."""

from __future__ import annotations

import html
import re
from dataclasses import replace
from pathlib import Path

import pytest
from matplotlib.figure import Figure
from typer.testing import CliRunner, Result

import model
from app import cli
from app.format.differences import change_text, figure_text
from app.format.markup import Html
from app.reports import run_report as report
from app.reports.drawings import LIGHT_LOOK, Drawing
from app.reports.run_report import report_page, ride_rows
from model import load_config, simulate
from model.analysis.figures import comparison
from model.analysis.ride import Summary
from model.config.config_files import parse_config
from model.simulation.trajectory import Trajectory

PAPER = load_config("paper")
NASTY = "A <b>\"bold\"</b> & 'quoted' name <script>alert(1)</script>"


def trackride(*arguments: object) -> Result:
    return CliRunner().invoke(cli.cli, [str(argument) for argument in arguments], prog_name="trackride")


def run_of(**changes: object) -> Trajectory:
    return simulate(PAPER.replace({"simulation.duration": 1.5, **changes}))


@pytest.fixture
def unpainted(monkeypatch) -> None:
    """Pictures are composed, but not painted: that takes most of the time."""

    def compose(drawing: Drawing, caption: str = "", suffix: str = "") -> Html:
        drawing.draw(Figure(figsize=(drawing.width, drawing.height)), LIGHT_LOOK)
        return Html()

    monkeypatch.setattr(report, "picture", compose)


def words(page: str) -> str:
    """The page without its pictures and its style."""
    return re.sub(r"base64,[^\"]*|<style>.*?</style>", "", page, flags=re.S)


@pytest.fixture(scope="module")
def fast() -> Trajectory:
    return run_of(**{"drive.speed_kmh": 30, "name": NASTY, "description": "Fast & <i>loud</i>"})


@pytest.fixture(scope="module")
def whole(fast) -> str:
    return report_page(fast, "a&b.yaml")


@pytest.fixture(scope="module")
def page(whole) -> str:
    return words(whole)


def test_the_page_stands_alone(whole):
    assert whole.startswith("<!doctype html>")
    assert not re.search(r"(src|href|srcset)=\"(?!data:)", whole)
    assert "url(" not in whole
    assert len(whole) < 4e6
    assert whole.count("<picture>") == 9


def test_all_texts_are_escaped(page):
    assert "<script" not in page
    assert "<i>loud" not in page
    assert page.count(html.escape(NASTY)) >= 2
    assert "a&amp;b.yaml" in page


def test_figures_and_checks(page, fast):
    of = Summary(fast)
    assert ("Vertical acceleration, rms", figure_text(of.acceleration_rms), "m/s²", "") in ride_rows(fast)
    for row in ride_rows(fast):
        assert f"<dt>{row.label}</dt><dd>{row.value}" in page
    assert figure_text(of.load_max[0] / 1e3) in page
    assert "Energy unaccounted for" in page


@pytest.mark.usefixtures("unpainted")
def test_warnings_or_none():
    assert "Nothing: it is exact, and arms, penetration" in words(report_page(run_of(**{"road.type": "flat"}), "paper"))
    short = words(report_page(run_of(), "paper"))
    assert "The start has died away only after" in short
    assert " s on, like all means on this page" in short
    deep = words(report_page(run_of(**{"contact.normal_stiffness": 3e6}), "paper"))
    assert "sank" in deep
    assert "stiffen the ground" in deep


def test_what_was_changed_comes_first_with_the_papers_value(page):
    changed, _, rest = page.partition("<h3>Suspension</h3>")
    assert "<td>30 km/h</td><td>15 km/h (section 5)</td>" in changed
    assert "30 km/h" not in rest.partition("<h2>")[0]
    assert "75.53 kN/m</td><td>Table 1" in rest


@pytest.mark.usefixtures("unpainted")
def test_the_papers_vehicle_differs_in_nothing():
    assert "this is the paper&#x27;s vehicle" in words(report_page(simulate(PAPER), "paper"))


def test_the_yaml_gives_the_same_run(page, fast):
    text = re.search(r"<details>.*?<pre>(.*?)</pre>", page, flags=re.S)
    assert text is not None
    assert parse_config(html.unescape(text[1])) == fast.config


CASES = {
    "no track": {"vehicle.imaginary_wheels.enabled": False},
    "flat": {"road.type": "flat"},
    "a value for each wheel": {"vehicle.road_suspension.damping": [4000.0, 0, 0, 0, 0, 4000.0]},
    "torsion": {"vehicle.road_suspension.basis": "torsion", "vehicle.road_suspension.stiffness": 8000},
    "one sample": {"simulation.duration": 0.1, "simulation.output_rate": 10},
}


@pytest.mark.usefixtures("unpainted")
@pytest.mark.parametrize("case", CASES)
def test_every_kind_of_run_has_a_report(case):
    text = words(report_page(run_of(**CASES[case]), case))
    assert "None" not in text
    assert "nan" not in text


@pytest.mark.usefixtures("unpainted")
def test_a_baseline_stands_beside_every_figure(fast):
    baseline = run_of()
    parts: list[float] = []
    page = words(report_page(fast, "mine", baseline, parts.append))
    assert "Beside the baseline, Paper vehicle" in page
    assert "<td>30 km/h</td><td>15 km/h</td>" in page.partition("<dl>")[0]
    for row in ride_rows(fast, baseline):
        assert f'class="beside">{row.beside}' in page
    rms = next(row for row in comparison(fast, baseline) if row.figure == "Vertical acceleration, rms")
    assert f"<td>{change_text(rms.change)}</td>" in page.partition("<h2>Beside the baseline")[2]
    assert parts == sorted(parts)
    assert parts[0] == 0.0
    assert 0.8 < parts[-1] < 1.0
    texts = re.findall(r"<details>.*?<pre>(.*?)</pre>", page, flags=re.S)
    assert [parse_config(html.unescape(text)) for text in texts] == [fast.config, baseline.config]


@pytest.mark.usefixtures("unpainted")
def test_an_equal_baseline_says_so(fast):
    assert "Both have the same parameters" in words(report_page(fast, "mine", fast))


@pytest.mark.usefixtures("unpainted")
def test_a_run_cut_short_says_so():
    run = run_of()
    broken = replace(run, status="diverged at t = 1 s: <why>", advice="Try less.")
    assert "is not complete: diverged at t = 1 s: &lt;why&gt;. Try less." in words(report_page(broken, "paper"))


@pytest.mark.usefixtures("unpainted")
def test_the_command(tmp_path):
    out = tmp_path / "report.html"
    result = trackride("report", "half_round", "--set", "simulation.duration=1", "--out", out)
    assert result.exit_code == 0
    assert str(out) in result.stdout
    assert [path.name for path in tmp_path.iterdir()] == ["report.html"]
    assert "Half-round obstacle" in out.read_text(encoding="utf-8")
    assert "Example: trackride report" in trackride("report", "--help").output


@pytest.mark.usefixtures("unpainted")
def test_a_diverged_run_is_reported_as_far_as_it_came(tmp_path):
    out = tmp_path / "report.html"
    coarse = ("--set", "simulation.integrator=rk4", "--set", "simulation.step=0.02")
    result = trackride("report", *coarse, "--out", out)
    assert result.exit_code == 3
    assert "The run is not complete" in result.stderr
    assert "This run is not complete" in out.read_text(encoding="utf-8")


@pytest.mark.parametrize(("name", "said"), [("r.npz", "must end in .html"), ("no/r.html", "No such file")])
def test_bad_input_is_said_before_computing(tmp_path, monkeypatch, name, said):
    monkeypatch.setattr(model, "simulate", lambda *_: pytest.fail("it was computed"))
    result = trackride("report", "--out", Path(tmp_path / name))
    assert result.exit_code == 2
    assert said in result.stderr
    assert trackride("report", "--set", "drive.speed_kmh=500", "--out", tmp_path / "r.html").exit_code == 2
