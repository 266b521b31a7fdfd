"""What is refused: every fault of bad input at once, in words, and never another exception."""

from __future__ import annotations

import math
import pickle
from collections.abc import Callable

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from model.config.config import Config, ConfigError, config_from_dict
from model.config.config_files import dump_config, parse_config
from model.config.parameters import PARAMETER, PARAMETERS, SECTIONS
from model.config.validation import IMAGINARY, WHEELS

KNOWN = [*PARAMETER, *SECTIONS]
ROAD_SPRING = "vehicle.road_suspension"


def faults(text: str) -> dict[str, str]:
    """Message by path of all faults of a YAML text, which must have some."""
    with pytest.raises(ConfigError) as error:
        parse_config(text)
    assert str(error.value).splitlines() == [str(fault) for fault in error.value.faults]
    return {fault.path: fault.message for fault in error.value.faults}


def only_fault(text: str) -> tuple[str, str]:
    found = faults(text)
    assert len(found) == 1, found
    return next(iter(found.items()))


@pytest.mark.parametrize(
    ("path", "value", "words"),
    [
        ("vehicle.chassis.mass", "-5", "-5 is not allowed; give a number from 1 to 100000 kg"),
        ("vehicle.chassis.mass", "heavy", "'heavy' is not allowed"),
        ("vehicle.chassis.mass", "", "nothing is not allowed"),
        ("vehicle.chassis.mass", "[5125]", "is not allowed"),
        ("vehicle.chassis.mass", "true", "'true' is not allowed"),
        ("vehicle.chassis.mass", ".nan", "is not allowed"),
        ("vehicle.chassis.mass", "nan", "nan is not allowed"),
        ("vehicle.chassis.mass", "-inf", "-inf is not allowed"),
        ("vehicle.chassis", "5", "5 is not allowed; vehicle.chassis holds keys and values"),
        (f"{WHEELS}.count", "6.5", "give a whole number from 2 to 20"),
        (f"{WHEELS}.count", "1000000", "give a whole number from 2 to 20"),
        (f"{WHEELS}.positions", "5", "give a list of 2 to 20 numbers from -50 to 50 m, front wheel first"),
        (f"{WHEELS}.positions", "[1]", "give a list of 2 to 20 numbers"),
        (f"{WHEELS}.positions", "[1, x]", "give a list of 2 to 20"),
        (f"{WHEELS}.positions", "[1, 1, -1]", "must fall from front to rear, each wheel 0.05 to 5 m behind"),
        (f"{WHEELS}.positions", "[2, 1]", "the wheels stand at 2 to 1 m; the centre of mass"),
        (f"{WHEELS}.offset", "2", "the wheels stand at 3.75 to 0.25 m; the centre of mass"),
        ("vehicle.imaginary_wheels.enabled", "2", "give true or false"),
        (f"{ROAD_SPRING}.basis", "axle", "give one of wheel, torsion"),
        (f"{ROAD_SPRING}.bump_travel", "0.5", "less than 0.4697 m"),
        (f"{ROAD_SPRING}.rebound_travel", "0.25", "less than 0.2303 m"),
        (f"{ROAD_SPRING}.damping", "[1, 2]", "2 values for 6 road wheels; give 6, or one number for all"),
        ("drive.speed_kmh", "500", "give a number from 0.5 to 100 km/h"),
        ("simulation.duration", "1000000", "from 0.1 to 600 s"),
        ("simulation.duration", "600", "600 s at 200 samples a second are more than the 100000 samples"),
        ("simulation.integrator", "euler", "give one of stretched-rk43, dormand-prince"),
        ("road.type", "cobbles", "give one of flat, sine, half_round"),
        ("road.type", "[sine]", "give one of flat"),
        ("road.start", "1", "the first wheel stands at 1.75 m"),
        ("wheels", "6", "unknown key"),
        ("drive.5", "6", "unknown key"),
        ("vehicle.chasis", "{mass: 5}", "the nearest known one is vehicle.chassis"),
        ("vehicle.chassis.masss", "5", "the nearest known one is vehicle.chassis.mass"),
        ("speed_kmh", "5", "the nearest known one is drive.speed_kmh"),
        ("drive.speed", "5", "the nearest known one is drive.speed_kmh"),
        ("vehicle.wavelength", "5", "the nearest known one is road.wavelength"),
    ],
)
def test_each_kind_of_fault(path, value, words):
    *sections, leaf = path.split(".")
    text = "".join(f"{{{section}: " for section in sections) + f"{{{leaf}: {value}}}" + "}" * len(sections)
    found, message = only_fault(text)
    assert found == path
    assert words in message


