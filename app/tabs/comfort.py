"""How the ride feels, at the driver's seat and at the centre of mass: a run (and a baseline) -> HTML. Pure."""

from __future__ import annotations

import html
from collections.abc import Callable
from typing import NamedTuple

from app.format.differences import NONE, figure_text
from app.format.markup import page, words_html
from app.tabs.comparison import cells
from model.analysis.comfort import MOST_CREST, POWER_LIMIT, Comfort, ride_comfort
from model.analysis.figures import DOSE, POWER, SHOCK, TRANSIENT, WEIGHTED, Row, percent
from model.analysis.ride import figure_warnings
from model.analysis.signals import CENTRE_OF_MASS, same_window, seat, window
from model.simulation.trajectory import Trajectory

LEAST = 1e-3  # of all figures: a smaller one of the baseline is as good as nothing


class Figure(NamedTuple):
    """One line of the table."""

    name: str
    unit: str
    meaning: str
    value: Callable[[Comfort], float | None]
    grows: bool = False  # with the time over which it is taken


FIGURES = (
    Figure(
        "Up and down", WEIGHTED.unit, "rms weighted by W_k of ISO 2631-1: 5 to 8 Hz count most", lambda of: of.vertical
    ),
    Figure("Fore and aft", WEIGHTED.unit, "rms weighted by W_d: 0.5 to 2 Hz count most", lambda of: of.fore_aft),
    Figure("Both", WEIGHTED.unit, "root of the sum of their squares: what the words are about", lambda of: of.total),
    Figure(
        "Crest factor",
        "",
        f"peak of up and down / its rms: over {MOST_CREST:g}, the rms tells too little; use MTVV or VDV",
        lambda of: of.crest_factor,
    ),
    Figure("VDV", DOSE.unit, "dose of up and down: it tells jolts, and grows with time", lambda of: of.dose, True),
    Figure("MTVV", TRANSIENT.unit, "rms of the worst second of up and down", lambda of: of.transient),
    Figure(
        "Shock",
        SHOCK.unit,
        "largest of up and down, not weighted, behind a low-pass of 30 Hz; 2.5 g is held to be the limit",
        lambda of: of.shock,
    ),
    Figure(
        "Absorbed power",
        POWER.unit,
        f"by a sitting person (Pradko and Lee); {POWER_LIMIT:g} W is held to be the most that crews bear for long",
        lambda of: of.absorbed_power,
    ),
)
SEAT = "Driver's seat"
PLACES = ((SEAT, seat), ("Centre of mass", lambda config: CENTRE_OF_MASS))


def comfort_headline(run: Trajectory) -> str:
    """HTML: the ride in a line."""
    if not len(run.t):
        return ""
    felt = ride_comfort(run, seat(run.config))
    if felt is None:
        rate = f"{run.config.simulation.output_rate:g}"
        return f'<div class="trackride-comfort">Driver\'s seat: {NONE} (too few samples: {rate} a second)</div>'
    sign = "bad" if felt.absorbed_power > POWER_LIMIT else ""
    alarms = ["run too short"] if felt.window.shortfall else []
    if felt.crest_factor is not None and felt.crest_factor > MOST_CREST:
        alarms.append(f"crest factor {figure_text(felt.crest_factor)}")
    said = "".join(f' · <span class="bad">{alarm}</span>' for alarm in alarms)
    return (
        f'<div class="trackride-comfort">Driver\'s seat: <b>{felt.reaction}</b>, {figure_text(felt.total)} m/s² '
        f'weighted · <span class="{sign}">{figure_text(felt.absorbed_power)} W</span> absorbed{said}</div>'
    )


def comfort_page(run: Trajectory, baseline: Trajectory | None = None) -> str:
    """HTML: all figures at both places, now and of the baseline, what they are taken from and what they mean."""
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
            tables.append(_table(place, felt, None if other is None else ride_comfort(other, point(other.config))))
    cautions = "".join(
        f'<p class="bad">{html.escape(str(warning))}</p>'
        for warning in figure_warnings(run.config, taken, felt_by_driver)
    )
    meanings = "".join(f"<li><b>{figure.name}</b>: {words_html(figure.meaning)}.</li>" for figure in FIGURES)
    return page(
        f"<h4>Ride comfort</h4>{cautions}{''.join(tables)}<p>Taken {taken.why}; up and along the level, not the hull's "
        f"floor. The words are ISO 2631-1's; where they overlap, the harsher one.</p><ul>{meanings}</ul>"
    )


def _table(place: str, now: Comfort, baseline: Comfort | None) -> str:
    compared = baseline is not None
    heads = "".join(f"<th>{text}</th>" for text in (place, "now", *(("baseline", "change") if compared else ())))
    lines = [f"<tr>{heads}</tr>"]
    for figure in FIGURES:
        row = _row(figure, now, baseline)
        label = f"{row.figure}, {row.unit}" if row.unit else row.figure
        lines.append(f"<tr><td>{label}</td>{''.join(cells(row, compared))}</tr>")
    words = [now.reaction] if baseline is None else [now.reaction, baseline.reaction, ""]
    said = "".join(f'<td class="words">{word}</td>' for word in words)
    lines.append(f"<tr><td>In words</td>{said}</tr>")
    return f'<table class="trackride-figures felt">{"".join(lines)}</table>'


def _row(figure: Figure, now: Comfort, baseline: Comfort | None) -> Row:
    value, reference, change = figure.value(now), None, None
    if baseline is not None:
        reference = figure.value(baseline)
        if not figure.grows or same_window(now.window, baseline.window):
            change = percent(value, reference, LEAST)
    return Row(figure.name, "", figure.unit, value, reference, change)
