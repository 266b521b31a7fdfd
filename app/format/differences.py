"""The figures of a run, and how much they differ from those of its baseline, in plain text."""

from __future__ import annotations

import math

from model.analysis.figures import Row

NONE = "–"  # where there is no figure


def row_texts(row: Row) -> tuple[str, str]:
    """Now and baseline."""
    return figure_text(row.now, row.resolution), figure_text(row.baseline, row.resolution)


def figure_text(value: float | None, resolution: float = 0.0) -> str:
    """Three digits that count, as people write them: 0.0912, 1.35, 18.7, 183; none finer than the resolution."""
    if value is None:
        return NONE
    if value == 0:
        return "0"
    digits = max(2 - int(f"{abs(value):e}".partition("e")[2]), 0)
    finest = 4 if resolution == 0 else max(math.ceil(-math.log10(resolution)), 0)
    return f"{value:.{min(digits, finest, 4)}f}"


def change_text(change: float | None) -> str:
    """Percent with its sign: "+13 %", "−1.1 %"."""
    if change is None:
        return NONE
    text = f"{change:+.0f}" if abs(change) >= 9.95 else f"{change:+.1f}"
    return f"{'0' if float(text) == 0 else text.replace('-', '−')} %"
