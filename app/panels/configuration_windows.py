"""Windows over the page: the configuration as text, and all that is wrong with one."""

from __future__ import annotations

from typing import Any

import viser

from app.files.uploads import configuration
from app.format.assets import asset
from app.format.markup import Html, element, joined, running, style
from app.panels.actions import Actions
from app.panels.callbacks import by_user
from model.config.config import Config, ConfigError


class YamlWindow:
    """A configuration as text, to copy, change or paste. Faults of the text are shown below it, and lead to it."""

    def __init__(self, gui: viser.GuiApi, text: str, actions: Actions, error: ConfigError | None = None) -> None:
        """error: what is known to be wrong with the text."""
        self._shown = 0  # faults so far
        with gui.add_modal("Configuration") as self._modal:
            gui.add_html(str(joined((element("div", class_="trackride-yaml"), style(asset("modal.css"))))))
            self._text: Any = gui.add_text("YAML", text, multiline=True)
            self._faults = gui.add_html("")
            use = gui.add_button("Use this", hint="Run it; Undo leads back")
            close = gui.add_button("Close", color="gray")
        use.on_click(by_user(lambda event: actions.use_configuration(self.read), actions.fail))
        close.on_click(by_user(lambda event: self._modal.close(), actions.fail))
        if error is not None:
            self._show(error)

    def read(self) -> Config | None:
        """What the text says, and the window closes; None, and the window shows all faults, when it has any."""
        try:
            config = configuration("", self._text.value.encode())
        except ConfigError as error:
            self._show(error)
            return None
        self._modal.close()
        return config

    def _show(self, error: ConfigError) -> None:
        self._shown += 1
        leading = running(asset("modal.js"), data_count=str(self._shown))  # anew for the same faults, too
        self._faults.content = str(joined((fault_list(error), leading)))


def show_faults(gui: viser.GuiApi, title: str, error: ConfigError, actions: Actions, text: str | None = None) -> None:
    """Open a window that says all that is wrong with a configuration; text: its own, which the user may mend."""
    with gui.add_modal(title) as modal:
        gui.add_html(str(joined((fault_list(error), style(asset("modal.css"))))))
        edit = None if text is None else gui.add_button("Edit", hint="Open the text at its first fault")
        close = gui.add_button("Close", color="gray")

    def mend(event: Any) -> None:
        modal.close()
        if text is not None:
            actions.mend_yaml(text, error)

    if edit is not None:
        edit.on_click(by_user(mend, actions.fail))
    close.on_click(by_user(lambda event: modal.close(), actions.fail))


def fault_list(error: ConfigError) -> Html:
    """All faults, each with the line of the text that says it, where that is known."""
    return element(
        "ul",
        *(
            element(
                "li",
                f"Line {fault.line}: {fault}" if fault.line and fault.path else str(fault),
                data_line=str(fault.line) if fault.line else None,
            )
            for fault in error.faults
        ),
        class_="trackride-faults",
    )
