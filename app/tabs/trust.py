"""How far a run can be trusted: checks of its correctness, warnings, what was assumed; as HTML. Pure."""

from __future__ import annotations

from typing import NamedTuple

from app.format.load_unit import load_unit
from app.format.markup import Content, Html, element, joined, page, table, words_html
from app.format.units import METRIC, Units
from model.analysis.energy import EnergyBalance, energy_balance, load_balance
from model.analysis.ride_warnings import RideWarning, motion_warnings, warnings
from model.config.parameters import number_text
from model.paper.errata import ERRATA, Erratum
from model.road.road import Road
from model.simulation.accuracy import APART_NOTED, ENERGY_NOTED
from model.simulation.trajectory import Trajectory

CLOSING_LIMIT = 0.5  # % of the energy turned over that may be unaccounted for where only powers at samples are known
FORCE_LIMIT = 1e-6  # of the weight that Newton's law may be broken by
LEAST_SAMPLES = 2  # of a run that has an energy balance
LEFT_OPEN = "How deep wheels sink, and whether the hull's floor meets the ground, is checked when the drive pauses."


class Check(NamedTuple):
    """One figure."""

    name: str
    value: str  # with its unit
    meaning: str
    good: bool | None = None  # None: there is nothing to judge


def trust_html(run: Trajectory, driving: bool = False, road: Road | None = None, units: Units = METRIC) -> str:
    """HTML of figures and warnings. driving: the run is a stretch of an endless drive, without balances of its own.

    road: under that stretch; without it nothing is said of what its wheels and the hull's floor do to it.
    """
    if len(run.t) < LEAST_SAMPLES:
        return page(element("p", f"There is nothing to judge: {run.status}."))
    open_ended = driving and road is None
    found = motion_warnings(run) if open_ended else warnings(run, road)
    checks = [] if driving else balances(run, units)
    return page(
        element("h4", "Warnings"),
        _warnings(found, units),
        element("p", LEFT_OPEN) if open_ended else "",
        element("h4", "Does the run obey its laws?"),
        _table([*checks, drift(run)]),
        element("h4", "Work"),
        _table(work(run)),
    )


def errata_html() -> str:
    """HTML of what had to be assumed beyond the paper."""
    items = (element("li", *_erratum(erratum)) for erratum in ERRATA)
    return page(element("h4", "Assumed beyond the paper, and its misprints"), element("ol", *items))


def _erratum(erratum: Erratum) -> list[Content]:
    paper, reading = words_html(erratum.paper), words_html(erratum.reading)
    return [element("b", f"{erratum.where}."), " ", paper, " ", element("em", "Here:"), " ", reading]


def _energy_check(run: Trajectory, energy: EnergyBalance) -> Check:
    """From the work that was integrated with the motion, or, where a run has none, from the powers at its samples."""
    name = "Energy unaccounted for"
    if energy.turned_over == 0:
        return Check(name, "–", "no energy was turned over")
    if run.energy_error is not None:
        meaning = "of all rises and falls of motion and height: against the work of ground, drive and suspension"
        return Check(name, f"{100 * run.energy_error:.1g} %", meaning, run.energy_error <= ENERGY_NOTED)
    meaning = f"of {_energy(energy.turned_over)} turned over, as far as samples tell: drive against dampers and ground"
    return Check(name, f"{energy.closing_error:.2g} %", meaning, energy.closing_error <= CLOSING_LIMIT)


def balances(run: Trajectory, units: Units = METRIC) -> list[Check]:
    """What the whole run says about energy and forces."""
    energy, force = energy_balance(run), load_balance(run)
    system, unit = run.system, load_unit(run.system, units)
    weight = float(system.weight.sum())
    broken = float(abs(force.residual).max()) / weight
    return [
        _energy_check(run, energy),
        Check(
            "Vertical forces out of balance",
            f"{broken:.1g} of the weight",
            "at worst: Σ contact forces against Σ m (g + ÿ) of all bodies",
            broken <= FORCE_LIMIT,
        ),
        Check(
            "Σ contact forces, mean",
            unit.text(float(force.contact_force.mean())),
            f"weight {unit.text(weight)}; they differ by what the hull has gained in upward speed",
        ),
    ]


def drift(run: Trajectory) -> Check:
    """How far joints came apart."""
    worst = float(run.constraint_residual.max())
    return Check(
        "Joints apart",
        f"{1e6 * worst:.2g} µm",
        "at worst; Baumgarte's α and β pull them together",
        worst <= APART_NOTED,
    )


def work(run: Trajectory) -> list[Check]:
    """What the run cost."""
    of, settings = run.statistics, run.config.simulation
    seconds = float(run.t[-1])  # work is counted from the start, of a drive too
    return [
        Check(
            "Integrator", settings.integrator, f"rtol {number_text(settings.rtol)}, atol {number_text(settings.atol)}"
        ),
        Check("Steps", f"{of.steps}", f"{of.rejected_steps} more were rejected and tried again shorter"),
        Check("Smallest step", f"{1e3 * of.smallest_step:.3g} ms", "short ones mark impacts and slipping"),
        Check("Evaluations", f"{of.evaluations}", "of the equations of motion"),
        Check(
            "Real-time factor",
            f"{seconds / of.seconds:.0f}×" if of.seconds > 0 else "–",
            f"{seconds:.3g} s simulated in {1e3 * of.seconds:.0f} ms",
        ),
    ]


def _warnings(found: list[RideWarning], units: Units) -> Html:
    if not found:
        return element("p", "None: this is within what the model was made for.", class_="good")
    items = (
        element("li", element("b", units.reword(warning.what)), element("br"), units.reword(warning.meaning))
        for warning in found
    )
    return element("ul", *items, class_="bad")


def _table(checks: list[Check]) -> Html:
    rows: list[list[Content]] = [
        [check.name, joined((check.value, " ", _sign(check.good))), check.meaning] for check in checks
    ]
    return table((), rows, "trackride-facts")


def _sign(good: bool | None) -> Html:
    if good is None:
        return Html()
    return element("span", "✓", class_="good", title="as it should be") if good else element("span", "!", class_="bad")


def _energy(joules: float) -> str:
    factor, unit = next(((f, u) for f, u in ((1e6, "MJ"), (1e3, "kJ")) if joules >= f), (1.0, "J"))
    return f"{joules / factor:.3g} {unit}"
