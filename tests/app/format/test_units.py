"""Units by choice: what becomes of each unit of the tables, and that a value that is shown and left alone stays."""

from __future__ import annotations

import pytest

from app.format.parameters import (
    allowed,
    file_number,
    file_value,
    hint,
    refusal,
    shown_label,
    shown_number,
    shown_text,
    slider_numbers,
    step_number,
)
from app.format.units import BY_CHOICE, CHOICES, FINER, METRIC, TABLE, US, Units
from model.analysis.figures import FIGURES
from model.config.config import ConfigError
from model.config.config_files import load_config
from model.config.parameters import PARAMETER, PARAMETERS, Parameter
from tests.app.conftest import as_typed

PAPER = load_config("paper")
SPEED, DAMPING = PARAMETER["drive.speed_kmh"], PARAMETER["vehicle.road_suspension.damping"]
NUMBERS = [parameter for parameter in PARAMETERS if parameter.kind in ("number", "integer", "list")]
# Units that stay, since engineers of all countries use them, or since they tell about the computation
STAY = {"", "°", "%", "s", "ms", "1/s", "W", "µm", "1/rad²", "g", "m/s¹·⁷⁵"}


def test_each_unit_of_the_tables_has_another_or_stays_on_purpose() -> None:
    units = {parameter.shown_unit for one in NUMBERS for parameter in (one, one.torsional())}
    units |= {figure.unit for figure in FIGURES}
    assert units - TABLE.keys() <= STAY
    assert not TABLE.keys() & (STAY | BY_CHOICE)
    assert {unit for unit, _ in CHOICES.values()} <= TABLE.keys()


@pytest.mark.parametrize(
    ("value", "unit", "told", "name"),
    [
        (8.82, "kN", 1982.8, "lbf"),
        (100, "mm", 3.937, "in"),
        (7, "m", 22.966, "ft"),
        (100, "km/h", 62.137, "mph"),
        (9.80665, "m/s²", 1.0, "g"),
        (1.0, "m/s", 3.2808, "ft/s"),
        (5125, "kg", 11298.7, "lb"),
        (14630, "kg m²", 347175, "lb ft²"),
        (75.53, "kN/m", 431.28, "lbf/in"),
        (4732, "N s/m", 27.020, "lbf s/in"),
        (1.0, "MN/m²", 145.04, "lbf/in²"),  # as of pressures: 1 MPa is 145.04 psi
        (1.0, "kN m/rad", 8850.7, "lbf in/rad"),
        (100, "N m", 73.756, "lbf ft"),
        (96.17, "m²/s³", 1.0, "g²/Hz"),
        (4.0, "1/m²", 0.37161, "1/ft²"),
        (30.0, "MN s/m³", 110.52, "lbf s/in³"),
    ],
)
def test_known_conversions(value: float, unit: str, told: float, name: str) -> None:
    other = US.of(unit)
    assert other.name == name
    assert value * other.factor == pytest.approx(told, rel=1e-4)
    assert METRIC.of(unit) == (unit, 1.0, 0)


def test_each_choice_stands_for_itself() -> None:
    mixed = METRIC.changed({"force": "lbf", "speed": "mph"})
    assert mixed == Units(force="lbf", speed="mph")
    assert [mixed.of(unit).name for unit in ("kN", "mm", "km/h", "m/s²", "kN/m")] == [
        "lbf",
        "mm",
        "mph",
        "m/s²",
        "lbf/m",
    ]
    assert US.changed(METRIC.chosen) == METRIC
    assert METRIC.changed({"force": "stone", "length": 3, "colour": "mph"}) == METRIC  # anybody may have written it


def test_a_vehicle_is_told_in_inches_and_the_way_in_feet() -> None:
    assert US.told(PARAMETER["vehicle.road_wheels.spacing"]).shown_unit == "in"
    assert US.told(PARAMETER["road.wavelength"]).shown_unit == "ft"
    assert US.told(PARAMETER["road.amplitude"]).shown_unit == "in"


@pytest.mark.parametrize("parameter", [one for one in NUMBERS if one.kind != "list"], ids=lambda one: one.key)
def test_what_is_shown_and_left_alone_is_the_same_value(parameter: Parameter) -> None:
    for basis in (parameter, parameter.torsional()):
        told = US.told(basis)
        for value in (parameter.default or parameter.low, parameter.low, parameter.high, parameter.slider(1.0)[1]):
            shown = shown_number(told, value)
            assert file_number(told, shown, (value,)) == value
            assert file_value(told, shown_text(told, value), value) == value
            assert shown == pytest.approx(value * told.shown_factor, rel=1e-3)
            assert file_number(told, shown) == pytest.approx(value, rel=1e-3)
        for bound in (parameter.low, parameter.high):
            assert file_number(told, shown_number(told, bound)) == bound  # what is said to be allowed is


