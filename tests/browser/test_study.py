"""The tab "Study" as a user meets it: curves when one rests, a click on a curve, a drag."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Locator, expect

from app.runs.study_choice import WHAT_IF
from tests.browser.driver import FIRST_RUN, SOON, Explorer

SPEED = 3  # place of its column
DONE = "trackrideStudy.data.profiler?.done && trackrideStudy.data.profiler.columns"


@pytest.fixture
def study(at_rest: Explorer) -> Iterator[Explorer]:
    """With the tab in front, and few parameters: each run takes its time on a busy machine."""
    at_rest.strips.check()
    at_rest.page.get_by_role("tab", name="Study").click()
    at_rest.page.wait_for_function(f"{DONE}[0].now === 75.53", timeout=FIRST_RUN)
    yield at_rest
    at_rest.page.get_by_role("button", name="Profiler").click()
    at_rest.page.get_by_role("tab", name="Loads").click()
    at_rest.strips.uncheck()


def panel(explorer: Explorer, place: int) -> Locator:
    return explorer.page.locator("trackride-study .panel").nth(place)


def test_curves_stand_there_when_the_user_rests_and_say_what_matters(study: Explorer) -> None:
    expect(study.page.locator("trackride-study svg").first).to_be_visible(timeout=SOON)
    expect(study.page.locator("trackride-study .panel")).to_have_count(24)
    words = study.page.locator("trackride-study svg").get_attribute("aria-label") or ""
    assert "Absorbed power" in words
    assert "W: Speed +" in words
    expect(study.page.locator("trackride-matters")).to_contain_text(": mostly speed")
    expect(study.page.locator(".trackride-strip")).to_have_count(len(WHAT_IF))


def test_a_click_on_a_curve_moves_its_slider_and_undo_moves_it_back(study: Explorer) -> None:
    before, number = study.value("Speed"), study.run_number()
    box = panel(study, SPEED).bounding_box()
    assert box is not None
    study.page.mouse.click(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    study.wait_for_value("Speed", "now === value", 36.0)  # half way from 2 to 70 km/h
    number = study.wait_for_run(after=number)
    study.page.wait_for_function(f"{DONE}[{SPEED}].now === 36", timeout=FIRST_RUN)
    study.status.click()
    study.page.keyboard.press("Control+z")
    study.wait_for_value("Speed", "now === value", before)
    study.page.wait_for_function(f"{DONE}[{SPEED}].now === {before:g}", timeout=SOON)


def test_a_slider_that_moves_gives_it_up(study: Explorer) -> None:
    """No curve of a value that was passed on the way; those of the first value may still become finer."""
    page = study.page
    page.evaluate("""() => {
      window.seen = new Set();
      const take = trackrideStudy.take;
      trackrideStudy.take = (kind, data) => {
        if (kind === 'profiler') window.seen.add(data.columns[3].now);
        take(kind, data);
      };
    }""")
    study.thumb("Speed").focus()
    start = study.value("Speed")
    for _ in range(12):
        page.keyboard.press("ArrowRight")
        page.wait_for_timeout(60)
    study.wait_for_value("Speed", "now === value", start + 6.0)
    page.wait_for_function(f"{DONE}[{SPEED}].now === {start + 6.0:g}", timeout=FIRST_RUN)
    assert set(page.evaluate("[...window.seen]")) - {start} == {start + 6.0}


def test_the_strips_can_be_switched_off(study: Explorer) -> None:
    study.strips.uncheck()
    expect(study.page.locator(".trackride-strip")).to_have_count(0)
    expect(study.page.locator("trackride-matters")).not_to_contain_text("mostly")
    study.strips.check()
    expect(study.page.locator(".trackride-strip")).to_have_count(len(WHAT_IF))


def test_it_opens_large_and_closes_again(study: Explorer) -> None:
    narrow = study.page.locator("trackride-study").bounding_box()
    study.page.get_by_title("Large, over the view").click()
    wide = study.page.locator("trackride-study").bounding_box()
    assert narrow is not None
    assert wide is not None
    assert wide["width"] > 1.5 * narrow["width"]
    study.page.keyboard.press("Escape")
    expect(study.page.get_by_title("Large, over the view")).to_be_visible()


@pytest.mark.parametrize("kind", ["SVG", "PNG", "CSV"])
def test_the_curves_can_be_saved(study: Explorer, kind: str) -> None:
    with study.page.expect_download() as download:
        study.page.locator("trackride-study").get_by_role("button", name=kind).click()
    content = Path(download.value.path()).read_bytes()
    assert download.value.suggested_filename == f"trackride-profiler.{kind.lower()}"
    if kind == "SVG":
        assert b"Absorbed power at the seat" in content
    elif kind == "PNG":
        assert content[1:4] == b"PNG"
    else:
        lines = content.decode().splitlines()
        assert lines[0].startswith("parameter,unit,value,Absorbed power at the seat [W]")
        assert len(lines) > 6 * 25


def test_a_record_is_laid_over_the_run(study: Explorer, tmp_path: Path) -> None:
    lines = ["t [s],a [m/s^2]", *(f"{k / 50:.2f},{(-1) ** (k // 25) * 0.5}" for k in range(500))]
    file = tmp_path / "ride.csv"
    file.write_text("\n".join(lines))
    study.page.get_by_role("button", name="Measured").click()
    study.page.locator("trackride-study input[type=file]").set_input_files(file)
    expect(study.page.locator("trackride-study")).to_contain_text("rms apart", timeout=SOON)
    file.write_text("no record")
    study.page.locator("trackride-study input[type=file]").set_input_files(file)
    expect(study.page.get_by_text("No record", exact=True)).to_be_visible(timeout=SOON)
