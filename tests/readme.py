"""`make readme`: puts what is generated into the README: what was settled beyond the paper, figures,
parameters, benchmarks."""

from __future__ import annotations

import json

from model.analysis.figures import figure_table
from model.config.parameters import parameter_table
from model.paper.errata import errata_list
from tests.structure import ROOT

RESULTS = ROOT / "tests" / "benchmarks" / "results"


def filled(text: str, mark: str, content: str) -> str:
    """The text with the content between <!-- mark … --> and <!-- end of mark -->."""
    head, _, rest = text.partition(f"<!-- {mark}")
    comment, _, rest = rest.partition("-->")
    _, _, tail = rest.partition(f"<!-- end of {mark} -->")
    return f"{head}<!-- {mark}{comment}-->\n\n{content.strip()}\n\n<!-- end of {mark} -->{tail}"


def figure_text(value: float) -> str:
    """Three digits, without powers of ten."""
    return f"{float(f'{value:.3g}'):,.10g}"


def benchmark_table() -> str:
    """The newest kept figures, as Markdown."""
    kept = max((json.loads(path.read_text()) for path in RESULTS.glob("*.json")), key=lambda kept: kept["date"])
    rows = [
        f"| {what} | {figure_text(figure['median'])} {figure['unit']} |" for what, figure in kept["figures"].items()
    ]
    return "\n".join([f"On {kept['machine']}, {kept['date']}:", "", "| What | Median |", "| --- | --- |", *rows])


def main() -> None:
    readme = ROOT / "README.md"
    text = filled(readme.read_text(), "errata", errata_list())
    text = filled(text, "figures", figure_table())
    text = filled(text, "parameters", parameter_table())
    readme.write_text(filled(text, "benchmarks", benchmark_table()))


if __name__ == "__main__":
    main()
