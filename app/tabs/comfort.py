"""How the ride feels, at the driver's seat and at the centre of mass: a run (and a baseline) -> HTML. Pure."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from app.format.differences import figure_text
from app.format.markup import page, words_html
from app.tabs.comparison import cells
from model.analysis.comfort import POWER_LIMIT, Comfort, ride_comfort
from model.analysis.ride import Row
from model.analysis.signals import CENTRE_OF_MASS, seat
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
    Figure("Up and down", "m/s²", "rms weighted by W_k of ISO 2631-1: 5 to 8 Hz count most", lambda of: of.vertical),
    Figure("Fore and aft", "m/s²", "rms weighted by W_d: 0.5 to 2 Hz count most", lambda of: of.fore_aft),
    Figure("Both", "m/s²", "root of the sum of their squares: what the words are about", lambda of: of.total),
    Figure(
        "Crest factor",
        "",
        "peak of up and down / its rms: over 9, the rms tells too little",
        lambda of: of.crest_factor,
    ),
    Figure("VDV", "m/s¹·⁷⁵", "dose of up and down: it tells jolts, and grows with time", lambda of: of.dose, True),
    Figure("MTVV", "m/s²", "rms of the worst second of up and down", lambda of: of.transient),
    Figure(
        "Absorbed power",
        "W",
        f"by a sitting person (Pradko and Lee); {POWER_LIMIT:g} W is held to be the most that crews bear for long",
        lambda of: of.absorbed_power,
    ),
)
PLACES = (("Driver's seat", seat), ("Centre of mass", lambda config: CENTRE_OF_MASS))


def comfort_headline(run: Trajectory) -> str:
    """HTML: the ride in a line."""
    if not len(run.t):
        return ""
    felt = ride_comfort(run, seat(run.config))
    sign = "bad" if felt.absorbed_power > POWER_LIMIT else ""
    return (
        f'<div class="trackride-comfort">Driver\'s seat: <b>{felt.reaction}</b>, {figure_text(felt.total)} m/s² '
        f'weighted · <span class="{sign}">{figure_text(felt.absorbed_power)} W</span> absorbed</div>'
    )


def comfort_page(run: Trajectory, baseline: Trajectory | None = None) -> str:
    """HTML: all figures at both places, now and of the baseline, and what they mean."""
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
        f"From {felt.since:.1f} s on, when the start has died away" if felt.since > run.t[0] else "Of all there is"
    )
    meanings = "".join(f"<li><b>{figure.name}</b>: {words_html(figure.meaning)}.</li>" for figure in FIGURES)
    return page(
        f"<h4>Ride comfort</h4>{''.join(tables)}<p>{stretch}; up and along the level, not the hull's floor. The words "
        f"are ISO 2631-1's; where they overlap, the harsher one.</p><ul>{meanings}</ul>"
    )


def _table(place: str, now: Comfort, baseline: Comfort | None, same_length: bool) -> str:
    compared = baseline is not None
    heads = "".join(f"<th>{text}</th>" for text in (place, "now", *(("baseline", "change") if compared else ())))
    lines = [f"<tr>{heads}</tr>"]
    for figure in FIGURES:
        row = _row(figure, now, baseline, same_length)
        label = f"{row.figure}, {row.unit}" if row.unit else row.figure
        lines.append(f"<tr><td>{label}</td>{''.join(cells(row, compared))}</tr>")
    words = [now.reaction] if baseline is None else [now.reaction, baseline.reaction, ""]
    said = "".join(f'<td class="words">{word}</td>' for word in words)
    lines.append(f"<tr><td>In words</td>{said}</tr>")
    return f'<table class="trackride-figures felt">{"".join(lines)}</table>'


def _row(figure: Figure, now: Comfort, baseline: Comfort | None, same_length: bool) -> Row:
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
