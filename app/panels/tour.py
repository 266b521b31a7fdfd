"""The tour of the page, and the card of an example that is shown: assets/tour.js draws both."""

from __future__ import annotations

import json

import viser

from app.format.assets import asset
from app.format.markup import element, joined, running, style
from app.runs.examples import EXAMPLE


class Tour:
    """Of one tab. A browser that has never seen the tour begins it by itself."""

    def __init__(self, gui: viser.GuiApi) -> None:
        gui.add_html(str(joined((running(asset("tour.js")), style(asset("tour.css"))))))
        self._tour, self._card = gui.add_html(_tour_html(0)), gui.add_html("")
        self._starts = 0

    def start(self) -> None:
        """Show the tour from its first step."""
        self._starts += 1
        self._tour.content = _tour_html(self._starts)

    def show_example(self, name: str, says: str, *, ended: bool) -> None:
        """Show the card of an example; ended: nothing more is to come."""
        self._card.content = str(element("trackride-example", name=name, says=says, ended="" if ended else None))

    def hide_example(self) -> None:
        """Put the card away."""
        self._card.content = str(element("trackride-example"))


def _tour_html(starts: int) -> str:
    return str(element("trackride-tour", examples=json.dumps(list(EXAMPLE)), starts=str(starts)))
