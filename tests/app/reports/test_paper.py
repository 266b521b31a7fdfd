"""`trackride paper`: what it writes, and sentences that follow the numbers."""

from __future__ import annotations

import re
import signal
import xml.etree.ElementTree as ElementTree
from dataclasses import replace
from pathlib import Path

import pytest
from typer.testing import CliRunner, Result

from app import cli
from app.reports.paper import amplitude
from app.reports.paper import page as paper
from app.reports.paper.findings import findings
from app.reports.paper.links import lessons, record_texts
from app.reports.paper.page import paper_files
from app.reports.paper.words import change_words, length_words, list_words, share_words
from model.paper import links as paper_links
from model.paper import study as paper_study
from model.paper.links import TRIED, Compared, Errors, LinksStudy, study_links
from model.paper.study import PRELOAD, Figures, PaperStudy, StudyError, study_paper

FIGURES = ("fig5_acceleration", "fig6_spectrum", "fig7_loads", "claims", "harmonics", "links")


@pytest.fixture(scope="module")
def study() -> PaperStudy:
    """The real one with fewer runs."""
    fewer = {
        "WAVES": 4,
        "FACTORS": (0.1, 1.0, 3.0, 5.0, 10.0),
        "SPEEDS": (15.0, 20.0),
        "AMPLITUDES": (0.01, 0.05, 0.1),
        "ALTERNATIVES": {"vehicle.road_wheels.spacing": (0.583,), PRELOAD: (0.0,)},
    }
    with pytest.MonkeyPatch.context() as patch:
        for name, value in fewer.items():
            patch.setattr(paper_study, name, value)
        return study_paper()


