"""Measured profiles: what a CSV file may hold, and the smooth line through its points."""

from __future__ import annotations

from time import process_time

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from model.config.config import ConfigError, ProfileRoad, dump_config, load_config, parse_config, read_profile
from model.config.profile_points import POINT_LIMIT, PointsError, points, points_text, read_csv
from model.road.road import Road, build_road
from model.road.shapes import measured
from model.simulation.simulate import simulate
from tests.model.road.nearest import assert_nearest, centres_near
from tests.model.support import PAPER


def road_through(text: str, start: float | None = None) -> Road:
    return Road(measured(ProfileRoad(points=text, start=start)), 0.32)


# Files


@pytest.mark.parametrize(
    "text",
    [
        "x,y\n0,0\n1.5,0.25\n3,-1e-2\n",
        "x [m]; y [m]\n0;0\n1.5;0.25\n3;-0.01",
        "0;0\r\n1,5;0,25\r\n3;-0,01\r\n",
        "x,y\r0,0\r1.5,0.25\r3,-0.01\r",
        "\ufeff0\t0\n\n1.5\t.25\n  \n3\t-0.01\n",
        "0 0\n 1.5   0.25\n3 -0.01",
        "0, 0\n1.5, 0.25\n3, -0.01",
    ],
)
def test_csv_files(text):
    x, y = points(read_csv(text.encode()))
    assert x.tolist() == [0.0, 1.5, 3.0]
    assert y.tolist() == [0.0, 0.25, -0.01]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("x,y\n0,0\n1,abc\n", "line 3: 'abc' is no number; give x and y in m"),
        ("0,0\n\n1,0,0\n", "line 3: 3 numbers; give two"),
        ("0,0\n1\n", "line 2: 1 numbers; give two"),
        ("0,0\n1,0\n1,0\n", "line 3: x must grow from point to point, by 1 mm at least"),
        ("0,0\n1,0\n0.5,0\n", "line 3: x must grow"),
        ("0,0\n1,nan\n", "line 2: y must be from -10000 to 10000 m"),
        ("0,0\n1e9,0\n", "line 2: x must be from -20000 to 20000 m"),
        ("0,0\n1,20\n", "line 2: steeper than 85°"),
        ("x,y\n0,0\n", "1 points; give 2 to 200001"),
        ("", "0 points"),
    ],
)
def test_faults_of_files_name_the_line(text, words):
    with pytest.raises(PointsError, match="^" + words.replace("(", "[(]")):
        read_csv(text.encode())


def test_files_that_are_too_large_or_no_text():
    with pytest.raises(PointsError, match="larger than 20000000 bytes"):
        read_csv(b"0" * 20_000_001)
    with pytest.raises(PointsError, match="not UTF-8"):
        read_csv(b"\xff\xfe0,0")
    with pytest.raises(PointsError, match=f"give 2 to {POINT_LIMIT}"):
        read_csv(b"\n".join(b"%d 0" % k for k in range(POINT_LIMIT + 1)))


@settings(max_examples=200, deadline=None)
@given(st.text(alphabet="0123456789,;.\t\n -e\x00xn\u2028", max_size=60))
def test_any_text_gives_points_or_a_fault(text):
    try:
        x, y = points(read_csv(text.encode()))
    except PointsError:
        return
    assert len(x) == len(y) >= 2
    assert points_text(x, y) == points_text(*points(points_text(x, y)))


def test_a_configuration_names_a_file_beside_it(tmp_path):
    (tmp_path / "bump.csv").write_text("x,y\n5,0\n6,0.1\n7,0\n")
    (tmp_path / "mine.yaml").write_text("road: {type: profile, file: bump.csv}")
    config = load_config(tmp_path / "mine.yaml")
    assert config.value("road.points") == "5.0 0.0, 6.0 0.1, 7.0 0.0"
    assert config.value("road.file") == "bump.csv"
    (tmp_path / "bump.csv").unlink()
    assert parse_config(dump_config(config)) == config  # the run can be repeated without the file


