"""The vehicle's natural modes, as HTML and as choices. Pure."""

from __future__ import annotations

from collections.abc import Iterable

from app.format.markup import Html, element, page, table
from model.analysis.modes import BOUNCE, PITCH, SURGE, Creep, Mode, Modes

WORTH_TELLING = 0.1  # of a mode's kinetic energy
WORDS = {BOUNCE: "hull up and down", PITCH: "hull nodding", SURGE: "hull fore and aft"}
NOTE = (
    "Small motions about the vehicle at rest. Frequency: undamped. Damping: share of the damping with which it "
    "would no longer swing. "
    "The nearer v/λ and its multiples come to bounce or pitch, the harder the ride; damping lowers the peak."
)
EXCITED, STILL = 1.3, 0.7  # times the road's own motion, from which on a mode is excited, and under which it is not
BY_THE_WAVES = (
    "By the road: how many times as far as the waves a mass on one spring and damper of this kind would move."
)
BY_ALL = "This road has no waves of one length: it shakes at all frequencies, and excites all modes."
BY_NOTHING = "A flat road excites no mode."


def mode_titles(modes: Modes | None) -> tuple[str, ...]:
    """One for each mode that swings, no two alike: "1 Pitch, 1.04 Hz"."""
    swinging = () if modes is None else modes.swinging
    return tuple(f"{k} {mode.name}, {mode.frequency:.3g} Hz" for k, mode in enumerate(swinging, 1))


def modes_page(excitation: float | None, modes: Modes | None, *, flat: bool = False) -> str:
    """HTML of what drives the vehicle, v/λ in Hz, all its modes, and which of them the road excites."""
    rows = []
    if excitation is not None:
        meaning = "waves met each second: the road shakes the vehicle at this frequency and its multiples"
        rows.append(["v/λ", f"{excitation:.2f} Hz", "", "", meaning])
    for number, mode in enumerate(() if modes is None else modes.swinging, 1):
        damping = f"{100 * mode.damping_ratio:.0f} %"
        by_road = "" if excitation is None else excited(mode, excitation)
        rows.append([f"{number} {mode.name}", f"{mode.frequency:.2f} Hz", damping, by_road, moving(mode)])
    heads = ("", "Frequency", "Damping", "By the road", "What moves, by its part in the energy")
    facts = table(heads, rows, "trackride-facts trackride-modes")
    if modes is None:
        return page(facts, element("p", "The vehicle has no rest pose to swing about."))
    which = BY_THE_WAVES if excitation is not None else BY_NOTHING if flat else BY_ALL
    return page(facts, element("p", which), element("p", NOTE), _creeping(modes.creeping))


def excited(mode: Mode, excitation: float) -> str:
    """Whether waves met so many times a second, Hz, excite a mode, and how strongly: "excited, ×1.9"."""
    factor = response(excitation / mode.frequency, mode.damping_ratio)
    word = "excited" if factor >= EXCITED else "hardly" if factor < STILL else "follows"
    return f"{word}, ×{factor:.1f}"


def response(ratio: float, damping: float) -> float:
    """How many times as far as its moved base a mass on a spring and a damper moves, once it swings evenly.

    ratio: of the base's frequency to the mass's own; damping: as a part of the critical.
    """
    viscous = (2 * damping * ratio) ** 2
    return float(((1 + viscous) / ((1 - ratio**2) ** 2 + viscous)) ** 0.5)


def moving(mode: Mode) -> str:
    """What moves in a mode, by its part in the kinetic energy."""
    told = [(WORDS.get(name, name[0].lower() + name[1:]), share) for name, share in mode.shares]
    return ", ".join(f"{words} {100 * share:.0f}\N{NO-BREAK SPACE}%" for words, share in told if share >= WORTH_TELLING)


def _creeping(creeping: Iterable[Creep]) -> Html:
    items = ", ".join(f"{creep.name} {creep.decay:.3g}" for creep in creeping)
    summary = element("summary", "Over-damped: these motions die away without swinging")
    return element("details", summary, element("p", f"How fast they die away, 1/s: {items}."))
