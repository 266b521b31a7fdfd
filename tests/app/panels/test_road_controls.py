"""Roads in the explorer: parts and their text, profiles from files, and the side view of the road ahead."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest

from app.format.units import US
from app.panels.road_parts import parts_from, parts_text, with_part, without_last
from app.runs.history import run_name
from app.runs.request import Request
from app.tabs.road_profile import AHEAD, BEHIND, HEIGHT, WIDTH, RoadAhead, road_view, span_of
from model.config.config import Config, ConfigError, HalfRoundRoad, RandomRoad, SineRoad, SumRoad
from model.config.config_files import load_config
from model.road.road import build_road
from tests.app.conftest import Tab, make_run, wait_for
from tests.app.session.test_transfers import html, upload

PAPER = load_config("paper")
FLAT = PAPER.replace({"road.type": "flat"})


def summed(*parts: dict[str, Any]) -> Config:
    return PAPER.replace({"road.type": "sum", "road.parts": parts})


# Parts


def test_an_obstacle_comes_on_the_road_that_is_there() -> None:
    config = PAPER.replace(with_part(PAPER, "half_round"))
    assert isinstance(config.road, SumRoad)
    assert [type(part) for part in config.road.parts] == [SineRoad, HalfRoundRoad]
    config = config.replace(with_part(config, "step"))
    places = [part.position for part in config.road.parts[1:]]  # type: ignore[union-attr]
    assert places[1] - places[0] >= 5
    assert config.replace(without_last(config)).road.parts == config.road.parts[:2]  # type: ignore[union-attr]


def test_level_ground_is_no_part() -> None:
    config = FLAT.replace(with_part(FLAT, "random"))
    assert config.value("road.parts") == (RandomRoad(seed=1),)
    assert FLAT.replace(with_part(config, "random")).value("road.parts") == (RandomRoad(seed=1), RandomRoad(seed=2))
    assert config.replace(without_last(config)).road == FLAT.road


def test_of_two_parts_the_first_becomes_the_road_again() -> None:
    config = PAPER.replace(with_part(PAPER, "trapezoid"))
    assert config.replace(without_last(config)).road == PAPER.road
    assert without_last(PAPER) == {}


@pytest.mark.parametrize("wheels", [2, 6, 20])
def test_what_is_added_lies_ahead_of_any_vehicle(wheels: int) -> None:
    config = FLAT.replace({"vehicle.road_wheels.count": wheels})
    for road_type in ("half_round", "trapezoid", "step", "random"):
        config = config.replace(with_part(config, road_type))
    assert len(config.value("road.parts")) == 4  # type: ignore[arg-type]


def test_parts_as_text_and_back() -> None:
    config = load_config("obstacles")
    text = parts_text(config.road.parts)  # type: ignore[union-attr]
    assert text.splitlines()[:2] == [
        "random: roughness class C, seed 7, length 200 m, longest wave 20 m",
        "half round: position 10 m, height 100 mm, radius 0.2 m",
    ]
    assert config.replace({"road.parts": parts_from(text, ())}).road == config.road
    shorter = "\n".join(text.replace("height 100 mm", "height 55").splitlines()[:2])
    road = config.replace({"road.parts": parts_from(shorter, ())}).road
    assert [part.type for part in road.parts] == ["random", "half_round"]  # type: ignore[union-attr]
    assert road.parts[1].height == 0.055  # type: ignore[union-attr]


def test_parts_in_other_units_keep_what_is_left_alone() -> None:
    config = load_config("obstacles")
    parts = config.road.parts  # type: ignore[union-attr]
    text = parts_text(parts, US)
    assert text.splitlines()[1] == "half round: position 32.81 ft, height 3.937 in, radius 0.6562 ft"
    assert config.replace({"road.parts": parts_from(text, parts, US)}).road == config.road
    higher = config.replace({"road.parts": parts_from(text.replace("height 3.937 in", "height 5"), parts, US)}).road
    assert higher.parts[1] == parts[1].model_copy(update={"height": 0.127})  # type: ignore[union-attr]
    assert higher.parts[2:] == parts[2:]  # type: ignore[union-attr]


def test_a_profile_among_the_parts_stays_what_it_is() -> None:
    config = summed({"type": "profile", "points": "5 0, 6 0.1", "file": "bump.csv"}, {"type": "step"})
    text = parts_text(config.road.parts)  # type: ignore[union-attr]
    assert text.splitlines()[0] == "profile: bump.csv"
    parts = parts_from(text, config.road.parts)  # type: ignore[union-attr]
    assert config.replace({"road.parts": parts}).road == config.road


@pytest.mark.parametrize(
    ("text", "path"),
    [
        ("half round: position 8, hight 3", "road.parts[0].hight"),
        ("flat\nstep: position far", "road.parts[1].position"),
        ("step: height 0.1 m", "road.parts[0].height_0.1"),
        ("cobbles", "road.parts[0].type"),
        ("step: position", "road.parts[0].position"),
        ("sum: parts 3", "road.parts[0].parts"),
        (": , :", "road.parts[0].type"),
    ],
)
def test_what_means_nothing_is_refused_by_its_place(text: str, path: str) -> None:
    with pytest.raises(ConfigError) as error:
        summed(*parts_from(text, ()))
    assert path in {fault.path for fault in error.value.faults}


def named(request: Request) -> str:
    return run_name(request.base, request.config())


def test_runs_on_new_roads_have_short_names() -> None:
    request = Request(PAPER, {"road.type": "profile", "road.points": "5 0, 6 0.1, 9 0"})
    assert named(request) == "Road type sine → profile, Profile 3 points, 4 m long, 0.1 m high"
    assert named(Request(PAPER, with_part(PAPER, "step"))).endswith("Parts sine + step")


# Profiles


def test_a_profile_is_opened_in_a_tab(explore: Any, open_tab: Any) -> None:
    tab: Tab = open_tab(explore())
    wait_for(lambda: tab.shows_run(1), "run 1")
    upload(tab, "Open a profile", "bad.csv", b"x,y\n0,0\n1,high\n")
    wait_for(lambda: "line 3: &#x27;high&#x27; is no number" in html(tab, "trackride-faults"), "the fault")
    assert tab.widget("Road type")["value"] == "sine"
    upload(tab, "Open a profile", "good.csv", b"x [m],y [m]\n0,0\n1,0.1\n3,0\n")
    wait_for(lambda: tab.widget("Road type")["value"] == "profile", "the profile")
    wait_for(lambda: "3 points, 3 m long, 0.1 m high" in tab.html("trackride-extent"), "what it is")


def test_obstacles_are_added_and_edited_in_a_tab(explore: Any, open_tab: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("app.session.session.REFUSAL_DELAY", 0.1)
    tab: Tab = open_tab(explore())
    wait_for(lambda: tab.shows_run(1), "run 1")
    tab.use("Add", "Half round")
    wait_for(lambda: tab.widget("Road type")["value"] == "sum", "a sum")
    text = wait_for(lambda: tab.widget("Parts")["value"], "its parts")
    assert text.splitlines()[1] == "half round: position 5.1 m, height 100 mm, radius 0.2 m"
    tab.use("Speed, km/h", 22)
    wait_for(lambda: tab.shows_run(3), "run 3")
    assert tab.widget("Parts")["value"] == text  # other sliders leave it alone
    tab.use("Parts", text.replace("height 100", "height 900"))
    wait_for(lambda: any("road.parts[1].height" in n["body"] for n in tab.notifications), "a refusal")
    wait_for(lambda: tab.widget("Parts")["value"] == text, "the good text again")
    tab.send("GuiUpdateMessage", uuid=tab.find("Take the last one away"), updates={"value": True})
    wait_for(lambda: tab.widget("Road type")["value"] == "sine", "the waves again")


# The side view


def test_side_view_has_the_road_and_the_wheels_to_scale() -> None:
    road = build_road(PAPER)
    view = road_view(road, (-0.1, 0.1), 20.0, np.array([21.0, 19.0]))
    points = np.array(re.search(r'<polyline points="([^"]+)"', view)[1].replace(",", " ").split(), float)  # type: ignore[index]
    x, y = points.reshape(-1, 2).T
    along = x / WIDTH * (BEHIND + AHEAD) + 10.0
    slope, at = np.polyfit(road.height(along), y, 1)
    assert slope < 0
    np.testing.assert_allclose(y, at + slope * road.height(along), atol=0.1)
    assert y.min() >= 0
    assert y.max() <= HEIGHT
    assert view.count("<circle") == 2
    assert re.findall(r">(-?\d+) m<", view) == ["20", "30", "40"]  # at the ends they would be cut
    told = float(re.search(r"enlarged (\S+) times", view)[1])  # type: ignore[index]
    assert told == pytest.approx(-slope / (WIDTH / (BEHIND + AHEAD)), rel=0.05)


def test_side_view_follows_time_on_one_scale() -> None:
    run = make_run(PAPER)
    run.q[:, :, 0] += 40 * run.t[:, None]
    ahead = RoadAhead()
    first, last = ahead.of_run(run, 0.0), ahead.of_run(run, 2.0)
    assert first != last
    assert first.split("figcaption")[1] == last.split("figcaption")[1]
    assert ahead.of_run(run, 2.0) == last
    assert ahead.of_drive(run, build_road(FLAT), 2.0) != last
    assert ahead.of_run(run, 2.0) == last


def test_level_ground_has_a_scale_of_its_own() -> None:
    low, high = span_of(build_road(FLAT), 0.0, 10.0)
    assert high - low > 0.1
