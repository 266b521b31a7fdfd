"""The window that asks how the file of a profile is to be read, and its picture."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest

from app.tabs.profile_preview import FOOT, HEIGHT, LEFT, ROOM, WIDTH, profile_preview
from tests.app.conftest import Tab, wait_for
from tests.app.session.test_transfers import html, upload


def test_the_picture_shows_all_of_the_profile_to_scale() -> None:
    x = np.linspace(100.0, 160.0, 5001)
    y = 0.03 * np.sin(x)
    picture = str(profile_preview(x, y))
    points = np.array(re.search(r'<polyline points="([^"]+)"', picture)[1].replace(",", " ").split(), float)  # type: ignore[index]
    right, down = points.reshape(-1, 2).T
    assert len(right) < 1000
    assert (right[0], right[-1]) == (LEFT, WIDTH - ROOM)
    assert (down.min(), down.max()) == (ROOM, HEIGHT - FOOT - ROOM)
    at = 100.0 + (right - LEFT) / (WIDTH - ROOM - LEFT) * 60.0
    np.testing.assert_allclose(down, np.interp(0.03 * np.sin(at), [-0.03, 0.03], [down.max(), down.min()]), atol=2.0)
    assert re.findall(r">([^<]+ m)<", picture) == ["110 m", "120 m", "130 m", "140 m", "150 m"]
    assert re.findall(r">([^<]+ mm)<", picture) == ["\u221220 mm", "0 mm", "20 mm"]


@pytest.mark.parametrize("height", [0.0, 75.0, -3.0])
def test_level_points_are_a_level_line(height: float) -> None:
    assert "nan" not in str(profile_preview(np.array([0.0, 5.0]), np.full(2, height)))


def test_a_file_that_is_not_clear_is_asked_about_and_used_as_chosen(explore: Any, open_tab: Any) -> None:
    tab: Tab = open_tab(explore())
    wait_for(lambda: tab.shows_run(1), "run 1")
    rows = "\n".join(f"{0.5 * k},{40 * (k % 2)},{20 * (k % 3)}" for k in range(60))
    upload(tab, "Open a profile", "<b>tracks.csv", f"x [m],left,<i>right\n{rows}\n".encode())
    wait_for(lambda: "trackride-preview" in html(tab, "trackride-road trackride-preview"), "the picture")
    assert "Which columns are x and height? There are 3: x [m], left, &lt;i&gt;right. What" in html(
        tab, "trackride-why"
    )
    assert [tab.widget(f"{what} column")["value"] for what in ("Distance", "Height")] == ["x [m]", "left"]
    assert [tab.widget(f"{what} unit")["value"] for what in ("Distance", "Height")] == ["m", "mm"]
    assert "heights 0 to 40 mm" in html(tab, "trackride-road trackride-preview")
    tab.use("Height unit", "m")
    wait_for(lambda: "steeper than 85°" in html(tab, "trackride-refused"), "the refusal")
    assert tab.widget("Use")["props"]["disabled"]
    tab.use("Height unit", "cm")
    tab.use("Height column", "<i>right")
    wait_for(lambda: "heights 0 to 400 mm" in html(tab, "trackride-road trackride-preview"), "the other picture")
    assert "<i>" not in html(tab, "trackride-road trackride-preview")
    assert tab.widget("Road type")["value"] == "sine"
    tab.use("Use", True)
    wait_for(lambda: tab.widget("Road type")["value"] == "profile", "the profile")
    wait_for(lambda: "60 points, 29.5 m long, 0.4 m high" in tab.html("trackride-extent"), "what it is")
    tab.use("Columns and units", True)
    wait_for(lambda: tab.widget("Height unit")["value"] == "cm", "the question once more")
    tab.use("Cancel", True)
    assert "Undo" in tab.widget("Changes")["props"]["options"]
