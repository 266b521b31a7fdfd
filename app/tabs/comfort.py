"""How the ride feels, at the driver's seat and at the centre of mass: a run (and a baseline) -> HTML. Pure."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from app.format.differences import NONE, figure_text
from app.format.load_unit import KILONEWTON, told_row
from app.format.markup import Content, Html, cell, element, page, table, words_html
from app.format.units import METRIC, Units
from app.tabs.comparison import cells
from model.analysis.comfort import MOST_CREST, POWER_LIMIT, Comfort, ride_comfort
from model.analysis.figures import DOSE, POWER, SHOCK, TRANSIENT, WEIGHTED, Row, percent
from model.analysis.ride_warnings import figure_warnings
from model.analysis.signals import CENTRE_OF_MASS, same_window, seat, window
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
        "Up and down", WEIGHTED.unit, "rms weighted by W_k of ISO 2631-1: 5 to 8 Hz count most", lambda of: of.vertical
    ),
    ComfortFigure(
        "Fore and aft",
        WEIGHTED.unit,
        "rms weighted by W_d: 0.5 to 2 Hz count most",
        lambda of: of.fore_aft,
    ),
    ComfortFigure(
        "Both",
        WEIGHTED.unit,
        "root of the sum of their squares: what the words are about",
        lambda of: of.total,
    ),
    ComfortFigure(
        "Crest factor",
        "",
        f"peak of up and down / its rms: above {MOST_CREST:g}, the rms says too little; use MTVV or VDV",
        lambda of: of.crest_factor,
    ),
    ComfortFigure(
        "VDV", DOSE.unit, "dose of up and down: it shows jolts, and grows with time", lambda of: of.dose, True
    ),
    ComfortFigure(
        "MTVV",
        TRANSIENT.unit,
        "rms of the worst second of up and down",
        lambda of: of.transient,
    ),
    ComfortFigure(
        "Shock",
        SHOCK.unit,
        "largest of up and down, not weighted, behind a low-pass of 30 Hz; 2.5 g is taken as the limit",
        lambda of: of.shock,
    ),
    ComfortFigure(
        "Absorbed power",
        POWER.unit,
        f"by a sitting person (Pradko and Lee); {POWER_LIMIT:g} W is taken as the most that crews bear for long",
        lambda of: of.absorbed_power,
    ),
)
SEAT = "Driver's seat"
PLACES = ((SEAT, seat), ("Centre of mass", lambda config: CENTRE_OF_MASS))


def comfort_headline(run: Trajectory, driving: bool = False, units: Units = METRIC) -> str:
    """HTML of the ride in a line. driving: the run is a stretch of an endless drive."""
    if not len(run.t):
        return ""
    felt = ride_comfort(run, seat(run.config))
    if felt is None:
        words = f"Driver's seat: {NONE} (too few samples: {run.config.simulation.output_rate:g} a second)"
        return str(element("div", words, class_="trackride-comfort"))
    power = element(
        "span",
        f"{figure_text(felt.absorbed_power)} W",
        class_="bad" if felt.absorbed_power > POWER_LIMIT else None,
    )
    unit = units.of(WEIGHTED.unit)
    weighted = f"{figure_text(felt.total * unit.factor)}{unit.after} weighted"
    seat_words = "Driver's seat: ", element("b", felt.reaction), f", {weighted} · "
    alarms = []
    if felt.window.shortfall:
        alarms.append("still settling" if driving else "run too short")
    if felt.crest_factor is not None and felt.crest_factor > MOST_CREST:
        alarms.append(f"crest factor {figure_text(felt.crest_factor)}")
    said = (part for alarm in alarms for part in (" · ", element("span", alarm, class_="bad")))
    return str(element("div", *seat_words, power, " absorbed", *said, class_="trackride-comfort"))


def comfort_page(
    run: Trajectory, baseline: Trajectory | None = None, driving: bool = False, units: Units = METRIC
) -> str:
    """HTML of all figures at both places, now and of the baseline, what they are taken from and what they mean.

    driving: the run is a stretch of an endless drive.
    """
    if not len(run.t):
        return ""
    other = baseline if baseline is not None and len(baseline.t) else None
    taken = window(run)
    tables, felt_by_driver = [], None
    for place, point in PLACES:
        felt = ride_comfort(run, point(run.config), taken)
        if place == SEAT:
            felt_by_driver = felt
        if felt is not None:
            before = None if other is None else ride_comfort(other, point(other.config))
            tables.append(_table(place, felt, before, units))
    found = figure_warnings(run.config, taken, felt_by_driver, driving)
    cautions = (element("p", units.reword(str(each)), class_="bad") for each in found)
    words = (
        f"Taken {taken.why}; vertical and horizontal, not turned with the hull. The words are those of ISO 2631-1; "
        "where two apply, the harsher one."
    )
    meanings = (
        element("li", element("b", figure.name), ": ", words_html(figure.meaning), ".") for figure in COMFORT_FIGURES
    )
    return page(element("h4", "Ride comfort"), *cautions, *tables, element("p", words), element("ul", *meanings))


def _table(place: str, now: Comfort, baseline: Comfort | None, units: Units) -> Html:
    compared = baseline is not None
    lines: list[list[Content]] = []
    for figure in COMFORT_FIGURES:
        row = told_row(_row(figure, now, baseline), KILONEWTON, units)
        lines.append([f"{row.figure}, {row.unit}" if row.unit else row.figure, *cells(row, compared)])
    words = [now.reaction] if baseline is None else [now.reaction, baseline.reaction, ""]
    lines.append(["In words", *(cell(word, class_="words") for word in words)])
    heads = (place, "now", *(("baseline", "change") if compared else ()))
    return table(heads, lines, "trackride-figures felt", titled=False)


def _row(figure: ComfortFigure, now: Comfort, baseline: Comfort | None) -> Row:
    value, reference, change = figure.value(now), None, None
    if baseline is not None:
        reference = figure.value(baseline)
        if not figure.grows or same_window(now.window, baseline.window):
            change = percent(value, reference, LEAST)
    return Row(figure.name, "", figure.unit, value, reference, change)
