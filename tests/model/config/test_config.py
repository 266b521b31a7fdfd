"""Configurations: defaults, presets, reading, round trips and replacement."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from model.config.config import Config, ConfigError, FlatRoad, RoadWheels, Vehicle, config_from_dict
from model.config.config_files import dump_config, load_config, parse_config, parse_value, preset_names, preset_title
from model.config.parameters import PARAMETER, PARAMETERS, Parameter
from model.config.validation import IMAGINARY, WHEELS

REFERENCES = sorted((Path(__file__).parents[2] / "reference").glob("*.yaml"))


# Defaults and presets


def test_defaults_are_the_papers_vehicle():
    config = Config()
    vehicle = config.vehicle
    assert (vehicle.chassis.mass, vehicle.chassis.pitch_inertia, vehicle.chassis.cg_height) == (
        5125,
        14630,
        0.95,
    )
    wheels = vehicle.road_wheels
    assert (wheels.count, wheels.spacing, wheels.offset, wheels.radius, wheels.mass) == (6, 0.7, 0, 0.32, 75)
    assert wheels.positions is None
    assert (vehicle.road_arms.length, vehicle.road_arms.angle_deg, vehicle.road_arms.mass) == (0.35, 20, 30)
    road = vehicle.road_suspension
    assert (road.basis, road.stiffness, road.damping) == ("wheel", 75530, 4732)
    assert (vehicle.imaginary_wheels.enabled, vehicle.imaginary_wheels.mass, vehicle.imaginary_arms.mass) == (
        True,
        75,
        5,
    )
    imaginary = vehicle.imaginary_suspension
    assert (imaginary.basis, imaginary.stiffness, imaginary.damping) == ("wheel", 10000, 5000)
    assert (imaginary.preload_deflection, imaginary.preload_force, imaginary.reacts_on) == (
        0.1,
        None,
        "road_arm",
    )
    contact = config.contact
    assert (contact.normal_stiffness, contact.normal_damping) == (6e7, 3e7)
    assert (contact.tangential_stiffness, contact.tangential_damping, contact.friction) == (5e5, 1e4, 0.7)
    drive = config.drive
    assert (drive.mode, drive.speed_kmh) == ("cruise", 15)
    assert (drive.proportional_gain, drive.integral_gain, drive.force_limit) == (20000, 10000, 40000)
    assert config.road.model_dump() == {
        "type": "sine",
        "amplitude": 0.1,
        "wavelength": 7,
        "start": None,
        "ramp": None,
    }
    run = config.simulation
    assert (run.duration, run.output_rate, run.integrator) == (10, 200, "stretched-rk43")
    assert (run.rtol, run.atol, run.baumgarte_alpha, run.baumgarte_beta) == (1e-4, 1e-6, 20, 20)


def test_nothing_at_all_is_the_default():
    assert parse_config("") == parse_config("vehicle:\ncontact: {}") == config_from_dict(None) == Config()


def test_presets():
    assert preset_names()[0] == "paper"
    assert load_config("paper").model_copy(update={"name": "Paper vehicle", "description": ""}) == Config()
    assert load_config("paper_0583").vehicle.road_wheels.spacing == 0.583
    assert load_config("half_round").road.type == "half_round"
    assert len({preset_title(name) for name in preset_names()}) == len(preset_names())
    for name in preset_names():
        assert load_config(name).description.endswith("."), name


@pytest.mark.parametrize("path", REFERENCES, ids=lambda path: path.stem)
def test_reference_cases_load(path):
    given = yaml.safe_load(path.read_text())
    config = load_config(path)
    assert config.name == path.stem
    assert config.simulation.duration == given["simulation"]["duration"]


def test_there_are_reference_cases():
    assert len(REFERENCES) == 27


# Reading


def test_numbers_as_yaml_writes_them():
    config = parse_config("contact: {normal_stiffness: 5e7, normal_damping: 2.0e+7, friction: '0.5'}")
    assert (config.contact.normal_stiffness, config.contact.normal_damping, config.contact.friction) == (
        5e7,
        2e7,
        0.5,
    )
    assert parse_config("vehicle: {road_wheels: {count: 5.0}}").vehicle.road_wheels.count == 5


@pytest.mark.parametrize(("word", "value"), [("true", True), ("off", False), ("No", False), ("yes", True)])
def test_flags_as_yaml_writes_them(word, value):
    text = f"vehicle: {{imaginary_wheels: {{enabled: {word}}}}}"
    assert parse_config(text).vehicle.imaginary_wheels.enabled is value


def test_per_wheel_lists_and_positions():
    config = parse_config("""
