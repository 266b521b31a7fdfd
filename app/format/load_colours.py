"""Loads as colours: a perceptually uniform ramp, from little to much."""

from __future__ import annotations

import numpy as np

from app.format.colours import rgb

# Viridis (Smith and van der Walt, CC0) at nine even steps: perceptually uniform, and readable by colour-blind eyes.
RAMP = ("#440154", "#472d7b", "#3b528b", "#2c728e", "#21918c", "#28ae80", "#5ec962", "#addc30", "#fde725")

_ENDS = np.array([rgb(css) for css in RAMP], dtype=float)


def load_colours(shares: np.ndarray) -> np.ndarray:
    """(..., 4) RGBA of shares 0…1 (...)."""
    at = np.clip(shares, 0.0, 1.0) * (len(RAMP) - 1)
    k = np.minimum(at.astype(int), len(RAMP) - 2)
    part = (at - k)[..., None]
    mixed = (1 - part) * _ENDS[k] + part * _ENDS[k + 1]
    return np.concatenate([mixed, np.full((*shares.shape, 1), 255.0)], axis=-1).round().astype(np.uint8)
