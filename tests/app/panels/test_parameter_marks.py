"""Which parameters are marked as changed, which are among the first sliders, and how the palette leads to them."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from html import unescape
from typing import Any

import pytest
import viser

from app.panels.palette import add_palette
from app.panels.parameter_panel import MOST_FIRST, PINNABLE
from app.runs.request import Request
from model.config.config_files import load_config
from model.config.parameters import PARAMETERS
from tests.app.panels.test_controls import PAPER, actions, panel

FRICTION = "contact.friction"


@pytest.fixture(scope="module")
def server() -> Iterator[viser.ViserServer]:
    server = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
    yield server
    server.stop()


def told(html: viser.GuiHtmlHandle) -> Any:
    found = re.search(r'of="([^"]*)"', html.content)
    assert found
    return json.loads(unescape(found[1]))


def test_what_is_changed_is_marked_with_what_it_was(server: viser.ViserServer) -> None:
    controls = panel(server)
    controls.mark(Request(PAPER))
    assert told(controls._changes) == {}
    controls.mark(Request(PAPER, {"drive.speed_kmh": 22, "vehicle.road_arms.inertia": 0.5, "road.amplitude": 0.1}))
    assert told(controls._changes) == {"drive.speed_kmh": "15 km/h", "vehicle.road_arms.inertia": "left out"}
    controls.mark(Request(PAPER, {"road.type": "half_round", "road.height": 0.2}))
    assert told(controls._changes) == {"road.type": "sine", "road.height": "100 mm"}


def test_any_parameter_can_be_among_the_first_sliders(server: viser.ViserServer) -> None:
    controls = panel(server)
    controls.set_first([FRICTION, FRICTION, "drive.speed_kmh", "nothing"])
    assert list(controls._first) == [FRICTION]
    assert controls._first[FRICTION].value == 0.7
    controls.show(PAPER.replace({FRICTION: 0.5}))
    assert controls._first[FRICTION].value == controls[FRICTION].value == 0.5
    rows = told(controls._rows)
    assert [row for row in rows.values() if row[2]] == [[FRICTION, True, True]] * 2
    assert [row for row in rows.values() if row[0] == "drive.speed_kmh"] == [["drive.speed_kmh", False, False]]
    controls.set_first([])
    assert not controls._first
    controls.set_first(sorted(PINNABLE))
    assert len(controls._first) == MOST_FIRST


def test_each_of_them_shows_its_value_there(server: viser.ViserServer) -> None:
    keys = sorted(PINNABLE)
    configs = [load_config(preset) for preset in ("paper", "m113", "robot", "random_road")]
    for first in range(0, len(keys), MOST_FIRST):
        controls = panel(server)
        controls.set_first(keys[first : first + MOST_FIRST])
        for config in configs:
            controls.show(config)
            for key, control in controls._first.items():
                if config.parameter(key).applies_to(config.road.type):
                    assert control.value == pytest.approx(config.value(key)), key


def test_the_palette_knows_parameters_tabs_exports_and_presets(server: viser.ViserServer) -> None:
    server.gui.reset()
    added: list[tuple[str, str]] = []
    asked = actions()

    class Gui:
        def add_command(self, label: str, *, description: str) -> Any:
            added.append((label, description))
            return type("Handle", (), {"on_trigger": lambda self, act: None})()

    add_palette(Gui(), {"paper": PAPER}, asked)  # type: ignore[arg-type]
    labels = dict(added)
    damping = next(p for p in PARAMETERS if p.key == "vehicle.road_suspension.damping")
    assert labels[damping.label] == "Parameter: Suspension"
    assert labels["Runs"] == "Tab"
    assert labels["Data: CSV"] == "Export"
    assert labels["Paper vehicle"] == "Preset"
