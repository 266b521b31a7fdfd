"""Which frames a movie has, and what is written into them."""

from __future__ import annotations

import numpy as np
import pytest

from app.files.movie_frames import MovieChoice, movie_frames, movie_times, stamp_text, stamped
from tests.app.conftest import make_run
from tests.app.files.test_pictures import FakeBrowser

RUN = make_run(samples=1001)  # 10 s


def test_each_time_is_shown_before_it_is_filmed() -> None:
    browser = FakeBrowser(np.zeros((36, 64, 3), dtype=np.uint8))
    seen: list[float] = []
    frames = list(movie_frames(browser, seen.append, movie_times(1.0, 2.0), (64, 36)))
    assert len(frames) == len(seen) == 20
    assert seen == pytest.approx(np.arange(1, 2, 0.05))
    assert (browser.asked["size"], browser.asked["transport_format"]) == ((64, 36), "jpeg")


@pytest.mark.parametrize(
    ("choice", "time", "stretch"),
    [
        (MovieChoice(), 1.0, (1.0, 5.0)),
        (MovieChoice(), 9.0, (6.0, 10.0)),  # as long as others
        (MovieChoice(length=30.0), 3.0, (0.0, 10.0)),
        (MovieChoice(from_start=True), 3.0, (0.0, 4.0)),
        (MovieChoice(length=None), 3.0, (3.0, 10.0)),
        (MovieChoice(length=None, from_start=True), 3.0, (0.0, 10.0)),
    ],
)
def test_a_movie_is_as_long_as_the_user_chose_and_the_run_allows(
    choice: MovieChoice, time: float, stretch: tuple[float, float]
) -> None:
    assert choice.stretch(RUN, time) == pytest.approx(stretch)


def test_a_movie_at_the_very_end_has_a_frame() -> None:
    assert movie_times(10.0, 10.0) == [10.0]


def test_a_stamp_is_read_at_the_lower_left_and_leaves_the_rest_alone() -> None:
    pixels = np.full((720, 1280, 3), 200, dtype=np.uint8)
    text = stamp_text(RUN, 3.25, "Käfer → ½")
    assert text == "t = 3.25 s · Käfer → ½ · 0.0 km/h"
    changed = (stamped(pixels, text) != pixels).any(axis=2)
    rows, columns = np.nonzero(changed)
    assert rows.min() > 640
    assert columns.max() < 640
    assert (stamped(pixels, text)[changed] > 240).any()  # its letters are white
    assert (stamped(pixels, "t = 3.30 s") != stamped(pixels, "t = 3.35 s")).any()
