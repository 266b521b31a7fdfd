"""Files that users bring along."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from app.files.uploads import ProfileQuestion, configuration, profile, profile_changes, question, run_from
from model.config.config import Config, ConfigError, ProfileRoad
from model.config.config_files import SIZE_LIMIT, load_config
from model.config.profile_files import ProfileFile, Reading, read_profile_file
from tests.app.conftest import make_run

PAPER = load_config("paper")


def test_files_of_any_content_lead_to_a_message(monkeypatch: pytest.MonkeyPatch) -> None:
    run = make_run(samples=3)
    good = run.to_bytes(".npz")
    assert np.array_equal(run_from("a.npz", good).normal_load, run.normal_load)
    for content in (b"", b"\0" * 100, good[:-100], good[: len(good) // 2], b"PK\x05\x06" + bytes(18)):
        with pytest.raises(ValueError, match="a\\.npz"):
            run_from("a.npz", content)
    monkeypatch.setattr("app.files.uploads.RUN_LIMIT", 2e6)
    with pytest.raises(ValueError, match="larger than 2 MB"):
        run_from("a.npz", bytes(2_000_001))
    monkeypatch.setattr("app.files.uploads.UNPACKED_LIMIT", 7e3)
    with pytest.raises(ValueError, match="more than 0 MB"):
        run_from("a.npz", good)
    for content in (b"\xff\xfe", b"a" * (SIZE_LIMIT + 1), b"[", b"- 1"):
        with pytest.raises(ConfigError):
            configuration("a.yaml", content)


def test_a_profile_whose_headings_say_all_is_read_at_once() -> None:
    read = profile("a.csv", b"x [m],height [mm]\n0,0\n1,100\n3,0\n")
    assert isinstance(read, ProfileFile)
    assert read.said == "3 points, 0 to 3 m, heights 0 to 100 mm; x read as m, heights as mm"


@pytest.mark.parametrize(
    ("content", "why", "reading"),
    [
        ("x,z\n0,0\n1,0.1\n3,0\n", "The heading of x and of z names no unit", (("x", "z"), ("m", "m"))),
        ("x [m],z [m]\n0,0\n1,90\n3,0\n", "steeper than 85°", (("x [m]", "z [m]"), ("m", "mm"))),
        ("0,0,0\n1,0,0.1\n3,0,0\n", "which columns are x and height?", (("1", "2"), ("m", "m"))),
    ],
)
def test_a_profile_that_is_not_clear_is_a_question(content: str, why: str, reading: tuple[Any, Any]) -> None:
    asked = profile("a.csv", content.encode())
    assert isinstance(asked, ProfileQuestion)
    assert why in asked.why
    assert asked.reading == Reading(*reading)


@pytest.mark.parametrize("content", [b"x,y\n0,0\n1,high\n", b"", b"x,z\n2,0\n1,0\n0,0\n"])
def test_a_profile_that_can_be_read_in_no_way_is_refused(content: bytes) -> None:
    with pytest.raises(ConfigError, match=r"a\.csv"):
        profile("a.csv", content)
    with pytest.raises(ConfigError, match=r"a\.csv"):
        question("a.csv", content, Reading((), ()))


def test_the_user_is_asked_again_with_what_was_chosen_or_with_what_is_likely() -> None:
    content = b"x,left,right\n0,0,0\n1,0,0.1\n3,0,0\n"
    chosen = Reading(("x", "right"), ("ft", "in"))
    assert question("a.csv", content, chosen).reading == chosen
    for other in (Reading((), ()), Reading(("right",), ("m", "m")), Reading(("x", "other"), ("m", "m"))):
        assert question("a.csv", content, other).reading == Reading(("x", "left"), ("m", "m"))


def test_what_is_chosen_is_in_the_configuration_as_a_file_would_say_it() -> None:
    content, reading = b"x,left,right\n0,0,0\n10,1,2\n30,0,0\n", Reading(("x", "right"), ("ft", "in"))
    read = read_profile_file(content, reading.columns, reading.units)
    config = PAPER.replace(profile_changes("a.csv", read, reading, PAPER))
    assert isinstance(config.road, ProfileRoad)
    assert (config.road.columns, config.road.units) == (("x", "right"), ("ft", "in"))
    assert config.road.points == "0.0 0.0, 3.048 0.0508, 9.144 0.0"


def test_a_profile_stays_where_its_file_says_or_comes_ahead_of_the_vehicle() -> None:
    def changes(content: str, config: Config = PAPER) -> dict[str, Any]:
        return profile_changes("a.csv", read_profile_file(content.encode()), None, config)

    assert "road.start" not in changes("3,0\n4,0.1\n")
    assert changes("0,5\n4,5.1\n")["road.start"] == 2.75
    assert "road.start" not in changes("x [m],z [m]\n12345.6,5\n12350,5.1\n")
    config = PAPER.replace({"road.type": "profile", "road.columns": ["a", "b"], "road.units": "mm"})
    assert config.replace(changes("3,0\n4,0.1\n", config)).road.columns == ()
