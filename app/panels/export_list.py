"""The list of exports that are being made or wait for their turn: a line for each, with a button to cancel it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import viser

from app.format.assets import asset
from app.format.markup import element, joined, style
from app.panels.actions import Actions
from app.panels.callbacks import by_user
from app.panels.page_layout import PageLayout

GAP = 14  # px from the view's edges
WIDTH, HEAD, ROW = 330, 44, 31  # px of usual type (page_layout.py): the panel's width, heights of its head and a line
MOST_ROWS = 6  # that are seen without scrolling
CANCEL = "Cancel"


class ExportLine(NamedTuple):
    """One export."""

    number: int  # unique
    text: str  # what it is, and how far it has come


class ExportList:
    """A panel at the upper right corner of the view; it is there while it has lines."""

    def __init__(self, gui: viser.GuiApi, actions: Actions) -> None:
        self._gui, self._actions = gui, actions
        self._panel: viser.PanelHandle | None = None
        self._tab: Any = None
        self._rows: dict[int, Any] = {}
        self._layout: PageLayout | None = None

    def show(self, lines: Sequence[ExportLine]) -> None:
        """Show these, and no others."""
        numbers = [line.number for line in lines]
        changed = set(numbers) != self._rows.keys()
        for number in self._rows.keys() - set(numbers):
            self._rows.pop(number).remove()
        if self._panel is not None and not lines:
            self._panel.remove()
            self._panel = None
        elif self._panel is None and lines:
            self._panel = self._gui.add_panel()
            self._tab = self._panel.add_tab("Exports")
            with self._tab:
                marked = element("div", class_="trackride-exports")
                self._gui.add_html(str(joined((marked, style(asset("exports.css"))))), order=0)  # above all lines
        for line in lines:
            if line.number not in self._rows:
                self._rows[line.number] = self._row(line)
            elif self._rows[line.number].label != line.text:
                self._rows[line.number].label = line.text
        if changed and self._layout is not None:
            self.place(self._layout)

    def place(self, layout: PageLayout) -> None:
        """Float in the upper right corner of the view: messages come at its left."""
        self._layout = layout
        if self._panel is not None:
            height = HEAD + ROW * min(len(self._rows), MOST_ROWS)
            self._panel.float(x=-GAP, y=GAP, width=int(WIDTH * layout.scale), height=int(height * layout.scale))

    def _row(self, line: ExportLine) -> viser.GuiButtonGroupHandle:
        with self._tab:
            row = self._gui.add_button_group(
                line.text, (CANCEL,), order=line.number, hint="Cancel: make this file no more; the others go on."
            )
        row.on_click(by_user(lambda event: self._actions.cancel_export(line.number), self._actions.fail))
        return row
