"""Sums of roads: heights add up, whatever the parts, and each part is checked like a road of its own."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from model.config.config import ConfigError, RandomRoad
from model.config.config_files import dump_config, parse_config
from model.road.nearest_point import HEIGHT, NEXT, NODE
from model.road.road import Road, build_road
from model.road.table import SAME
from model.simulation.simulate import simulate
from tests.model.road.nearest import assert_nearest, centres_near
from tests.model.support import PAPER

Parts = list[dict[str, Any]]
HALF_ROUND = {"type": "half_round", "position": 8.0}
BLOCK = {"type": "trapezoid", "position": 8.5, "height": 0.15}
KERB = {"type": "step", "position": 12.0}
WAVES = {"type": "sine", "amplitude": 0.05, "wavelength": 3.0}
RIPPLES = {"type": "sine", "amplitude": 0.005, "wavelength": 0.7, "start": 5.0, "ramp": 0.0}
ROUGH = {"type": "random", "roughness_class": "D", "length": 30.0}
BUMP = {"type": "profile", "points": "6 0, 7 0.1, 7.5 0.05, 9 0.2"}
SUMS: dict[str, Parts] = {
    "nothing": [],
    "level": [{"type": "flat"}, {"type": "flat"}],
    "obstacle on rough ground": [ROUGH, HALF_ROUND],
    "obstacles": [HALF_ROUND, BLOCK, KERB, BUMP],
    "obstacle on waves": [WAVES, BLOCK],
    "two waves": [WAVES, RIPPLES],
    "all": [WAVES, ROUGH, RIPPLES, HALF_ROUND, BUMP],
}


def summed(parts: Parts) -> Road:
    return build_road(PAPER.replace({"road.type": "sum", "road.parts": parts}))


def alone(part: dict[str, Any]) -> Road:
    return build_road(PAPER.replace({f"road.{key}": value for key, value in part.items()}))


@pytest.mark.parametrize("name", SUMS)
def test_heights_add_up(name):
    """Also far behind the run's end, as far as just one part repeats itself."""
    parts = SUMS[name]
    repeating = sum(alone(part).profile.period > 0 for part in parts)
    x = np.linspace(-10.0, 1000.0 if repeating < 2 else 60.0, 20_001)
    for found, *of_parts in zip(
        summed(parts).derivatives(x), *(alone(part).derivatives(x) for part in parts), strict=True
    ):
        np.testing.assert_allclose(found, np.sum([0 * x, *of_parts], axis=0), atol=1e-9)


@pytest.mark.parametrize("name", SUMS)
def test_no_cell_is_made_of_rounding(name):
    """Where nodes of two parts fall on the same place but for the last digit."""
    cell = summed(SUMS[name]).table.cell
    assert np.diff(cell[:, NODE]).min() > SAME / 2
    assert np.isfinite(cell[:, HEIGHT:NEXT]).all()


@pytest.mark.parametrize("name", SUMS)
def test_nearest_point_on_sums(name):
    road = summed(SUMS[name])
    rng = np.random.default_rng(2)
    assert_nearest(road, centres_near(road, rng, rng.uniform(2.0, 20.0, 30)), tolerance=1e-9)


def test_a_sum_of_one_drives_as_that_road():
    one = PAPER.replace({"road.type": "random", "simulation.duration": 2})
    same = PAPER.replace({"road.type": "sum", "road.parts": [{"type": "random"}], "simulation.duration": 2})
    np.testing.assert_allclose(simulate(same).normal_load, simulate(one).normal_load, rtol=1e-3, atol=20)


def test_parts_are_kept_by_text_and_by_changes_of_others():
    config = PAPER.replace({"road.type": "sum", "road.parts": SUMS["all"]})
    assert parse_config(dump_config(config)) == config
    assert config.replace({"drive.speed_kmh": 20}).road == config.road
    assert config.replace({"road.parts": config.value("road.parts")}) == config
    assert config.value("road.parts")[1] == RandomRoad(roughness_class="D", length=30.0)
    assert config.replace({"road.type": "flat"}).replace({"road.type": "sum"}).value("road.parts") == ()


@pytest.mark.parametrize(
    ("parts", "faults"),
    [
        (
            "[{type: flat}, {type: half_round, height: 0.3}]",
            {"road.parts[1].height": "must not be greater than the radius, 0.2 m"},
        ),
        ("[{type: cobbles}]", {"road.parts[0].type": "'cobbles' is not allowed; give one of flat, sine"}),
        (
            "[{type: flat, height: 1}, 5]",
            {
                "road.parts[0].height": "a road of type flat has no such key; it belongs to half_round",
                "road.parts[1]": "5 is not allowed; a road holds keys and values",
            },
        ),
        ("[{hight: 1}]", {"road.parts[0].hight": "unknown key; the nearest known one is road.parts[0].height"}),
        ("[{type: step, position: 1}]", {"road.parts[0].position": "under the vehicle; give at least 2.07 m"}),
        ("[{type: sum, parts: []}]", {"road.parts[0].type": "a sum cannot be part of a sum"}),
        ("[{type: trapezoid, top: 3}]", {"road.parts[0].top": "must not be greater than the base, 1.5 m"}),
        ("[" + "{type: flat}, " * 11 + "]", {"road.parts": "give a list of at most 10 roads"}),
        ("{type: flat}", {"road.parts": "give a list of at most 10 roads"}),
    ],
)
def test_faults_name_the_part(parts, faults):
    with pytest.raises(ConfigError) as error:
        parse_config(f"road: {{type: sum, parts: {parts}}}")
    found = {fault.path: fault.message for fault in error.value.faults}
    assert set(found) == set(faults)
    for path, words in faults.items():
        assert words in found[path]


@pytest.mark.parametrize(
    ("wheels", "faults"),
    [("count: 8, mass: -1", ["vehicle.road_wheels.mass"]), ("count: 12", ["road.parts[1]"])],
)
def test_parts_are_checked_under_the_vehicle_that_is_given(wheels, faults):
    parts = "[{type: random}, {type: half_round}]"
    with pytest.raises(ConfigError) as error:
        parse_config(f"{{vehicle: {{road_wheels: {{{wheels}}}}}, road: {{type: sum, parts: {parts}}}}}")
    assert [fault.path for fault in error.value.faults] == faults


def test_a_part_without_a_type_is_a_sine_as_a_road_is():
    road = parse_config("road: {type: sum, parts: [{}, {amplitude: 0.2}]}").road
    assert [(part.type, part.amplitude) for part in road.parts] == [("sine", 0.1), ("sine", 0.2)]
