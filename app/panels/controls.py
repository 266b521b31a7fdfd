"""Sliders and boxes for single parameters, as the parameter table describes them.

A box shows a value in the unit that its parameter is shown in; what the session is asked for is as in a file.
"""

from __future__ import annotations

from typing import Any

import viser

from app.format.parameters import (
    choice_words,
    file_number,
    file_value,
    hint,
    shown_label,
    shown_number,
    shown_text,
    slider_numbers,
    step_number,
)
from app.format.units import Units
from app.panels.actions import Actions
from app.panels.callbacks import by_user
from model.config.parameters import Parameter

PRECISION = 4  # decimals that a box for numbers takes by itself; more of them come as text
FINEST_STEP = 10**-PRECISION  # parameters that need finer ones are typed as text: 1e-6
ONE_EACH = " Here one for each road wheel, front first."
IMAGINARY = "vehicle.imaginary_"
IMAGINARY_SWITCH = "vehicle.imaginary_wheels.enabled"


def _typed(parameter: Parameter) -> bool:
    """Whether it is typed as text: it may be left out, is a list, or goes over many powers of ten."""
    return parameter.optional or parameter.kind == "list" or 0 < parameter.step < FINEST_STEP


def _decimals(value: float) -> int:
    text = f"{value:.10f}".rstrip("0")
    return len(text.partition(".")[2])


class Control:
    """Slider or box of one parameter. A parameter for each wheel has two: for one value, and for a list."""

    def __init__(
        self, gui: viser.GuiApi, parameter: Parameter, value: Any, actions: Actions, *, slider: bool | None = None
    ) -> None:
        """slider: a number has a slider; None: if it is one of the first sliders."""
        self.parameter = parameter
        self._held = value  # that was shown last, as in a file
        self._slider = (parameter.what_if if slider is None else slider) and parameter.kind in ("number", "integer")
        self._slider &= not _typed(parameter)
        label, help_text = shown_label(parameter), hint(parameter)
        self._list: Any = None
        if _typed(parameter):
            self._one: Any = gui.add_text(label, shown_text(parameter, value), hint=help_text)
        elif parameter.kind == "choice":
            self._one = gui.add_dropdown(
                label, tuple(map(choice_words, parameter.choices)), initial_value=choice_words(value), hint=help_text
            )
        elif parameter.kind == "flag":
            self._one = gui.add_checkbox(label, value, hint=help_text)
        else:
            single = value[0] if isinstance(value, tuple) else value
            first = shown_number(parameter, single)
            if self._slider:
                self._reach = slider_numbers(parameter, single)  # of the slider, before it is widened
                low, high, step = self._reach
                self._one = gui.add_slider(label, min(low, first), max(high, first), step, first, hint=help_text)
            else:
                self._one = gui.add_number(label, float(first), step=step_number(parameter), hint=help_text)
            self._one.precision = max(PRECISION, _decimals(first))
        ask = actions.enter if _typed(parameter) else actions.change
        self._one.on_update(by_user(lambda event: ask(parameter.key, self.value), actions.fail))
        if parameter.per_wheel:
            self._list = gui.add_text(label, "", hint=help_text + ONE_EACH)
            self._list.on_update(by_user(lambda event: actions.enter(parameter.key, self.listed_value), actions.fail))
            self.show(value)

    @property
    def value(self) -> Any:
        """The value of the slider or box, as in a file."""
        shown = self._one.value
        if isinstance(shown, str) and self.parameter.kind == "choice":
            return next((choice for choice in self.parameter.choices if choice_words(choice) == shown), shown)
        if isinstance(shown, str):
            return file_value(self.parameter, shown, self._held)
        if isinstance(shown, bool):
            return shown
        return file_number(self.parameter, shown, () if isinstance(self._held, tuple) else (self._held,))

    @property
    def listed_value(self) -> Any:
        """The values in the box for a list, as in a file."""
        return None if self._list is None else file_value(self.parameter, self._list.value, self._held)

    @property
    def box(self) -> str:
        """viser's name of the slider or box for one value; on the page its label has it."""
        return self._one._impl.uuid

    @property
    def boxes(self) -> tuple[str, ...]:
        """viser's names of the slider or box, and of the box for a list."""
        return (self.box,) if self._list is None else (self.box, self._list._impl.uuid)

    def remove(self) -> None:
        """Take it away from the page."""
        self._one.remove()
        if self._list is not None:
            self._list.remove()

    def show(self, value: Any) -> None:
        """Show this value, unless the control shows it already."""
        as_list = isinstance(value, tuple) and self._list is not None
        if self._list is not None:
            self._list.visible, self._one.visible = as_list, not as_list
            if as_list and self._list.value != shown_text(self.parameter, value):
                self._list.value = shown_text(self.parameter, value)  # also where it was typed in another way
        self._fit(value)
        shown_already = not as_list and self.value == value
        self._held = value
        if as_list or shown_already:
            return
        if _typed(self.parameter):
            self._one.value = shown_text(self.parameter, value)
        elif isinstance(value, str):
            self._one.value = choice_words(value)
        elif isinstance(value, bool):
            self._one.value = value
        else:
            shown = shown_number(self.parameter, value)
            self._one.precision = max(PRECISION, _decimals(shown))
            self._one.value = shown

    def _fit(self, value: Any) -> None:
        """Give the slider its own range again, or that of vehicles like the one with this value, widened if need be."""
        if not self._slider or isinstance(value, tuple):
            return
        shown = shown_number(self.parameter, value)
        if not self._reach[0] <= shown <= self._reach[1]:
            self._reach = slider_numbers(self.parameter, value)
        low, high, step = self._reach
        self._one.min, self._one.max, self._one.step = min(low, shown), max(high, shown), step

    def widen(self, value: Any) -> None:
        """Widen the range of the slider so that this value is in it."""
        if self._slider and not isinstance(value, tuple):
            shown = shown_number(self.parameter, value)
            self._one.min, self._one.max = min(self._one.min, shown), max(self._one.max, shown)

    def describe(self, parameter: Parameter, units: Units) -> None:
        """Show the same parameter, which may be a rate at the wheel or of the spring itself, in these units."""
        parameter = units.told(parameter)
        if parameter == self.parameter:
            return
        value = self.listed_value if isinstance(self._held, tuple) and self._list is not None else self.value
        told = parameter.kind == "choice" or not isinstance(value, str)  # else it is a text that means nothing
        self.parameter = parameter
        self._one.label, self._one.hint = shown_label(parameter), hint(parameter)
        if self._list is not None:
            self._list.label, self._list.hint = shown_label(parameter), hint(parameter) + ONE_EACH
        if self._slider:
            self._reach = slider_numbers(parameter, value[0] if isinstance(value, tuple) else value)
        elif parameter.kind in ("number", "integer") and not _typed(parameter):
            self._one.step = step_number(parameter)
        self.show(value if told else self._held)

    def enable(self, applies: bool) -> None:
        """Let it be used, or show that it has no effect now: a slider turns grey, a box of a road disappears."""
        if self.parameter.roads and not self._slider:
            self._one.visible = applies
        else:
            self._one.disabled = not applies
