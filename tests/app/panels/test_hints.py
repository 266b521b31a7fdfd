"""Every control says what it is."""

from __future__ import annotations

import html
import json
import re
from typing import Any

from tests.app.conftest import Tab, wait_for

NOT_SEEN = (
    "In view",
    "Tabs in front",
    "Dark pages",
    "Visit",
    "Typed",
    "Study says",
    "Size",
    "At",
    "Asked",
    "Place",
)  # that only the page itself uses


def test_every_control_has_a_hint_that_says_more_than_its_label(explore: Any, open_tab: Any) -> None:
    tab: Tab = open_tab(explore())
    wait_for(lambda: tab.shows_run(1) and tab.html("trackride-hints"))
    controls = [widget["props"] for widget in tuple(tab.widgets.values()) if "hint" in widget["props"]]
    assert len(controls) > 60
    for props in controls:
        if props["label"] not in NOT_SEEN:
            assert props["hint"], f"{props['label']} has no hint"
            assert len(props["hint"].split()) > 2, f"{props['label']}: {props['hint']}"


def test_the_page_gets_the_hints_that_viser_does_not_show(explore: Any, open_tab: Any) -> None:
    tab: Tab = open_tab(explore())
    wait_for(lambda: tab.shows_run(1) and tab.html("trackride-hints"))
    text = re.search(r'data-hints="([^"]*)"', tab.html("trackride-hints"))
    assert text is not None
    hints = json.loads(html.unescape(text[1]))
    plain = {
        uuid: widget["props"]["hint"]
        for uuid, widget in tab.widgets.items()
        if widget["type"] in ("GuiButtonMessage", "GuiUploadButtonMessage")
    }
    assert len(plain) >= 3
    assert hints == plain
