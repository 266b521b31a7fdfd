"""Figures and changes in plain text."""

from __future__ import annotations

import pytest

from app.format.differences import change_text, figure_text


@pytest.mark.parametrize(
    ("value", "resolution", "text"),
    [
        (None, 0, "–"),
        (0.0, 0, "0"),
        (0.0912, 0, "0.0912"),
        (1.346, 0, "1.35"),
        (18.74, 0, "18.7"),
        (182.7, 0, "183"),
        (0.00001, 0, "0.0000"),
        (0.09, 0.005, "0.090"),
        (0.3, 0.1, "0.3"),
        (1.235, 0.005, "1.24"),
        (4.0, 1.0, "4"),
    ],
)
def test_figures_have_three_digits_and_none_that_nobody_measured(
    value: float | None, resolution: float, text: str
) -> None:
    assert figure_text(value, resolution) == text


@pytest.mark.parametrize(
    ("change", "text"),
    [(None, "–"), (13.3, "+13 %"), (-1.147, "−1.1 %"), (0.01, "0 %"), (-0.04, "0 %"), (-9.96, "−10 %")],
)
def test_changes_have_their_sign(change: float | None, text: str) -> None:
    assert change_text(change) == text
