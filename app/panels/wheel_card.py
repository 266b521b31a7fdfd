"""The card of one wheel: what the road and the vehicle do to it at this moment."""

from __future__ import annotations

from typing import Any

import viser

from app.format.assets import asset
from app.format.load_unit import LoadUnit
from app.format.markup import element, joined, style
from app.format.units import METRIC, Unit, Units
from app.panels.actions import Actions
from app.panels.callbacks import by_user
from app.panels.page_layout import PageLayout
from model.analysis.wheel_contact import WheelState

HEIGHT, GAP = 152, 14  # px of usual type (page_layout.py); px from the view's upper edge
ABSENT = "–"


class WheelCard:
    """A low panel at the upper edge of the view, above the vehicle; it is there while a wheel is picked."""

    def __init__(self, gui: viser.GuiApi, actions: Actions) -> None:
        self._gui, self._actions = gui, actions
        self._panel: viser.PanelHandle | None = None
        self._text: Any = None
        self._layout: PageLayout | None = None
        self.wheel: int | None = None

    def pick(self, wheel: int | None) -> int | None:
        """Pick a wheel, in the model's order; None, or the one that is picked already: none. Returns the picked one."""
        self.wheel = None if wheel == self.wheel else wheel
        if self.wheel is None and self._panel is not None:
            self._panel.remove()
            self._panel = None
        elif self.wheel is not None and self._panel is None:
            self._panel = self._gui.add_panel()
            with self._panel.add_tab("Wheel"):
                close = self._gui.add_button("Close", color="gray")
                self._text = self._gui.add_html("")
            close.on_click(by_user(lambda event: self._actions.pick_wheel(None), self._actions.fail))
            if self._layout is not None:
                self.place(self._layout)
        return self.wheel

    def place(self, layout: PageLayout) -> None:
        """Float along the upper edge of the view."""
        self._layout = layout
        if self._panel is not None:
            height = int(HEIGHT * layout.scale)
            self._panel.float(x=layout.player_x, y=GAP, width=layout.player_width, height=height)

    def show(self, state: WheelState, colour: str, unit: LoadUnit, units: Units) -> None:
        """Fill in the card; colour: the wheel's, CSS; unit: of forces; units: of all else."""
        if self._panel is not None:
            self._text.content = card(state, colour, unit, units)


def card(state: WheelState, colour: str, unit: LoadUnit, units: Units = METRIC) -> str:
    """HTML of a wheel's figures, forces in that unit."""
    family = "Road wheel" if state.name.startswith("R") else "Imaginary wheel"
    in_air = state.penetration is None
    figures = (
        ("Normal load", unit.text(state.normal_load)),
        ("Share of all loads", _figure(_percent(state.load_share), 1, "%")),
        ("Traction", unit.text(state.traction)),
        ("Penetration", _told(None if state.penetration is None else 1e3 * state.penetration, 1, units.of("mm"))),
        ("Load at rest", unit.text(state.static_load)),
        ("Share of torque", _figure(_percent(state.torque_share), 1, "%")),
        ("Slip of the rim", _told(state.slip_velocity, 3, units.of("m/s"))),
        ("Arm in the hull", _figure(state.arm_angle, 2, "°")),
    )
    sign = element("i", style=f"background:{colour}")
    flying = joined((" ", element("em", "in the air"))) if in_air else ""
    cells = [element("span", label, element("b", value)) for label, value in figures]
    name = element("p", sign, element("b", state.name), " ", family, flying)
    shown = element("div", name, element("div", *cells), class_="trackride-wheel")
    return str(joined((shown, style(asset("wheel.css")))))


def _percent(share: float | None) -> float | None:
    return None if share is None else 100 * share


def _told(value: float | None, digits: int, unit: Unit) -> str:
    return _figure(None if value is None else value * unit.factor, digits + unit.finer, unit.name)


def _figure(value: float | None, digits: int, unit: str) -> str:
    if value is None:
        return ABSENT
    number = round(value, digits) + 0.0  # no minus before zero
    return f"{number:.{digits}f}{'' if unit == '°' else ' '}{unit}".replace("-", "−")
