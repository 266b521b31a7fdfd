"""What the results of all studies are made of: names of keys and figures, CSV, a page with its pictures."""

from __future__ import annotations

import csv
import re
from collections.abc import Iterable, Mapping, Sequence
from io import StringIO
from typing import Any

from matplotlib.axes import Axes
from rich.table import Column, Table

from app.format.markup import Content, Html, element
from app.reports.drawings import SMALL, Drawing, Look
from app.reports.html_page import document, picture
from model.analysis.figures import FIGURE
from model.config.config import Config
from model.config.config_files import dump_config
from model.config.parameters import PARAMETER

NAME = 21  # characters in a line of a dotted name in the terminal: a parameter's longest part
DOTTED = re.compile(r"\w+(\.\w+)+")


def key_label(key: str) -> str:
    """What a key is called, with the unit of the file: "Speed, km/h"."""
    parameter = PARAMETER[key]
    return f"{parameter.label}, {parameter.unit}" if parameter.unit else parameter.label


def figure_label(name: str) -> str:
    """What a figure is called, with the wheel and the unit: "Peak load R1, kN"."""
    of, _, wheel = name.partition(".")
    return f"{FIGURE[of].label}{' ' if wheel else ''}{wheel}, {FIGURE[of].unit}"


def csv_bytes(heads: Sequence[str], rows: Iterable[Sequence[object]]) -> bytes:
    """A CSV file; numbers in six digits, empty where there is none."""
    text = StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(heads)
    writer.writerows([number_cell(cell) for cell in row] for row in rows)
    return text.getvalue().encode()


def number_cell(value: object) -> str:
    """A cell of a table."""
    if value is None:
        return ""
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def terminal_table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> Table:
    """For the terminal: dotted names in the first column break behind dots only."""
    lines = [[folded(cell) for cell in row] for row in rows]
    named = any(DOTTED.fullmatch(row[0]) for row in rows)
    shown = Table(*(Column(folded(head), overflow="fold", no_wrap=named and not k) for k, head in enumerate(heads)))
    for line in lines:
        shown.add_row(*line)
    return shown


def folded(cell: str) -> str:
    """A cell; a dotted name in lines of NAME characters."""
    if not DOTTED.fullmatch(cell):
        return cell
    lines = [""]
    for piece in re.findall(r"[^.]+\.?", cell):
        if lines[-1] and len(lines[-1]) + len(piece) > NAME:
            lines.append("")
        lines[-1] += piece
    return "\n".join(lines)


def legend(axes: Axes, look: Look, **options: Any) -> None:
    """The names of the curves."""
    axes.legend(fontsize=SMALL, frameon=False, labelcolor=look.ink, **options)


def result_files(
    title: str,
    subtitle: str,
    drawing: Drawing,
    caption: str,
    body: Iterable[Content],
    bases: Sequence[Config],
    others: Mapping[str, bytes],
) -> dict[str, bytes]:
    """The page, its figure as .png and .svg, and what lies beside them."""
    configurations: list[Html] = [
        element("details", element("summary", f"Configuration: {base.name}"), element("pre", dump_config(base)))
        for base in bases
    ]
    page = document(title, subtitle, [picture(drawing, caption), *body, *configurations])
    pictures = {f"figure{suffix}": drawing.bytes(suffix, background="white") for suffix in (".png", ".svg")}
    return {"index.html": page.encode(), **pictures, **others}
