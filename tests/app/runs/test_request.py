"""What is asked to be run."""

from __future__ import annotations

from app.runs.request import Request, first_request
from model.config.config_files import load_config

PAPER = load_config("paper")
SPEED = "drive.speed_kmh"


def test_contradicting_changes_drop_out() -> None:
    suspension = "vehicle.imaginary_suspension"
    request = Request(PAPER).changed(f"{suspension}.preload_deflection", 0.2)
    request = request.changed(f"{suspension}.preload_force", 500.0)
    assert request.config().vehicle.imaginary_suspension.preload_force == 500
    request = request.changed(f"{suspension}.preload_deflection", 0.15)
    assert request.config().vehicle.imaginary_suspension.preload_force is None
    request = Request(PAPER).changed("road.amplitude", 0.2).changed("road.type", "flat")
    assert request.config().road.type == "flat"
    assert request.changed("road.type", "sine").config().road == PAPER.road


def test_a_configuration_is_a_preset_with_changes() -> None:
    config = PAPER.replace({SPEED: 22})
    assert first_request(PAPER, config).changes == {SPEED: 22}
    other = load_config("half_round")
    assert first_request(PAPER, other).config() == other


def test_one_parameter_is_reset_with_what_goes_with_it() -> None:
    request = Request(PAPER).changed("drive.speed_kmh", 20).changed("road.type", "half_round")
    request = request.changed("road.height", 0.15)
    assert dict(request.reset("drive.speed_kmh").changes) == {"road.type": "half_round", "road.height": 0.15}
    assert dict(request.reset("road.height").changes) == {"drive.speed_kmh": 20, "road.type": "half_round"}
    back = request.reset("road.type")
    assert dict(back.changes) == {"drive.speed_kmh": 20}
    assert back.config().road.type == "sine"
    assert "road.type" not in back.touched


def test_a_reset_of_positions_brings_the_presets_back() -> None:
    m113 = load_config("m113")
    request = Request(m113).changed("vehicle.road_wheels.spacing", 0.6)
    assert request.reset("vehicle.road_wheels.spacing").config() == m113
