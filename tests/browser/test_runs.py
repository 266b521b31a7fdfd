"""Baseline, kept runs, undo, downloads, uploads and what the browser remembers, as a user does them."""

from __future__ import annotations

import io
import re
from pathlib import Path

import numpy as np
from PIL import Image
from playwright.sync_api import Download, expect

from model.trajectory import Trajectory
from tests.browser.driver import SOON, Explorer

PATIENCE = 90_000  # ms for a download that the browser has to draw for


def open_tab_named(explorer: Explorer, name: str) -> None:
    explorer.page.get_by_role("tab", name=name).click()


def download(explorer: Explorer, group: str, button: str) -> Download:
    """What comes when a button beside this label is clicked."""
    row = explorer.page.locator("div:has(> div > p > label)").filter(has_text=re.compile(f"^{group}"))
    with explorer.page.expect_download(timeout=PATIENCE) as download:
        row.get_by_role("button", name=button).first.click()
    return download.value


def content(download: Download) -> bytes:
    return Path(download.path()).read_bytes()


def test_from_a_pinned_vehicle_to_a_figure_that_proves_it(explorer: Explorer) -> None:
    """The two minutes of the issue: pin, halve the damping, see which wheel is worse off, take a figure home."""
    page = explorer.page
    open_tab_named(explorer, "Runs")
    page.keyboard.press("b")
    expect(page.get_by_text("Baseline pinned")).to_be_visible(timeout=SOON)
    page.get_by_text("Suspension", exact=True).click()
    before = explorer.run_number()
    explorer.control("Road damping").fill("2.366")
    explorer.wait_for_run(after=before)
    table = page.locator(".trackride-figures")
    expect(table.first).to_contain_text(re.compile(r"rms, m/s².*[+]\d"), timeout=SOON)
    expect(table.nth(1)).to_contain_text("Time in the air, s")
    kept = page.get_by_text("Road damping 4.732 → 2.366 kN s/m")
    expect(kept.last).to_be_visible(timeout=SOON)

    page.keyboard.press("Escape")
    page.locator(".trackride-compared").click()  # no text box has the keys any more
    page.keyboard.press("Control+z")
    explorer.wait_for_run(after=before + 1)
    expect(explorer.control("Road damping")).to_have_value("4.732", timeout=SOON)
    page.keyboard.press("Control+Shift+z")
    explorer.wait_for_run(after=before + 2)
    expect(explorer.control("Road damping")).to_have_value("2.366", timeout=SOON)

    page.get_by_text("Suspension", exact=True).click()
    page.get_by_text("Export", exact=True).click()
    figure = download(explorer, "Figure", "PNG")
    assert figure.suggested_filename == "paper-vehicle_road-damping-2.366-kn-s-m_figure.png"
    picture = Image.open(io.BytesIO(content(figure)))
    assert picture.width > 2000
    run = download(explorer, "Data", "NPZ")
    damping = Trajectory.load(run.path()).config.vehicle.road_suspension.damping
    assert damping == 2366

    # The page is narrow, the picture is wide: the vehicle fills it all the same
    with page.expect_download(timeout=PATIENCE) as screenshot:
        explorer.button("Screenshot").click()
    pixels = np.asarray(Image.open(io.BytesIO(content(screenshot.value))).convert("RGB")).astype(int)
    red, green, blue = np.moveaxis(pixels, 2, 0)
    hull = (green > red) & (red > blue) & (green - blue > 20) & (green < 200)
    columns = np.flatnonzero(hull.sum(axis=0) > 15)
    assert np.ptp(columns) > 0.5 * pixels.shape[1]


def test_a_preset_and_the_last_state_come_back_with_a_reload(explorer: Explorer, tmp_path: Path) -> None:
    page = explorer.page
    page.get_by_text("Import and presets", exact=True).click()
    bad = tmp_path / "bad.yaml"
    bad.write_text("drive: {speed_kmh: 4000}\nroads: {}\n")
    before = explorer.run_number()
    with page.expect_file_chooser() as chooser:
        explorer.button("Open a configuration").click()
    chooser.value.set_files(bad)
    faults = page.locator(".trackride-faults li")
    expect(faults).to_have_count(2, timeout=SOON)
    expect(faults.last).to_contain_text("from 0.5 to 100 km/h")
    page.get_by_role("dialog").get_by_role("button", name="Close").click()
    expect(faults).to_have_count(0)
    assert explorer.run_number() == before

    bad.write_text("name: My tank\ndrive: {speed_kmh: 30}\n")
    with page.expect_file_chooser() as chooser:
        explorer.button("Open a configuration").click()
    chooser.value.set_files(bad)
    explorer.wait_for_run(after=before)
    expect(explorer.control("Preset")).to_have_value("My tank", timeout=SOON)
    explorer.press("Amplitude", "End")
    explorer.wait_for_run(after=before + 1)
    page.wait_for_timeout(2000)
    page.reload()
    explorer.open(page.url)
    expect(explorer.control("Preset")).to_have_value("My tank", timeout=SOON)
    assert (explorer.value("Speed"), explorer.value("Amplitude")) == (30, 300)
