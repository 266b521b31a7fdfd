"""Baseline, kept runs, undo, downloads, uploads and what the browser remembers, as a user does them."""

from __future__ import annotations

import io
import re
from pathlib import Path

from PIL import Image
from playwright.sync_api import Download, expect

from app.format.differences import change_text, row_texts
from model import load_config, simulate
from model.analysis.figures import AIR_TIME, comparison
from model.simulation.trajectory import Trajectory
from tests.browser.conftest import OpenTab
from tests.browser.driver import DOWNLOAD, Explorer

DAMPING = "vehicle.road_suspension.damping"


def download(explorer: Explorer, group: str, button: str) -> Download:
    """What comes when a button beside this label is clicked."""
    row = explorer.page.locator("div:has(> div > p > label)").filter(has_text=re.compile(f"^{group}"))
    with explorer.page.expect_download(timeout=DOWNLOAD) as download:
        row.get_by_role("button", name=button).first.click()
    return download.value


def content(download: Download) -> bytes:
    return Path(download.path()).read_bytes()


def upload(explorer: Explorer, file: Path, text: str) -> None:
    file.write_text(text)
    with explorer.page.expect_file_chooser() as chooser:
        explorer.button("Open a configuration").click()
    chooser.value.set_files(file)


def test_from_a_pinned_vehicle_to_a_figure_that_proves_it(at_rest: Explorer) -> None:
    """The two minutes of the issue: the paper's vehicle, pinned; half the damping; which wheel leaves the ground more
    often, by how much the ride got worse; a figure to take home."""
    page = at_rest.page
    expect(at_rest.control("Preset")).to_have_value("Paper vehicle")
    page.get_by_role("tab", name="Runs").click()
    page.keyboard.press("b")
    expect(page.locator(".trackride-compared")).to_contain_text("Baseline ● Paper vehicle")
    before = at_rest.run_number()
    at_rest.box("Suspension damping").fill("2.366")
    at_rest.wait_for_run(after=before)

    paper = load_config("paper")
    rows = comparison(simulate(paper.replace({DAMPING: 2366})), simulate(paper))
    rms = next(row for row in rows if row.figure == "Vertical acceleration, rms")
    assert rms.change is not None
    assert rms.change > 1
    worst = max((row for row in rows if row.figure == AIR_TIME.label), key=lambda row: row.now - row.baseline)
    assert worst.now > worst.baseline
    page.get_by_role("button", name="Time in the air, s").click()
    for name, row in ((f"{rms.figure}, {rms.unit}", rms), (worst.wheel, worst)):
        body = page.locator(f'tbody[data-figure="{row.figure}"]')
        line = body.locator("tr").filter(has=page.get_by_role("cell", name=name, exact=True))
        texts = (*row_texts(row), change_text(row.change))
        expect(line).to_contain_text("".join(texts))

    kept = page.get_by_text("Suspension damping 4.732 → 2.366 kN s/m")
    expect(kept.last).to_be_visible()
    at_rest.fold("Export")
    figure = download(at_rest, "Figure", "PNG")
    assert figure.suggested_filename == "paper-vehicle_suspension-damping-2.366-kn-s-m_figure.png"
    assert Image.open(io.BytesIO(content(figure))).width > 2000
    run = download(at_rest, "Data", "NPZ")
    assert Trajectory.load(run.path()).config == paper.replace({DAMPING: 2366})
    at_rest.fold("Export")


def test_undo_and_redo_by_keys(at_rest: Explorer) -> None:
    page = at_rest.page
    speed, before = at_rest.value("Speed"), at_rest.run_number()
    at_rest.press("Speed", "ArrowRight")
    at_rest.wait_for_run(after=before)
    at_rest.wait_for_value("Speed", "now > value", speed)
    at_rest.status.click()  # no box has the keys any more
    page.keyboard.press("Control+z")
    at_rest.wait_for_value("Speed", "now === value", speed)
    page.keyboard.press("Control+Shift+z")
    at_rest.wait_for_value("Speed", "now > value", speed)


def test_a_baseline_of_another_size_is_not_drawn_and_it_is_said(at_rest: Explorer) -> None:
    page = at_rest.page
    page.keyboard.press("b")
    page.wait_for_function("() => '/ghost' in __viserMutable.nodePoseData")
    at_rest.control("Preset").click()
    page.get_by_role("option", name="Tracked robot").click()
    expect(page.get_by_text("The baseline is of another size")).to_be_visible()
    expect(page.locator(".u-title").first).to_have_text(
        "Normal load of road wheels (dotted: at rest, baseline: other size)"
    )
    expect(page).to_have_title(re.compile("Tracked robot, sine"))
    at_rest.control("Preset").click()
    page.get_by_role("option", name="Paper vehicle", exact=True).click()
    expect(page.locator(".u-title").first).to_have_text(
        "Normal load of road wheels (dotted: at rest, dashed: baseline)"
    )


