"""What the page itself does about the plots: the time cursor through all of them, values at it, and the shared zoom.

Charts draw their data only; moving the cursor costs a line of HTML, and no chart is drawn anew.
"""

from __future__ import annotations

import html
import json
from pathlib import Path

from app.panels.charts import OTHER_KEY, TIME_KEY
from app.plots.spectrum import Mark

_ASSETS = Path(__file__).parents[2] / "assets"


def plot_page() -> str:
    """HTML that goes into the page once: script and style. The picture that cannot be loaded runs the script."""
    script, style = (_ASSETS / "plots.js").read_text(), (_ASSETS / "plots.css").read_text()
    return f'<img hidden src="data:," onerror="{html.escape(script)}"><style>{style}</style>'


def tab_html(name: str) -> str:
    """HTML of something invisible in a tab, by which the page knows whether that tab is in front."""
    return f'<trackride-tab name="{name}"></trackride-tab>'


def now_html(time: float) -> str:
    """HTML that moves the time cursor in all plots."""
    return _marks_html(TIME_KEY, [(round(time, 4), "")])


def marks_html(marks: tuple[Mark, ...]) -> str:
    """HTML that marks frequencies by named lines."""
    return _marks_html(OTHER_KEY, [(mark.frequency, f"{mark.name} {mark.frequency:.2f} Hz") for mark in marks])


def _marks_html(key: str, marks: list[tuple[float, str]]) -> str:
    return f"<trackride-marks for='{key}' at='{html.escape(json.dumps(marks, ensure_ascii=False))}'></trackride-marks>"
