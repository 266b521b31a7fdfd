"""A drive that pauses can be looked back on; what it shows beside the plots, and what it gives to take home."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest

from app.files.movie_frames import LENGTHS
from app.runs.drive import Driver
from app.tabs.trust import trust_html
from model.analysis.ride import suspension_travel
from model.config.config_files import load_config
from model.simulation.simulate import simulate
from tests.app.conftest import FakeView, Tab, wait_for
from tests.app.runs.test_drive import Clock
from tests.app.session.test_downloads import answer_renders, download, renders

PAPER = load_config("paper")


def drive(tab: Tab, seconds: float) -> None:
    """Drive, until that long has been driven."""
    tab.use("Mode", "○ Drive")
    wait_for(lambda: tab.charts()[0]["data"][0][-1] > seconds and "changes act" in tab.status, "the drive")


def test_stepping_back_pauses_the_drive_and_shows_its_past(explore: Any, open_tab: Any) -> None:
    explorer = explore()
    tab: Tab = open_tab(explorer)
    wait_for(lambda: tab.shows_run(1))
    view: FakeView = explorer.sessions[0]._window.view
    drive(tab, 0.5)
    tab.press("Ten steps back")
    wait_for(lambda: "look back" in tab.status and view.runs[-1].t[0] == 0.0, "the past")
    end = view.runs[-1].t[-1]
    wait_for(lambda: end - 0.2 < view.times[-1] < end - 0.05, "0.1 s before the end")
    tab.use("Time, s", 0.25)
    wait_for(lambda: view.times[-1] == 0.25)
    wait_for(lambda: "[[0.25," in tab.html("trackride-time"), "the cursor")
    assert view.roads[-1].nearest(view.runs[-1].q[:, view.runs[-1].system.wheel, :2].reshape(-1, 2))[2].max() < 1.0
    tab.use("Speed, km/h", 25)  # takes part in the pause
    wait_for(lambda: view.runs[-1].config.drive.speed_kmh == 25)
    wait_for(lambda: view.times[-1] == 0.25)
    tab.press("Play or pause")
    wait_for(lambda: view.times[-1] > end + 0.1, "the drive to go on")
    assert view.runs[-1].t[-1] < end + 5.0
    assert not explorer.sessions[0]._window._notifications


def test_tabs_that_cost_more_follow_a_drive_and_say_which_stretch_they_show(explore: Any, open_tab: Any) -> None:
    tab: Tab = open_tab(explore())
    wait_for(lambda: tab.shows_run(1))
    drive(tab, 0.2)
    tab.use("Tabs in front", "Spectrum,Load map,Trust")

    def shown() -> set[str]:
        texts = [w["props"]["content"] for w in tuple(tab.widgets.values()) if w["type"] == "GuiHtmlMessage"]
        return set(re.findall("The drive from [^<]*", " ".join(texts)))

    wait_for(shown, "a stretch")
    before, amplitude, load_map = shown(), tab.charts()[-1]["data"][1], tab.html("trackride-map")
    wait_for(lambda: not np.array_equal(tab.charts()[-1]["data"][1], amplitude), "another spectrum")
    wait_for(lambda: tab.html("trackride-map") != load_map, "another map")
    wait_for(lambda: shown() and not shown() & before, "newer stretches")
    assert "checked when the drive pauses" in tab.html("Warnings")
    tab.press("Play or pause")
    wait_for(lambda: "judged when" not in tab.html("Warnings"), "the judgement")
    wait_for(lambda: len(shown()) == 1, "the same stretch in all tabs")
    tab.use("Mode", "○ Run")
    wait_for(lambda: not shown(), "a run without a stretch")


def downloads(tab: Tab) -> list[str]:
    return [m["filename"] for m in tuple(tab.messages) if m["type"] == "FileTransferStartDownload"]


def test_what_a_drive_gives_to_take_home(explore: Any, open_tab: Any) -> None:
    explorer = explore()
    tab: Tab = open_tab(explorer)
    wait_for(lambda: tab.shows_run(1))
    drive(tab, 0.3)
    session = explorer.sessions[0]
    for what, words in (("run.npz", "cannot be repeated"), ("movie", "Pause the drive"), ("replay", "Pause the drive")):
        session.export(what)
        wait_for(lambda words=words: any(words in notice["body"] for notice in tab.notifications), words)
    assert downloads(tab) == []
    assert session._playback.playing
    session.export("run.csv")
    wait_for(lambda: any(name.endswith("s.csv") and "drive-0-" in name for name in downloads(tab)), "the table")
    tab.press("Play or pause")
    wait_for(lambda: "look back" in tab.status)
    session.export("replay")
    wait_for(lambda: any(name.endswith(".html") and "replay-drive-0-" in name for name in downloads(tab)), "the replay")


def test_a_movie_of_a_pause_films_the_past_and_leaves_the_drive_alone(
    explore: Any, open_tab: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(LENGTHS, "4 s", 0.15)
    explorer = explore()
    tab: Tab = open_tab(explorer)
    wait_for(lambda: tab.shows_run(1))
    view: FakeView = explorer.sessions[0]._window.view
    drive(tab, 0.3)
    tab.press("Play or pause")
    wait_for(lambda: "look back" in tab.status)
    end = view.runs[-1].t[-1]
    tab.use("Time, s", 0.1)
    wait_for(lambda: view.times[-1] == 0.1)
    explorer.sessions[0].export("movie")
    times, count = [], 0
    while count < 3:
        wait_for(lambda count=count: renders(tab) > count, "a request")
        times.append(view.times[-1])
        count = answer_renders(tab, count)
    assert times == pytest.approx([0.1, 0.15, 0.2])
    assert "_drive-0-" in download(tab, ".mp4")[0]
    wait_for(lambda: view.times[-1] == 0.1, "the time that was shown before")
    assert view.runs[-1].t[-1] == end  # it has stood all the while
    tab.press("Play or pause")
    wait_for(lambda: view.times[-1] > end)


def test_figures_of_a_stretch_count_from_rest_and_from_the_start_of_the_drive() -> None:
    clock = Clock()
    driver = Driver(PAPER, clock)
    for _ in range(150):
        clock.now += 0.1
        driver.frame(1.0)
    past, whole = driver.stand().past, simulate(PAPER.replace({"simulation.duration": 16}))
    first, last = np.searchsorted(whole.t, past.t[[0, -1]] - 1e-6)
    assert past.t[0] > 4.0
    right = suspension_travel(whole)[first : last + 1]
    np.testing.assert_allclose(suspension_travel(past), right, atol=0.002)  # m, of 0.2 m; the runs are the same to that
    assert np.abs(right[0]).max() > 0.01
    assert "14.9 s simulated" in trust_html(past, driving=True) or "15 s simulated" in trust_html(past, driving=True)


def test_warnings_of_a_drive_that_goes_on_leave_open_what_needs_its_road() -> None:
    clock = Clock()
    driver = Driver(PAPER.replace({"contact.normal_stiffness": 1e6}), clock)  # so soft that wheels sink in deep
    for _ in range(30):
        clock.now += 0.1
        driver.frame(1.0)
    state = driver.stand()
    assert "checked when the drive pauses" in trust_html(state.past, driving=True)
    assert "into the ground (t" in trust_html(state.past, driving=True, road=state.road)
