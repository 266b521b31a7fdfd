"""The wheels' names under the vehicle, with the loads that they carry if the user wants them."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
import viser

from app.format.load_unit import LoadUnit
from app.view3d.meshes.measures import Measures
from app.view3d.nodes import VEHICLE, Frame, update

BELOW = 0.12  # m from the lowest point of the road down to the names of the road wheels of the paper's vehicle
NAMES = 0.0, 0.2  # m from there down to the middle of each row of names, at the size of the paper's vehicle
WITH_LOADS = 0.12, 0.67  # the same of names with loads, which take two lines
UNIT_AHEAD = 0.45  # m from the first wheel to the loads' unit
ROOM, ROOM_WITH_LOADS = 32.0, 40.0  # px of usual type that a name takes along the vehicle
FIGURE_SPACE = "\u2007"  # as wide as a figure


class WheelLabels:
    """R1… and below them I1…, under the arrows of the right side."""

    def __init__(self, api: viser.SceneApi, measures: Measures) -> None:
        name = f"{VEHICLE}/labels"
        self._frame = Frame(api, name)
        self._scale, self._y = measures.scale, -measures.arrow
        between = (np.array(measures.wheel_x)[: len(measures.links)] - measures.links).tolist()
        families = ("R", measures.wheel_x), ("I", between)
        self._names = [f"{letter}{k + 1}" for letter, xs in families for k in range(len(xs))]
        self._places = [(x, row) for row, (_, xs) in enumerate(families) for x in xs]  # along the vehicle, and the row
        self._labels = [api.add_label(f"{name}/{text}", text, anchor="center-center") for text in self._names]
        self._texts = self._names
        ahead = (measures.front + UNIT_AHEAD * self._scale, self._y, -WITH_LOADS[0] * self._scale)
        self._unit = api.add_label(f"{name}/unit", "", position=ahead, anchor="center-center", visible=False)
        self._with_loads = False
        self._type = 1.0  # times its usual size
        self._every = 1  # which names are shown: of each family every so many, from the front
        self._spacing = min(np.diff(np.sort(xs)).min() for _, xs in families if len(xs) > 1)  # m, of one family
        self._arrange()

    def show(self, on: Mapping[str, bool]) -> None:
        """Show the names, or the names with their loads, or neither, as the switches say."""
        self._frame.node.visible = on["names"] or on["loads"]
        if on["loads"] != self._with_loads:
            self._with_loads = on["loads"]
            self._arrange()

    def write(self, load: np.ndarray, unit: LoadUnit) -> None:
        """Write these loads (W,), N, in the model's order, in that unit, if loads are shown."""
        if self._with_loads:
            if self._unit.text != unit.name:
                self._unit.text = unit.name
            self._say([f"{name}\n{load_text(own, unit)}" for name, own in zip(self._names, load, strict=True)])

    def set_type(self, scale: float) -> None:
        """Write so many times as large as usual."""
        if scale != self._type:
            self._type = scale
            for label in (*self._labels, self._unit):
                label.font_screen_scale = scale

    def thin_out(self, pixels: Callable[[float], float]) -> None:
        """Show as many names as have room; pixels: how far apart points are seen that are so many m apart, px."""
        room = (ROOM_WITH_LOADS if self._with_loads else ROOM) * self._type
        every = int(np.ceil(np.clip(room / max(pixels(self._spacing), 1e-3), 1, len(self._labels))))
        if every != self._every:
            self._every = every
            for label, name in zip(self._labels, self._names, strict=True):
                label.visible = (int(name[1:]) - 1) % every == 0

    def move(self, x: float, lowest: float) -> None:
        """Stand under the vehicle at x in the view, m, on a road with this lowest point."""
        self._frame.move(x, lowest - BELOW * self._scale)

    def _arrange(self) -> None:
        self._unit.visible = self._with_loads
        rows = WITH_LOADS if self._with_loads else NAMES
        for label, (x, row) in zip(self._labels, self._places, strict=True):
            label.position = (x, self._y, -rows[row] * self._scale)
        if not self._with_loads:
            self._say(self._names)

    def _say(self, texts: list[str]) -> None:
        """Write the labels' texts; nothing is sent for a label that has its text already."""
        for label, text, before in zip(self._labels, texts, self._texts, strict=True):
            if text != before:
                update(label, text=text)
        self._texts = texts


def load_text(load: float, unit: LoadUnit) -> str:
    """A load, N, without its unit, as wide as the largest: " 8.9"."""
    return f"{load / unit.newtons:.{min(unit.decimals, 1)}f}".rjust(4, FIGURE_SPACE)
