"""Where the hull is shaken, and where it likes to swing: a run (and a baseline) -> spectrum and marks. Pure."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from app.markup import page
from app.plots import Curve, Plot, thin
from model.spectrum import Marks, Mode, acceleration_spectrum
from model.trajectory import Trajectory

LOWEST_END = 8.0  # Hz: the axis goes this far at least …
HARMONICS = 3.0  # … and to this many times v/λ
DECIMALS = 3
LEAST_SAMPLES = 8  # of a run that has a spectrum


class Mark(NamedTuple):
    """A frequency to know when reading a spectrum."""

    name: str
    frequency: float  # Hz
    damping_ratio: float | None  # part of the critical damping; None for what drives the vehicle
    meaning: str


def spectrum_plot(run: Trajectory, colour: str, marks: tuple[Mark, ...], baseline: Trajectory | None = None) -> Plot:
    """Amplitude spectrum of the hull's vertical acceleration in the steady part of the run, m/s²."""
    curves = [Curve("Hull", colour)]
    frequency, amplitude = _spectrum(run)
    columns = [amplitude]
    if baseline is not None and len(baseline.t) >= LEAST_SAMPLES:
        curves += [Curve("Hull", colour, "baseline")]
        columns += [np.interp(frequency, *_spectrum(baseline), right=np.nan)]
    highest = max((HARMONICS * mark.frequency for mark in marks if mark.damping_ratio is None), default=0.0)
    shown = frequency <= max(LOWEST_END, highest)
    frequency, values = thin(frequency[shown], np.column_stack(columns)[shown])
    return Plot(
        "Amplitude of the hull's vertical acceleration",
        "m/s²",
        tuple(curves),
        (0.0, 0.1),
        frequency,
        np.round(values, DECIMALS),
        axis="Frequency, Hz",
    )


def named(marks: Marks) -> tuple[Mark, ...]:
    """Excitation and natural frequencies with their names, as far as they exist; the highest first."""
    found = []
    if marks.excitation is not None:
        meaning = "waves met each second: the road shakes here, and at its multiples"
        found.append(Mark("v/λ", marks.excitation, None, meaning))
    for name, mode, meaning in (
        ("Bounce", marks.bounce, "the hull's own up and down"),
        ("Pitch", marks.pitch, "the hull's own nodding"),
    ):
        if isinstance(mode, Mode):
            found.append(Mark(name, mode.frequency, mode.damping_ratio, meaning))
    return tuple(sorted(found, key=lambda mark: -mark.frequency))


def marks_table(marks: tuple[Mark, ...]) -> str:
    """HTML: what the marks are. None of it is a user's text."""
    rows = "".join(map(_row, marks))
    head = "<tr><th></th><th>Frequency</th><th>Damping ratio</th><th></th></tr>"
    note = "The nearer v/λ and its multiples come to bounce or pitch, the harder the ride; damping flattens the peak."
    return page(f'<table class="trackride-facts trackride-modes">{head}{rows}</table><p>{note}</p>')


def _row(mark: Mark) -> str:
    damping = "" if mark.damping_ratio is None else f"{100 * mark.damping_ratio:.0f} %"
    return f"<tr><th>{mark.name}</th><td>{mark.frequency:.2f} Hz</td><td>{damping}</td><td>{mark.meaning}</td></tr>"


def _spectrum(run: Trajectory) -> tuple[np.ndarray, np.ndarray]:
    if len(run.t) < LEAST_SAMPLES:
        return np.zeros(1), np.zeros(1)
    return acceleration_spectrum(run)