def test_of_a_list_only_the_number_that_is_typed_changes() -> None:
    told = US.told(DAMPING)
    values = (4732.0, 4000.0, 4732.0)
    assert shown_text(told, values) == "27.02, 22.84, 27.02"
    assert file_value(told, "27.02, 30, 27.02", values) == (4732.0, pytest.approx(5253.8, rel=1e-5), 4732.0)


@pytest.mark.parametrize("text", ["9", "27.5", "0.3125", "12.345", "123456"])
def test_a_typed_number_is_taken_in_full_and_stays_as_it_was_typed(text: str) -> None:
    for parameter in (SPEED, DAMPING, PARAMETER["road.amplitude"], PARAMETER["vehicle.chassis.mass"]):
        told = US.told(parameter)
        value = file_value(told, text)
        assert value == pytest.approx(float(text) / told.shown_factor, rel=1e-9)
        assert shown_number(told, value) == float(text)
    assert file_value(US.told(SPEED), "10") == 16.09344


def test_numbers_have_few_digits() -> None:
    shown = [shown_number(US.told(PAPER.parameter(key)), PAPER.value(key)) for key in (SPEED.key, DAMPING.key)]  # type: ignore[arg-type]
    assert shown == [9.321, 27.02]
    assert shown_number(US.told(PARAMETER["vehicle.chassis.mass"]), 5125.0) == 11299  # whole units are told in full


@pytest.mark.parametrize(
    "parameter", [one for one in NUMBERS if one.slider_high and one.shown_unit in TABLE], ids=lambda one: one.key
)
def test_sliders_have_round_steps_and_ends_that_are_allowed(parameter: Parameter) -> None:
    told = US.told(parameter)
    low, high, step = slider_numbers(told, parameter.default or parameter.slider_high)  # type: ignore[arg-type]
    assert parameter.low - 1e-9 <= file_number(told, low) < file_number(told, high) <= parameter.high * (1 + 1e-9)
    assert f"{step:e}"[0] in "125"
    assert low / step == pytest.approx(round(low / step))
    assert f"{step_number(told):e}"[0] in "125"


def test_labels_hints_and_refusals_are_in_the_units_of_choice() -> None:
    told = US.told(SPEED)
    assert as_typed(shown_label(told)) == "Speed, mph"
    assert "unit mph" in hint(told)
    assert allowed(told) == "0.3107 to 62.14 mph"
    assert "(the paper's 3.94 in)" in hint(US.told(PARAMETER["road.amplitude"]))
    with pytest.raises(ConfigError) as caught:
        PAPER.replace({SPEED.key: 160.9344})
    said = refusal(caught.value.faults[0], 160.9344, PAPER, US)
    assert said == "Speed: 100 mph is not allowed. Give 0.3107 to 62.14 mph."


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ("above about 50 km/h give more than 20 m.", "above about 31.1 mph give more than 65.6 ft."),
        ("sank 38.2 mm into the ground (t = 1.25 s)", "sank 1.5 in into the ground (t = 1.25 s)"),
        ("from 0.5 to 100 km/h", "from 0.311 to 62.1 mph"),
        ("MTVV, 1.23 m/s², or VDV, 2.5 m/s¹·⁷⁵", "MTVV, 0.125 g, or VDV, 2.5 m/s¹·⁷⁵"),
        ("6 modes, 5 N/m, 7 W, 30 Hz, m.", "6 modes, 5 N/m, 7 W, 30 Hz, m."),
    ],
)
def test_sentences_are_reworded(words: str, told: str) -> None:
    assert US.reword(words) == told
    assert METRIC.reword(words) == words


def test_the_metric_page_shows_what_it_always_has() -> None:
    for parameter in PARAMETERS:
        assert METRIC.told(parameter) is parameter


def test_the_fields_are_the_choices() -> None:
    assert METRIC.chosen == {name: units[0] for name, units in CHOICES.items()}
    assert US.chosen == {name: units[1] for name, units in CHOICES.items()}
    assert FINER == {"in": 1, "g": 1, "g²/Hz": 2}
