"""Where an axis has its numbers."""

from __future__ import annotations

import numpy as np

TICKS = 5  # of an axis, at least; twice as many at most


def ticks(low: float, high: float, least: float = TICKS) -> list[float]:
    """Round numbers from low to high, `least` of them or a few more, in steps of 1, 2 or 5 times a power of ten."""
    rough = (high - low) / least
    power = 10.0 ** np.floor(np.log10(rough))
    step = max(factor * power for factor in (1.0, 2.0, 5.0) if factor * power <= rough * (1 + 1e-9))
    first, last = np.ceil(low / step - 1e-9), np.floor(high / step + 1e-9)
    return [float(round(k * step, 9)) + 0.0 for k in np.arange(first, last + 1)]
