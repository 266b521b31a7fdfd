"""Windows over the page: the configuration as text, and all that is wrong with one."""

from __future__ import annotations

from typing import Any

import viser

from app.files.uploads import configuration
from app.format.assets import asset
from app.format.markup import Html, element, joined, style
from app.panels.actions import Actions
from app.panels.callbacks import by_user
from model.config.config import Config, ConfigError
from model.config.config_files import dump_config


class YamlWindow:
    """A configuration as text, to copy, change or paste. Faults of the text are shown below it."""

    def __init__(self, gui: viser.GuiApi, config: Config, actions: Actions) -> None:
        with gui.add_modal("Configuration") as self._modal:
            gui.add_html(str(joined((element("div", class_="trackride-yaml"), style(asset("modal.css"))))))
            self._text: Any = gui.add_text("YAML", dump_config(config), multiline=True)
            self._faults = gui.add_html("")
            use = gui.add_button("Use this", hint="Run it; Undo leads back")
            close = gui.add_button("Close", color="gray")
        use.on_click(by_user(lambda event: actions.use_configuration(self.read), actions.fail))
        close.on_click(by_user(lambda event: self._modal.close(), actions.fail))

    def read(self) -> Config | None:
        """What the text says, and the window closes; None, and the window shows all faults, when it has any."""
        try:
            config = configuration("", self._text.value.encode())
        except ConfigError as error:
            self._faults.content = str(fault_list(error))
            return None
        self._modal.close()
        return config


def show_faults(gui: viser.GuiApi, title: str, error: ConfigError, actions: Actions) -> None:
    """Open a window that says all that is wrong with a configuration."""
    with gui.add_modal(title) as modal:
        gui.add_html(str(joined((fault_list(error), style(asset("modal.css"))))))
        close = gui.add_button("Close")
    close.on_click(by_user(lambda event: modal.close(), actions.fail))


def fault_list(error: ConfigError) -> Html:
    """All faults."""
    return element("ul", *(element("li", str(fault)) for fault in error.faults), class_="trackride-faults")
