"""The results of `trackride fit`."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from rich.table import Table

from app.format.markup import element
from app.reports.drawings import WIDTH, Drawing, Look, panels, plain_axes
from app.reports.html_page import wide_table
from app.reports.studies.common import csv_bytes, key_label, legend, result_files, terminal_table
from model.config.config import Config
from model.config.config_files import dump_config
from model.config.parameters import number_text
from model.study.design import Range
from model.study.fit import Estimate, Fit

HEADS = ("Value", "Fitted", "From (95 %)", "To (95 %)", "Note")
POOR = 0.5  # of the record's energy: a run that explains less is not the record's, or the model is not right
SHARE = 4  # spectra are means over stretches of a fourth of the record
CAPTION = (
    "Vertical acceleration: measured, fitted, and of the vehicle as it was, in time and as spectra. Intervals "
    "follow from the slopes at the best values and from what is left; they hold if the model is right but for noise."
)


def files(found: Fit, base: Config, over: Sequence[Range], record: str) -> dict[str, bytes]:
    """By name: page, figure, tables, and the fitted configuration."""
    ranges = [[key_label(of.key), of.key, f"{number_text(of.low)} to {number_text(of.high)}"] for of in over]
    body = [
        element("p", told(found)),
        *(element("p", doubt) for doubt in doubts(found, over)),
        element("h2", "Values"),
        wide_table(HEADS, _rows(found, over)),
        element("h2", "Ranges"),
        wide_table(("Key", "Name", "Range"), ranges),
    ]
    curves = [found.t, found.measured, found.fitted]
    tables = {
        "table.csv": csv_bytes(
            ("name", "value", "low", "high"), [(name, of.value, of.low, of.high) for name, of in _estimates(found)]
        ),
        "curves.csv": csv_bytes(
            ("t [s]", "measured [m/s^2]", "fitted [m/s^2]"), [[float(v) for v in row] for row in np.array(curves).T]
        ),
        "fitted.yaml": dump_config(base.replace(found.changes)).encode(),
    }
    subtitle = f"{base.name} on the record {record}: {found.runs} runs"
    return result_files("Fitted to a record", subtitle, drawing(found), CAPTION, body, [base], tables)


def table(found: Fit, over: Sequence[Range]) -> Table:
    """For the terminal."""
    return terminal_table(HEADS, _rows(found, over))


def told(found: Fit) -> str:
    """How near the fitted run comes to the record."""
    measured = float(np.std(found.measured))
    before = "" if found.rms_before is None else f", {found.rms_before:.3g} m/s² as it was"
    filtered = "" if found.low_pass is None else f" Compared up to {found.low_pass:g} Hz."
    return (
        f"{found.rms:.3g} m/s² are left (rms) of {measured:.3g} m/s²{before}; {len(found.t)} samples, worth "
        f"{found.samples:.0f} independent ones.{filtered}"
    )


def doubts(found: Fit, over: Sequence[Range]) -> list[str]:
    """Sentences that say why the values may not be trusted."""
    sentences = []
    if found.explained < POOR:
        sentences.append(
            f"The fitted run explains {100 * max(found.explained, 0):.0f} % of the record's energy: see that road, "
            "speed and place of the sensor are those of the record; intervals hold only for a model that is right."
        )
    for of, note in zip(over, _notes(found, over), strict=True):
        if note:
            sentences.append(f"{of.key}: {note}.")
    return sentences


def _notes(found: Fit, over: Sequence[Range]) -> list[str]:
    """What is doubtful about the value of each key, empty where nothing is."""
    notes = []
    for of, estimate, at_end in zip(over, found.estimates, found.at_end, strict=True):
        if at_end:
            notes.append("lies at an end of its range: widen it, or do not trust its interval")
        elif estimate.high - estimate.low > of.high - of.low:
            notes.append("cannot be told from this record: its interval is wider than its range")
        elif estimate.low < of.low or estimate.high > of.high:
            notes.append("its interval reaches beyond its range")
        else:
            notes.append("")
    return notes


def _begins(found: Fit) -> str:
    """What the lag means."""
    lag = found.lag.value
    return f"the run begins {lag:.3g} s into the record" if lag > 0 else f"the record begins {-lag:.3g} s into the run"


def _estimates(found: Fit) -> list[tuple[str, Estimate]]:
    return [
        *zip(found.keys, found.estimates, strict=True),
        ("lag of the record, s", found.lag),
        ("offset of the sensor, m/s²", found.offset),
    ]


def _rows(found: Fit, over: Sequence[Range]) -> list[list[str]]:
    notes = [*_notes(found, over), _begins(found), ""]
    return [
        [name, f"{of.value:.4g}", f"{of.low:.4g}", f"{of.high:.4g}", note]
        for (name, of), note in zip(_estimates(found), notes, strict=True)
    ]


def drawing(found: Fit) -> Drawing:
    """Over each other in time and as spectra."""

    def draw(figure: Figure, look: Look) -> None:
        above, below = panels(figure, 2, 1)
        curves = [("measured", found.measured, look.grey, 1.6), ("fitted", found.fitted, look.accents[0], 1.1)]
        if found.before is not None:
            curves.insert(1, ("as it was", found.before, look.accents[1], 0.7))
        plain_axes(above, look, "Vertical acceleration, m/s²", "Time, s")
        plain_axes(below, look, "Its spectrum, m/s² rms in each band", "Frequency, Hz")
        for name, values, colour, width in curves:
            above.plot(found.t, values, color=colour, lw=width, label=name)
            below.plot(*_spectrum(found.t, values), color=colour, lw=width)
        above.set_xlim(found.t[0], found.t[-1])
        below.set_xlim(0, min(30.0, below.get_xlim()[1]))
        below.set_ylim(0)
        legend(above, look, ncols=3, loc="lower right", bbox_to_anchor=(1.0, 1.0))

    return Drawing("Measured and fitted vertical acceleration", WIDTH, 5.2, draw)


def _spectrum(t: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies, Hz, and amplitudes."""
    from scipy.signal import welch

    rate = (len(t) - 1) / (t[-1] - t[0])
    frequency, power = welch(values, rate, nperseg=max(len(t) // SHARE, 16), scaling="spectrum")
    return frequency, np.sqrt(power)
