"""The About tab: first steps, the model's equations with the paper's numbers, and every parameter with its source.

Pure.
"""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

from app.format.markup import Html, element, formula_html, page, row, table, words_html
from app.format.parameters import value_text
from app.format.units import METRIC, Units
from app.runs.examples import EXAMPLES
from model.config.parameters import GROUPS, NOTES, PARAMETERS, Parameter


class Law(NamedTuple):
    """A few formulas and what they say."""

    title: str
    numbers: str  # of the paper's equations
    formulas: tuple[str, ...]  # as app.format.markup reads them
    words: str


LAWS: tuple[Law, ...] = (
    Law(
        "Bodies",
        "eq. 8",
        ("q_i = (x_i, y_i, θ_i)",),
        "One side of the vehicle is a chain of rigid bodies in a plane: hull, road arms, road wheels, and between the "
        "road wheels imaginary wheels on links, which stand for the track's contact with the ground. x points forward, "
        "y up; θ turns counter-clockwise.",
    ),
    Law(
        "Suspensions",
        "eqs. 1–3",
        (
            "τ = k_s (θ_i − θ_j) + c_s (θ̇_i − θ̇_j) + τ_0",
            "τ′ = k_sl (θ_j − θ_l) + c_sl (θ̇_j − θ̇_l) + τ′_0",
        ),
        "A torsion bar between hull i and road arm j; another between road arm j and imaginary link l, which presses "
        "the imaginary wheel to the ground. The preloads τ_0 hold the hull at its height at rest.",
    ),
    Law(
        "Ground, upright",
        "eq. 4",
        ("f_n = max(0, z² (k_n + c_n ż))",),
        "z is how deep a wheel is in the ground, measured at the point of the road nearest to its centre. The ground "
        "never pulls.",
    ),
    Law(
        "Ground, along the road",
        "eqs. 5–7",
        (
            "f_stick = −(k_t ξ + c_t ṗ)",
            'f_t = f_stick "limited to" ±μ f_n',
            "ξ̇ = −(k_t ξ + f_t) / c_t",
        ),
        "ṗ is the speed at which the wheel's rim slides over the road, ξ how far the ground has been sheared. A wheel "
        "sticks until friction gives way.",
    ),
    Law(
        "Joints",
        "eqs. 10, 13, 14",
        ("C(q) = 0", "C_q q̇ + C_t = 0", "γ = −(C_q q̇)_q q̇ − 2 C_{qt} q̇ − C_{tt} − 2 α Ċ − β² C"),
        "Each hinge holds two points together. α and β (Baumgarte) pull them back should rounding drive them apart.",
    ),
    Law(
        "Motion",
        "eqs. 12, 15",
        ("M q̈ + C_qᵀ λ = Q", "C_q q̈ = γ"),
        "Newton's law with the joint forces λ. Both lines are solved together for q̈ and λ, then stepped on in time "
        "with an error control.",
    ),
    Law(
        "Speed control",
        "section 2.2",
        ("e = v_ref − ẋ_hull", "F = K_p e + K_i ∫e dt, |F| ≤ F_max"),
        "Cruise: the torque r F goes to the wheels in proportion to their loads. Prescribed: the hull is pulled along "
        "at v_ref (eq. 11), which pitches it differently.",
    ),
    Law(
        "Road",
        "section 5",
        ("y = A sin(2π (x − x_s) / λ)",),
        "Waves of amplitude A and length λ, grown over the first stretch ℓ. They are met v/λ times a second.",
    ),
)
SOURCE = (
    "After Mahalingam and Padmanabhan, “Planar Multi-body Dynamics of a Tracked Vehicle using Imaginary Wheel Model "
    "for Tracks”, Defence Science Journal. Where the paper leaves a sign or a value open, the Trust tab says how it is "
    "read."
)


@cache
def about_html(units: Units = METRIC) -> str:
    """HTML of the whole tab."""
    laws = (part for law in LAWS for part in _law(law))
    tables = (part for group in GROUPS if group != NOTES for part in _group(group, units))
    return page(_first_steps(), element("p", SOURCE), *laws, element("h3", "Parameters"), *tables)


def _first_steps() -> Html:
    """Buttons for the tour and the examples; assets/tour.js says what they do."""
    tries = {"Tour of the page": "tour"} | {example.name: example.name for example in EXAMPLES}
    buttons = (element("button", name, type="button", data_trackride_try=what) for name, what in tries.items())
    return element("p", "First steps: ", *buttons, class_="trackride-tries")


def _law(law: Law) -> list[Html]:
    """Its heading, its formulas, one below the other, and what they say."""
    first, *others = map(formula_html, law.formulas)
    formulas = first, *(part for formula in others for part in (element("br"), formula))
    return [
        element("h4", law.title, " ", element("small", law.numbers)),
        element("div", *formulas, class_="trackride-formula"),
        element("p", words_html(law.words)),
    ]


def _group(group: str, units: Units) -> list[Html]:
    rows = [_row(units.told(parameter)) for parameter in PARAMETERS if parameter.group == group]
    return [element("h4", group), table(("Name", "Symbol", "Default", "From"), rows, "trackride-parameters")]


def _row(parameter: Parameter) -> Html:
    cells = parameter.label, formula_html(parameter.symbol), _default(parameter), parameter.source
    return row(cells, titled=False, title=parameter.description)


def _default(parameter: Parameter) -> str:
    """With its unit; in brackets where it is left out."""
    text = value_text(parameter, parameter.default)
    return text if parameter.default is not None or not parameter.shown_unit else f"{text} ({parameter.shown_unit})"
