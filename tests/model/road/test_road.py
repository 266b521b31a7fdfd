"""Roads: heights as model/MODEL.md defines them, and the nearest point against brute force on random profiles."""

from __future__ import annotations

import numpy as np
import pytest

from model.road import nearest_point as road_search
from model.road.nearest_point import HEIGHT, NODE, RoadTable
from model.road.road import Piece, Profile, Road, build_road
from tests.model.road.nearest import assert_nearest, brute_force, centres_near, resting_height
from tests.model.support import FLAT, PAPER

RADIUS = 0.32


def waves(rng: np.random.Generator, roughness: float, period: float) -> Piece:
    """A sum of ten sines that repeat by the period; roughness 1 has valleys far tighter than the wheel."""
    number = rng.integers(1, 13, 10)
    phase = rng.uniform(0.0, 2 * np.pi, 10)
    k = 2 * np.pi * number / period
    amplitude = roughness * rng.uniform(0.3, 1.0, 10) / k / RADIUS / 6

    def derivatives(x: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        angle = np.multiply.outer(x, k) + phase
        return (
            np.sin(angle) @ amplitude,
            np.cos(angle) @ (amplitude * k),
            -np.sin(angle) @ (amplitude * k**2),
        )

    return Piece(3.0 + np.linspace(0.0, period, 1537), derivatives)


def polyline(x: np.ndarray, y: np.ndarray) -> Profile:
    """Straight pieces with corners between them."""

    def piece(k: int) -> Piece:
        slope = (y[k + 1] - y[k]) / (x[k + 1] - x[k])
        return Piece(x[k : k + 2], lambda s: (y[k] + slope * (s - x[k]), np.full(s.shape, slope), 0 * s))

    return Profile([piece(k) for k in range(len(x) - 1)])


# Heights


def sine_height(x: np.ndarray, x_s: float, ramp: float) -> np.ndarray:
    """The paper's road, A = 0.1 m, λ = 7 m, straight from model/MODEL.md."""
    u = np.clip((x - x_s) / ramp, 0.0, 1.0)
    return 0.1 * u**2 * (3 - 2 * u) * np.sin(2 * np.pi * (x - x_s) / 7.0)


def test_the_papers_road_begins_a_metre_ahead_of_the_first_wheel():
    x = np.linspace(-10.0, 400.0, 5001)
    np.testing.assert_allclose(build_road(PAPER).height(x), sine_height(x, 1.75 + 1.0, 7.0), atol=1e-12)


def test_start_and_ramp_of_a_sine_road_can_be_given():
    road = build_road(PAPER.replace({"road.start": 5.0, "road.ramp": 2.5}))
    x = np.linspace(0.0, 40.0, 1001)
    np.testing.assert_allclose(road.height(x), sine_height(x, 5.0, 2.5), atol=1e-12)


def test_without_ramp_the_waves_begin_at_once():
    road = build_road(PAPER.replace({"road.start": 5.0, "road.ramp": 0.0}))
    np.testing.assert_allclose(road.height(np.array([4.9, 5.0 + 7 / 4, 5.0 + 21 / 4])), [0.0, 0.1, -0.1], atol=1e-12)


def test_flat_road_is_flat_everywhere():
    np.testing.assert_array_equal(build_road(FLAT).height(np.array([-1e5, 0.0, 0.5, 1e5])), 0.0)


@pytest.mark.parametrize(("height", "radius"), [(0.1, 0.2), (0.05, 1.5), (0.19, 0.2), (0.2, 0.2), (0.001, 0.01)])
def test_half_round_is_the_part_of_a_circle_above_ground(height, radius):
    changes = {"road.height": height, "road.radius": radius, "road.position": 6.0}
    road = build_road(PAPER.replace({"road.type": "half_round"} | changes))
    half_width = np.sqrt(radius**2 - (radius - height) ** 2)
    x = 6.0 + np.linspace(-1.0, 1.0, 2001) * min(half_width, radius * np.sin(np.radians(85)))
    np.testing.assert_allclose(road.height(x), np.sqrt(radius**2 - (x - 6.0) ** 2) - (radius - height), atol=1e-12)
    assert road.height(np.array([6.0]))[0] == pytest.approx(height, abs=1e-12)
    outside = 6.0 + np.array([-1.0, 1.0]) * (half_width + 0.005 * radius)
    np.testing.assert_allclose(road.height(outside), 0.0, atol=1e-12)


@pytest.mark.parametrize(("height", "top", "base"), [(0.1, 0.5, 1.5), (0.2, 1.0, 1.0), (2.0, 0.01, 20.0)])
def test_trapezoid(height, top, base):
    changes = {"road.position": 20.0, "road.height": height, "road.top": top, "road.base": base}
    road = build_road(PAPER.replace({"road.type": "trapezoid"} | changes))
    base = max(base, top + 2 * height / np.tan(np.radians(85)))
    corners = np.array([-base / 2, -top / 2, top / 2, base / 2])
    x = 20.0 + np.linspace(-12.0, 12.0, 4801)
    np.testing.assert_allclose(road.height(x), np.interp(x - 20.0, corners, [0, height, height, 0]), atol=1e-12)


@pytest.mark.parametrize(("ramp", "length"), [(2.0, 2.0), (None, 0.1 / np.tan(np.radians(85))), (0.0, 0.00875)])
def test_step(ramp, length):
    """No steeper than 85°, and what lies behind is as high as the step."""
    road = build_road(PAPER.replace({"road.type": "step", "road.position": 5.0, "road.ramp": ramp}))
    x = np.linspace(0.0, 100.0, 5001)
    np.testing.assert_allclose(road.height(x), np.interp(x, [5.0, 5.0 + length], [0, 0.1]), atol=1e-4)
    assert road.height(np.array([5.0 + length / 2]))[0] == pytest.approx(0.05, rel=1e-3)


# The table


def table_height(table: RoadTable, x: np.ndarray) -> np.ndarray:
    """h from the quintics."""
    if table.period > 0.0:
        x = np.where(x > table.repeat_from, table.repeat_from + np.mod(x - table.repeat_from, table.period), x)
    c = np.maximum(np.searchsorted(table.cell[:, NODE], x, side="right") - 1, 0)
    u = x - table.cell[c, NODE]
    return sum(table.cell[c, HEIGHT + power] * u**power for power in range(6))


ROADS = {
    "paper": {},
    "steepest": {"road.amplitude": 0.5, "road.wavelength": 0.5},
    "longest": {"road.wavelength": 200.0, "road.amplitude": 0.5},
    "bridging": {"road.amplitude": 0.04, "road.wavelength": 0.7},
    "long ramp": {"road.wavelength": 0.5, "road.ramp": 33.3},
    "short ramp": {"road.wavelength": 7.0, "road.ramp": 0.3},
    "half round": {"road.type": "half_round"},
    "upright foot": {"road.type": "half_round", "road.height": 0.2, "road.radius": 0.2},
    "trapezoid": {"road.type": "trapezoid"},
    "upright block": {"road.type": "trapezoid", "road.height": 0.3, "road.top": 0.4, "road.base": 0.4},
    "ridge": {"road.type": "trapezoid", "road.height": 0.5, "road.top": 0.01, "road.base": 2.0},
    "kerb": {"road.type": "step"},
    "slope": {"road.type": "step", "road.height": 0.5, "road.ramp": 2.0},
    "shallow": {"road.type": "half_round", "road.height": 0.05, "road.radius": 3.0, "road.position": 8.0},
}


@pytest.mark.parametrize("name", ROADS)
def test_table_and_formula_agree(name):
    road = build_road(PAPER.replace(ROADS[name]))
    x = np.random.default_rng(0).uniform(-5.0, 60.0, 20_000)
    np.testing.assert_allclose(table_height(road.table, x), road.height(x), rtol=0, atol=1e-12)


# The nearest point


@pytest.mark.parametrize("name", ROADS)
def test_nearest_point_on_the_roads(name):
    road = build_road(PAPER.replace(ROADS[name]))
    rng = np.random.default_rng(1)
    low, high = (2.0, 9.0) if road.profile.period == 0.0 else (0.0, 45.0)
    assert_nearest(road, centres_near(road, rng, rng.uniform(low, high, 40)))


@pytest.mark.parametrize("seed", range(12))
def test_nearest_point_on_random_waves(seed):
    rng = np.random.default_rng(seed)
    period = rng.uniform(1.0, 6.0)
    road = Road(Profile([waves(rng, 10.0 ** rng.uniform(-1.5, 0.0), period)], period), RADIUS)
    assert_nearest(road, centres_near(road, rng, rng.uniform(2.0, 12.0, 30)))


def test_the_random_waves_have_safe_and_unsafe_stretches():
    """Both searches are met above: the quick one where one minimum is certain, and that through all cells."""
    shares = []
    for seed in range(12):
        rng = np.random.default_rng(seed)
        period = rng.uniform(1.0, 6.0)
        table = Road(Profile([waves(rng, 10.0 ** rng.uniform(-1.5, 0.0), period)], period), RADIUS).table
        shares.append(table.safe.mean())
    assert min(shares) < 0.3
    assert max(shares) > 0.9
    assert sum(0.3 < share < 0.9 for share in shares) >= 2


@pytest.mark.parametrize("seed", range(6))
def test_nearest_point_on_corners_and_steps(seed):
    rng = np.random.default_rng(seed)
    x = 3.0 + np.cumsum(rng.choice([0.01, 0.1, 0.5, 1.5], 12))  # gaps of 1 cm are as good as steps
    y = rng.choice([0.0, 0.05, 0.15, -0.1], 12)
    road = Road(polyline(x, y), RADIUS)
    assert_nearest(road, centres_near(road, rng, rng.uniform(x[0] - 0.5, x[-1] + 0.5, 30)))


@pytest.mark.parametrize("radius", [0.05, 1.0, 2.0])
def test_nearest_point_for_small_and_large_wheels(radius):
    rng = np.random.default_rng(4)
    road = Road(Profile([waves(rng, 0.5, 4.0)], 4.0), radius)
    assert_nearest(road, centres_near(road, rng, rng.uniform(2.0, 12.0, 40)))


def test_a_wheel_bridges_a_valley_tighter_than_itself():
    """On waves of 0.7 m with r = 0.32 m a wheel above the trough rests on both flanks, not in the trough."""
    waves = {"road.amplitude": 0.1, "road.wavelength": 0.7, "road.ramp": 0.0, "road.start": 3.0}
    road = build_road(PAPER.replace(waves))
    trough = 3.0 + 0.7 * 20.75
    points, _, d = road.nearest(np.array([[trough, 0.25]]))
    assert d[0] < 0.35 - 0.01  # the trough itself is 0.35 m below
    assert abs(points[0, 0] - trough) > 0.05
    assert d[0] == pytest.approx(brute_force(road, np.array([trough, 0.25])), abs=1e-12)


@pytest.mark.parametrize("tightness", [0.7, 0.9, 1.05, 1.3, 2.0, 4.0])
def test_nearest_point_in_valleys_about_as_tight_as_the_wheel(tightness):
    """Trough's curvature × radius from safe to bridged; there both flanks are nearly as near, and one is nearer."""
    k = 2 * np.pi / 1.2
    amplitude = tightness / (k**2 * RADIUS)
    valleys = {"road.amplitude": amplitude, "road.wavelength": 1.2, "road.ramp": 0.0, "road.start": 3.0}
    road = build_road(PAPER.replace(valleys))
    rng = np.random.default_rng(8)
    aside = rng.choice([-1.0, 1.0], 60) * 10.0 ** rng.uniform(-7.0, -0.7, 60)
    x = 3.0 + 1.2 * 10.75 + aside
    assert_nearest(road, np.column_stack([x, resting_height(road, x, np.full(60, 0.02 * RADIUS))]))


def test_nearest_point_between_two_straight_flanks():
    """Coarse cells: the nearer flank is not always the one with the nearer node."""
    road = Road(polyline(np.array([3.0, 4.0, 5.07]), np.array([0.5, 0.0, 0.535])), RADIUS)
    rng = np.random.default_rng(9)
    x = 4.0 + rng.choice([-1.0, 1.0], 60) * 10.0 ** rng.uniform(-7.0, -1.5, 60)
    assert_nearest(road, np.column_stack([x, resting_height(road, x, np.full(60, 0.01))]))


def test_a_centre_below_the_road_counts_negative_and_turns_the_normal_round():
    rng = np.random.default_rng(5)
    for changes in (ROADS["paper"], ROADS["bridging"]):
        road = build_road(PAPER.replace(changes))
        x = rng.uniform(0.0, 30.0, 30)
        below = np.column_stack([x, road.height(x) - rng.uniform(0.001, 0.25, 30)])
        _, normals, distances = road.nearest(below)
        assert (distances < 0.0).all()
        assert (normals[:, 1] > 0.0).all()  # from the centre up to the road and on
        assert_nearest(road, below)


def test_a_centre_on_the_road_has_the_roads_normal():
    road = build_road(PAPER)
    x = np.linspace(0.0, 40.0, 101)
    y, slope, _ = road.derivatives(x)
    points, normals, distances = road.nearest(np.column_stack([x, y]))
    np.testing.assert_allclose(distances, 0.0, atol=1e-12)
    np.testing.assert_allclose(points, np.column_stack([x, y]), atol=1e-12)
    np.testing.assert_allclose(
        normals, np.column_stack([-slope, np.ones(101)]) / np.hypot(1, slope)[:, None], atol=1e-9
    )


def test_distance_is_continuous_through_the_road():
    road = build_road(PAPER)
    heights = road.height(np.array([12.0]))[0] + np.linspace(-0.01, 0.01, 41)
    _, normals, distances = road.nearest(np.column_stack([np.full(41, 12.0), heights]))
    assert np.abs(np.diff(distances, 2)).max() < 1e-6
    assert np.abs(np.diff(normals, axis=0)).max() < 1e-3


def test_a_centre_far_above_does_not_touch():
    for changes in ROADS.values():
        road = build_road(PAPER.replace(changes))
        _, _, distances = road.nearest(np.array([[4.0, 3.0], [4.0, 100.0]]))
        assert (distances >= road.radius).all()


@pytest.mark.parametrize("wavelength", [0.7, 7.0, 3.3])
def test_waves_repeat_without_end(wavelength):
    """A hundred kilometres along, the contact is where it is in the first waves."""
    road = build_road(PAPER.replace({"road.amplitude": 0.04, "road.wavelength": wavelength}))
    rng = np.random.default_rng(6)
    here = centres_near(road, rng, rng.uniform(20.0, 20.0 + 2 * wavelength, 50))
    away = np.array([np.round(1e5 / wavelength) * wavelength, 0.0])
    points, normals, distances = road.nearest(here)
    far_points, far_normals, far_distances = road.nearest(here + away)
    np.testing.assert_allclose(far_distances, distances, atol=1e-9)
    np.testing.assert_allclose(far_points - away, points, atol=1e-8)
    np.testing.assert_allclose(far_normals, normals, atol=1e-8)
    np.testing.assert_allclose(road.height(here[:, 0] + away[0]), road.height(here[:, 0]), atol=1e-9)


def test_flat_road_has_no_end():
    road = build_road(FLAT)
    centres = np.array([[-1e5, 0.3], [-0.1, 0.3], [0.5, 0.3], [1e6, 0.3]])
    points, normals, distances = road.nearest(centres)
    np.testing.assert_allclose(points, centres * [1, 0], atol=1e-12)
    np.testing.assert_allclose(normals, np.tile([0.0, 1.0], (4, 1)), atol=1e-12)
    np.testing.assert_allclose(distances, 0.3, atol=1e-12)


@pytest.mark.parametrize("x", [np.inf, -np.inf, np.nan])
def test_a_position_that_is_no_number_gives_no_contact(x):
    """A diverging run asks for such: the answer must not be taken for a distance."""
    for changes in ROADS.values():
        _, _, distances = build_road(PAPER.replace(changes)).nearest(np.array([[x, 0.3], [x, -0.3]]))
        assert np.isnan(distances).all()


@pytest.mark.parametrize("x", [np.inf, -np.inf, np.nan, 1e300])
def test_the_search_stays_inside_the_table_wherever_a_wheel_is(x):
    """As Python, which checks every index; the compiled search would read whatever lies beyond in memory."""
    for changes in ROADS.values():
        table = build_road(PAPER.replace(changes)).table
        assert 0 <= road_search._cell.py_func(table, x) <= len(table.cell) - 1
        for b in range(0, len(table.bin), max(1, len(table.bin) // 50)):
            with np.errstate(all="ignore"):
                _, cell = road_search._guessed.py_func(table, b, x, 0.3)
            assert 0 <= cell <= len(table.cell) - 1


@pytest.mark.parametrize("ramp", [1e-300, 1e-15, 1e-9])
def test_a_ramp_of_no_length_is_none(ramp):
    tiny, none = (build_road(PAPER.replace({"road.ramp": length})) for length in (ramp, 0.0))
    np.testing.assert_array_equal(tiny.table.cell, none.table.cell)
