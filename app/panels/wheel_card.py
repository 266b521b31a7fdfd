"""The card of one wheel: what the road and the vehicle do to it at this moment."""

from __future__ import annotations

from html import escape
from typing import Any

import viser

from app.format.load_unit import LoadUnit
from app.panels.actions import Actions
from app.panels.callbacks import by_user
from model.analysis.ride import WheelState

HEIGHT, GAP = 152, 14  # px; GAP from the view's upper edge
ABSENT = "–"


class WheelCard:
    """A low panel at the upper edge of the view, above the vehicle; it is there while a wheel is picked."""

    def __init__(self, gui: viser.GuiApi, actions: Actions) -> None:
        self._gui, self._actions = gui, actions
        self._panel: viser.PanelHandle | None = None
        self._text: Any = None
        self._place = 0, 0
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
            self.place(*self._place)
        return self.wheel

    def place(self, x: int, width: int) -> None:
        """Float along the upper edge of the view, px from its left edge."""
        self._place = x, width
        if self._panel is not None:
            self._panel.float(x=x, y=GAP, width=width, height=HEIGHT)

    def show(self, state: WheelState, colour: str, unit: LoadUnit) -> None:
        """Fill in the card; colour: the wheel's, CSS; unit: of forces."""
        if self._panel is not None:
            self._text.content = card(state, colour, unit)


def card(state: WheelState, colour: str, unit: LoadUnit) -> str:
    """HTML of a wheel's figures, forces in that unit."""
    family = "Road wheel" if state.name.startswith("R") else "Imaginary wheel"
    in_air = state.penetration is None
    figures = (
        ("Normal load", unit.text(state.normal_load)),
        ("Share of all loads", _figure(_percent(state.load_share), 1, "%")),
        ("Traction", unit.text(state.traction)),
        ("Penetration", _figure(None if state.penetration is None else 1e3 * state.penetration, 1, "mm")),
        ("Load at rest", unit.text(state.static_load)),
        ("Share of torque", _figure(_percent(state.torque_share), 1, "%")),
        ("Slip of the rim", _figure(state.slip_velocity, 3, "m/s")),
        ("Arm in the hull", _figure(state.arm_angle, 2, "°")),
    )
    cells = "".join(f"<span>{label}<b>{value}</b></span>" for label, value in figures)
    return (
        f'<div class="trackride-wheel"><p><i style="background:{colour}"></i><b>{escape(state.name)}</b> {family}'
        f"{' <em>in the air</em>' if in_air else ''}</p><div>{cells}</div></div>{STYLE}"
    )


def _percent(share: float | None) -> float | None:
    return None if share is None else 100 * share


def _figure(value: float | None, digits: int, unit: str) -> str:
    if value is None:
        return ABSENT
    number = round(value, digits) + 0.0  # no minus before zero
    return f"{number:.{digits}f}{'' if unit == '°' else ' '}{unit}".replace("-", "−")


STYLE = """<style>
  div:has(+ div > .trackride-wheel) { float: right; margin: 0.35em 0.6em 0 0; }
  div:has(+ div > .trackride-wheel) button { height: 1.8em !important; padding: 0 0.8em; font-size: 0.75em;
    background: #5c6670 !important; }
  .trackride-wheel { padding: 0 0.9em; font-size: 0.8em; line-height: 1.4; }
  .trackride-wheel p { margin: 0 0 0.35em; line-height: 2; white-space: nowrap; }
  .trackride-wheel i { display: inline-block; width: 0.8em; height: 0.8em; border-radius: 50%; margin-right: 0.5em; }
  .trackride-wheel em { font-style: normal; font-weight: 550; color: var(--trackride-bad); padding-left: 1ch; }
  .trackride-wheel > div { display: grid; grid-template-columns: repeat(4, 1fr); gap: 0.25em 0.8em; }
  .trackride-wheel span { color: var(--mantine-color-dimmed); white-space: nowrap; font-size: 0.9em; }
  .trackride-wheel span b { display: block; font-weight: 550; font-size: 1.1em; color: var(--mantine-color-text);
    font-variant-numeric: tabular-nums; }
</style>"""
