"""The results of `trackride sensitivity`."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from rich.table import Table

from app.format.markup import element
from app.reports.drawings import SMALL, WIDTH, Drawing, Look, plain_axes
from app.reports.html_page import wide_table
from app.reports.studies.common import csv_bytes, figure_label, folded, key_label, legend, result_files
from model.config.config import Config
from model.config.parameters import number_text
from model.study.design import Range
from model.study.sensitivity import Sensitivity

HEADS = (
    "figure", "key", "total", "total_low", "total_high", "first", "first_low", "first_high",
    "strength", "strength_error", "mean", "spread",
)  # fmt: skip
SHOWN = ("Figure", "Key", "Total (95 %)", "Alone (95 %)", "Change over the range")
CAPTION = (
    "Sobol's indices: shares of each figure's variance when all keys vary evenly over their ranges. Dark: of the key "
    "alone; pale: with all that it does together with others. Lines: bounds at 95 %."
)
MEANING = (
    "Change over the range: Morris's μ*, by how much the figure changes on the average when the key goes over its "
    "whole range, in the figure's unit; the sign is that of the mean change, ± what it may be off at 95 %."
)


def rows(found: Sensitivity) -> list[tuple[object, ...]]:
    """(figure, key, numbers as in HEADS), of each figure the key that matters most first."""
    indices, screening = found.indices, found.screening
    numbers = np.stack([
        indices.total, indices.total_low, indices.total_high, indices.first, indices.first_low, indices.first_high,
        screening.strength, screening.strength_error, screening.mean, screening.spread,
    ], axis=-1)  # fmt: skip
    return [
        (figure, found.keys[k], *map(float, numbers[s, k]))
        for s, figure in enumerate(found.figures)
        for k in np.argsort(-indices.total[s])
    ]


def _shown(row: tuple[object, ...]) -> list[str]:
    figure, key, total, total_low, total_high, first, first_low, first_high, strength, error, mean, _ = row
    sign = "−" if isinstance(mean, float) and mean < 0 else "+"
    return [
        str(figure),
        str(key),
        f"{total:.2f} ({total_low:.2f} … {total_high:.2f})",
        f"{first:.2f} ({first_low:.2f} … {first_high:.2f})",
        f"{sign}{strength:.3g} ± {error:.2g}",
    ]


def table(found: Sensitivity) -> Table:
    """For the terminal."""
    shown = Table(*SHOWN[1:], box=None, pad_edge=False)  # lines between its columns would make it too wide
    last = ""
    for row in rows(found):
        figure, key, *numbers = _shown(row)
        if figure != last:
            shown.add_row(figure, style="bold")
        shown.add_row(folded(key), *(number.replace(" … ", "…") for number in numbers))
        last = figure
    return shown


def files(found: Sensitivity, base: Config, over: Sequence[Range]) -> dict[str, bytes]:
    """By name: page, figure, table."""
    ranges = [[key_label(of.key), of.key, f"{number_text(of.low)} to {number_text(of.high)}"] for of in over]
    body = [
        element("h2", "Numbers"),
        wide_table(SHOWN, [_shown(row) for row in rows(found)]),
        element("p", MEANING),
        element("h2", "Ranges"),
        wide_table(("Key", "Name", "Range"), ranges),
    ]
    return result_files(
        "What matters", f"{base.name}: {found.runs} runs", drawing(found), CAPTION, body, [base],
        {"table.csv": csv_bytes(HEADS, rows(found))},
    )  # fmt: skip


def drawing(found: Sensitivity) -> Drawing:
    """A bar chart of the indices, one plot a figure."""
    each = 0.55 + 0.42 * len(found.keys)
    height = each * len(found.figures) + 0.4

    def draw(figure: Figure, look: Look) -> None:
        for s, name in enumerate(found.figures):
            bottom = (height - 0.1 - (s + 1) * each + 0.15) / height
            axes = figure.add_axes((2.2 / WIDTH, bottom, (WIDTH - 2.5) / WIDTH, (each - 0.5) / height))
            _bars(axes, found, s, look)
            plain_axes(axes, look, figure_label(name), "Share of the variance" if name == found.figures[-1] else "")
            axes.grid(axis="y", visible=False)
            if s == 0:
                legend(axes, look, ncols=2, loc="lower right", bbox_to_anchor=(1.0, 1.0))

    return Drawing("Sobol's indices of figures by key", WIDTH, height, draw)


def _bars(axes: Axes, found: Sensitivity, s: int, look: Look) -> None:
    indices = found.indices
    order = np.argsort(indices.total[s])
    place = np.arange(len(order))
    for values, low, high, shift, alpha, label in (
        (indices.total, indices.total_low, indices.total_high, 0.2, 0.45, "with others"),
        (indices.first, indices.first_low, indices.first_high, -0.2, 1.0, "alone"),
    ):
        value = values[s, order]
        error = np.abs(np.array([value - low[s, order], high[s, order] - value]))
        axes.barh(
            place + shift, np.maximum(value, 0), 0.36, xerr=error, color=look.accents[0], alpha=alpha, label=label,
            error_kw={"ecolor": look.grey, "elinewidth": 1},
        )  # fmt: skip
    axes.set_yticks(place, [key_label(found.keys[k]) for k in order], fontsize=SMALL)
    axes.set_xlim(0, 1.05 * max(1.0, float(indices.total_high[s].max())))
