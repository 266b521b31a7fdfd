"""Shapes joined to the road of an endless drive: where they stand, how they join, what laying them costs."""

from __future__ import annotations

import numpy as np
import pytest

from model.road.endless import BLEND, GAP, LaidRoad, Shapes
from model.road.road import Derivatives, Piece, Profile, Road, build_road
from tests.model.support import FLAT, PAPER

RADIUS = 0.32
HALF_ROUND = PAPER.replace({"road.type": "half_round"})


def waves(amplitude: float, wavelength: float = 7.0) -> Road:
    return build_road(PAPER.replace({"road.amplitude": amplitude, "road.wavelength": wavelength}))


def bank() -> Road:
    """Up by 0.2 m between x = 5 and 6, with corners, and up it stays."""
    slope = lambda x: (0.2 * (x - 5.0), np.full(x.shape, 0.2), 0 * x)  # noqa: E731
    return Road(Profile([Piece(np.array([5.0, 6.0]), slope)]), RADIUS)


def height(shapes: Shapes, x: np.ndarray | float) -> np.ndarray:
    return shapes.derivatives(np.atleast_1d(x))[0]


def laid(shapes: Shapes, low: float, high: float) -> Road:
    return Road(shapes.laid(low, high), RADIUS)


def assert_smooth(road: Road, low: float, high: float) -> None:
    """Slope and curvature are those of the height."""
    x = np.linspace(low, high, 20001)[:-1]
    h, h1, h2 = road.derivatives(x)
    np.testing.assert_allclose(np.gradient(h, x)[1:-1], h1[1:-1], atol=1e-5)
    np.testing.assert_allclose(np.gradient(h1, x)[1:-1], h2[1:-1], atol=1e-3)


def test_a_new_shape_takes_over_from_its_start_on_and_smoothly():
    before = Shapes.of(waves(0.1))
    after = before.joined(waves(0.2, 5.0), 30.0, same_kind=True)
    x = np.linspace(20.0, 30.0, 1001)
    np.testing.assert_array_equal(height(after, x), height(before, x))
    assert np.abs(height(after, np.linspace(30.0 + BLEND, 40.0, 1001))).max() == pytest.approx(0.2, abs=1e-4)
    assert_smooth(laid(after, 20.0, 50.0), 20.0, 50.0)


def test_longer_waves_come_into_a_random_road_and_its_bumps_stay_in_their_places():
    short, long = (
        build_road(PAPER.replace({"road.type": "random", "road.longest_wave": longest})) for longest in (20, 90)
    )
    shapes = Shapes.of(short).joined(long, 50.0, same_kind=True)
    assert_smooth(laid(shapes, 40.0, 70.0), 40.0, 70.0)
    x = np.linspace(50.0 + BLEND, 100.0, 1001)
    np.testing.assert_allclose(height(shapes, x), long.height(x), atol=1e-9)
    assert np.abs(long.derivatives(x)[2] - short.derivatives(x)[2]).max() < 0.01  # 1/m: only long waves have come in