@pytest.mark.parametrize(
    ("section", "values", "path", "words"),
    [
        ("simulation", "output_rate: 2000, duration: 60", "simulation.output_rate", "more than the 100000"),
        ("simulation", "integrator: rk4, step: 1e-6", "simulation.step", "more than 5000000 steps"),
        (
            "road",
            "type: flat, ramp: 2",
            "road.ramp",
            "a road of type flat has no such key; it belongs to sine",
        ),
        ("road", "amplitude: 0.45, wavelength: 0.4", "road.amplitude", "greater than the wavelength, 0.4 m"),
        ("road", "type: half_round, height: 0.3", "road.height", "greater than the radius, 0.2 m"),
        ("road", "type: half_round, position: 2", "road.position", "give at least 2.243 m"),
        ("road", "type: trapezoid, position: 2.5", "road.position", "give at least 2.82 m"),
        ("road", "type: trapezoid, top: 2", "road.top", "greater than the base, 1.5 m"),
        ("road", "type: trapezoid, position: 2.3, top: 0.5, base: 0.5", "road.position", "give at least 2.329 m"),
        ("road", "type: step, position: 2", "road.position", "give at least 2.07 m"),
        ("road", "type: random, roughness_class: I", "road.roughness_class", "give one of A, B, C, D, E, F, G, H"),
        ("road", "type: random, seed: -1", "road.seed", "give a whole number from 0 to 999999"),
        ("road", "type: profile, points: '0 0, 1 x'", "road.points", "point 2: 'x' is no number"),
        ("road", "type: profile, points: '-3 0, 0 0, 1 0.2, 9 0'", "road.points", "not level under the vehicle"),
        ("road", "type: profile, points: [0, 0]", "road.points", "give points x y, x y, … in m, x growing"),
    ],
)
def test_values_that_do_not_fit_each_other(section, values, path, words):
    found, message = only_fault(f"{section}: {{{values}}}")
    assert found == path
    assert words in message


@pytest.mark.parametrize("value", [True, 15j])
def test_what_python_takes_for_a_number_may_be_none(value):
    with pytest.raises(ConfigError, match=r"drive\.speed_kmh.*is not allowed"):
        Config().replace({"drive.speed_kmh": value})


def test_two_ways_to_say_the_same():
    text = """
vehicle:
  road_wheels: {positions: [1, 0, -1], count: 3, spacing: 1}
  imaginary_suspension: {preload_force: 2000, preload_deflection: 0.1}
"""
    assert faults(text) == {
        f"{WHEELS}.count": f"{WHEELS}.positions says the same; leave one of them out",
        f"{WHEELS}.spacing": f"{WHEELS}.positions says the same; leave one of them out",
        f"{IMAGINARY}.preload_deflection": f"{IMAGINARY}.preload_force says the same; leave one of them out",
    }


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("[1, 2]", "['1', '2'] is not allowed; a configuration holds keys and values"),
        ("a: [1", "line 1, column 6: expected ',' or ']'"),
        ("name: a\nname: b", "line 2, column 1: the key 'name' is given twice"),
        ("road: &r {type: flat}", "anchors and aliases"),
        ("road: *r", "anchors and aliases"),
        ("name: !!python/object/apply:os.getcwd []", "tags are not used"),
        ("name: !!timestamp x", "tags are not used"),
        ("{[1, 2]: 3}", "a key must be a plain word"),
        ("a: " + "[" * 5000, "nested deeper than 20 levels"),
        ("\n".join(" " * i + "a:" for i in range(100)), "nested deeper than 20 levels"),
        ("a: [" + "1, " * 3000 + "]", "more than 2000 keys and values"),
        ("name: a\n---\nname: b", "line 2, column 1: a second document; give one"),
        ("drive:\n\tspeed_kmh: 3", "line 2, column 1: a tab; indent with blanks"),
        ("name: a: b", "line 1, column 8: a colon too many"),
        (
            "drive:\n  speed_kmh: 3: 4\n",
            "a colon too many; put texts that hold one in quotes; line 2 is 'speed_kmh: 3: 4'",
        ),
        ("drive: {speed_kmh: 3\nname: a\n", "; line 2 is 'name: a'; line 1 is 'drive: {speed_kmh: 3'"),
        ("# a\nname: \x00", "line 2: not YAML text: the character U+0000 is not allowed"),
        ("name: \ud800", "line 1: not YAML text: the character U+D800 is not allowed"),
        (r'name: "\U00110000"', "line 1, column 10: a character or a number that does not exist"),
        (r'name: "\UFFFFFFFF"', "a character or a number that does not exist"),
        ("%YAML 1." + "9" * 5000 + "\n---\n", "a character or a number that does not exist"),
    ],
)
def test_faults_of_the_text_itself(text, words):
    path, message = only_fault(text)
    assert path == ""
    assert words in message


def test_a_key_without_a_name_is_shown():
    assert set(faults("'': 1\ndrive: {'': 1}")) == {"''", "drive.''"}


