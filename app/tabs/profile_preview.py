"""A picture of a measured profile, all of it, as HTML. Pure."""

from __future__ import annotations

import numpy as np

from app.format.markup import Html, element, joined
from app.plots.thinning import thin
from app.plots.ticks import ticks
from model.config.parameters import number_text
from model.config.profile_points import height_unit

WIDTH, HEIGHT = 600, 150  # of the drawing
LEFT = 64  # of it, for the heights
FOOT = 18  # of it, for the distances
ROOM = 8  # of it, above the highest point and right of the last
FLAT = 1e-3  # m: heights that differ by less fill half of this
EDGE = 24  # from the ends within which a distance's text would be cut


def profile_preview(x: np.ndarray, y: np.ndarray) -> Html:
    """The line through points (K,), m, its heights enlarged so that they fill the picture."""
    unit, factor = height_unit(y)
    low, high = float(y.min()), float(y.max())
    if high - low < FLAT:
        low, high = (low + high - FLAT) / 2, (low + high + FLAT) / 2
    first, last = float(x[0]), float(x[-1])
    across = (WIDTH - LEFT - ROOM) / (last - first)
    up = (HEIGHT - FOOT - 2 * ROOM) / (high - low)

    def right(at: float | np.ndarray) -> float | np.ndarray:
        return LEFT + (at - first) * across

    def down(height: float | np.ndarray) -> float | np.ndarray:
        return HEIGHT - FOOT - ROOM - (height - low) * up

    few, heights = thin(x, y[:, None])
    line = " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(right(few), down(heights[:, 0]), strict=True))  # type: ignore[arg-type]
    foot = HEIGHT - FOOT
    drawing = element(
        "svg",
        *(
            joined(
                (
                    element("line", x1=f"{LEFT}", x2=f"{WIDTH - ROOM}", y1=f"{down(tick):.1f}", y2=f"{down(tick):.1f}"),
                    element(
                        "text",
                        f"{number_text(round(tick * factor, 9))} {unit}".replace("-", "\u2212"),
                        x=f"{LEFT - 6}",
                        y=f"{down(tick) + 4:.1f}",
                        class_="trackride-height",
                    ),
                )
            )
            for tick in ticks(low, high, 2)
        ),
        element("polygon", points=f"{LEFT},{foot} {line} {WIDTH - ROOM},{foot}"),
        element("polyline", points=line),
        *(
            element("text", f"{number_text(tick)} m".replace("-", "\u2212"), x=f"{right(tick):.1f}", y=f"{HEIGHT - 4}")
            for tick in ticks(first, last, 4)
            if LEFT + EDGE <= right(tick) <= WIDTH - EDGE
        ),
        viewBox=f"0 0 {WIDTH} {HEIGHT}",
        role="img",
        aria_label="The profile as it would be read",
    )
    caption = element("figcaption", f"Heights enlarged {number_text(float(f'{up / across:.2g}'))} times")
    return element("figure", drawing, caption, class_="trackride-road trackride-preview")
