"""A link says all that a page shows, as short as what differs from a preset, and is checked like a file."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from app.format.link import READABLE, Link, Look, link_from, link_text, nearest_preset
from model.config.config import Config, ConfigError
from model.config.config_files import load_config, preset_names

PRESETS = {name: load_config(name) for name in preset_names()}
VIEWS, TABS = ("side", "front"), ("Loads", "Load map")
PARTS = [{"type": "sine", "amplitude": 0.05}, {"type": "half_round", "position": 9.5}]
DAMPING = "vehicle.road_suspension.damping"


def read(text: str) -> Link:
    return link_from(text, PRESETS, VIEWS, TABS)


def faults(text: str) -> list[str]:
    with pytest.raises(ConfigError) as caught:
        read(text)
    return [str(fault) for fault in caught.value.faults]


@pytest.mark.parametrize(
    ("preset", "changes", "text"),
    [
        ("m113", {}, "m113"),
        ("m113", {"road.type": "half_round", "drive.speed_kmh": 25}, "m113&drive.speed_kmh=25&road.type=half_round"),
        (
            "paper",
            {DAMPING: [1000, 2000, 3000, 4000, 5000, 6000.5]},
            f"paper&{DAMPING}=1000,2000,3000,4000,5000,6000.5",
        ),
        ("paper", {"vehicle.imaginary_wheels.enabled": False}, "paper&vehicle.imaginary_wheels.enabled=false"),
        ("paper", {"name": "A & B, 1/2 = ½?"}, "paper&name=A+%26+B,+1/2+%3D+%C2%BD%3F"),
        ("m113", {"vehicle.chassis.belly_height": None}, "m113&vehicle.chassis.belly_height="),
        ("paper", {"road.type": "profile", "road.points": "0 0, 6 0, 7 0.2"}, None),
        ("paper", {"road.type": "sum", "road.parts": PARTS}, None),
        ("obstacles", {"road.parts": []}, "obstacles&road.parts="),
        ("m113", {"vehicle.road_wheels.count": 5, "vehicle.road_wheels.spacing": 0.65}, None),
        ("paper", {"contact.normal_stiffness": 1.23456789012e7, "simulation.rtol": 1e-7}, None),
    ],
)
def test_a_configuration_is_told_in_what_differs_and_found_again(
    preset: str, changes: dict[str, Any], text: str | None
) -> None:
    config = PRESETS[preset].replace(changes)
    link = Link(preset, config)
    told = link_text(link, PRESETS)
    assert text is None or told.split("&")[0] == preset
    assert text is None or sorted(told.split("&")) == sorted(text.split("&"))
    assert read(told) == link
    assert told.isascii()
    assert not set(told) & set(' #?"<>')


def test_the_parts_of_a_sum_can_be_read() -> None:
    told = link_text(Link("paper", PRESETS["paper"].replace({"road.type": "sum", "road.parts": PARTS})), PRESETS)
    assert "road.parts.1.type=sine&road.parts.1.amplitude=0.05&road.parts.2.type=half_round" in told
    assert "road.parts.2.position=9.5" in told


@pytest.mark.parametrize("other", preset_names())
@pytest.mark.parametrize("preset", ["paper", "m113", "obstacles"])
def test_any_preset_can_be_told_from_any_other(preset: str, other: str) -> None:
    link = Link(preset, PRESETS[other])
    assert read(link_text(link, PRESETS)) == link


def test_baseline_view_and_wheel_are_told_too() -> None:
    now, before = (PRESETS["paper"].replace({"drive.speed_kmh": speed}) for speed in (20, 10))
    link = Link("paper", now, "paper", before, Look("front", "R3"))
    told = link_text(link, PRESETS)
    assert told == "paper&drive.speed_kmh=20&vs=paper&vs.drive.speed_kmh=10&view=front&wheel=R3"
    assert read(told) == link
    other = replace(link, baseline_preset="m113", baseline=PRESETS["m113"])
    assert "&vs=m113&view" in link_text(other, PRESETS)
    assert read(link_text(other, PRESETS)) == other


def test_tab_time_and_a_camera_turned_by_hand_are_told_where_they_are_not_as_usual() -> None:
    look = Look("", "", "Load map", 3.25, (0.5, -9.0, 1.12, 0.0, 0.0, 0.75))
    link = Link("paper", PRESETS["paper"], look=look)
    told = link_text(link, PRESETS)
    assert told == "paper&tab=Load+map&time=3.25&camera=0.5,-9,1.12,0,0,0.75"
    assert read(told) == link
    start = replace(link, look=Look(time=0.0))
    assert link_text(start, PRESETS) == "paper&time=0"
    assert read("paper&time=0") == start


def test_the_preset_is_the_one_from_which_least_differs() -> None:
    def nearest(config: Config) -> str:
        return nearest_preset(config, PRESETS, "paper")

    assert nearest(PRESETS["marder"].replace({"drive.speed_kmh": 33})) == "marder"
    assert nearest(PRESETS["paper"]) == "paper"


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("tank", "preset: 'tank' is not allowed; give one of paper, "),
        ("paper&drive.speed_kmh=500", "drive.speed_kmh: 500 is not allowed; give a number from 0.5 to 100 km/h"),
        ("paper&drive.sped_kmh=5", "drive.sped_kmh: unknown key; the nearest known one is drive.speed_kmh"),
        ("paper&drive.speed_kmh", "'drive.speed_kmh' is not understood; give key=value"),
        ("paper&drive.speed_kmh=5&drive.speed_kmh=6", "'drive.speed_kmh': is given twice"),
        ("paper&road.height=0.1", "road.height: a road of type sine has no such key"),
        ("paper&view=below", "view: 'below' is not allowed; give one of side, front"),
        ("paper&wheel=R0", "wheel: 'R0' is not allowed; give a wheel's name"),
        ("paper&tab=Seat", "tab: 'Seat' is not allowed; give one of Loads, Load map"),
        ("paper&time=-1", "time: -1 is not allowed; give a time of the run, s"),
        ("paper&time=nan", "time: nan is not allowed"),
        ("paper&time=1,2", "time: '1,2' is not allowed"),
        ("paper&camera=1,2,3,4,5", "camera: '1,2,3,4,5' is not allowed; give six numbers, m"),
        ("paper&camera=1,2,3,1,2,3", "camera: '1,2,3,1,2,3' is not allowed"),
        ("paper&camera=1,2,3,4,5,1e300", "camera: '1,2,3,4,5,1e300' is not allowed"),
        ("paper&vs.drive.speed_kmh=5", "vs: the baseline's preset is missing; give vs=paper"),
        ("paper&vs=tank", "preset: 'tank' is not allowed"),
        ("paper&road.parts.1.type=sine", "road.parts: a road of type sine has no such key"),
        ("paper&road.type=sum&road.parts.11.type=sine&road.parts.12.type=sine", "road.parts.11.type: unknown key"),
        ("paper&" + "x" * READABLE, "the link is longer than"),
    ],
)
def test_what_a_link_says_is_checked_like_a_file(text: str, expected: str) -> None:
    assert any(fault.startswith(expected) for fault in faults(text)), faults(text)


def test_all_faults_are_told_at_once() -> None:
    assert len(faults("paper&drive.speed_kmh=500&road.wavelength=-1&view=below")) == 3