@pytest.fixture(scope="module")
def links() -> LinksStudy:
    """The real one with a shorter search."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(paper_links, "TRIED", {key: values[1:3] for key, values in TRIED.items()})
        patch.setattr(paper_links, "CLOSER", ())
        return study_links(record_texts())


@pytest.fixture(scope="module")
def files(study, links) -> dict[str, bytes]:
    return paper_files(study, links)


def trackride(*arguments: object) -> Result:
    return CliRunner().invoke(cli.cli, [str(argument) for argument in arguments], prog_name="trackride")


def found(study: PaperStudy) -> dict[str, tuple[str, str]]:
    """By a word of the statement: verdict, and what was found with its limit."""
    words = (
        "almost no pressure",
        "quite lower",
        "Baumgarte",
        "leave the ground",
        "peaks at 0.6 Hz",
        "Higher harmonics",
        "share of the load",
        "hardly matters",
        "lower the load",
    )
    return {
        word: (finding.verdict, f"{finding.found} {finding.limit}")
        for word in words
        for finding in findings(study)
        if word in finding.statement
    }


def test_the_command_writes_page_and_figures(study, links, files, tmp_path, monkeypatch):
    monkeypatch.setattr(paper_study, "study_paper", lambda on_progress: on_progress(1.0) or study)
    monkeypatch.setattr(paper_links, "study_links", lambda texts, on_progress: on_progress(1.0) or links)
    monkeypatch.setattr(paper, "paper_files", lambda *of: files if of == (study, links) else {})
    out = tmp_path / "new" / "paper"
    result = trackride("paper", "--out", out)
    assert result.exit_code == 0
    assert str(out / "index.html") in result.stdout
    names = {path.name for path in out.iterdir()}
    assert names == {"index.html"} | {f"{name}{suffix}" for name in FIGURES for suffix in (".png", ".svg")}
    for name in FIGURES:
        assert (out / f"{name}.png").read_bytes().startswith(b"\x89PNG")
        ElementTree.parse(out / f"{name}.svg")
    assert trackride("paper", "--out", out).exit_code == 0


def test_the_page_stands_alone_and_says_everything(study, files):
    page = files["index.html"].decode()
    assert not re.search(r"(src|href|srcset)=\"(?!data:)", page)
    assert "<script" not in page
    assert page.count("<picture>") == len(FIGURES)
    for part in ("Imaginary wheels against links", "arms at the records&#x27; pose", "200 mm, 14.2 km/h"):
        assert part in page
    for part in ("What hangs on the amplitude", "last 6 waves", "are those of the whole run"):
        assert part in page
    for part in ("Wheel spacing 0.583 m", "Track preload 0 mm", "How the paper is read", "negative spring"):
        assert part in page
    assert "nan" not in re.sub(r"base64,[^\"]*", "", page)
    for finding in findings(study):
        assert finding.statement.replace("'", "&#x27;") in page


def test_verdicts_on_the_real_runs(study):
    verdicts = found(study)
    assert verdicts["peaks at 0.6 Hz"][0] == "holds"
    assert verdicts["share of the load"][0] == "holds within limits"
    assert "7.2 %" in verdicts["share of the load"][1]
    verdict, words = verdicts["hardly matters"]
    assert verdict == "holds within limits"
    assert "holds up to 3 times" in words
    assert "imaginary wheels then carry the vehicle" in words
    assert verdicts["almost no pressure"][0] == "does not hold here"
    assert verdicts["Higher harmonics"][0] == "does not hold here"
    assert verdicts["lower the load"][0] == "holds within limits"
    verdict, words = verdicts["quite lower"]
    assert verdict == "holds"
    assert "Table 1 has 10 beside 75.5 kN/m: 13 %" in words
    assert "Up to 3 times Table 1's, 40 %" in words
    verdict, words = verdicts["Baumgarte"]
    assert verdict == "holds"
    assert re.search(r"In the whole run of 14 s .* apart by \S+ mm\. .*: \S+ nm at rtol 1e-9 and atol 1e-11", words)


def test_what_hangs_on_the_amplitude(study):
    """The paper's remark on harmonics and flying wheels, not its claims about the imaginary springs."""
    assert study.half is not None
    half = found(study.half)
    assert found(study)["leave the ground"][0] == "holds"
    assert half["leave the ground"][0] == "does not hold here"
    assert "in the air for 0 %" in half["leave the ground"][1]
    assert "hardly any, whether its speed is constant or not: the strongest is 3.1 %" in half["Higher harmonics"][1]
    verdicts, remark = amplitude.lessons(study, study.half)
    assert verdicts.startswith("One verdict hangs on the reading: “Contact needs forces")
    assert verdicts.endswith("The other 14 stay.")
    assert "fits the paper's remark better" in remark
    assert amplitude.lessons(study, study) == ["All 15 verdicts are the same with either."]


def test_sentences_follow_the_numbers(study):
    def all_of(sweep: str, **changes: float) -> dict[float, Figures]:
        return {value: replace(figures, **changes) for value, figures in getattr(study, sweep).items()}

    calm = found(replace(study, stiffness=all_of("stiffness", acceleration_rms=0.6)))["hardly matters"]
    assert calm[0] == "holds"
    assert "holds up to 10 times" in calm[1]

    moved = replace(study.paper, figures=replace(study.paper.figures, peak_frequency=1.2))
    assert found(replace(study, paper=moved))["peaks at 0.6 Hz"][0] == "does not hold here"

    stiff = study.run.config.replace({paper_study.STIFFNESS: 60000})
    assert found(replace(study, run=replace(study.run, config=stiff)))["quite lower"][0] == "does not hold here"

    light = replace(study.paper, figures=replace(study.paper.figures, static_share=0.01))
    assert found(replace(study, paper=light))["almost no pressure"][0] == "holds"

    same = found(replace(study, stiffness_same_force=study.stiffness))["share of the load"]
    assert same[0] == "holds"
    assert "with the same preload force at every stiffness, too" in same[1]

    smooth = replace(study.prescribed, harmonics=(1.0, 0.001, 0.001))
    assert found(replace(study, prescribed=smooth))["Higher harmonics"][0] == "holds"


def test_links_on_the_real_runs(links):
    first, worth, nearest, _, remains = lessons(links)
    assert "Over all 9 curves the preset is off by 71 %" in first
    assert "it is 62 %: the rest is the vehicle's pose" in first
    assert "off by 66 %" in worth
    assert "nearer to the links" in worth
    assert "imaginary stiffness 16 kN/m, imaginary damping 2.5 kN s/m" in nearest
    assert "Most is left of the acceleration" in remains