def test_all_faults_at_once():
    found = faults("""
vehicle:
  chassis: {mass: -5, colour: green}
  road_wheels: {count: 5}
  road_suspension: {stiffness: [1e5, 1e5], damping: soft}
drive: {speed_kmh: .inf}
road: {type: half_round, height: 0.3, radius: 0.2, wavelength: 3}
simulation: {duration: 600, output_rate: 2000}
solver: rk4
""")
    assert set(found) == {
        "vehicle.chassis.mass",
        "vehicle.chassis.colour",
        "vehicle.road_suspension.stiffness",
        "vehicle.road_suspension.damping",
        "drive.speed_kmh",
        "road.height",
        "road.wavelength",
        "simulation.output_rate",
        "solver",
    }


def test_no_rule_speaks_about_values_that_are_at_fault_themselves():
    found = faults("vehicle: {road_wheels: {count: many}, road_suspension: {stiffness: [1e5, 1e5]}}")
    assert set(found) == {"vehicle.road_wheels.count"}


def test_faults_keep_the_value_short():
    for value in (
        "x" * 10_000,
        "9" * 10_000,
        [[1] * 1000] * 1000,
        10**5000,
        float("nan"),
        {1: {2: {3: {4: 5}}}},
    ):
        with pytest.raises(ConfigError) as error:
            config_from_dict({"drive": {"speed_kmh": value}, "x" * 10_000: value, 10**5000: value})
        for fault in error.value.faults:
            assert len(fault.value) < 200
            assert len(str(fault)) < 400


def test_faults_are_counted_out():
    with pytest.raises(ConfigError) as error:
        config_from_dict({f"key_{i}": i for i in range(1000)})
    assert len(error.value.faults) == 51
    assert str(error.value.faults[-1]) == "there are more faults"


def test_a_source_is_named_in_every_line():
    with pytest.raises(ConfigError) as error:
        parse_config("a: 1\nb: 2", source="mine.yaml")
    assert all(line.startswith("mine.yaml: ") for line in str(error.value).splitlines())


def test_errors_survive_pickling():
    with pytest.raises(ConfigError) as error:
        parse_config("a: 1", source="mine.yaml")
    copy = pickle.loads(pickle.dumps(error.value))
    assert (copy.faults, str(copy)) == (error.value.faults, str(error.value))


# Properties


scalars = (
    st.none()
    | st.booleans()
    | st.integers()
    | st.floats()
    | st.text(st.characters(exclude_categories=()), max_size=8)
    | st.binary(max_size=3)
)
anything = st.recursive(
    scalars,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(scalars, inner, max_size=3),
    max_leaves=5,
)


@st.composite
def plausible(draw) -> dict:
    """A nested mapping with mostly known keys and any values."""
    nested: dict = {}
    for path in draw(st.lists(st.sampled_from(KNOWN), max_size=6)):
        *sections, leaf = path.split(".")
        inner = nested
        for section in sections:
            if not isinstance(inner.get(section), dict):
                inner[section] = {}
            inner = inner[section]
        inner[leaf] = draw(anything)
    return nested


def outcome(make: Callable[..., Config], given: object) -> Config | ConfigError:
    """What came of it; any other exception fails the test."""
    try:
        return make(given)
    except ConfigError as error:
        return error


def is_sound(result: Config | ConfigError) -> bool:
    if isinstance(result, ConfigError):
        return 0 < len(result.faults) <= 51 and all(len(str(fault)) < 400 for fault in result.faults)
    return parse_config(dump_config(result)) == result


@settings(max_examples=150, deadline=None)
@given(plausible() | anything)
def test_anything_gives_a_config_or_a_config_error(data):
    assert is_sound(outcome(config_from_dict, data))


@settings(max_examples=100, deadline=None)
@given(st.text(st.characters(exclude_categories=()), max_size=60))
def test_any_text_gives_a_config_or_a_config_error(text):
    for sample in (text, f"name: {text}", f"road: {{amplitude: {text}}}"):
        assert is_sound(outcome(parse_config, sample))


@settings(max_examples=100, deadline=None)
@given(st.dictionaries(st.sampled_from(KNOWN) | st.text(max_size=8), anything, max_size=4))
def test_any_replacement_gives_a_config_or_a_config_error(data):
    assert is_sound(outcome(Config().replace, data))


def test_numbers_outside_are_refused_on_both_sides():
    for parameter in PARAMETERS:
        if parameter.kind == "number" and parameter.applies_to("sine"):
            for outside in (
                math.nextafter(parameter.low, -math.inf),
                math.nextafter(parameter.high, math.inf),
            ):
                with pytest.raises(ConfigError, match="is not allowed; give a number from"):
                    Config().replace({parameter.key: outside})
