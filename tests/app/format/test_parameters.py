"""Parameters as people read and type them."""

from __future__ import annotations

from typing import Any

import pytest

from app.format.parameters import allowed, file_number, file_value, hint, refusal, shown_label, shown_number, shown_text
from model.config.config import ConfigError
from model.config.config_files import load_config
from model.config.parameters import GROUPS, NOTES, PARAMETER, PARAMETERS
from tests.app.conftest import as_typed

PAPER = load_config("paper")
STIFFNESS = "vehicle.road_suspension.stiffness"
NUMBERS = [parameter for parameter in PARAMETERS if parameter.kind in ("number", "integer")]


@pytest.mark.parametrize("parameter", NUMBERS, ids=lambda parameter: parameter.key)
def test_numbers_go_to_the_shown_unit_and_back_unharmed(parameter: Any) -> None:
    values = (parameter.low, parameter.high, parameter.slider_low, parameter.default or parameter.low)
    for value in values:
        assert file_number(parameter, shown_number(parameter, value)) == pytest.approx(value, rel=1e-9)
        assert file_value(parameter, shown_text(parameter, value)) == pytest.approx(value, rel=1e-9)


def test_shown_numbers_have_no_rounding_noise() -> None:
    assert shown_number(PARAMETER[STIFFNESS], 75530.0) == 75.53
    assert file_number(PARAMETER[STIFFNESS], 75.53) == 75530.0
    assert file_number(PARAMETER["road.amplitude"], 55.0) == 0.055
    assert shown_text(PARAMETER["simulation.atol"], 1e-10) == "1e-10"


def test_typed_texts() -> None:
    start, positions = PARAMETER["road.start"], PARAMETER["vehicle.road_wheels.positions"]
    assert file_value(start, "  ") is None
    assert file_value(start, "3.5") == 3.5
    for text in ("abc", "4.7/2", "1_0", "nan", "1e", "3, , 4"):
        assert file_value(start, text) == text
    assert file_value(positions, "1.75, 1.05,0.35") == (1.75, 1.05, 0.35)
    assert file_value(positions, "[1.75; 1.05]") == (1.75, 1.05)
    assert file_value(PARAMETER[STIFFNESS], "60, 70.5") == (60000.0, 70500.0)
    assert file_value(PARAMETER[STIFFNESS], "60 70.5") == (60000.0, 70500.0)
    assert file_value(start, "60 70.5") == "60 70.5"
    assert file_value(PARAMETER["simulation.rtol"], "1e-5") == 1e-5


def test_labels_fit_one_line_and_hints_explain() -> None:
    for parameter in PARAMETERS:
        if parameter.group != NOTES:
            assert len(as_typed(shown_label(parameter))) <= 26, parameter.key
            unit = shown_label(parameter)[len(parameter.label) + 2 :]
            assert " " not in unit, f"{unit} may be broken"
            explained = parameter.description.lower().replace("left out:", "empty:")
            told = hint(parameter).lower()
            assert explained in told or (parameter.kind == "choice" and explained.replace("_", " ") in told)
            assert "left out" not in told
            assert parameter.symbol in hint(parameter)
            assert parameter.shown_unit in hint(parameter)
    assert as_typed(shown_label(PARAMETER[STIFFNESS])) == "Suspension stiffness, kN/m"
    assert "When it grows: " in hint(PARAMETER[STIFFNESS])


def test_a_refusal_has_the_unit_of_the_basis() -> None:
    config = PAPER.replace({"vehicle.road_suspension.basis": "torsion"})
    with pytest.raises(ConfigError) as caught:
        config.replace({STIFFNESS: 1.0})
    assert refusal(caught.value.faults[0], 1.0, config).endswith("Give 0.01 to 100000 kN m/rad.")


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({"road.amplitude": 0.9}, "Amplitude: 900 mm is not allowed. Give 0 to 500 mm."),
        ({"drive.speed_kmh": float("nan")}, "Speed: nan is not allowed. Give 0.5 to 100 km/h."),
        ({"road.start": "abc"}, "Start of road: 'abc' is not allowed. Give -50 to 1000 m."),
        ({"road.amplitude": 0.5, "road.wavelength": 0.3}, "Amplitude: must not be greater than the wavelength, 0.3 m."),
        ({"drive.speed_kmh": None}, "Speed: a value is needed. Give 0.5 to 100 km/h."),
        (
            {"simulation.duration": 600},
            "Output rate: 600 s at 200 samples a second are more than the 100000 samples that are allowed; 166 a "
            "second, or 500 s, would do.",
        ),
        ({"drive.speed_kmh": (1.0, 5.0)}, "Speed: one number is needed, with a point: 1.5, not 1,5. Give 0.5 to 100"),
        ({STIFFNESS: (0.0, 5e3)}, "Suspension stiffness: 0, 5 kN/m is not allowed. Give 0.01 to 100000 kN/m, for each"),
        ({STIFFNESS: (float("inf"), 5e3)}, "Suspension stiffness: "),
        ({"vehicle.road_wheels.count": 2.5}, "Road wheels: 2.5 is not allowed; give a whole number from 2 to 20."),
    ],
)
def test_refusals_name_label_range_and_unit(changes: dict[str, Any], expected: str) -> None:
    with pytest.raises(ConfigError) as caught:
        PAPER.replace(changes)
    (fault,) = caught.value.faults
    assert refusal(fault, changes.get(fault.path), PAPER).startswith(expected)


def test_allowed_values_in_the_shown_unit() -> None:
    assert allowed(PARAMETER[STIFFNESS]) == "0.01 to 100000 kN/m"
    assert allowed(PARAMETER["road.type"]).startswith("one of flat, sine, half round")


def test_no_parameter_is_called_like_another_a_folder_or_a_mode() -> None:
    labels = [parameter.label for parameter in PARAMETERS]
    assert len(set(labels)) == len(labels)
    assert not {*labels, *GROUPS} & {"Run", "Drive"}
    assert not set(labels) & set(GROUPS)