def test_links_sentences_follow_the_numbers(links):
    def off(by: float, peak: float = -0.1) -> Compared:
        errors = (Errors((by, by, 1.001 * by), (peak, peak, peak)),) * 3
        return replace(links.nearest, errors=errors)

    def words(**changes: object) -> list[str]:
        return lessons(replace(links, **changes))

    assert "the vehicle's pose" not in words(assembly=off(0.8), preset=off(0.8))[0]
    assert "hardly more or less" in words(assembly=off(0.6), without=off(0.61))[1]
    assert "further from the links (+50 %)" in words(assembly=off(0.6), without=off(0.4))[1]
    assert "hardly nearer than the preset's" in words(assembly=off(0.5), nearest=off(0.49))[2]
    assert "−50 % from the preset's" in words(assembly=off(0.4), nearest=off(0.2))[2]
    vague = dict.fromkeys(links.values, (1.0, 2.0)) | {paper_links.DAMPING: (10.0, 1000.0)}
    assert words(as_good=vague)[3].count("little about imaginary damping") == 1
    inside = {key: (values[0] + values[-1]) / 2 for key, values in TRIED.items()}
    assert "edge" not in words(values=inside)[3]
    assert (
        "edge of what was tried for preload force"
        in words(values=inside | {"vehicle.imaginary_suspension.preload_force": 1e6})[3]
    )
    for by, verdict in ((0.1, "is close to"), (0.4, "in outline"), (0.6, "not their size")):
        assert verdict in words(nearest=off(by))[4]
    assert "peaks are larger, by up to 10 %" in words(nearest=off(0.4, peak=0.1))[4]
    assert "Most is left of the rise (40 %), least of the acceleration (40 %)" in words(nearest=off(0.4))[4]


def test_numbers_in_words():
    assert [length_words(x) for x in (4.7e-9, 1.5e-7, 3e-5, 1.6e-3)] == ["4.7 nm", "0.15 µm", "30 µm", "1.6 mm"]
    assert [share_words(x) for x in (0.0, 0.0072, 0.0994, 0.2, 1.0)] == ["0 %", "0.7 %", "9.9 %", "20 %", "100 %"]
    assert [change_words(x) for x in (-0.0911, 0.29, 0.0001)] == ["−9.1 %", "+29 %", "±0 %"]
    assert [list_words(list("abc"[:k])) for k in (1, 2, 3)] == ["a", "a and b", "a, b and c"]


def test_a_bad_folder_is_refused_before_anything_is_computed(tmp_path, monkeypatch):
    monkeypatch.setattr(paper_study, "study_paper", lambda *_: pytest.fail("it was computed"))
    (tmp_path / "file").touch()
    for name, words in (("file", "is a file"), ("file/inside", "Not a directory")):
        result = trackride("paper", "--out", tmp_path / name)
        assert result.exit_code == 2
        assert words in result.stderr
    assert trackride("paper").exit_code == 2


def test_ctrl_c_and_a_diverged_run_write_nothing(tmp_path, monkeypatch):
    def interrupted(on_progress):
        signal.raise_signal(signal.SIGINT)
        on_progress(0.5)

    def diverged(on_progress):
        raise StudyError("A run of the study is not complete: diverged.")

    out = tmp_path / "paper"
    for study, status in ((interrupted, 130), (diverged, 3)):
        monkeypatch.setattr(paper_study, "study_paper", study)
        result = trackride("paper", "--out", out)
        assert result.exit_code == status
        assert result.stderr
        assert not out.exists()


def test_help_has_an_example():
    assert "Example: trackride paper --out" in trackride("paper", "--help").output


def test_the_readme_shows_a_picture_of_the_command():
    root = Path(__file__).parents[3]
    assert "assets/pictures/claims.png" in (root / "README.md").read_text(encoding="utf-8")
    assert (root / "assets/pictures/claims.png").is_file()
