"""What `trackride paper` writes: the paper's figures as pictures, and a page about its statements."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from app.format.markup import Html, element, words_html
from app.reports.drawings import Drawing
from app.reports.html_page import document, picture
from app.reports.paper.amplitude import amplitude_section
from app.reports.paper.assumptions import assumptions
from app.reports.paper.figures import PAPER_FIGURES
from app.reports.paper.findings import Finding, findings
from app.reports.paper.links import TITLE as LINKS_TITLE
from app.reports.paper.links import links_section, motions
from model.paper.errata import ERRATA
from model.paper.links import LinksStudy
from model.paper.study import WAVES, PaperStudy

TITLE = "What the paper says, and what its model does"
PAPER = (
    "Mahalingam and Padmanabhan, “Planar Multi-body Dynamics of a Tracked Vehicle using Imaginary Wheel Model for "
    "Tracks”, Defence Science Journal: its vehicle on its road, computed again."
)
STRETCHES = (
    f"Which stretch of a run: amplitudes, rms, shares, highest loads, parts of the time and the swing of the speed are "
    f"those of the samples in the last {WAVES} waves, when the start has died away. How far joints are apart, and the "
    "time to compute, are those of the whole run. What is said to be at rest is of the pose in which a run starts. "
    "Figs. 5 and 7 show the whole run of the preset paper, Fig. 6 its steady part. Runs beside links have a "
    "stretch of their own, told there."
)
CLASSES = {
    "holds": "good",
    "holds within limits": "warn",
    "does not hold here": "bad",
    "cannot be compared": "note",
}


def paper_files(study: PaperStudy, links: LinksStudy) -> dict[str, bytes]:
    """Name -> content of every file: index.html, and each figure as PNG and SVG."""
    drawings = {name: (make(study), words) for name, (make, words) in PAPER_FIGURES.items()}
    beside_links = motions(links)
    files = {"index.html": _page(study, drawings, links_section(links, beside_links)).encode()}
    for name, drawing in {**{name: drawing for name, (drawing, _) in drawings.items()}, "links": beside_links}.items():
        for suffix in (".png", ".svg"):
            files[name + suffix] = drawing.bytes(suffix, background="white")
    return files


def _page(study: PaperStudy, drawings: dict[str, tuple[Drawing, str]], links: Iterable[Html]) -> str:
    found = findings(study)
    shown = {name: picture(drawing, words) for name, (drawing, words) in drawings.items()}
    return document(
        TITLE,
        PAPER,
        [
            *_summary(found),
            element("h2", "The paper's figures"),
            element(
                "p",
                "The curves of the paper itself, measured and simulated, are not drawn beside ours: the copy that "
                "this project has is without its figures.",
                class_="note",
            ),
            *(shown[name] for name in ("fig5_acceleration", "fig6_spectrum", "fig7_loads")),
            element("h2", "Its statements, one by one"),
            *map(_finding, found),
            element("h2", "The two claims as curves"),
            shown["claims"],
            element("h2", "Where higher harmonics come from"),
            shown["harmonics"],
            element("h2", "What our assumptions do to it"),
            *assumptions(study),
            *_amplitude(study),
            element("h2", LINKS_TITLE),
            *links,
            element("h2", "How the paper is read"),
            element("ol", *map(_erratum, range(len(ERRATA)))),
            element("p", STRETCHES, class_="note"),
        ],
    )


def _amplitude(study: PaperStudy) -> Iterator[Html]:
    if study.half is not None:
        yield element("h2", "What hangs on the amplitude")
        yield from amplitude_section(study, study.half)


def _summary(found: list[Finding]) -> Iterator[Html]:
    """How many statements came to what."""
    tiles = []
    for verdict, kind in CLASSES.items():
        count = sum(finding.verdict == verdict for finding in found)
        tiles.append(element("div", element("dt", verdict), element("dd", str(count), class_=kind)))
    yield element("p", f"{len(found)} statements of the paper were put to the test.")
    yield element("dl", *tiles)


def _finding(finding: Finding) -> Html:
    verdict = element(
        "div",
        finding.verdict,
        element("small", f"section {finding.where}"),
        class_=f"verdict {CLASSES[finding.verdict]}",
    )
    limit = element("p", finding.limit, class_="note") if finding.limit else Html()
    parts = (verdict, element("h3", finding.statement), element("p", finding.found), limit)
    return element("section", *parts, class_="finding")


def _erratum(number: int) -> Html:
    erratum = ERRATA[number]
    paper, reading = words_html(erratum.paper), words_html(erratum.reading)
    return element("li", element("b", erratum.where), ". ", paper, " ", element("em", "Here: "), reading)
