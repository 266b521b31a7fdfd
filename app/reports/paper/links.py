"""Imaginary wheels against a track of links: curves, a table of differences, and sentences chosen by them."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
from matplotlib.figure import Figure

from app.format.assets import asset
from app.format.markup import Content, Html, element
from app.format.parameters import value_text
from app.reports.drawings import HEADROOM, SMALL, WIDTH, Drawing, Look, panels, plain_axes
from app.reports.html_page import picture, wide_table
from app.reports.paper.words import HARDLY, change_words, list_words, share_words
from model.config.parameters import PARAMETER
from model.paper.links import AFTER, AS_GOOD, CLIMBED, CUT_OFF, RECORDS, TRIED, Compared, LinksStudy, Motion, Record

TITLE = "Imaginary wheels against links"
QUANTITIES = ("acceleration", "pitch", "rise")
CLOSE, OUTLINE = 0.2, 0.5  # error up to which runs come close to links, or give their motion in outline
VAGUE = 3.0  # factor between values that are as good, from which records say little about them


def record_texts() -> list[str]:
    """The files of the records."""
    return [asset(f"links/{name}.csv") for name in RECORDS]


def motions(study: LinksStudy) -> Drawing:
    """Acceleration, pitch and rise over time: a column for each record."""
    rows: tuple[tuple[str, Callable[[Motion], np.ndarray]], ...] = (
        (f"Acceleration < {CUT_OFF:g} Hz, m/s²", lambda motion: motion.acceleration),
        ("Pitch, °", lambda motion: np.degrees(motion.pitch)),
        ("Rise, mm", lambda motion: 1000 * motion.rise),
    )

    def draw(figure: Figure, look: Look) -> None:
        columns = len(study.records)
        axes = iter(panels(figure, len(rows), columns))
        for title, values in rows:
            for k, record in enumerate(study.records):
                at = next(axes)
                plain_axes(at, look, title, f"s, over {_name(record)}" if title == rows[-1][0] else "")
                curves = (
                    ("links", record.motion, look.ink, 1.6),
                    ("preset m113", study.preset.motions[k], look.accents[0], 1.1),
                    ("nearest", study.nearest.motions[k], look.accents[1], 1.1),
                )
                for label, motion, colour, width in curves:
                    at.plot(motion.t, values(motion), color=colour, lw=width, label=label)
                at.set_xlim(record.motion.t[0], record.motion.t[-1])
                if title == rows[0][0] and k == 0:
                    low, high = at.get_ylim()
                    at.set_ylim(low, high + 1.5 * HEADROOM * (high - low))
                    at.legend(
                        fontsize=SMALL, frameon=False, labelcolor=look.ink, loc="upper right", ncols=len(curves),
                        columnspacing=0.8, handlelength=1.0, handletextpad=0.4, borderaxespad=0.0,
                    )  # fmt: skip

    return Drawing("Motion of the hull over half-rounds: a track of links, and imaginary wheels", WIDTH, 6.9, draw)


def links_section(study: LinksStudy, drawing: Drawing) -> Iterator[Html]:
    """The section of the page."""
    yield element(
        "p",
        "How far is the paper's idea from a real track? Half an M113 with 63 rigid shoes on pins was computed in "
        "another engine (MuJoCo) over three half-rounds. Here the preset m113 drives over them. Runs and records are "
        f"laid over each other where the first wheel has climbed {1000 * CLIMBED:g} mm. Our vehicle keeps the speed "
        "that the record has while its wheels climb; the record's own falls a little on the obstacle. Its peak loads "
        f"are not converged, so they are not compared, nor is acceleration above {CUT_OFF:g} Hz.",
    )
    yield element(
        "p",
        "The records' arms are near the assembly pose of the published data; the preset stands at the rest pose, where "
        "they hang lower. So the same vehicle is also run with its arms at the assembly pose: as it is, without "
        f"imaginary wheels, and with those that come nearest, of {study.tried} sets of stiffness, damping and preload.",
    )
    yield picture(
        drawing,
        "“Nearest” has its arms at the records' pose. Pitch and rise are counted from what they "
        f"are ahead of the obstacle; time from where the first wheel has climbed, to {AFTER:g} s after that.",
    )
    heads = ("Vehicle", "Half-round", *(f"{quantity} off, rms" for quantity in QUANTITIES))
    rows = [row for name, compared in _vehicles(study) for row in _rows(name, compared, study.records)]
    yield wide_table(heads, rows, "numbers")
    yield element(
        "p",
        "Off: root mean square of the difference, as a share of the record's own. Small: by how much the largest value "
        "in either direction differs.",
        class_="note",
    )
    for words in lessons(study):
        yield element("p", words)


def lessons(study: LinksStudy) -> list[str]:
    """What the table comes to, in sentences; plain text."""
    return [_at_first(study), _worth(study), _nearest(study), _known(study), _remains(study)]


def _at_first(study: LinksStudy) -> str:
    preset, posed = study.preset.error, study.assembly.error
    curves = len(QUANTITIES) * len(study.records)
    words = (
        f"Over all {curves} curves the preset is off by {share_words(preset)}; a hull that did not move would be off "
        f"by 100 %. With the arms at the records' pose it is {share_words(posed)}"
    )
    return f"{words}: the rest is the vehicle's pose, not the track." if posed < preset else f"{words}."


def _worth(study: LinksStudy) -> str:
    change = study.assembly.error / study.without.error - 1
    bare = f"Without imaginary wheels the run is off by {share_words(study.without.error)}"
    if abs(change) <= HARDLY:
        return (
            f"{bare}, hardly more or less than with those of the preset: what the hull does is the road wheels' doing."
        )
    better = "nearer to" if change < 0 else "further from"
    return f"{bare}. Those of the preset bring it {better} the links ({change_words(change)})."


def _nearest(study: LinksStudy) -> str:
    change = study.nearest.error / study.assembly.error - 1
    values = list_words([f"{_label(key)} {_value(key, value)}" for key, value in study.values.items()])
    worth = "hardly nearer than the preset's" if -change <= HARDLY else f"{change_words(change)} from the preset's"
    return f"Nearest come {values}: off by {share_words(study.nearest.error)}, {worth}."


def _known(study: LinksStudy) -> str:
    vague = [key for key, (low, high) in study.as_good.items() if high > VAGUE * low]
    ranges = list_words(
        [f"{_label(key)} from {_value(key, low)} to {_value(key, high)}" for key, (low, high) in study.as_good.items()]
    )
    words = f"Of the values tried, some with {ranges} come within {100 * (AS_GOOD - 1):g} % of that"
    edges = [
        key for key, values in TRIED.items() if study.values[key] <= min(values) or study.values[key] >= max(values)
    ]
    edge = f" The search ended at the edge of what was tried for {_labels(edges)}." if edges else ""
    return (f"{words}: the records say little about {_labels(vague)}." if vague else f"{words}.") + edge


def _remains(study: LinksStudy) -> str:
    error = study.nearest.error
    rms = np.sqrt(np.mean(np.square([errors.rms for errors in study.nearest.errors]), axis=0))
    peaks = np.array([errors.peak for errors in study.nearest.errors])
    most, least = int(rms.argmax()), int(rms.argmin())
    if error < CLOSE:
        verdict = "With them the motion is close to that of links."
    elif error < OUTLINE:
        verdict = "With them the motion is that of links in outline, not in its figures."
    else:
        verdict = (
            "No imaginary wheels of this kind repeat what links do: the motion has the same events, not their size."
        )
    low = (peaks < 0).sum()
    side = "smaller" if low == peaks.size else "larger" if low == 0 else f"smaller in {low} of {peaks.size} curves"
    return (
        f"{verdict} Most is left of the {QUANTITIES[most]} ({share_words(float(rms[most]))}), least of the "
        f"{QUANTITIES[least]} ({share_words(float(rms[least]))}); peaks are {side}, by up to "
        f"{share_words(float(np.abs(peaks).max()))}. What else differs, and cannot be told apart here: the record's "
        "tension and contact are assumed, its sprocket drives through the track, and its hull is not quite at rest "
        "when it meets the obstacle."
    )


def _vehicles(study: LinksStudy) -> tuple[tuple[str, Compared], ...]:
    return (
        ("preset m113", study.preset),
        ("arms at the records' pose", study.assembly),
        ("that without imaginary wheels", study.without),
        ("that with the nearest ones", study.nearest),
    )


def _rows(name: str, compared: Compared, records: tuple[Record, ...]) -> Iterator[list[Content]]:
    for record, errors in zip(records, compared.errors, strict=True):
        cells = [
            element("span", share_words(rms), element("small", " ", change_words(peak)))
            for rms, peak in zip(errors.rms, errors.peak, strict=True)
        ]
        yield [name, _name(record), *cells]
        name = ""


def _name(record: Record) -> str:
    return f"{1000 * record.height:g} mm, {record.speed_kmh:g} km/h"


def _label(key: str) -> str:
    return PARAMETER[key].label.lower()


def _labels(keys: list[str]) -> str:
    return list_words([_label(key) for key in keys])


def _value(key: str, value: float) -> str:
    return value_text(PARAMETER[key], float(f"{value:.2g}"))
