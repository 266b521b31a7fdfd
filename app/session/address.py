"""The address of the page: it follows what is shown, and what it asks for is shown.

Only the thread that draws (app/session/session.py) uses it. Times are monotonic, in s.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

from app.format.link import LONGEST, Link, Look, link_from, link_text, nearest_preset
from app.panels.plot_panel import TABS
from app.panels.view_panel import VIEWS
from app.runs.request import Request
from app.session.window import Window
from app.session.workspace import Workspace
from model.config.config import Config, ConfigError
from model.config.config_files import preset_names

EVERY = 0.5  # s from one address to the next in a drag: browsers take a hundred in half a minute
TOO_LONG = "This road has too many points for a link. Send the file instead: Export, YAML."


class Address:
    """Of one tab."""

    def __init__(
        self,
        window: Window,
        workspace: Workspace,
        presets: Mapping[str, Config],
        stands_at: Callable[[], float | None],
    ) -> None:
        """presets: name -> configuration; those that come with the program are known to every explorer.

        stands_at: the time of a run that is paused, s; None: it plays.
        """
        self._window, self._workspace, self._stands_at = window, workspace, stands_at
        self._presets = {name: presets[name] for name in preset_names() if name in presets}
        self._shown: tuple[object, ...] = ()  # what the address says
        self._shown_at = float("-inf")
        self._step = 0
        self._steps: object = None

    def tick(self, now: float) -> None:
        """Let the address follow; `now`, s. To be called several times a second."""
        if not self._workspace.stands or now - self._shown_at < EVERY:
            return
        present, steps, looks = self._workspace.present, self._workspace.steps, self._looks
        shown = (present.number, steps, looks)
        if shown == self._shown:
            return
        if steps != self._steps:
            self._steps, self._step = steps, self._step + 1
        self._shown, self._shown_at = shown, now
        self._window.address.show(self._text(), self._step)

    @property
    def _looks(self) -> Look:
        time = self._stands_at()
        return replace(self._window.looks, time=None if time is None else round(time, 2))

    def open(self, text: str) -> None:
        """Show what a fragment says."""
        try:
            link = link_from(text, self._presets, tuple(VIEWS.values()), TABS)
        except ConfigError as error:
            self._window.show_faults("This link cannot be used", error)
            self._shown = ()
            return
        self._workspace.open(link)
        self._window.look(link.config, link.look)

    def copy(self) -> None:
        """Give the user the address of what is shown."""
        text = self._text()
        if not text:
            self._window.say("No link", TOO_LONG)
            return
        self._window.address.copy(text)
        self._window.say(
            "Link copied",
            "It opens this vehicle, road and baseline, and what you look at. In an explorer on another machine, put "
            "what follows # behind its own address.",
        )

    def _text(self) -> str:
        """The fragment; empty where it would be too long."""
        present, (_, baseline) = self._workspace.present, self._workspace.steps
        config = present.config()
        link = Link(
            self._preset_of(present, config),
            config,
            "" if baseline is None else nearest_preset(baseline, self._presets),
            baseline,
            self._looks,
        )
        text = link_text(link, self._presets)
        return text if len(text) <= LONGEST else ""

    def _preset_of(self, request: Request, config: Config) -> str:
        """The preset that the user started from, or the one that comes nearest."""
        own = next((name for name, preset in self._presets.items() if preset == request.base), "")
        return own or nearest_preset(config, self._presets)
