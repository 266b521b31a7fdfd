"""What the command palette (Ctrl+K) finds besides the keys: parameters, tabs, examples, exports, presets."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

import viser

from app.panels.actions import Actions
from app.panels.callbacks import by_user
from app.panels.files_panel import DATA_BUTTONS, FIGURE_BUTTONS, MOTION_BUTTONS, PROJECT
from app.panels.parameter_panel import BOXED
from app.panels.plot_panel import TABS
from app.panels.units_panel import SYSTEMS
from app.runs.examples import EXAMPLES
from model.config.config import Config
from model.config.parameters import PARAMETERS

EXPORTS = {"Figure": FIGURE_BUTTONS, "Data": DATA_BUTTONS, "In motion": MOTION_BUTTONS}


def add_palette(gui: viser.GuiApi, presets: Mapping[str, Config], actions: Actions) -> None:
    """Register all of it. presets: name -> configuration."""

    def add(label: str, kind: str, act: Callable[[], None]) -> None:
        command = gui.add_command(label, description=kind)
        command.on_trigger(by_user(_without_event(act), actions.fail))

    for parameter in (p for p in PARAMETERS if p.what_if or p in BOXED):
        add(parameter.label, f"Parameter: {parameter.group}", partial(actions.lead_to, parameter.key))
    for tab in TABS:
        add(tab, "Tab", partial(actions.open_tab, tab))
    add("Tour of the page", "First steps", actions.start_tour)
    for example in EXAMPLES:
        add(example.name, "Example", partial(actions.try_example, example.name))
    for group, buttons in EXPORTS.items():
        for name, what in buttons.items():
            add(f"{group}: {name}", "Export", partial(actions.export, what))
    add("Save project", "Export", partial(actions.export, PROJECT))
    for name, units in SYSTEMS.items():
        add(f"{name} units", "Units", partial(actions.choose_units, units.chosen))
    for name, preset in presets.items():
        add(preset.name, "Preset", partial(actions.load, name))


def _without_event(act: Callable[[], None]) -> Callable[[Any], None]:
    return lambda event: act()
