"""Between which places a wheel may bridge a valley."""

from __future__ import annotations

import numpy as np

from model.road.road import build_road
from tests.model.support import PAPER


def valleys(**road: object) -> tuple[float, float]:
    return build_road(PAPER.replace({f"road.{key}": value for key, value in road.items()})).table.valleys


def test_gentle_waves_have_none():
    assert valleys(type="sine") == (np.inf, -np.inf)


def test_an_obstacle_has_them_around_its_feet():
    start, end = valleys(type="half_round", position=4.0, radius=0.1)
    assert 3.0 < start < 3.9
    assert 4.1 < end < 5.0


def test_waves_that_go_on_have_no_last_one():
    start, end = valleys(type="sine", wavelength=0.8, amplitude=0.1)
    assert np.isfinite(start)
    assert end == np.inf