vehicle:
  road_wheels: {positions: [1.5, 0.5, -1.6]}
  road_suspension: {stiffness: [6e4, 5e4, 7e4]}
""")
    assert config.vehicle.road_suspension.stiffness == (6e4, 5e4, 7e4)
    wheels = config.vehicle.road_wheels
    assert (wheels.count, wheels.x) == (3, (1.5, 0.5, -1.6))
    assert (wheels.spacing, wheels.offset) == (pytest.approx(1.55), pytest.approx(-0.05))


def test_texts_are_one_line_of_printable_characters():
    assert parse_config("name: '  a\n\n   b '").name == "a b"
    for text in ("a\\x07b", "x" * 101):
        with pytest.raises(ConfigError, match="at most 100 printable characters"):
            parse_config(f'name: "{text}"')


def test_missing_road_type_means_sine():
    assert parse_config("road: {amplitude: 0.2}").road == parse_config("road: {type: sine, amplitude: 0.2}").road


# Files


def test_a_missing_file_or_preset_names_the_presets(tmp_path):
    for name in ("papr", tmp_path / "no.yaml"):
        with pytest.raises(ConfigError, match=r"no such file, nor a preset.*paper, .*half_round"):
            load_config(name)


def test_files_that_cannot_be_read(tmp_path):
    latin = tmp_path / "latin.yaml"
    latin.write_bytes("name: Kettenlaufwerk für alle".encode("latin-1"))
    large = tmp_path / "large.yaml"
    large.write_text("#" * 8_000_001)
    for path, words in [
        (latin, "not UTF-8"),
        (large, "larger than"),
        (tmp_path, "cannot be read"),
        ("a\0b", "read"),
    ]:
        with pytest.raises(ConfigError, match=words):
            load_config(path)


def test_a_file_may_begin_with_a_byte_order_mark(tmp_path):
    path = tmp_path / "mark.yaml"
    path.write_text("name: marked", encoding="utf-8-sig")
    assert load_config(path).name == "marked"


# Types


def test_configurations_are_frozen_and_hashable():
    config = Config()
    with pytest.raises(ValidationError):
        config.name = "other"
    with pytest.raises(ValidationError):
        config.vehicle.chassis.mass = 1
    assert len({config, Config(), config.replace({"name": "other"})}) == 2


def test_making_one_from_sections_checks_as_well():
    assert Config(road=FlatRoad()).road.type == "flat"
    assert Config(vehicle=Vehicle(road_wheels=RoadWheels(count=5))) == config_from_dict(
        {"vehicle": {"road_wheels": {"count": 5}}}
    )
    with pytest.raises(ConfigError, match=r"vehicle\.road_wheels\.count: 1 is not allowed"):
        Config(vehicle=Vehicle(road_wheels=RoadWheels(count=1)))
    assert Config.model_validate(Config()) == Config()


# Replacing


def test_replace_gives_a_new_one_and_leaves_the_old():
    old = Config()
    new = old.replace({"vehicle.road_suspension.stiffness": 60000, "name": "Softer"})
    assert (new.vehicle.road_suspension.stiffness, old.vehicle.road_suspension.stiffness) == (60000, 75530)
    assert new == parse_config("name: Softer\nvehicle: {road_suspension: {stiffness: 60000}}")
    assert old.replace({}) == old


def test_replace_reports_all_faults_as_a_file_does():
    changes = {"drive.speed": 5, "drive.speed_kmh": -1, "vehicle.chassis": 5, "drive.speed_kmh.x": 1, "": 1}
    with pytest.raises(ConfigError) as error:
        Config().replace(changes)
    messages = {fault.path: fault.message for fault in error.value.faults}
    assert set(messages) == set(changes)
    assert "the nearest known one is drive.speed_kmh" in messages["drive.speed"]
    assert "give a number from 0.5 to 100 km/h" in messages["drive.speed_kmh"]
    assert "is a section; name one of its keys, such as vehicle.chassis.mass" in messages["vehicle.chassis"]


@pytest.mark.parametrize("preset", ["paper", "marder", "half_round", "random_road"])
def test_a_single_value_that_is_replaced_is_as_if_it_had_been_in_the_file(preset):
    base = load_config(preset)
    for key, value in base.values().items() - {("name", base.name)}:
        nudged = 1.01 * value if isinstance(value, float) else value
        with suppress(ConfigError):
            expected = parse_config(dump_config(base.replace({"name": "other", key: nudged})))  # a text: all is checked
            found = base.replace({key: nudged}).replace({"name": "other"})
            assert found == expected, key
            assert dump_config(found) == dump_config(expected)
            assert hash(found) == hash(expected)


def test_a_value_that_no_longer_fits_the_others_is_refused_alone_too():
    base = load_config("paper")
    with pytest.raises(ConfigError, match="must not be greater than the wavelength"):
        base.replace({"road.wavelength": 0.4}).replace({"road.amplitude": 0.5})
    parts = [{"type": "half_round", "position": 2.8}]
    with pytest.raises(ConfigError, match=r"road\.parts"):
        base.replace({"road.type": "sum", "road.parts": parts}).replace({"vehicle.road_wheels.radius": 1.0})


def test_replace_drops_the_other_way_to_say_the_same():
    forced = Config().replace({f"{IMAGINARY}.preload_force": 2000})
    assert forced.vehicle.imaginary_suspension.preload_force == 2000
    back = forced.replace({f"{IMAGINARY}.preload_deflection": 0.05})
    assert back.vehicle.imaginary_suspension.preload_force is None
    assert back.vehicle.imaginary_suspension.preload_deflection == 0.05
    assert forced.replace({f"{IMAGINARY}.preload_force": None}) == Config()

    placed = Config().replace({f"{WHEELS}.positions": [2, 0.5, -1]})
    assert placed.vehicle.road_wheels.x == (2, 0.5, -1)
    counted = placed.replace({f"{WHEELS}.count": 4}).vehicle.road_wheels
    assert (counted.positions, counted.count) == (None, 4)
    assert (counted.spacing, counted.offset) == (1.5, 0.5)
    with pytest.raises(ConfigError, match="says the same"):
        Config().replace({f"{WHEELS}.positions": [2, 0.5, -1], f"{WHEELS}.count": 3})


def test_replacing_the_road_type_drops_the_other_types_keys():
    sine = Config().replace({"road.amplitude": 0.2})
    round_one = sine.replace({"road.type": "half_round"})
    assert round_one.road == load_config("half_round").road
    assert round_one.replace({"road.type": "sine"}).road == Config().road
    assert sine.replace({"road.type": "half_round", "road.height": 0.15}).road.height == 0.15
    with pytest.raises(ConfigError, match="a road of type flat has no such key"):
        sine.replace({"road.type": "flat", "road.amplitude": 0.2})
    with pytest.raises(ConfigError, match=r"road\.type: 'x' is not allowed"):
        sine.replace({"road.type": "x"})


def test_replacing_the_count_beside_a_list_says_so():
    config = Config().replace({"vehicle.road_suspension.stiffness": [7e4] * 6})
    with pytest.raises(ConfigError, match=r"6 values for 5 road wheels; give 5, or one number for all"):
        config.replace({"vehicle.road_wheels.count": 5})


def test_values_by_path():
    config = load_config("half_round")
    assert config.value("drive.speed_kmh") == 15
    assert config.value("road.radius") == 0.2
    for path in ("road.amplitude", "drive", "drive.speed", "", "__class__", "drive.__class__"):
        with pytest.raises(KeyError):
            config.value(path)


@pytest.mark.parametrize(
    ("text", "lines"),
    [
        ("name: A\ndrive: {speed_kmh: 4000}\n", [2]),
        ("# mine\ndrive:\n  driver: {}\n  speed_kmh: 4000\nroads: {}\n", [5, 3, 4]),
        ("road:\n  type: sum\n  parts:\n    - type: step\n    - {type: step, height: 90}\n", [5]),
        ("road:\n  type: half_round\n  amplitude: 1\n", [3]),
        ("name: A\nvehicle:\n  road_wheels: [1, 2\n  seat: {x: 1}\nroad: {}\n", [3]),  # where the bracket opens
        ("name: A\nroad:\n  type: sine\n amplitude: 1\n", [4]),
        ("name: A\nroad\ndrive: {}\n", [2]),
        ("name: 'A\ndrive: {}\n", [1]),
        ("name: A\ndrive: \x07\n", [2]),
        ("- 1\n- 2\n", [0]),
    ],
)
def test_faults_of_a_text_know_their_lines(text, lines):
    with pytest.raises(ConfigError) as error:
        parse_config(text)
    assert sorted(fault.line for fault in error.value.faults) == sorted(lines), error.value


def test_single_values_as_on_the_command_line():
    config = Config().replace({"contact.normal_stiffness": parse_value("5e7"), "road.start": parse_value("null")})
    assert (config.contact.normal_stiffness, config.road.start) == (5e7, None)
    assert parse_value("[1, 2]") == ["1", "2"]
    with pytest.raises(ConfigError, match="line 1"):
        parse_value("[1, 2")


# Properties


def allowed(parameter: Parameter) -> st.SearchStrategy:
    numbers = st.floats(parameter.low, parameter.high)
    match parameter.kind:
        case "number":
            return numbers
        case "integer":
            return st.integers(int(parameter.low), int(parameter.high))
        case "choice":
            return st.sampled_from(parameter.choices)
        case "flag":
            return st.booleans()
        case "text":
            return st.text(max_size=int(parameter.high))
    steps = st.lists(st.floats(0.1, 5), min_size=1, max_size=19)
    return steps.map(lambda gaps: [0.05 + sum(gaps[i:]) for i in range(len(gaps))] + [-0.05])


def changes(keys: list[str]) -> st.SearchStrategy[dict]:
    return st.fixed_dictionaries({}, optional={key: allowed(PARAMETER[key]) for key in keys})


@settings(max_examples=60, deadline=None)
@given(st.sampled_from(PARAMETER["road.type"].choices), st.data())
def test_what_is_dumped_comes_back(road_type, data):
    keys = [
        parameter.key for parameter in PARAMETERS if parameter.applies_to(road_type) and parameter.key != "road.type"
    ]
    config = Config().replace({"road.type": road_type})
    for key, value in data.draw(changes(keys)).items():
        with suppress(ConfigError):  # one that does not fit the others
            config = config.replace({key: value})
    text = dump_config(config)
    assert parse_config(text) == config
    assert config_from_dict(yaml.safe_load(text)) == config  # any YAML reader reads the same
    assert config.replace({}) == config


def test_a_dump_says_everything_once():
    given = yaml.safe_load(dump_config(Config()))
    assert list(given) == ["name", "description", "vehicle", "contact", "drive", "road", "simulation"]
    assert given["contact"]["normal_stiffness"] == 6e7
    assert "inertia" not in given["vehicle"]["road_wheels"]
    placed = yaml.safe_load(dump_config(Config().replace({"vehicle.road_wheels.positions": [1, 0, -1]})))
    assert list(placed["vehicle"]["road_wheels"]) == ["positions", "radius", "mass"]
    forced = yaml.safe_load(dump_config(Config().replace({"vehicle.imaginary_suspension.preload_force": 2000})))
    assert "preload_deflection" not in forced["vehicle"]["imaginary_suspension"]
