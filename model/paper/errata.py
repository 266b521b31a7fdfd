"""What was settled beyond the paper: its misprints, how they are read, and what it leaves open. Shown to users."""

from __future__ import annotations

from typing import NamedTuple


class Erratum(NamedTuple):
    """One point; plain text with k_s for a symbol with an index."""

    where: str  # in the paper
    paper: str  # what it says
    reading: str  # what this project does


ERRATA: tuple[Erratum, ...] = (
    Erratum(
        "Eqs. 2 and 3",
        "Together they give the imaginary arm a negative spring. Eq. 2 prints c_s where c_sl is meant, and θ_s differs "
        "for the two suspensions.",
        "The sign is turned, c_sl is used, and each suspension has a preload of its own.",
    ),
    Erratum(
        "Eqs. 5 to 7",
        "Eqs. 5 and 7 contradict each other in sign.",
        "One sign throughout; eq. 7 uses the force as limited by friction in eq. 6.",
    ),
    Erratum("Eq. 4", "It could pull a rebounding wheel down.", "The force is cut at zero."),
    Erratum("Eq. 13", "The velocity constraint is misprinted.", "It is read as C_q q̇ + C_t = 0."),
    Erratum(
        "Table 1, torsion bars",
        "Stiffness and damping of torsion bars are given in N/m and N s/m.",
        "They are read as rates at the wheel: the vehicle bounces at 1.55 Hz. Read as N m/rad, it would bounce at 4.74 "
        "Hz, or at 3.54 Hz if the imaginary springs are read so too, which no vehicle of its kind does.",
    ),
    Erratum(
        "Table 1, wheel spacing",
        "It gives 0.583 m between road wheels and a wheel base of 3.5 m.",
        "Six wheels have five gaps, so 3.5 m means 0.7 m; 0.583 m is 3.5/6, and wheels of 0.64 m diameter would "
        "overlap. The preset paper_0583 keeps the printed value.",
    ),
    Erratum(
        "Section 5",
        "“100 mm amplitude”.",
        "It is taken from the mean of the road to a crest. From crest to trough it would be an amplitude of 50 mm: "
        "the command “trackride paper” says what hangs on that.",
    ),
    Erratum(
        "Not in the paper",
        "Contact stiffness and friction; length, angle and mass of the arms; height of the centre of mass; cruise "
        "control; preload.",
        "The table of parameters marks them “assumed”.",
    ),
    Erratum(
        "Contact point",
        "The paper does not say where a wheel meets an uneven road.",
        "At the point of the road that is nearest to the wheel's centre, so that a wheel bridges valleys tighter than "
        "itself.",
    ),
    Erratum(
        "Bump stops",
        "There are none in the paper.",
        "The paper's vehicle has none here either: its arms can turn beyond 45° at speed, and Trackride then warns. "
        "Bump and rebound stops can be given.",
    ),
)


def errata_list() -> str:
    """The points as a numbered list in Markdown."""
    return "\n".join(f"{k}. **{e.where}.** {e.paper} *Here:* {e.reading}" for k, e in enumerate(ERRATA, 1))
