"""What a page tells of the tab "Study": anybody may have written it."""

from __future__ import annotations

import json

import pytest

from app.runs.study_choice import COLUMNS, ROWS, StudyChoice, choice_from, figures_of, keys_of, variable_keys
from model.config.config_files import load_config

PAPER = load_config("paper")


def test_a_choice_comes_back_as_it_was():
    choice = StudyChoice("map", ("road.amplitude",), ("shock", "peak_load.R1"), "shock", False, low_pass=20.0, fit=3)
    assert choice_from(json.dumps(choice.__dict__)) == choice


@pytest.mark.parametrize(
    "text", ["", "null", "[]", "{", '{"view": 3, "columns": "x", "rows": [[]], "fit": -1}', "1e999"]
)
def test_nonsense_is_the_usual_choice(text):
    assert choice_from(text) == StudyChoice()


def test_unknown_keys_and_figures_are_left_out():
    told = {"columns": ["no.such", "road.amplitude", "road.type"], "rows": ["grip", "pitch"], "x": "name"}
    choice = choice_from(json.dumps(told))
    assert (choice.columns, choice.rows, choice.x) == (("road.amplitude",), ("pitch",), StudyChoice().x)


def test_a_row_may_be_of_a_wheel_that_this_vehicle_does_not_have():
    assert figures_of(("peak_load.R9", "peak_load.R1", "peak_load.R1"), PAPER) == ("peak_load.R1",)


def test_without_imaginary_wheels_there_is_nothing_of_theirs():
    without = PAPER.replace({"vehicle.imaginary_wheels.enabled": False})
    assert "imaginary_share" in figures_of(ROWS, PAPER)
    assert "imaginary_share" not in figures_of(ROWS, without)
    assert "vehicle.imaginary_suspension.stiffness" in keys_of(COLUMNS, PAPER)
    assert "vehicle.imaginary_suspension.stiffness" not in keys_of(COLUMNS, without)


def test_only_keys_of_the_road_are_offered():
    assert "road.wavelength" in variable_keys(PAPER)
    assert "road.height" not in variable_keys(PAPER)
    assert "road.height" in variable_keys(PAPER.replace({"road.type": "half_round"}))
