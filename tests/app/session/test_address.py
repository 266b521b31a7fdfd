"""The address follows what a tab shows, and a link opens it: over viser's own protocol."""

from __future__ import annotations

import json
import re
from html import unescape
from typing import Any

from model.config.config_files import load_config
from tests.app.conftest import Tab, wait_for

SPEED, KEY = "Speed, km/h", "drive.speed_kmh"
DAMPING = "vehicle.road_suspension.damping"


def ask(tab: Tab, fragment: str) -> None:
    """Open a link, as the page does at first and when the user goes back."""
    tab.use("Asked", json.dumps({"kind": "link", "content": fragment, "count": 1}))


def address(tab: Tab) -> tuple[str, int] | None:
    """Fragment and step."""
    found = re.search(r'<trackride-address of="(.*)" step="(\d+)"', tab.html("<trackride-address"))
    return None if found is None else (unescape(found[1]), int(found[2]))


def wait_for_address(tab: Tab, fragment: str) -> int:
    """The step that the address with this fragment belongs to."""
    return wait_for(
        lambda: (shown := address(tab)) and shown[0] == fragment and shown[1], f"{fragment}, {address(tab)}"
    )


def shown_faults(tab: Tab) -> str:
    """HTML of the window that says what is wrong."""
    texts = [str(widget["props"].get("content", "")) for widget in tuple(tab.widgets.values())]
    return next((text for text in texts if "trackride-faults" in text), "")


def open_at_rest(explore: Any, open_tab: Any, **browser: Any) -> Tab:
    tab: Tab = open_tab(explore(), **browser)
    wait_for_address(tab, "paper")
    return tab


def test_the_address_follows_in_steps_that_the_user_rests_in(explore: Any, open_tab: Any) -> None:
    tab = open_at_rest(explore, open_tab)
    first = wait_for_address(tab, "paper")
    tab.use(SPEED, 22)
    faster = wait_for_address(tab, "paper&drive.speed_kmh=22")
    tab.use(SPEED, 23)
    assert wait_for_address(tab, "paper&drive.speed_kmh=23") == faster > first
    tab.press("Undo the last change")
    assert wait_for_address(tab, "paper") > faster
    tab.press("View: Front")
    before = wait_for_address(tab, "paper&view=front")
    tab.press("Pin this run as the baseline")
    assert wait_for_address(tab, "paper&vs=paper&view=front") > before


def test_a_link_opens_vehicle_road_baseline_view_and_wheel(explore: Any, open_tab: Any) -> None:
    explorer = explore()
    tab: Tab = open_tab(explorer)
    link = "m113&road.type=half_round&drive.speed_kmh=25&vs=m113&vs.drive.speed_kmh=20&view=front&wheel=R2"
    ask(tab, link)
    wait_for_address(tab, link)
    session = explorer.sessions[0]
    assert session.shown.config == load_config("m113").replace({KEY: 25, "road.type": "half_round"})
    baseline = wait_for(lambda: session._workspace.baseline, "the baseline's run")
    assert baseline.config.drive.speed_kmh == 20
    assert session._window.view.views[-1] == "front"
    tab.press("Undo the last change")
    wait_for(lambda: session.shown.config == load_config("paper"), "what was shown before")


def test_a_link_opens_tab_time_and_a_camera_turned_by_hand(explore: Any, open_tab: Any) -> None:
    explorer = explore()
    tab = open_at_rest(lambda: explorer, open_tab)
    ask(tab, "paper&tab=Ride&time=1.5&camera=1,-9,2,0,0,0.5")
    wait_for(lambda: 'of="Ride"' in tab.html("<trackride-front"), "the tab")
    tab.use("Tabs in front", "Ride")  # as the page tells then
    wait_for_address(tab, "paper&tab=Ride&time=1.5")  # this tab's camera cannot be moved
    moved = [message for message in tab.messages if message["type"] == "SetCameraPositionMessage"]
    assert tuple(moved[-1]["position"]) == (1, -9, 2)
    tab.press("Play or pause")
    wait_for_address(tab, "paper&tab=Ride")


def test_a_link_comes_before_what_the_browser_has_stored(explore: Any, open_tab: Any) -> None:
    explorer, storage = explore(), {}
    tab = open_at_rest(lambda: explorer, open_tab, storage=storage)
    tab.use(SPEED, 30)
    wait_for(lambda: "30" in json.dumps(json.loads(storage.get("trackride", "{}")).get("wish", {})), "what is stored")
    tab.close()
    again: Tab = open_tab(explorer, storage=storage)
    ask(again, "paper&drive.speed_kmh=11")
    wait_for_address(again, "paper&drive.speed_kmh=11")
    assert all(notice["title"] != "Welcome back" for notice in again.notifications)


def test_a_bad_link_is_refused_with_all_faults_and_changes_nothing(explore: Any, open_tab: Any) -> None:
    tab = open_at_rest(explore, open_tab)
    ask(tab, "paper&drive.speed_kmh=900&road.amplitude=x")
    faults = wait_for(lambda: shown_faults(tab), "the faults")
    assert "drive.speed_kmh: 900 is not allowed; give a number from 0.5 to 100 km/h" in unescape(faults)
    assert "road.amplitude" in faults
    assert tab.widget(SPEED)["value"] == 15


def test_a_link_can_be_copied(explore: Any, open_tab: Any) -> None:
    tab = open_at_rest(explore, open_tab)
    tab.press("Copy a link to what is shown")
    wait_for(lambda: 'of="paper"' in tab.html("<trackride-copy"), "the copy")
    wait_for(lambda: "Link copied" in [notice["title"] for notice in tab.notifications], "the message")


def test_what_the_page_does_not_say_is_left_alone(explore: Any, open_tab: Any) -> None:
    tab = open_at_rest(explore, open_tab)
    for text in ("", "{", "[]", '{"kind": "link"}', '{"kind": "link", "content": 5}', '{"kind": "x", "content": ""}'):
        tab.use("Asked", text)
    tab.use(SPEED, 22)
    wait_for_address(tab, "paper&drive.speed_kmh=22")
    assert not [notice for notice in tab.notifications if notice["title"] == "Something went wrong"]