def test_a_sum_names_a_file_as_well(tmp_path):
    (tmp_path / "bump.csv").write_text("5,0\n6,0.1\n7,0\n")
    (tmp_path / "mine.yaml").write_text("road: {type: sum, parts: [{type: random}, {type: profile, file: bump.csv}]}")
    assert load_config(tmp_path / "mine.yaml").road.parts[1].points == "5.0 0.0, 6.0 0.1, 7.0 0.0"


@pytest.mark.parametrize(
    ("road", "path", "words"),
    [
        ("{type: profile, file: gone.csv}", "road.file", "gone.csv cannot be read: No such file"),
        ("{type: profile, file: bad.csv}", "road.file", "line 2: x must grow"),
        ("{type: sum, parts: [{type: profile, file: bad.csv}]}", "road.parts[0].file", "line 2: x must grow"),
    ],
)
def test_faults_of_a_named_file(tmp_path, road, path, words):
    (tmp_path / "bad.csv").write_text("5,0\n5,0\n")
    (tmp_path / "mine.yaml").write_text(f"road: {road}\nvehicle: {{chassis: {{mass: -1}}}}")
    with pytest.raises(ConfigError) as error:
        load_config(tmp_path / "mine.yaml")
    found = {fault.path: fault.message for fault in error.value.faults}
    assert set(found) == {path, "vehicle.chassis.mass"}
    assert words in found[path]


def test_text_without_a_folder_reads_no_file(tmp_path):
    (tmp_path / "bump.csv").write_text("5,0\n6,0.1\n")
    with pytest.raises(ConfigError, match=r"road.file: only the file of a configuration can name another"):
        parse_config(f"road: {{type: profile, file: {tmp_path / 'bump.csv'}}}")


# The line


@settings(max_examples=200, deadline=None)
@given(st.lists(st.tuples(st.floats(0.001, 5.0), st.floats(-1.0, 1.0)), min_size=2, max_size=12))
def test_the_line_stays_within_the_heights_of_its_points(steps):
    gap, slope = np.array(steps).T
    x = 5.0 + np.cumsum(gap)
    y = np.append(0.0, np.cumsum(slope[1:] * gap[1:]))
    road = road_through(points_text(x, y))
    np.testing.assert_allclose(road.height(x), y, atol=1e-9)
    part = np.linspace(0.0, 1.0, 21)
    between = road.height(x[:-1, None] + part * np.diff(x)[:, None])
    low, high = np.minimum(y[:-1], y[1:])[:, None], np.maximum(y[:-1], y[1:])[:, None]
    assert (between >= low - 1e-9).all()
    assert (between <= high + 1e-9).all()
    assert (np.diff(between, axis=1) * np.sign(y[1:] - y[:-1])[:, None] >= -1e-9).all()


def test_slope_and_curvature_are_continuous_and_the_ends_level():
    rng = np.random.default_rng(3)
    x = 5.0 + np.cumsum(rng.uniform(0.05, 1.0, 30))
    y = np.append(0.0, 0.1 * rng.standard_normal(29))
    road = road_through(points_text(x, y))
    for before, behind in zip(road.derivatives(x - 1e-11), road.derivatives(x + 1e-11), strict=True):
        np.testing.assert_allclose(before, behind, atol=1e-5)
    h, h1, h2 = road.derivatives(np.array([x[0] - 1.0, x[-1] + 1.0]))
    np.testing.assert_allclose(h, y[[0, -1]], atol=1e-12)
    assert not h1.any()
    assert not h2.any()


def test_a_finely_sampled_wave_is_followed():
    x = np.arange(0.0, 40.0, 0.05)
    wave = 0.1 * np.sin(2 * np.pi * x / 5.0)
    road = road_through(points_text(x + 5.0, wave))
    between = np.linspace(1.0, 39.0, 3001)
    assert np.abs(road.height(between + 5.0) - 0.1 * np.sin(2 * np.pi * between / 5.0)).max() < 5e-5


