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


def mode_titles(modes: Modes | None) -> tuple[str, ...]:
    """One for each mode that swings, no two alike: "1 Pitch, 1.04 Hz"."""
    swinging = () if modes is None else modes.swinging
    return tuple(f"{k} {mode.name}, {mode.frequency:.3g} Hz" for k, mode in enumerate(swinging, 1))


def modes_page(excitation: float | None, modes: Modes | None) -> str:
    """HTML of what drives the vehicle, v/λ in Hz, and all its modes."""
    rows = []
    if excitation is not None:
        meaning = "waves met each second: the road shakes the vehicle at this frequency and its multiples"
        rows.append(["v/λ", f"{excitation:.2f} Hz", "", meaning])
    for number, mode in enumerate(() if modes is None else modes.swinging, 1):
        damping = f"{100 * mode.damping_ratio:.0f} %"
        rows.append([f"{number} {mode.name}", f"{mode.frequency:.2f} Hz", damping, moving(mode)])
    facts = table(
        ("", "Frequency", "Damping", "What moves, by its part in the energy"), rows, "trackride-facts trackride-modes"
    )
    if modes is None:
        return page(facts, element("p", "The vehicle has no rest pose to swing about."))
    return page(facts, element("p", NOTE), _creeping(modes.creeping))


def moving(mode: Mode) -> str:
    """What moves in a mode, by its part in the kinetic energy."""
    told = [(WORDS.get(name, name[0].lower() + name[1:]), share) for name, share in mode.shares]
    return ", ".join(f"{words} {100 * share:.0f}\N{NO-BREAK SPACE}%" for words, share in told if share >= WORTH_TELLING)


def _creeping(creeping: Iterable[Creep]) -> Html:
    items = ", ".join(f"{creep.name} {creep.decay:.3g}" for creep in creeping)
    summary = element("summary", "Over-damped: these motions die away without swinging")
    return element("details", summary, element("p", f"How fast they die away, 1/s: {items}."))
