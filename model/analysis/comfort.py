"""How a ride feels: ISO 2631-1's weighted acceleration and doses, and the power that a sitting person absorbs.

Accelerations are those along the world's axes at a point of the hull. The filters run over the whole run, which begins
at rest; the figures are taken from its window (signals.py).
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property, lru_cache, partial

import numpy as np
from scipy.fft import irfft, rfft

from model.analysis.signals import CENTRE_OF_MASS, Point, Window, point_acceleration, window
from model.simulation.trajectory import Motion

LEAST_RATE = 200.0  # samples a second below which there are no figures: the weighting reaches up to 100 Hz
DECAY = 10.0  # s in which all filters have forgotten: the slowest, of 0.4 Hz, to 2e-8
RUNNING = 1.0  # s of the running rms whose largest value is the MTVV
FOOT = 0.3048  # m
G = 9.80665  # m/s²
SHOCK_LIMIT = 30.0  # Hz, of the low-pass behind which shocks are told
FINER = 4  # times as many values as samples, among which the largest shock is sought
MOST_CREST = 9.0  # crest factor above which the weighted rms tells too little, by ISO 2631-1, 6.2.1
POWER_LIMIT = 6.0  # W that people put up with for long: the limit of the NATO reference mobility model

# ISO 2631-1, annex C.2.3: reactions to weighted accelerations, from how much on, m/s². There the ranges overlap; here
# the harsher word counts.
REACTIONS = (
    (2.0, "extremely uncomfortable"),
    (1.25, "very uncomfortable"),
    (0.8, "uncomfortable"),
    (0.5, "fairly uncomfortable"),
    (0.315, "a little uncomfortable"),
    (0.0, "not uncomfortable"),
)

Filter = Callable[[np.ndarray], np.ndarray]  # s = iω (K,), 1/s -> gain (K,), complex


class Comfort:
    """Figures of the ride at one point of the hull, each computed when it is first asked for."""

    def __init__(self, motion: Motion, point: Point, taken: Window) -> None:
        """Of a run of at least one sample; taken: its window."""
        self.window = taken  # from which they are taken
        self._rate = motion.config.simulation.output_rate
        self._all = len(motion.t)
        self._samples = taken.samples(motion.t)
        acceleration = point_acceleration(motion, point).T
        self._length, (self._along, self._up) = _spectrum(acceleration, self._rate)

    def _through(self, spectrum: np.ndarray, gain: Filter) -> np.ndarray:
        """The samples in the window of what a filter makes of a signal with this spectrum."""
        gained = spectrum * _gain(self._length, self._rate, gain)
        return irfft(gained, self._length, overwrite_x=True)[: self._all][self._samples]

    @cached_property
    def _felt(self) -> np.ndarray:
        """m/s², vertical, weighted by W_k."""
        return self._through(self._up, W_K)

    @cached_property
    def _energy(self) -> np.ndarray:
        return self._felt**2

    @cached_property
    def vertical(self) -> float:
        """m/s², rms weighted by W_k."""
        return float(np.sqrt(np.mean(self._energy)))

    @cached_property
    def fore_aft(self) -> float:
        """m/s², rms weighted by W_d."""
        return float(np.sqrt(np.mean(self._through(self._along, W_D) ** 2)))

    @property
    def crest_factor(self) -> float | None:
        """Of the vertical one, peak / rms; None where nothing moves."""
        return float(np.abs(self._felt).max()) / self.vertical if self.vertical > 0 else None

    @property
    def dose(self) -> float:
        """VDV, m/s^1.75: (∫ a_w⁴ dt)^¼ of the vertical one; it grows with time."""
        return float((np.sum(self._energy**2) / self._rate) ** 0.25)

    @property
    def transient(self) -> float:
        """MTVV, m/s²: largest running rms over a second of the vertical one."""
        return float(running_rms(self._felt, self._rate).max())

    @cached_property
    def shock(self) -> float:
        """g: largest vertical acceleration in either direction, behind a low-pass of 30 Hz."""
        gained = self._up * _gain(self._length, self._rate, low_pass)
        finer = irfft(gained, FINER * self._length, overwrite_x=True)[: FINER * self._all] * FINER
        return float(np.abs(finer[FINER * self._samples.start : FINER * self._samples.stop]).max()) / G

    @cached_property
    def absorbed_power(self) -> float:
        """W, mean, of the vertical acceleration."""
        return float(np.mean(self._through(self._up, absorption) ** 2)) / FOOT**2

    @property
    def total(self) -> float:
        """m/s²: both directions together, ISO 2631-1's vibration total value in the plane of the model."""
        return float(np.hypot(self.vertical, self.fore_aft))

    @property
    def reaction(self) -> str:
        """ISO 2631-1's word for the total; none for a run that does not come to what is uneven."""
        return reaction(self.total) if self.window.reached else "not reached"


