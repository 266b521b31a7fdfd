"""What our assumptions do to the paper's results: a table of what else they may be, and sentences chosen by it."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from app.format.markup import Content, Html, element, joined
from app.format.parameters import value_text
from app.reports.html_page import wide_table
from app.reports.paper.words import HARDLY, change_words, list_words, share_words
from model.config.parameters import PARAMETER
from model.paper.study import SOFT, STIFF, Alternative, Figures, PaperStudy

NO_CHANGE = 0.0005  # a smaller relative change is shown as none


def assumptions(study: PaperStudy) -> Iterator[Html]:
    """A section of the page: a table of all alternatives, and what it comes to."""
    yield element(
        "p",
        "What the paper leaves open was assumed. Here each assumption is changed by itself, as far as it may well "
        f"have been otherwise. Changes of more than {100 * HARDLY:g} % are bold. The last two columns are about the "
        f"two claims: how the share moves when the imaginary springs go from {SOFT:g} to {STIFF:g} times their "
        f"stiffness, and how much the rms acceleration changes when they go from 1 to {STIFF:g} times.",
    )
    heads = (
        "Assumption", "Peak, Hz", "Amplitude at v/λ, m/s²", "rms, m/s²", "Share", "Highest load, kN",
        f"Share, ×{SOFT:g} to ×{STIFF:g}", f"rms, ×1 to ×{STIFF:g}",
    )  # fmt: skip
    rows = [_row(study.paper, study.paper, "As Trackride has it")]
    rows += [_row(alternative, study.paper, _name(alternative)) for alternative in study.alternatives]
    yield wide_table(heads, rows, "numbers")
    for words in _lessons(study):
        yield element("p", words)


def _row(alternative: Alternative, paper: Alternative, name: str) -> list[Content]:
    now, then = alternative.figures, paper.figures
    stiffer = alternative.stiff.acceleration_rms / now.acceleration_rms - 1
    return [
        name,
        f"{now.peak_frequency:.2f}",
        _beside(f"{now.harmonics[0]:.3f}", now.harmonics[0] / then.harmonics[0] - 1),
        _beside(f"{now.acceleration_rms:.3f}", now.acceleration_rms / then.acceleration_rms - 1),
        _beside(share_words(now.share), now.share / then.share - 1),
        _beside(f"{now.load_peak / 1e3:.1f}", now.load_peak / then.load_peak - 1),
        f"{share_words(alternative.soft.share)} to {share_words(alternative.stiff.share)}",
        element("b", change_words(stiffer)) if abs(stiffer) > HARDLY else change_words(stiffer),
    ]


def _beside(value: str, change: float) -> Html:
    """A value with its change, bold where that is more than hardly any."""
    if abs(change) < NO_CHANGE:
        return joined((value,))
    words = element("small", " ", change_words(change))
    return joined((value, element("b", words) if abs(change) > HARDLY else words))


def _strongest(study: PaperStudy, figure: Callable[[Figures], float], most: int = 3) -> list[tuple[Alternative, float]]:
    """The alternatives that change a figure most, as parts of what it is, the strongest first."""
    reference = figure(study.paper.figures)
    changes = [(alternative, figure(alternative.figures) / reference - 1) for alternative in study.alternatives]
    return sorted(changes, key=lambda change: -abs(change[1]))[:most]


def _lessons(study: PaperStudy) -> list[str]:
    """What the table of alternatives comes to, in sentences."""
    off = [a for a in study.alternatives if not a.figures.follows_waves]
    unmoved = [a for a in study.alternatives if a.stiff.share < 2 * a.soft.share]
    swayed = [a for a in study.alternatives if abs(a.stiff.acceleration_rms / a.figures.acceleration_rms - 1) > HARDLY]
    return [
        "The peak stays at v/λ under every one of these assumptions."
        if not off
        else f"The peak leaves v/λ with {_names(off)}.",
        f"From {SOFT:g} to {STIFF:g} times the stiffness the share at least doubles under every one of them."
        if not unmoved
        else f"From {SOFT:g} to {STIFF:g} times the stiffness the share does not double with {_names(unmoved)}.",
        f"{STIFF:g} times the stiffness changes the rms acceleration by less than {100 * HARDLY:g} % under every one "
        "of them."
        if not swayed
        else f"{STIFF:g} times the stiffness changes the rms acceleration by more than {100 * HARDLY:g} % with "
        f"{_names(swayed)}.",
        "The acceleration itself depends most on "
        + list_words([f"{_name(a)} ({change_words(c)})" for a, c in _strongest(study, lambda f: f.acceleration_rms)])
        + ", the highest load on "
        + list_words([f"{_name(a)} ({change_words(c)})" for a, c in _strongest(study, lambda f: f.load_peak)])
        + ", the imaginary wheels' share on "
        + list_words([f"{_name(a)} ({change_words(c)})" for a, c in _strongest(study, lambda f: f.share)])
        + ".",
    ]


def _name(alternative: Alternative) -> str:
    """What it changes: "Road arm length 0.25 m"."""
    parameter = PARAMETER[alternative.key]
    return f"{parameter.label} {value_text(parameter, alternative.value).replace('-', '−')}"


def _names(alternatives: list[Alternative]) -> str:
    return list_words([_name(alternative) for alternative in alternatives])