def test_many_changes_while_the_vehicle_goes_on_join_smoothly_and_end_at_the_last():
    shapes = Shapes.of(waves(0.1))
    for k in range(30):
        shapes = shapes.joined(waves(0.1 + 0.002 * k), 20.0 + k // 3, same_kind=True)
    assert_smooth(laid(shapes, 15.0, 60.0), 15.0, 60.0)
    last = waves(0.1 + 0.002 * 29)
    x = np.linspace(33.0, 60.0, 1001)
    np.testing.assert_allclose(height(shapes, x), last.height(x), atol=1e-12)  # the waves have stayed in their places


def test_waves_of_another_length_begin_fully_risen():
    shapes = Shapes.of(waves(0.1)).joined(waves(0.1, 5.0), 10.0, same_kind=True)
    x = 10.0 + BLEND + np.linspace(0.0, 5.0, 1001)
    assert np.ptp(height(shapes, x)) == pytest.approx(0.2, abs=1e-4)


def test_a_change_at_the_same_place_replaces_the_one_before():
    once = Shapes.of(waves(0.1)).joined(waves(0.3), 12.0, same_kind=True)
    again = once.joined(waves(0.05), 12.0, same_kind=True)
    assert len(again.row) == 2
    assert np.abs(height(again, np.linspace(15.0, 30.0, 1001))).max() == pytest.approx(0.05, abs=1e-4)


def test_an_obstacle_comes_soon_and_stays_where_it_is_while_it_changes_its_shape():
    def top(shapes: Shapes) -> float:
        x = np.arange(100.0, 140.0, 0.001)
        return float(x[np.argmax(height(shapes, x) > 0.999 * height(shapes, x).max())])

    low = Shapes.of(waves(0.0)).joined(build_road(HALF_ROUND.replace({"road.height": 0.05})), 100.0, same_kind=False)
    assert 100.0 + BLEND < top(low) < 100.0 + BLEND + 0.5
    high = low.joined(build_road(HALF_ROUND), 100.0, same_kind=True)
    assert top(high) == pytest.approx(top(low), abs=0.06)
    moved = high.joined(build_road(HALF_ROUND.replace({"road.position": 9.0})), 100.0, same_kind=True)
    assert top(moved) == pytest.approx(top(high) + 5.0, abs=0.02)
    passed = high.joined(build_road(HALF_ROUND), 110.0, same_kind=True)
    assert top(passed.seen_from(113.0)) == pytest.approx(top(high) + GAP + 0.35, abs=0.02)  # its next coming


def test_a_road_with_an_end_comes_again_backwards_and_has_no_step_in_between():
    shapes = Shapes.of(bank())
    every = 1.0 + GAP
    up = height(shapes, np.array([4.0, 5.5, 6.5, 5.0 + every - 0.1]))
    np.testing.assert_allclose(up, [0.0, 0.1, 0.2, 0.2], atol=1e-12)
    down = height(shapes, 5.0 + every + np.array([0.25, 0.5, 1.5]))
    np.testing.assert_allclose(down, [0.15, 0.1, 0.0], atol=1e-12)
    np.testing.assert_allclose(height(shapes, 5.0 + 2 * every + 0.25), 0.05, atol=1e-12)
    _, slopes, _ = shapes.derivatives(np.array([5.5, 5.5 + every, 5.5 + 2 * every]))
    np.testing.assert_allclose(slopes, [0.2, -0.2, 0.2], atol=1e-12)
    x = np.arange(0.0, 200.0, 0.001)
    assert np.abs(np.diff(height(shapes, x))).max() <= 0.00021
    corners = [piece.nodes[-1] for piece in shapes.laid(0.0, 60.0).pieces[:-1]]
    np.testing.assert_allclose(corners, [5, 6, 5 + every, 6 + every, 5 + 2 * every, 6 + 2 * every], atol=1e-6)


@pytest.mark.parametrize(
    "road",
    [waves(0.1), waves(0.04, 0.7), build_road(HALF_ROUND), bank(), build_road(FLAT)],
    ids=["waves", "short waves", "half-round", "bank", "flat"],
)
def test_contact_on_what_is_laid_is_that_of_the_whole_road(road):
    low, high = 0.0, 12.0
    on = laid(Shapes.of(road), low, high)
    x = np.random.default_rng(3).uniform(low + 1.0, high - 1.0, 200)
    centres = np.column_stack([x, road.height(x) + RADIUS - 0.01])
    for found, right in zip(on.nearest(centres), road.nearest(centres), strict=True):
        np.testing.assert_allclose(found, right, atol=1e-9)


def test_contact_in_the_midst_of_joins_does_not_depend_on_how_much_is_laid():
    shapes = Shapes.of(build_road(HALF_ROUND))
    for k in range(6):
        shapes = shapes.joined((waves(0.1), bank(), build_road(HALF_ROUND))[k % 3], 10.0 + 2 * k, same_kind=False)
    x = np.random.default_rng(4).uniform(12.0, 28.0, 200)
    centres = np.column_stack([x, height(shapes, x) + RADIUS - 0.01])
    short, long = laid(shapes, 10.0, 30.0), laid(shapes, -20.0, 70.0)
    for found, right in zip(short.nearest(centres), long.nearest(centres), strict=True):
        np.testing.assert_allclose(found, right, atol=1e-8)


def test_laying_asks_few_shapes_however_many_were_joined_before():
    asked = []

    def counted(road: Road) -> Road:
        def count(derivatives):
            def counting(x: np.ndarray) -> Derivatives:
                asked.append(len(x))
                return derivatives(x)

            return counting

        pieces = [Piece(piece.nodes, count(piece.derivatives)) for piece in road.profile.pieces]
        return Road(Profile(pieces, road.profile.period), road.radius)

    shapes = Shapes.of(waves(0.1))
    for k in range(200):
        shapes = shapes.joined(counted(waves(0.1 + 0.001 * (k % 50))), 20.0 + k // 4, same_kind=True)
    assert len(shapes.row) == 51
    assert len(shapes.seen_from(40.0).row) < 35
    profile = shapes.laid(60.0, 72.0)
    asked.clear()
    Road(profile, RADIUS).table  # noqa: B018
    nodes = 12.0 * (8 / RADIUS + 4 * 128 / 7.0)
    assert sum(asked) < 2 * nodes
    x = np.linspace(20.0, 80.0, 5001)
    np.testing.assert_array_equal(
        height(shapes.seen_from(60.0), x[x > 60.0]), height(shapes, x[x > 60.0])
    )  # what is left out was no part of it


def test_what_is_seen_reaches_further_than_what_is_laid():
    shapes = Shapes.of(build_road(HALF_ROUND))
    road = LaidRoad(shapes.to_see(-20.0, 60.0), RADIUS, near=shapes.laid(-3.0, 10.0))
    assert road.height(np.array([4.0]))[0] == pytest.approx(0.1)
    assert road.height(np.linspace(20.0, 40.0, 20001)).max() == pytest.approx(0.1, abs=1e-6)
    assert road.nearest(np.array([[4.0, 0.4]]))[2][0] == pytest.approx(0.3, abs=1e-9)


def test_moving_the_origin_moves_nothing_on_the_ground():
    shapes = Shapes.of(bank()).joined(waves(0.1), 30.0, same_kind=False)
    x = np.linspace(0.0, 80.0, 4001)
    np.testing.assert_allclose(height(shapes.moved(25.0), x - 25.0), height(shapes, x), atol=1e-12)
