"""Where the hull is shaken: spectra of its vertical acceleration over the window of a run (signals.py)."""

from __future__ import annotations

import numpy as np

from model.analysis.signals import CENTRE_OF_MASS, Point, point_acceleration, window
from model.config.config import Config, SineRoad
from model.simulation.trajectory import Trajectory

PADDING = 16  # points of a spectrum for each one that the signal's length resolves: a peak shows its full height
SEGMENT = 5.0  # s: longer signals are cut into pieces of this length, whose power densities are averaged


def acceleration_spectrum(trajectory: Trajectory, point: Point = CENTRE_OF_MASS) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies, Hz, and amplitudes, m/s², of the vertical acceleration at a point of the hull."""
    return amplitude_spectrum(_signal(trajectory, point), trajectory.config.simulation.output_rate)


def acceleration_density(trajectory: Trajectory, point: Point = CENTRE_OF_MASS) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies, Hz, and power spectral density, m²/s³, of the vertical acceleration at a point of the hull."""
    return power_spectral_density(_signal(trajectory, point), trajectory.config.simulation.output_rate)


def amplitude_spectrum(signal: np.ndarray, rate: float) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies, Hz, and amplitudes of a signal (N,) with `rate` samples a second, its mean taken away.

    A sine of amplitude a shows a peak as high as a: Hann window, scaled by its mean, with finely spaced frequencies.
    Two peaks less than 2/T apart (T: how long the signal lasts) run into one.
    """
    count = len(signal)
    window = _hann(count)
    length = _padded(count)
    spectrum = np.abs(np.fft.rfft((signal - np.average(signal, weights=window)) * window, length))
    return np.fft.rfftfreq(length, 1 / rate), 2 * spectrum / window.sum()


def power_spectral_density(signal: np.ndarray, rate: float) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies, Hz, and one-sided power density, unit² per Hz, of a signal (N,) with `rate` samples a second.

    Welch's method: pieces of SEGMENT under a Hann window that overlap by half, each without its mean, averaged. The
    area under it is the signal's variance. Two peaks less than 2/SEGMENT apart run into one.
    """
    count = max(min(len(signal), round(SEGMENT * rate)), 1)
    window = _hann(count)
    length = _padded(count)
    pieces = np.lib.stride_tricks.sliding_window_view(signal, count)[:: max(count // 2, 1)]
    pieces = (pieces - pieces.mean(axis=1, keepdims=True)) * window
    power = (np.abs(np.fft.rfft(pieces, length)) ** 2).mean(axis=0) / (rate * (window**2).sum())
    power[1:-1] *= 2  # that of the negative frequencies; zero and half the rate have none
    return np.fft.rfftfreq(length, 1 / rate), power


def excitation(config: Config) -> float | None:
    """v/λ: waves met in a second, Hz; None where the road has no waves."""
    road = config.road
    if not isinstance(road, SineRoad) or road.amplitude == 0:
        return None
    return config.drive.speed_kmh / 3.6 / road.wavelength


def _signal(trajectory: Trajectory, point: Point) -> np.ndarray:
    return point_acceleration(trajectory, point)[window(trajectory).samples(trajectory.t), 1]


def _hann(count: int) -> np.ndarray:
    return np.hanning(count + 1)[:-1] if count > 1 else np.ones(count)


def _padded(count: int) -> int:
    return 2 ** int(np.ceil(np.log2(PADDING * max(count, 1))))
