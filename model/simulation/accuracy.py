"""How exact a run is, as its joints and its energy tell: limits, words and advice, for all places that judge a run.

Joints stay together and energy is accounted for in an exact solution. Where they are not, steps were too long.
"""

from __future__ import annotations

from model.config.config import Config, Simulation
from model.config.parameters import PARAMETER, number_text

APART_NOTED = 1e-4  # m that joints may be apart before a reader is warned
APART_ALLOWED = 1e-3  # m: a run ends where they are further apart
ENERGY_NOTED = 3e-4  # of the energy turned over that may be unaccounted for before a reader is warned
ENERGY_ALLOWED = 0.05  # more, and a run is not complete
GENTLE_RATE, FAST_RATE = 5.0, 100.0  # 1/s: Baumgarte's constants between these give the same motion
SHORTER = 0.25  # of a fixed step: the next to be tried
TIGHTER = 0.1  # of tolerances
DEFAULT = Config().simulation


def joints_apart(distance: float) -> str:
    """In words; distance: m."""
    return f"joints {1e3 * distance:.3g} mm apart"


def energy_missing(share: float) -> str:
    """In words; share: of the energy turned over, 0…"""
    return f"{100 * share:.2g} % of the energy unaccounted for"


def exacter(settings: Simulation) -> dict[str, float]:
    """Settings, by their keys, that give a more exact run than these."""
    found: dict[str, float] = {}
    if settings.integrator == "rk4":
        found["simulation.step"] = settings.step * SHORTER
    gains = settings.baumgarte_alpha, settings.baumgarte_beta
    held = all(GENTLE_RATE <= gain <= FAST_RATE for gain in gains)
    if not held:
        found["simulation.baumgarte_alpha"] = DEFAULT.baumgarte_alpha
        found["simulation.baumgarte_beta"] = DEFAULT.baumgarte_beta
    if settings.integrator != "rk4":
        # Joints that nothing holds together are enough of a reason, unless tolerances are loose too
        for name in ("rtol", "atol"):
            now, usual = getattr(settings, name), getattr(DEFAULT, name)
            key = f"simulation.{name}"
            wanted = max(float(f"{min(now * TIGHTER if held else now, usual):.3g}"), PARAMETER[key].low)
            if wanted < now:
                found[key] = wanted
    return found


def advice(settings: Simulation) -> str:
    """What to do about a run with these settings that is not exact."""
    changes = [f"{key} to {number_text(value)}" for key, value in exacter(settings).items()]
    if not changes:
        return "Lower speed, or the stiffness and damping of ground and suspension: no setting makes the steps exacter."
    *first, last = changes
    words = f"Set {', '.join(first)}{' and ' if first else ''}{last}."
    if settings.integrator == "rk4":
        return f"Shorten the step: {words.lower()} Or use {DEFAULT.integrator}, which finds its steps itself."
    return words