def reaction(acceleration: float) -> str:
    """ISO 2631-1's word for a weighted acceleration, m/s²."""
    return next(word for least, word in REACTIONS if acceleration >= least)


def ride_comfort(motion: Motion, point: Point = CENTRE_OF_MASS, taken: Window | None = None) -> Comfort | None:
    """The figures of a run of at least one sample, at a point of the hull; None where it has too few samples a second.

    taken: the run's window, where it is at hand.
    """
    if motion.config.simulation.output_rate < LEAST_RATE:
        return None
    return Comfort(motion, point, window(motion) if taken is None else taken)


def filtered(signal: np.ndarray, rate: float, gain: Filter) -> np.ndarray:
    """(N,) a signal (N,) with `rate` samples a second, zero before and after, through an analogue filter.

    The filter's own gain is applied to the signal's spectrum: exact up to half the rate, where a recursive filter of
    sampled values would bend.
    """
    length, spectrum = _spectrum(signal, rate)
    return irfft(spectrum * _gain(length, rate, gain), length)[: len(signal)]


def _spectrum(signals: np.ndarray, rate: float) -> tuple[int, np.ndarray]:
    """Of signals (..., N) with zeros behind them in which filters forget them: their new length, and the spectra."""
    length = 2 ** int(np.ceil(np.log2(signals.shape[-1] + DECAY * rate)))
    return length, rfft(signals, length)


@lru_cache(maxsize=8)
def _gain(length: int, rate: float, gain: Filter) -> np.ndarray:
    """(K,) what a filter does to each frequency of such a spectrum: runs of about the same length share it."""
    return gain(2j * np.pi * np.fft.rfftfreq(length, 1 / rate))


def running_rms(signal: np.ndarray, rate: float) -> np.ndarray:
    """(N,) rms over the second up to each sample of a signal (N,), zero before its start."""
    width = max(round(RUNNING * rate), 1)
    energy = np.concatenate([np.zeros(width), np.cumsum(signal**2)])
    return np.sqrt(np.maximum(energy[width:] - energy[: len(signal)], 0.0) / width)


def weighting(s: np.ndarray, transition: float, step: bool) -> np.ndarray:
    """ISO 2631-1, annex A: band limits 0.4 and 100 Hz, transition from acceleration to velocity, Hz, upward step."""
    low, high, turn = (2 * np.pi * f for f in (0.4, 100.0, transition))
    gain = s**2 / _quadratic(s, low, np.sqrt(0.5)) * high**2 / _quadratic(s, high, np.sqrt(0.5))
    gain *= (1 + s / turn) * turn**2 / _quadratic(s, turn, 0.63)
    if step:
        gain *= _quadratic(s, 2 * np.pi * 2.37, 0.91) / _quadratic(s, 2 * np.pi * 3.35, 0.91)
    return gain


W_K: Filter = partial(weighting, transition=12.5, step=True)  # vertical, for comfort and health of a sitting person
W_D: Filter = partial(weighting, transition=2.0, step=False)  # along


def absorption(s: np.ndarray) -> np.ndarray:
    """Pradko & Lee: from vertical acceleration, ft/s², to a value whose mean square is the power absorbed, W."""
    return 14.5 * s * (s + 44) / ((s + 63) * (s**2 + 24 * s + 750))


def low_pass(s: np.ndarray) -> np.ndarray:
    """Butterworth's of order 2, up to SHOCK_LIMIT."""
    omega = 2 * np.pi * SHOCK_LIMIT
    return omega**2 / _quadratic(s, omega, np.sqrt(0.5))


def _quadratic(s: np.ndarray, omega: float, q: float) -> np.ndarray:
    return s**2 + s * omega / q + omega**2
