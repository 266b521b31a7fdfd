"""What hangs on how the paper's "100 mm amplitude" is read: a table of both readings, and sentences chosen by it."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from app.format.markup import Html, element
from app.reports.html_page import wide_table
from app.reports.paper.findings import NOTABLE, amplitude, findings, peak_reach, steady_harmonic, unmoved_reach
from app.reports.paper.words import list_words, share_words
from model.paper.study import PaperStudy

FIGURES: tuple[tuple[str, Callable[[PaperStudy], str]], ...] = (
    ("Amplitude at v/λ, m/s²", lambda study: f"{study.paper.figures.harmonics[0]:.2f}"),
    ("Strongest harmonic at exactly constant speed, of it", lambda study: share_words(steady_harmonic(study))),
    ("Road wheel that flies most, of the time", lambda study: share_words(study.paper.figures.air)),
    ("Wheel that slips most, of the time", lambda study: share_words(study.paper.figures.slipping)),
    ("Highest load, kN", lambda study: f"{study.paper.figures.load_peak / 1e3:.1f}"),
    ("Load on imaginary wheels", lambda study: share_words(study.paper.figures.share)),
    ("Imaginary stiffness up to which rms acceleration hardly changes", lambda study: f"{unmoved_reach(study)[1]:g} ×"),
    ("Imaginary stiffness up to which the peak stays at v/λ", lambda study: f"{peak_reach(study)[1]:g} ×"),
)


def amplitude_section(study: PaperStudy, half: PaperStudy) -> Iterator[Html]:
    """A section of the page. half: the study with the amplitude read from crest to trough."""
    yield element(
        "p",
        f"“100 mm amplitude” is read here as {_name(study)} from the mean of the road to a crest. It may as well mean "
        f"100 mm from crest to trough, an amplitude of {_name(half)}. So the runs, all but those of the "
        "other assumptions, were made with that, too.",
    )
    rows = [[label, of(study), of(half)] for label, of in FIGURES]
    yield wide_table(("", _name(study), _name(half)), rows, "numbers")
    for words in lessons(study, half):
        yield element("p", words)


def lessons(study: PaperStudy, half: PaperStudy) -> list[str]:
    """What both readings come to, in sentences; plain text."""
    pairs = list(zip(findings(study), findings(half), strict=True))
    changed = [
        f"“{ours.statement.rstrip('.')}” ({ours.verdict}; at {_name(half)}: {theirs.verdict})"
        for ours, theirs in pairs
        if ours.verdict != theirs.verdict
    ]
    if changed:
        hang = "One verdict hangs" if len(changed) == 1 else f"{len(changed)} verdicts hang"
        verdicts = f"{hang} on the reading: {list_words(changed)}. The other {len(pairs) - len(changed)} stay."
    else:
        verdicts = f"All {len(pairs)} verdicts are the same with either."
    words = [verdicts]
    if steady_harmonic(half) < NOTABLE <= steady_harmonic(study):
        words.append(
            f"With {_name(half)} the model has hardly any higher harmonics. That fits the paper's remark better, which "
            "looks for the cause of those that were measured outside of its model."
        )
    return words


def _name(study: PaperStudy) -> str:
    return f"{1e3 * amplitude(study):g} mm"
