"""A mode in the place of the run, over viser's own protocol."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from app.panels.spectrum_panel import NO_MODE
from app.plots.spectrum import LOWEST_END
from app.view3d.mode_animation import EXCURSION, PERIOD, ModeShow
from model.analysis.modes import vehicle_modes
from model.config.config_files import load_config
from model.simulation.trajectory import Trajectory
from tests.app.conftest import FakeView, Tab, wait_for

PAPER = load_config("paper")
SHOW, BOUNCE = "Show in 3-D", "2 Bounce, 1.55 Hz"


@pytest.fixture
def shown(explore: Any, open_tab: Any) -> tuple[Tab, FakeView]:
    """A tab whose modes can be chosen, and its 3-D view."""
    explorer = explore()
    tab: Tab = open_tab(explorer)
    wait_for(lambda: tab.shows_run(1))
    wait_for(lambda: BOUNCE in tab.widget(SHOW)["props"]["options"], "the modes")
    return tab, explorer.sessions[0]._window.view


def is_bounce(run: Trajectory) -> bool:
    """Whether a run is a mode that swings."""
    return run.config.road.type == "flat" and bool(np.ptp(run.q[:, 0, 1]) > 0.05)


def show_bounce(tab: Tab, scene: FakeView) -> None:
    tab.use(SHOW, BOUNCE)
    wait_for(lambda: is_bounce(scene.runs[-1]), "the mode")
    wait_for(lambda: "<b>Bounce</b>" in tab.status, "the status")


def test_a_mode_swings_round_and_round_and_the_rest_pose_is_its_ghost(shown: tuple[Tab, FakeView]) -> None:
    tab, scene = shown
    show_bounce(tab, scene)
    first = len(scene.times)
    times = wait_for(lambda: len(scene.times) > first + 60 and scene.times[first:], "two swings")
    assert 0 <= min(times) < 0.2 * PERIOD
    assert 0.8 * PERIOD < max(times) < PERIOD
    ghost = scene.ghosts[-1]
    assert ghost is not None
    assert np.ptp(ghost.q[:, 0, 1]) == 0
    assert tab.widget("Playback")["props"]["options"][2] == "▶ Play"  # the run stands still meanwhile


def test_what_leads_back_to_the_run(shown: tuple[Tab, FakeView]) -> None:
    tab, scene = shown
    for lead_back in (
        lambda: tab.press("Play or pause"),
        lambda: tab.press("One step on"),
        lambda: tab.use(SHOW, NO_MODE),
        lambda: tab.use("Speed, km/h", 20),
        lambda: tab.press("Pin this run as the baseline"),
    ):
        show_bounce(tab, scene)
        lead_back()
        wait_for(lambda: not is_bounce(scene.runs[-1]), "the run")
        wait_for(lambda: "<b>Run" in tab.status, "the status")
        wait_for(lambda: tab.widget(SHOW)["value"] == NO_MODE, "the choice to follow")
    assert scene.ghosts[-2] is None
    assert scene.ghosts[-1] is scene.runs[-1]  # it is pinned


def test_one_mode_after_the_other_and_none_during_a_drive(shown: tuple[Tab, FakeView]) -> None:
    tab, scene = shown
    show_bounce(tab, scene)
    tab.use(SHOW, "1 Pitch, 1.04 Hz")
    wait_for(lambda: "<b>Pitch</b>" in tab.status, "the other mode")
    tab.press("Drive on and on, or back to the run")
    wait_for(lambda: scene.roads, "the drive")
    wait_for(lambda: tab.widget(SHOW)["props"]["disabled"], "the choice to be disabled")
    assert tab.widget(SHOW)["value"] == NO_MODE
    tab.press("Drive on and on, or back to the run")
    wait_for(lambda: not tab.widget(SHOW)["props"]["disabled"], "the choice to be enabled")


def test_other_spectra_can_be_asked_for(shown: tuple[Tab, FakeView]) -> None:
    tab, _ = shown
    tab.use("Spectrum", "Power density")
    wait_for(lambda: tab.charts()[-1]["title"] == "Vertical acceleration: power density")
    tab.use("Felt at", "Driver's seat")
    wait_for(lambda: tab.charts()[-1]["series"][1]["label"] == "Driver's seat")
    assert tab.charts()[-1]["data"][0][-1] <= LOWEST_END


def test_a_mode_is_shown_where_the_run_stands() -> None:
    mode = vehicle_modes(PAPER).swinging[-1]
    show = ModeShow(PAPER, mode, x=12.0)
    assert show.swing.q[:, 0, 0].mean() == pytest.approx(12, abs=0.01)
    moved = np.abs(show.swing.q - show.rest.q)[:, show.rest.system.wheel[5], 1].max()
    assert 0.7 * EXCURSION * 0.32 < moved < 1.1 * EXCURSION * 0.32
    assert show.move_on(0.75 * PERIOD) == pytest.approx(0.75 * PERIOD)
    assert show.move_on(0.5 * PERIOD) == pytest.approx(0.25 * PERIOD)
