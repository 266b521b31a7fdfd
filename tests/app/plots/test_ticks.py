"""Numbers of an axis."""

from __future__ import annotations

import pytest

from app.plots.ticks import ticks


@pytest.mark.parametrize(
    ("low", "high", "expected"),
    [
        (0, 10, [0, 2, 4, 6, 8, 10]),
        (0, 0.31, [0, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3]),
        (117.5, 127.5, [118, 120, 122, 124, 126]),
    ],
)
def test_ticks_are_round(low: float, high: float, expected: list[float]) -> None:
    assert ticks(low, high) == pytest.approx(expected)
    assert not any(str(tick).startswith("-") for tick in ticks(low, high))
