"""Names of downloads."""

from __future__ import annotations

import re

from app.format.file_names import NAME_LIMIT, file_name
from model.config.config_files import load_config

PAPER = load_config("paper")


def test_names_tell_preset_changes_and_content() -> None:
    changes = {
        "drive.speed_kmh": 22.5,
        "road.amplitude": 0.15,
        "vehicle.road_suspension.stiffness": 60000.0,
        "road.type": "half_round",
    }
    name = file_name(PAPER, "Paper vehicle", changes, "1280x720", ".png")
    assert name == (
        "paper-vehicle_speed-22.5-km-h_amplitude-150-mm_suspension-stiffness-60-kn-m_road-type-half-round_1280x720.png"
    )
    torsion = {"vehicle.road_suspension.basis": "torsion", "vehicle.road_suspension.stiffness": 9000.0}
    name = file_name(PAPER.replace(torsion), "Paper vehicle", torsion, "", ".yaml")
    assert name == "paper-vehicle_suspension-rates-torsion_suspension-stiffness-9-kn-m-rad.yaml"


def test_names_are_safe_and_short() -> None:
    evil = "../../etc/passwd\0 <b>\u202e CON: *?|" * 20
    name = file_name(PAPER, evil, {"vehicle.road_wheels.positions": tuple(range(20, 0, -1))}, "1280x720", ".png")
    assert re.fullmatch(r"[a-z0-9][a-z0-9._-]*_1280x720\.png", name)
    assert ".." not in name
    assert len(name) <= NAME_LIMIT + len(".png")
    assert file_name(PAPER, "日本", {}, "", ".png") == "run.png"
