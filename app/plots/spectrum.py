"""How strongly the hull is shaken at each frequency: a run (and a baseline) -> spectrum and marks. Pure."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from app.format.units import FINER, METRIC, Units
from app.plots.curves import Curve, Plot
from app.plots.thinning import thin
from model.analysis.modes import Modes
from model.analysis.signals import CENTRE_OF_MASS, seat
from model.analysis.spectrum import acceleration_density, acceleration_spectrum
from model.simulation.trajectory import Trajectory

LOWEST_END = 8.0  # Hz: the axis goes this far at least …
LOWEST = 0.1  # Hz, on a logarithmic axis
HARMONICS = 3.0  # … and to this many times v/λ
DECIMALS = 4  # of the values that are plotted, and FINER; the page shows no more (plots.js)
LEAST_SAMPLES = 8  # of a run that has a spectrum


class Mark(NamedTuple):
    """A frequency that is marked in a spectrum."""

    name: str
    frequency: float  # Hz
    drives: bool = False  # the road drives the vehicle with it; else it is one of the vehicle's own


def spectrum_plot(
    run: Trajectory,
    colour: str,
    marks: tuple[Mark, ...],
    baseline: Trajectory | None = None,
    *,
    density: bool = False,
    at_seat: bool = False,
    logarithmic: bool = False,
    units: Units = METRIC,
) -> Plot:
    """Spectrum of the vertical acceleration over the window of the run, at the centre of mass or the driver's seat.

    Amplitude, m/s², or power density, m²/s³, or what becomes of these units. logarithmic: the axis of the frequency
    is, and so has no 0.
    """

    def spectrum(trajectory: Trajectory) -> tuple[np.ndarray, np.ndarray]:
        if len(trajectory.t) < LEAST_SAMPLES:
            return np.zeros(1), np.zeros(1)
        point = seat(trajectory.config) if at_seat else CENTRE_OF_MASS
        return (acceleration_density if density else acceleration_spectrum)(trajectory, point)

    place = "Driver's seat" if at_seat else "Centre of mass"
    curves = [Curve(place, colour)]
    frequency, height = spectrum(run)
    columns = [height]
    if baseline is not None and len(baseline.t) >= LEAST_SAMPLES:
        curves += [Curve(place, colour, "baseline")]
        columns += [np.interp(frequency, *spectrum(baseline), right=np.nan)]
    highest = max((HARMONICS * mark.frequency for mark in marks if mark.drives), default=0.0)
    shown = frequency <= max(LOWEST_END, highest)
    logarithmic &= bool((frequency >= LOWEST).any())
    if logarithmic:
        shown &= frequency >= LOWEST
    frequency, values = thin(frequency[shown], np.column_stack(columns)[shown])
    unit = units.of("m²/s³" if density else "m/s²")
    return Plot(
        f"Vertical acceleration: {'power density' if density else 'amplitude'}",
        unit.name,
        tuple(curves),
        (0.0, 0.1 * unit.factor),
        frequency,
        np.round(values * unit.factor, DECIMALS + FINER.get(unit.name, 0)),
        axis="Frequency, Hz",
        logarithmic=logarithmic,
    )


def named(excitation: float | None, modes: Modes | None) -> tuple[Mark, ...]:
    """Excitation v/λ, Hz, and the hull's natural frequencies, as far as they exist; the highest first."""
    found = [] if excitation is None else [Mark("v/λ", excitation, drives=True)]
    hull = () if modes is None else (modes.bounce, modes.pitch)
    found += [Mark(mode.name, mode.frequency) for mode in hull if mode is not None]
    return tuple(sorted(found, key=lambda mark: -mark.frequency))
