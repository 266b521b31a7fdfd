"""Measured profiles: the files that a configuration names, and the line through their points."""

from __future__ import annotations

from pathlib import Path
from time import process_time

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from model.config.config import ConfigError, ProfileRoad
from model.config.config_files import dump_config, load_config, parse_config, read_profile
from model.config.profile_points import POINT_LIMIT, points_text
from model.road.road import Road, build_road, profile_end, profile_start
from model.road.shapes import DENSE, MISSED, ROUNDED, measured
from model.road.thinning import BRIDGING, CHANGED, thinned
from model.simulation.simulate import simulate
from tests.model.road.nearest import assert_nearest, centres_near
from tests.model.support import PAPER

FIELD = Path(__file__).parents[2] / "field"


def road_through(text: str, start: float | None = None, radius: float = 0.32) -> Road:
    return Road(measured(ProfileRoad(points=text, start=start), 2.75, radius), radius)


# Files


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
@given(st.lists(st.tuples(st.floats(0.011, 5.0), st.floats(-1.0, 1.0)), min_size=2, max_size=12))
def test_the_line_meets_its_points_and_is_nowhere_steeper_than_their_polyline(steps):
    """Points every 1 m or so, or with sharp bends, are corners; those of a dense curve it meets exactly."""
    gap, slope = np.array(steps).T
    x = 5.0 + np.cumsum(gap)
    y = np.append(0.0, np.cumsum(slope[1:] * gap[1:]))
    road = road_through(points_text(x, y))
    np.testing.assert_allclose(road.height(x), y, atol=MISSED + 1e-9)
    part = np.linspace(0.0, 1.0, 41)
    between, slopes, _ = road.derivatives(x[:-1, None] + part * np.diff(x)[:, None])
    low, high = np.minimum(y[:-1], y[1:])[:, None], np.maximum(y[:-1], y[1:])[:, None]
    assert (between >= low - MISSED - 1e-9).all()
    assert (between <= high + MISSED + 1e-9).all()
    if (gap[1:] > DENSE).all():
        rises = np.concatenate([[0.0], slope[1:], [0.0]])
        around = np.stack([rises[:-2], rises[1:-1], rises[2:]])
        assert (slopes >= around.min(axis=0)[:, None] - 1e-9).all()
        assert (slopes <= around.max(axis=0)[:, None] + 1e-9).all()
        straight = np.abs(part - 0.5) * gap[1:, None] < gap[1:, None] / 2 - ROUNDED
        assert np.abs(slopes - slope[1:, None])[straight].max(initial=0.0) < 1e-9


def test_a_ramp_given_by_its_corners_has_their_slope():
    config = load_config(FIELD / "ramp_two_points.yaml")
    run, road = simulate(config), build_road(config)
    x = np.linspace(0.0, 40.0, 40001)
    h, h1, _ = road.derivatives(x)
    assert h1.max() == pytest.approx(0.3, abs=1e-9)
    assert np.abs(h - np.interp(x, [0, 10, 20, 60], [0, 0, 3, 3])).max() < MISSED + 1e-9
    wheels = run.q[:, run.system.road_wheels, :2]
    middle = int(np.abs(run.q[:, 0, 0] - 15.0).argmin())
    rise = wheels[middle, 0] - wheels[middle, -1]
    assert np.degrees(np.arctan2(rise[1], rise[0])) == pytest.approx(16.70, abs=0.1)  # of a slope of 0.3


def test_an_edge_among_dense_points_is_no_steeper_than_given():
    """Every 5 cm, with a kerb of 0.1 m between two points: slope 2, where a curve through them would reach 3."""
    x = np.arange(5.0, 9.0, 0.05)
    road = road_through(points_text(x, np.where(x < 7.01, 0.0, 0.1)))
    assert road.derivatives(np.linspace(4, 10, 60001))[1].max() == pytest.approx(2.0, abs=1e-6)


def test_points_far_from_the_origin_lose_no_digits():
    """Stations near 1000 km give the road that the same points give near the vehicle."""
    x = np.arange(0.0, 40.0, 0.25)
    y = 0.02 * np.sin(x)
    near, far = (road_through(points_text(x + station, y), start=3.0) for station in (0.0, 999_000.0))
    along = np.linspace(0.0, 45.0, 5001)
    for one, other in zip(near.derivatives(along), far.derivatives(along), strict=True):
        np.testing.assert_allclose(one, other, rtol=0, atol=2e-8)


