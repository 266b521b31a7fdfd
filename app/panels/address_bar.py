"""The page's address, which says in its fragment what the page shows (assets/address.js)."""

from __future__ import annotations

import viser

from app.format.assets import asset
from app.format.markup import element, running


class AddressBar:
    """What the browser shows above the page."""

    def __init__(self, gui: viser.GuiApi) -> None:
        gui.add_html(str(running(asset("address.js"))))
        self._shown = gui.add_html("")
        self._copied = gui.add_html("")
        self._copies = 0

    def show(self, fragment: str, step: int) -> None:
        """Let the address end in this fragment; the browser's back button leads from each step to the one before."""
        self._shown.content = str(element("trackride-address", of=fragment, step=str(step)))

    def copy(self, fragment: str) -> None:
        """Put the page's address with this fragment among what the user can paste."""
        self._copies += 1
        self._copied.content = str(element("trackride-copy", of=fragment, count=str(self._copies)))
