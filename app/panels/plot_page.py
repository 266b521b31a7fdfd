"""What the page itself does about the plots: the time cursor through all of them, values at it, and the shared zoom.

Charts draw their data only; moving the cursor costs a line of HTML, and no chart is drawn anew.
"""

from __future__ import annotations

import json

from app.format.assets import asset
from app.format.markup import element, joined, running, style
from app.format.units import FINER
from app.plots.curves import Plot
from app.plots.spectrum import Mark
from model.analysis.signals import window
from model.simulation.trajectory import Trajectory

SHAPES = {  # of the curves in a plot: as the page knows it, as shown, what it means
    "auto": ("Auto", "Curves, and strips where they crowd, as on rough ground"),
    "curves": ("Curves", "All curves in one plot"),
    "strips": ("Strips", "One strip for each wheel, all with the same scale"),
    "band": ("Band", "From the least to the largest of all wheels, and their mean"),
}
TIME_KEY, OTHER_KEY = "trackride-time", "trackride-frequency"  # charts with the same key share cursor and zoom


def plot_page() -> str:
    """HTML that goes into the page once: script and rules."""
    return str(joined((running(asset("plots.js"), data_finer=json.dumps(FINER)), style(asset("plots.css")))))


def tab_html(name: str) -> str:
    """HTML of something invisible in a tab, by which the page knows whether that tab is in front."""
    return str(element("trackride-tab", name=name))


def tools_html(*, shapes: bool) -> str:
    """HTML of the tools above the plots of a tab; shapes: it has plots of several wheels."""
    large = element("button", "Large ⤢", type="button", data_act="large", title="Over the view, side by side (L)")
    if not shapes:
        return str(element("trackride-tools", large))
    buttons = (
        element("button", name, type="button", data_shape=key, title=hint) for key, (name, hint) in SHAPES.items()
    )
    choice = element("span", *buttons, role="group", aria_label="How curves are drawn")
    names = element("button", "Names", type="button", data_act="names", title="Each wheel's name at its curve's end")
    return str(element("trackride-tools", choice, names, large))


def now_html(time: float) -> str:
    """HTML that moves the time cursor in all plots."""
    return _marks_html(TIME_KEY, [(round(time, 4), "")])


def window_html(run: Trajectory) -> str:
    """HTML that marks in all plots over time which stretch of a run its figures are taken from; nothing for all."""
    if not len(run.t):
        return ""
    taken = window(run)
    whole = (taken.start, taken.end) == (run.t[0], run.t[-1])
    span = None if whole else (round(taken.start, 4), round(taken.end, 4))
    return str(element("trackride-span", at=json.dumps(span)))


def peaks_html(plots: tuple[Plot, ...]) -> str:
    """HTML that marks the peaks of curves: [name, time, value] of each, by the unit of its plot."""
    peaks: dict[str, list[tuple[str, float, float]]] = {plot.unit: [] for plot in plots}
    for plot in plots:
        peaks[plot.unit] += [(plot.curves[peak.curve].label, peak.time, peak.value) for peak in plot.peaks]
    return str(element("trackride-peaks", at=json.dumps(peaks, ensure_ascii=False)))


def marks_html(marks: tuple[Mark, ...]) -> str:
    """HTML that marks frequencies by named lines."""
    return _marks_html(OTHER_KEY, [(mark.frequency, f"{mark.name} {mark.frequency:.2f} Hz") for mark in marks])


def _marks_html(key: str, marks: list[tuple[float, str]]) -> str:
    return str(element("trackride-marks", for_=key, at=json.dumps(marks, ensure_ascii=False)))
