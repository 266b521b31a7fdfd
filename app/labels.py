"""The wheels' names under the vehicle, with the loads they carry if wanted."""

from __future__ import annotations

import numpy as np
import viser

from app.nodes import VEHICLE, Frame, update
from assets.layout import Layout

BELOW = 0.12  # m from the lowest point of the road down to the names of the road wheels
NAMES = 0.0, 0.2  # m from there down to the middle of each row of names, at the size of the paper's vehicle
WITH_LOADS = 0.12, 0.67  # the same of names with loads, which take two lines
UNIT_AHEAD = 0.45  # m from the first wheel to the loads' unit
FIGURE_SPACE = "\u2007"  # as wide as a figure


class WheelLabels:
    """R1… and below them I1…, under the arrows of the right side."""

    def __init__(self, api: viser.SceneApi, layout: Layout) -> None:
        name = f"{VEHICLE}/labels"
        self._frame = Frame(api, name)
        self._scale, self._y = layout.scale, -layout.arrow
        between = (np.array(layout.wheel_x)[: len(layout.links)] - layout.links).tolist()
        self._rows = [
            [(api.add_label(f"{name}/{letter}{k}", f"{letter}{k}", anchor="center-center"), x, f"{letter}{k}")
             for k, x in enumerate(xs, start=1)]
            for letter, xs in (("R", layout.wheel_x), ("I", between))
        ]  # fmt: skip
        ahead = (layout.front + UNIT_AHEAD * self._scale, self._y, -WITH_LOADS[0] * self._scale)
        self._unit = api.add_label(f"{name}/unit", "kN", position=ahead, anchor="center-center")
        self._with_loads = False
        self._texts: list[str] = []
        self._arrange()

    def show(self, names: bool, loads: bool) -> None:
        """Show the names, or the names with their loads, or neither."""
        self._frame.node.visible = names or loads
        if loads != self._with_loads:
            self._with_loads = loads
            self._arrange()

    def write(self, load: np.ndarray) -> None:
        """Say these loads (W,), N, in the model's order; nothing is sent while they read the same."""
        labels = [label for row in self._rows for label in row]
        texts = [f"{name}\n{load_text(own)}" for (_, _, name), own in zip(labels, load, strict=True)]
        if not self._with_loads or texts == self._texts:
            return
        for (node, _, _), text, before in zip(labels, texts, self._texts or [""] * len(texts), strict=True):
            if text != before:
                update(node, text=text)
        self._texts = texts

    def move(self, x: float, lowest: float) -> None:
        """Stand under the vehicle at x in the view, m, on a road with this lowest point."""
        self._frame.move(x, lowest - BELOW)

    def _arrange(self) -> None:
        self._unit.visible = self._with_loads
        self._texts = []
        for row, below in zip(self._rows, WITH_LOADS if self._with_loads else NAMES, strict=True):
            for node, x, name in row:
                node.position = (x, self._y, -below * self._scale)
                if not self._with_loads:
                    update(node, text=name)


def load_text(load: float) -> str:
    """kN with one decimal, as wide as the largest: " 8.9"."""
    return f"{load / 1e3:.1f}".rjust(4, FIGURE_SPACE)