@pytest.mark.parametrize("station", [1000.5, 12345.6, 125000.0])
def test_a_profile_that_begins_at_a_station_is_put_ahead_of_the_vehicle(station):
    config = PAPER.replace({"road.type": "profile", "road.points": f"{station} 7, {station + 5} 7, {station + 6} 7.1"})
    assert profile_start(config) == 2.75
    assert profile_end(config) == 8.75
    np.testing.assert_allclose(build_road(config).height(np.array([0.0, 5.0, 9.0])), [0.0, 0.0, 0.1], atol=1e-9)


def test_ends_of_profiles():
    assert profile_end(PAPER) is None
    assert profile_start(PAPER) is None
    profile = {"type": "profile", "points": "5 0, 6 0.1, 9 0"}
    bump = PAPER.replace({"road.type": "sum", "road.parts": [profile, {"type": "step", "position": 5}]})
    endless = PAPER.replace({"road.type": "sum", "road.parts": [profile, {"type": "random"}]})
    assert (profile_start(bump), profile_end(bump)) == (5.0, 9.0)
    assert (profile_start(endless), profile_end(endless)) == (5.0, None)


# Points closer together than a wheel can feel


def dense_points(rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """3 m every 1 mm: waves, a kerb's face, texture that grows from nothing to 2 mm."""
    x = np.arange(3000) * 1e-3
    y = 0.03 * np.sin(4 * x) + np.clip((x - 1.5) / 0.02, 0.0, 1.0) * 0.08
    return x, y + 2e-3 * (x / 3) ** 2 * rng.standard_normal(len(x)).clip(-2, 2)


@pytest.mark.parametrize("radius", [0.1, 0.32, 1.0])
def test_thinning_leaves_the_distance_to_the_road_as_it_is(radius):
    """Against a search over all points of both polylines, from wherever a wheel may be with its centre outside."""
    rng = np.random.default_rng(1)
    x, y = dense_points(rng)
    few_x, few_y = thinned(x, y, radius)
    assert len(few_x) < len(x) / 4
    assert set(few_x) <= set(x)
    centre = np.column_stack([rng.uniform(0.3, 2.7, 300), np.zeros(300)])
    centre[:, 1] = np.interp(centre[:, 0], x, y) + radius * rng.uniform(0.6, 1.2, 300)
    fine = np.linspace(0.0, 2.999, 60001)
    for X, Y in centre:
        before = np.hypot(fine - X, np.interp(fine, x, y) - Y).min()
        if before >= BRIDGING * radius:
            after = np.hypot(fine - X, np.interp(fine, few_x, few_y) - Y).min()
            assert abs(after - before) < CHANGED + 1e-6


def test_points_that_a_wheel_can_feel_are_kept():
    x = np.array([0.0, 1.0, 1.02, 1.04, 1.5, 1.505, 1.51, 3.0])
    y = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.02, 0.0, 0.0])
    assert np.array_equal(thinned(x, y, 0.32)[0], x)


def test_fine_texture_costs_no_more_than_a_normal_run():
    """0.1 mm of texture on points every 1 mm: a hundred thousand steps and more where every point is kept."""
    rng = np.random.default_rng(0)
    x = np.arange(40_000) * 1e-3
    y = 0.03 * np.sin(2 * x)
    runs = [
        simulate(PAPER.replace({"road.type": "profile", "road.start": 3.0, "road.points": points_text(x, heights)}))
        for heights in (y, y + 1e-4 * rng.standard_normal(len(x)))
    ]
    smooth, textured = runs
    assert textured.statistics.steps < 6000
    assert np.abs(textured.q[:, 0, 1] - smooth.q[:, 0, 1]).max() < 5e-4


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
    np.testing.assert_allclose(road.height(np.array([0.0, 4.0, 5.0, 7.0, 50.0])), [0, 0, 0.1, 0, 0], atol=MISSED)


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
    road = road_through(f"0 0, 5 0, {kerb}, 9 {kerb.split()[-1]}", radius=radius)
    rng = np.random.default_rng(0)
    assert_nearest(road, centres_near(road, rng, rng.uniform(5.0 - radius, 5.05 + radius, 25)), tolerance=1e-9)


def test_ten_kilometres_are_read_and_ready_quickly(tmp_path):
    """Measured as the process's own time: reading and tabulating take 0.6 s, on a busy machine several times more."""
    x = np.arange(POINT_LIMIT) * 0.05
    y = 0.05 * np.sin(x) * np.minimum(x / 10, 1.0)
    (tmp_path / "road.csv").write_text("x,y\n" + "\n".join(f"{a:.2f},{b:.5f}" for a, b in zip(x, y, strict=True)))
    build_road(PAPER).table  # noqa: B018 (compiled)
    began = process_time()
    text = read_profile(tmp_path / "road.csv").points
    build_road(PAPER.replace({"road.type": "profile", "road.start": 3.0, "road.points": text})).table  # noqa: B018
    assert process_time() - began < 5.0
