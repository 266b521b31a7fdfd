"""What the page itself does about the plots: the time cursor through all of them, values at it, and the shared zoom.

Charts draw their data only; moving the cursor costs a line of HTML, and no chart is drawn anew.
"""

from __future__ import annotations

import json

from app.format.assets import asset
from app.format.markup import element, joined, running, style
from app.panels.plot_charts import OTHER_KEY, TIME_KEY
from app.plots.spectrum import Mark


def plot_page() -> str:
    """HTML that goes into the page once: script and rules."""
    return str(joined((running(asset("plots.js")), style(asset("plots.css")))))


def tab_html(name: str) -> str:
    """HTML of something invisible in a tab, by which the page knows whether that tab is in front."""
    return str(element("trackride-tab", name=name))


def now_html(time: float) -> str:
    """HTML that moves the time cursor in all plots."""
    return _marks_html(TIME_KEY, [(round(time, 4), "")])


def marks_html(marks: tuple[Mark, ...]) -> str:
    """HTML that marks frequencies by named lines."""
    return _marks_html(OTHER_KEY, [(mark.frequency, f"{mark.name} {mark.frequency:.2f} Hz") for mark in marks])


def _marks_html(key: str, marks: list[tuple[float, str]]) -> str:
    return str(element("trackride-marks", for_=key, at=json.dumps(marks, ensure_ascii=False)))