def test_who_is_paused_behind_an_obstacle_is_led_to_another(at_rest: Explorer) -> None:
    page = at_rest.page
    at_rest.fold("Road")
    for road, time in (("half round", "now === 0"), ("step", "now > 0 && now < 0.5")):
        before = at_rest.run_number()
        at_rest.control("Road type").click()
        page.get_by_role("option", name=road, exact=True).click()
        at_rest.wait_for_run(after=before)
        at_rest.wait_for_value("Time, s", time)
        at_rest.press("Time, s", "End")
        at_rest.wait_for_value("Time, s", "now === 10")
    expect(page.get_by_text("From 10.00 s back to")).to_be_visible()
    at_rest.fold("Road")


def test_faults_of_a_file_are_shown_and_nothing_changes(at_rest: Explorer, tmp_path: Path) -> None:
    page = at_rest.page
    at_rest.fold("Import and presets")
    before = at_rest.run_number()
    upload(at_rest, tmp_path / "bad.yaml", "drive: {speed_kmh: 4000}\nroads: {}\n")
    faults = page.locator(".trackride-faults li")
    expect(faults).to_have_count(2)
    expect(faults.filter(has_text="from 0.5 to 100 km/h")).to_have_count(1)
    page.get_by_role("dialog").get_by_role("button", name="Close").click()
    expect(faults).to_have_count(0)
    assert at_rest.run_number() == before
    at_rest.fold("Import and presets")


def test_a_faulty_file_is_mended_at_the_line_that_is_wrong(at_rest: Explorer, tmp_path: Path) -> None:
    page = at_rest.page
    at_rest.fold("Import and presets")
    before = at_rest.run_number()
    lines = [*(f"# remark {k}" for k in range(80)), "drive: {speed_kmh: 33", "road: {type: sine}", "name: Mended"]
    upload(at_rest, tmp_path / "bad.yaml", "\n".join(lines))
    page.get_by_role("dialog").get_by_role("button", name="Edit").click()
    area = page.get_by_role("dialog").locator("textarea:not([aria-hidden])")
    marked = "area => area.value.slice(area.selectionStart, area.selectionEnd)"
    page.wait_for_function(f"area => ({marked})(area) === 'drive: {{speed_kmh: 33'", arg=area.element_handle())
    assert area.evaluate("area => document.activeElement === area && area.scrollTop > 500")
    page.keyboard.press("ArrowRight")  # to the end of what is marked
    page.keyboard.type("00}")
    use = page.get_by_role("dialog").get_by_role("button", name="Use this")
    use.click()
    fault = page.locator(".trackride-faults li")
    expect(fault).to_contain_text("Line 81: drive.speed_kmh")
    page.wait_for_function(f"area => ({marked})(area) === 'drive: {{speed_kmh: 3300}}'", arg=area.element_handle())
    page.keyboard.press("ArrowRight")
    for key in ("ArrowLeft", "Backspace", "Backspace"):
        page.keyboard.press(key)
    use.click()
    at_rest.wait_for_run(after=before)
    expect(page.get_by_role("dialog")).to_have_count(0)
    expect(at_rest.control("Preset")).to_have_value("Mended")
    assert at_rest.value("Speed") == 33
    at_rest.control("Preset").click()
    page.get_by_role("option", name="Paper vehicle", exact=True).click()
    at_rest.wait_for_value("Speed", "now === 15")
    at_rest.fold("Import and presets")


