"""How the ride feels, at the driver's seat and at the centre of mass: a run (and a baseline) -> HTML. Pure."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from app.format.differences import figure_text
from app.format.markup import Content, Html, cell, element, page, table, words_html
from app.tabs.comparison import cells
from model.analysis.comfort import POWER_LIMIT, Comfort, ride_comfort
from model.analysis.ride import Row
from model.analysis.signals import CENTRE_OF_MASS, seat
from model.simulation.trajectory import Trajectory

LEAST = 1e-3  # of all figures: if the baseline's is smaller, a change in % means nothing


class ComfortFigure(NamedTuple):
    """One line of the table."""

    name: str
    unit: str
    meaning: str
    value: Callable[[Comfort], float | None]
    grows: bool = False  # with the time over which it is taken


COMFORT_FIGURES = (
    ComfortFigure(
        "Up and down", "m/s²", "rms weighted by W_k of ISO 2631-1: 5 to 8 Hz count most", lambda of: of.vertical
    ),
    ComfortFigure(
        "Fore and aft",
        "m/s²",
        "rms weighted by W_d: 0.5 to 2 Hz count most",
        lambda of: of.fore_aft,
    ),
    ComfortFigure(
        "Both",
        "m/s²",
        "root of the sum of their squares: what the words are about",
        lambda of: of.total,
    ),
    ComfortFigure(
        "Crest factor",
        "",
        "peak of up and down / its rms: above 9, the rms says too little",
        lambda of: of.crest_factor,
    ),
    ComfortFigure(
        "VDV", "m/s¹·⁷⁵", "dose of up and down: it shows jolts, and grows with time", lambda of: of.dose, True
    ),
    ComfortFigure(
        "MTVV",
        "m/s²",
        "rms of the worst second of up and down",
        lambda of: of.transient,
    ),
    ComfortFigure(
        "Absorbed power",
        "W",
        f"by a sitting person (Pradko and Lee); {POWER_LIMIT:g} W is taken as the most that crews bear for long",
        lambda of: of.absorbed_power,
    ),
)
PLACES = (("Driver's seat", seat), ("Centre of mass", lambda config: CENTRE_OF_MASS))


def comfort_headline(run: Trajectory) -> str:
    """HTML of the ride in a line."""
    if not len(run.t):
        return ""
    felt = ride_comfort(run, seat(run.config))
    power = element(
        "span",
        f"{figure_text(felt.absorbed_power)} W",
        class_="bad" if felt.absorbed_power > POWER_LIMIT else None,
    )
    seat_words = "Driver's seat: ", element("b", felt.reaction), f", {figure_text(felt.total)} m/s² weighted · "
    return str(element("div", *seat_words, power, " absorbed", class_="trackride-comfort"))


def comfort_page(run: Trajectory, baseline: Trajectory | None = None) -> str:
    """HTML of all figures at both places, now and of the baseline, and what they mean."""
    if not len(run.t):
        return ""
    other = baseline if baseline is not None and len(baseline.t) else None
    tables = []
    for place, point in PLACES:
        felt = ride_comfort(run, point(run.config))
        before = None if other is None else ride_comfort(other, point(other.config))
        same_length = before is not None and other is not None and run.t[-1] - felt.since == other.t[-1] - before.since
        tables.append(_table(place, felt, before, same_length))
    stretch = (
        f"From {felt.since:.1f} s on, when the start has died away" if felt.since > run.t[0] else "Over the whole run"
    )
    words = (
        "vertical and horizontal, not turned with the hull. The words are those of ISO 2631-1; where two apply, "
        "the harsher one."
    )
    meanings = (
        element("li", element("b", figure.name), ": ", words_html(figure.meaning), ".") for figure in COMFORT_FIGURES
    )
    return page(element("h4", "Ride comfort"), *tables, element("p", f"{stretch}; {words}"), element("ul", *meanings))


def _table(place: str, now: Comfort, baseline: Comfort | None, same_length: bool) -> Html:
    compared = baseline is not None
    lines: list[list[Content]] = []
    for figure in COMFORT_FIGURES:
        row = _row(figure, now, baseline, same_length)
        lines.append([f"{row.figure}, {row.unit}" if row.unit else row.figure, *cells(row, compared)])
    words = [now.reaction] if baseline is None else [now.reaction, baseline.reaction, ""]
    lines.append(["In words", *(cell(word, class_="words") for word in words)])
    heads = (place, "now", *(("baseline", "change") if compared else ()))
    return table(heads, lines, "trackride-figures felt", titled=False)


def _row(figure: ComfortFigure, now: Comfort, baseline: Comfort | None, same_length: bool) -> Row:
    value = figure.value(now)
    reference = None if baseline is None else figure.value(baseline)
    means = value is not None and reference is not None and reference >= LEAST and (same_length or not figure.grows)
    return Row(
        figure.name,
        "",
        figure.unit,
        value,
        reference,
        100 * (value / reference - 1) if means and value is not None and reference is not None else None,
    )
