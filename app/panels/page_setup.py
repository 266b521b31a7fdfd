"""What the page needs besides panels: theme, rules and script (assets/page.css, page.js), hints, hidden controls."""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple

import viser

from app.format.assets import asset
from app.format.markup import element, joined, running, style
from app.format.parameters import choice_words
from app.panels.actions import Actions
from app.panels.callbacks import by_user
from app.panels.controls import PRECISION
from app.panels.page_layout import PageLayout
from app.panels.page_requests import carry_out
from model.config.config import Config, SumRoad

BRAND = (28, 108, 178)
INTRO = "Move a slider: the run is computed anew. Ctrl+K: all keys."


def apply_theme(gui: viser.GuiApi, dark: bool) -> None:
    """Colours of the page. No logo, and no share button: it would let any visitor open a public tunnel."""
    gui.configure_theme(dark_mode=dark, brand_color=BRAND, show_logo=False, show_share_button=False)


class PageSigns(NamedTuple):
    """Controls that nobody sees but the page sets."""

    in_view: viser.GuiCheckboxHandle  # ticked while the page is in view
    in_front: viser.GuiTextHandle  # names of the tabs in front, with commas between, once the page shows the panels
    night: viser.GuiCheckboxHandle  # ticked where the browser is set to dark pages
    visit: viser.GuiTextHandle  # what this tab had stored when its page was loaded anew; "null": nothing
    typed: viser.GuiTextHandle  # JSON: viser's name of a box for numbers, what was typed there and is none, a count
    size: viser.GuiTextHandle  # JSON: width and height of the page, and the view's width, px
    at: viser.GuiTextHandle  # JSON: a time in a plot that was clicked, s, and a count
    asked: viser.GuiTextHandle  # JSON: kind, content and a count of what the page asks for (page_requests.py)
    place: viser.GuiTextHandle  # where in its run the tab was, and its camera; told as `visit` is
    layout: viser.GuiHtmlHandle  # see layout_html
    store: viser.GuiHtmlHandle  # what runs there stores something in the tab: its visit …
    store_place: viser.GuiHtmlHandle  # … and its place
    title: viser.GuiHtmlHandle  # see title_html


def add_page(gui: viser.GuiApi) -> PageSigns:
    """Add rules and script of the page, and the controls by which it tells something.

    page.js sets all but the tabs in front, which plots.js writes.
    """
    title = gui.add_html("")
    page = gui.add_html("")
    in_view = gui.add_checkbox("In view", True)
    in_front = gui.add_text("Tabs in front", "")
    night = gui.add_checkbox("Dark pages", False)
    visit = gui.add_text("Visit", "")
    typed = gui.add_text("Typed", "")
    size = gui.add_text("Size", "")
    at = gui.add_text("At", "")
    asked = gui.add_text("Asked", "")
    place = gui.add_text("Place", "")
    layout = gui.add_html("")
    store, store_place = gui.add_html(""), gui.add_html("")
    rules = style(
        asset("page.css"),
        id="trackride-style",
        data_in_view=in_view._impl.uuid,
        data_night=night._impl.uuid,
        data_visit=visit._impl.uuid,
        data_typed=typed._impl.uuid,
        data_size=size._impl.uuid,
        data_at=at._impl.uuid,
        data_asked=asked._impl.uuid,
        data_place=place._impl.uuid,
        data_decimals=str(PRECISION),
    )
    intro = element("p", INTRO, class_="trackride-intro")
    page.content = str(joined((running(asset("page.js")), intro, rules)))
    return PageSigns(in_view, in_front, night, visit, typed, size, at, asked, place, layout, store, store_place, title)


def listen(signs: PageSigns, actions: Actions, enter: Callable[[str, str], None]) -> None:
    """Pass on what the page tells. enter: gets viser's name of a box for numbers, and what was typed there."""
    tells: tuple[tuple[Any, Callable[[Any], object]], ...] = (
        (signs.in_view, actions.set_in_view),
        (signs.in_front, lambda tabs: actions.set_in_front(frozenset(tabs.split(",")))),
        (signs.night, actions.prefer_dark),
        (signs.visit, actions.recollect),
        (signs.place, actions.return_to),
        (signs.typed, lambda typed: enter(*json.loads(typed)[:2])),
        (signs.size, lambda size: actions.set_page_size(*json.loads(size))),
        (signs.at, lambda at: actions.scrub(float(json.loads(at)[0]))),
        (signs.asked, lambda asked: carry_out(asked, actions)),
    )
    for sign, act in tells:
        sign.on_update(by_user(partial(_told, act), actions.fail))


def _told(act: Callable[[Any], object], event: Any) -> None:
    act(event.target.value)


def store_visit(signs: PageSigns, state: str) -> None:
    """Have the tab store a text, which it tells when its page is loaded anew. Other tabs do not see it."""
    signs.store.content = str(running("sessionStorage.setItem('trackride', this.dataset.state)", data_state=state))


def store_place(signs: PageSigns, place: str) -> None:
    """Have the tab store its place in the same way."""
    signs.store_place.content = str(
        running("sessionStorage.setItem('trackride-place', this.dataset.place)", data_place=place)
    )


def title_html(config: Config) -> str:
    """HTML that names the browser's tab after vehicle and road."""
    parts = config.road.parts if isinstance(config.road, SumRoad) else (config.road,)
    road = " + ".join(choice_words(part.type) for part in parts)
    return str(element("trackride-title", of=f"{config.name}, {road} · Trackride"))


def layout_html(layout: PageLayout) -> str:
    """HTML by which the page takes over how its panels share it (page.js, page.css)."""
    return str(
        element(
            "trackride-layout",
            for_=f"{layout.width} {layout.height}",
            scale=f"{layout.scale:g}",
            plots=layout.plots,
            columns=str(layout.columns),
            left=str(layout.left),
            height=str(layout.plots_height),
        )
    )


def add_hints(gui: viser.GuiApi) -> None:
    """Let the page show the hints of the plain buttons that there are by now: viser takes them, but shows none."""
    buttons = {
        uuid: handle.hint
        for uuid, handle in gui._gui_input_handle_from_uuid.items()
        if isinstance(handle, viser.GuiButtonHandle | viser.GuiUploadButtonHandle) and handle.hint
    }
    gui.add_html(str(element("template", id="trackride-hints", data_hints=json.dumps(buttons))))
