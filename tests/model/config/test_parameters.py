"""The table of parameters: complete, consistent with itself and with the classes of the configuration."""

from __future__ import annotations

import math
from typing import Any, get_args

import pytest
from pydantic import BaseModel

from model.config.config import Config, Road
from model.config.parameters import GROUPS, PARAMETER, PARAMETERS, SECTIONS, Parameter, number_text, parameter_table

NUMERIC = [parameter for parameter in PARAMETERS if parameter.kind in ("number", "integer")]
ROADS: tuple[type[BaseModel], ...] = get_args(get_args(Road)[0])


def by_key(parameter: Parameter) -> str:
    return parameter.key


def leaves(section: type[BaseModel], prefix: str = "") -> dict[str, Any]:
    """Field by dotted path, roads left out."""
    found: dict[str, Any] = {}
    for name, field in section.model_fields.items():
        if name == "road":
            continue
        if isinstance(field.annotation, type) and issubclass(field.annotation, BaseModel):
            found |= leaves(field.annotation, f"{prefix}{name}.")
        else:
            found[prefix + name] = field
    return found


def test_every_key_stands_once():
    assert len(PARAMETER) == len(PARAMETERS)


def test_table_and_classes_have_the_same_keys():
    assert set(leaves(Config)) == {key for key in PARAMETER if not key.startswith("road.")}


@pytest.mark.parametrize("road", ROADS, ids=lambda road: road.__name__)
def test_table_and_road_classes_have_the_same_keys(road):
    road_type = road.model_fields["type"].default
    expected = {key for key in PARAMETER if key.startswith("road.") and PARAMETER[key].applies_to(road_type)}
    assert {f"road.{name}" for name in road.model_fields} == expected


def test_road_types_of_table_and_classes_agree():
    assert {road.model_fields["type"].default for road in ROADS} == set(PARAMETER["road.type"].choices)
    for parameter in PARAMETERS:
        assert set(parameter.roads) <= set(PARAMETER["road.type"].choices)


def test_classes_take_their_defaults_from_the_table():
    for key, field in leaves(Config).items():
        assert field.default == PARAMETER[key].default, key
        assert field.description == PARAMETER[key].description, key


def test_only_the_optional_default_to_nothing():
    for parameter in PARAMETERS:
        assert (parameter.default is None) == parameter.optional, parameter.key


@pytest.mark.parametrize("parameter", NUMERIC, ids=by_key)
def test_numbers_have_a_range_a_slider_and_a_growth(parameter):
    assert math.isfinite(parameter.low)
    assert math.isfinite(parameter.high)
    assert parameter.low <= parameter.slider_low < parameter.slider_high <= parameter.high
    assert 0 < parameter.step < parameter.slider_high - parameter.slider_low
    assert parameter.growth.endswith(".")
    if parameter.default is not None:
        assert parameter.slider_low <= parameter.default <= parameter.slider_high
        assert type(parameter.default) is (int if parameter.kind == "integer" else float)


@pytest.mark.parametrize("parameter", PARAMETERS, ids=by_key)
def test_words(parameter):
    assert 0 < len(parameter.label) <= 20
    assert parameter.label[0].isupper()
    assert parameter.description.endswith(".")
    assert parameter.group in GROUPS
    assert parameter.source in ("Table 1", "section 5", "assumed", "this project")
    assert (parameter.kind == "choice") == bool(parameter.choices)
    for choice in parameter.choices:
        assert choice.partition("-")[0] in parameter.description or choice in parameter.description


def test_labels_are_told_apart():
    assert len({parameter.label for parameter in PARAMETERS}) == len(PARAMETERS)


def test_the_first_sliders():
    assert {parameter.key for parameter in PARAMETERS if parameter.what_if} == {
        "vehicle.road_suspension.stiffness",
        "vehicle.road_suspension.damping",
        "vehicle.imaginary_suspension.stiffness",
        "drive.speed_kmh",
        "road.amplitude",
        "road.wavelength",
    }


def test_shown_units():
    stiffness = PARAMETER["vehicle.road_suspension.stiffness"]
    assert (stiffness.shown_unit, stiffness.default * stiffness.shown_factor) == (
        "kN/m",
        pytest.approx(75.53),
    )
    amplitude = PARAMETER["road.amplitude"]
    assert (amplitude.shown_unit, amplitude.default * amplitude.shown_factor) == ("mm", pytest.approx(100))
    speed = PARAMETER["drive.speed_kmh"]
    assert (speed.shown_unit, speed.shown_factor) == ("km/h", 1)


@pytest.mark.parametrize(
    ("key", "low", "high"),
    [  # what model/MODEL.md says was tried
        ("drive.speed_kmh", 2, 70),
        ("road.amplitude", 0, 0.3),
        ("road.wavelength", 0.5, 20),
        ("vehicle.road_suspension.stiffness", 7553, 755300),
        ("vehicle.imaginary_suspension.stiffness", 1000, 100000),
        ("simulation.baumgarte_alpha", 0, 1000),
        ("simulation.baumgarte_beta", 0, 1000),
    ],
)
def test_ranges_hold_what_was_tried(key, low, high):
    assert PARAMETER[key].low <= low
    assert PARAMETER[key].high >= high


def test_sections():
    assert {"vehicle", "vehicle.chassis", "contact", "drive", "road", "simulation"} <= SECTIONS
    assert not SECTIONS & set(PARAMETER)


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (5125.0, "5125"),
        (6e7, "6e7"),
        (1e-4, "0.0001"),
        (1e-6, "1e-6"),
        (0.0, "0"),
        (1.5e10, "1.5e10"),
        (-0.5, "-0.5"),
    ],
)
def test_number_text(value, text):
    assert number_text(value) == text


def test_parameter_table_is_markdown_with_a_row_for_each_key():
    lines = parameter_table().splitlines()
    assert len(lines) == 2 + len(PARAMETERS)
    assert len({line.count(" | ") for line in lines}) == 1
    for line, parameter in zip(lines[2:], PARAMETERS, strict=True):
        assert line.startswith(f"| `{parameter.key}` |")
    assert "| 75530 N/m | a number from 10 to 1e8 N/m, or a list" in parameter_table()
