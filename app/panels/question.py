"""A question over the page, which the user answers with yes or no."""

from __future__ import annotations

from collections.abc import Callable

import viser

from app.format.markup import element
from app.panels.actions import Actions
from app.panels.callbacks import by_user

NO = "Cancel"


def ask(gui: viser.GuiApi, title: str, words: str, yes: str, act: Callable[[], None], actions: Actions) -> None:
    """Open a window with a question. yes: the button at which `act`, which must not block, is called."""
    with gui.add_modal(title) as modal:
        gui.add_html(str(element("p", words, style="padding: 0 1em; margin: 0.4em 0; font-size: 0.9em")))
        agreed, not_agreed = gui.add_button(yes), gui.add_button(NO, color="gray")

    def agree() -> None:
        modal.close()
        act()

    agreed.on_click(by_user(lambda event: agree(), actions.fail))
    not_agreed.on_click(by_user(lambda event: modal.close(), actions.fail))
