"""Command lines name what the page shows."""

from __future__ import annotations

import shlex

from app.commands.common import configuration
from app.format.command_line import Source
from model.config.config_files import load_config, preset_names

PRESETS = {name: load_config(name) for name in preset_names()}


def test_a_preset_is_named_as_it_is():
    assert Source(PRESETS["m113"], PRESETS).command("limits", "--seeds", "2") == "trackride limits m113 --seeds 2"


def test_the_command_makes_the_same_configuration():
    config = PRESETS["paper"].replace(
        {"drive.speed_kmh": 22.5, "road.type": "random", "road.roughness_class": "D", "vehicle.road_wheels.count": 5}
    )
    words = shlex.split(Source(config, PRESETS).command("sweep"))
    assert words[:2] == ["trackride", "sweep"]
    made = configuration(words[2], [text for text in words[3:] if text != "--set"])
    named = {"name": config.name, "description": config.description}
    assert made.replace(named) == config


def test_of_two_presets_the_nearer_one_is_named():
    config = PRESETS["marder"].replace({"drive.speed_kmh": 17.0})
    assert Source(config, PRESETS).command("sweep") == "trackride sweep marder --set drive.speed_kmh=17"


def test_what_no_preset_leads_to_is_a_file_that_is_to_be_saved_first():
    config = PRESETS["paper"].replace({"road.type": "profile", "road.points": "0 0, 5 0, 6 0.1, 20 0.1"})
    source = Source(config, PRESETS)
    assert source.command("sweep") == "trackride sweep vehicle.yaml"
    assert "vehicle.yaml" in source.note