def test_preset_parameters_runs_and_baseline_come_back_with_a_reload(at_rest: Explorer, tmp_path: Path) -> None:
    page = at_rest.page
    page.get_by_role("tab", name="Runs").click()
    at_rest.fold("Import and presets")
    upload(at_rest, tmp_path / "tank.yaml", "name: My tank\ndrive: {speed_kmh: 30}\n")
    expect(at_rest.control("Preset")).to_have_value("My tank")
    before = at_rest.run_number()
    at_rest.press("Amplitude", "End")
    at_rest.wait_for_run(after=before)
    kept = page.get_by_text("Amplitude 100 → 300 mm")
    expect(kept.last).to_be_visible()
    page.keyboard.press("b")
    heading = page.locator(".trackride-compared")
    expect(heading).to_contain_text("Baseline ● Amplitude 100 → 300 mm")
    before = at_rest.run_number()
    at_rest.press("Speed", "End")
    at_rest.wait_for_run(after=before)
    page.wait_for_function(
        "text => Object.values(localStorage).some(stored => stored.includes(text))", arg='"drive.speed_kmh": 70'
    )

    page.reload()
    expect(at_rest.control("Preset")).to_have_value("My tank")
    at_rest.wait_for_value("Speed", "now === value", 70)
    at_rest.wait_for_value("Amplitude", "now === value", 300)
    page.get_by_role("tab", name="Runs").click()
    expect(heading).to_contain_text("Baseline ● Amplitude 100 → 300 mm")
    expect(page.locator(".trackride-figures:visible").first).to_contain_text(re.compile(r"rms, m/s².*%"))
    row = page.locator("div:has(> div > p > label)").filter(
        has_text=re.compile("^Suspension damping 4.732 → 2.366 kN s/m")
    )
    row.get_by_role("button", name="Show").first.click()
    expect(at_rest.control("Preset")).to_have_value("Paper vehicle")


def test_tabs_go_on_where_each_was_and_a_new_one_where_the_browser_was_last(open_tab: OpenTab) -> None:
    one = open_tab()
    address = one.page.url.partition("#")[0]  # without what is shown
    two = Explorer(one.page.context.new_page()).open(address)
    for tab, key, speed in ((one, "End", 70), (two, "Home", 2)):
        tab.press("Speed", key)
        tab.wait_for_value("Speed", "now === value", speed)
        tab.page.wait_for_function(
            "text => [localStorage, sessionStorage].every(store => Object.values(store).some(it => it.includes(text)))",
            arg=f'"drive.speed_kmh": {speed}',
        )
    three = Explorer(one.page.context.new_page()).open(address)
    three.wait_for_value("Speed", "now === value", 2)
    for tab, speed in ((one, 70), (two, 2)):
        tab.page.reload()
        tab.wait_for_value("Speed", "now === value", speed)


def test_exports_wait_for_their_turn_and_one_is_cancelled_without_the_others(at_rest: Explorer) -> None:
    """A movie holds up no table; the screenshot behind it comes when it is cancelled."""
    page = at_rest.page
    at_rest.fold("Export")
    with page.expect_download(timeout=DOWNLOAD) as table:
        at_rest.button("Movie").click()
        expect(page.get_by_text(re.compile(r"^Movie: (under way|\d+ %)"))).to_be_visible()
        at_rest.button("Screenshot").click()
        expect(page.get_by_text("Screenshot: waits for its turn")).to_be_visible()
        page.get_by_role("button", name="CSV", exact=True).click()
    assert table.value.suggested_filename.endswith(".csv")
    with page.expect_download(timeout=DOWNLOAD) as picture:
        page.get_by_role("group", name=re.compile("^Movie:")).get_by_role("button", name="Cancel").click()
    assert picture.value.suggested_filename.endswith("1280x720.png")
    expect(page.get_by_text("Movie was cancelled")).to_be_visible()
    expect(page.get_by_text(re.compile("^Movie:|^Screenshot:"))).to_have_count(0)
    at_rest.fold("Export")


def test_a_project_brings_runs_names_and_baseline_to_another_browser(open_tab: OpenTab, tmp_path: Path) -> None:
    one = open_tab()
    page = one.page
    page.get_by_role("tab", name="Runs").click()
    before = one.run_number()
    one.press("Speed", "End")
    one.wait_for_run(after=before)
    page.get_by_role("textbox", name="Name", exact=True).fill("Fast one")
    page.keyboard.press("Enter")
    page.get_by_role("button", name="Pin", exact=True).click()
    before = one.run_number()
    one.press("Amplitude", "End")
    one.wait_for_run(after=before)
    one.fold("Export")
    with page.expect_download(timeout=DOWNLOAD) as download:
        one.button("Save project").click()
    file = tmp_path / download.value.suggested_filename
    download.value.save_as(file)
    assert file.suffix == ".trackride"

    two = open_tab()
    two.page.get_by_role("tab", name="Runs").click()
    two.fold("Import and presets")
    with two.page.expect_file_chooser() as chooser:
        two.button("Open a project").click()
    chooser.value.set_files(file)
    two.wait_for_value("Speed", "now === value", 70)
    two.wait_for_value("Amplitude", "now === value", 300)
    expect(two.page.locator(".trackride-compared")).to_contain_text("Baseline ● Fast one")
    expect(two.page.get_by_text("Fast one", exact=True).first).to_be_visible()
    expect(two.page.locator(".trackride-figures:visible").first).to_contain_text(re.compile(r"rms, m/s².*%"))