def test_a_start_puts_the_first_point_at_ground_level():
    road = road_through("100 57, 101 57.1, 103 57", start=4.0)
    np.testing.assert_allclose(road.height(np.array([0.0, 4.0, 5.0, 7.0, 50.0])), [0, 0, 0.1, 0, 0], atol=1e-9)


def test_a_profile_must_begin_level():
    replace = {"road.type": "profile", "road.points": "0 0, 1 0.1, 2 0"}
    with pytest.raises(
        ConfigError, match=r"road.points: is not level under the vehicle, as it must be up to x = 2.07 m"
    ):
        PAPER.replace(replace)
    assert PAPER.replace(replace | {"road.start": 2.75}).road.start == 2.75
    with pytest.raises(ConfigError, match=r"road.start: the first wheel stands at 1.75 m"):
        PAPER.replace(replace | {"road.start": 1.0})


def test_who_rolls_away_downhill_still_finds_the_road():
    """Contact is laid as far as the speed asked for leads, and further when a run comes further."""
    config = PAPER.replace(
        {
            "road.type": "profile",
            "road.points": "5 0, 15 -1, 300 -60, 400 -70",
            "drive.force_limit": 0,
            "drive.speed_kmh": 5,
            "simulation.duration": 22,
        }
    )
    run, road = simulate(config), build_road(config)
    wheels = run.q[-1, run.system.road_wheels, :2]
    assert run.complete
    assert wheels[:, 0].min() > road.reach + 20
    assert np.abs(wheels[:, 1] - road.height(wheels[:, 0])).max() < 0.5


@pytest.mark.parametrize("seed", range(4))
def test_nearest_point_on_measured_profiles(seed):
    rng = np.random.default_rng(seed)
    x = 5.0 + np.cumsum(rng.choice([0.05, 0.3, 2.0], 20))
    y = np.append(0.0, rng.choice([0.03, 0.1], 1) * rng.standard_normal(19))
    slope = np.abs(np.diff(y)) / np.diff(x)
    y[1:][slope > 10] = 0.0
    road = road_through(points_text(x, np.clip(y, -0.2, 0.2)))
    assert_nearest(road, centres_near(road, rng, rng.uniform(4.0, x[-1] + 1.0, 30)))


@pytest.mark.parametrize("radius", [0.16, 0.32, 1.0])
@pytest.mark.parametrize("kerb", ["5.01 0.1, 5.02 0.1", "5.03 0.05, 5.06 0.05", "5.03 -0.05, 5.06 -0.05"])
def test_a_wheel_rests_on_the_shoulder_of_a_kerb_that_was_measured_finely(kerb, radius):
    """All of the kerb lies between two points: at either, its line is level and straight."""
    road = Road(measured(ProfileRoad(points=f"0 0, 5 0, {kerb}, 9 {kerb.split()[-1]}")), radius)
    rng = np.random.default_rng(0)
    assert_nearest(road, centres_near(road, rng, rng.uniform(5.0 - radius, 5.05 + radius, 25)), tolerance=1e-9)


def test_ten_kilometres_are_read_and_ready_quickly(tmp_path):
    """Measured as the process's own time: reading and tabulating take 0.6 s, elsewhere perhaps more."""
    x = np.arange(POINT_LIMIT) * 0.05
    y = 0.05 * np.sin(x) * np.minimum(x / 10, 1.0)
    (tmp_path / "road.csv").write_text("x,y\n" + "\n".join(f"{a:.2f},{b:.5f}" for a, b in zip(x, y, strict=True)))
    build_road(PAPER).table  # noqa: B018 (compiled)
    began = process_time()
    values = read_profile(tmp_path / "road.csv")
    build_road(PAPER.replace({"road.type": "profile", "road.start": 3.0, **values})).table  # noqa: B018
    assert process_time() - began < 2.0
