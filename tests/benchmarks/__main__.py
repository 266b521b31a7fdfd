"""`make bench`: measures, prints and keeps the figures that the README quotes.

Figures are medians; the machine is shared, so compare ratios within one run rather than times across runs.
"""

from __future__ import annotations

import json
import platform
import re
from datetime import date
from pathlib import Path

from rich.console import Console
from rich.table import Table

from tests.benchmarks import latency, model, peers, precision, publishing, scale, studies

RESULTS = Path(__file__).parent / "results"


def machine_name() -> str:
    """Processor and system, such as "Intel Xeon, 2 cores, Linux"."""
    processor = platform.processor() or platform.machine()
    information = Path("/proc/cpuinfo")
    if information.exists():
        found = re.search(r"model name\s*:\s*(.+)", information.read_text())
        processor = found.group(1).strip() if found else processor
    return f"{re.sub(r'[(](R|TM)[)]', '', processor)}, {model.cores()} cores, {platform.system()}"


def main() -> None:
    found, points = precision.measure()
    precision.draw(points, machine_name())
    figures = model.measure() | found | peers.measure() | scale.measure()
    figures |= studies.measure() | publishing.measure() | latency.measure()
    table = Table("what", "median", "unit", title=f"Trackride on {machine_name()}")
    for what, (value, unit) in figures.items():
        table.add_row(what, f"{value:.4g}", unit)
    Console().print(table)
    RESULTS.mkdir(exist_ok=True)
    file = RESULTS / (re.sub(r"[^a-z0-9]+", "-", machine_name().lower()).strip("-") + ".json")
    kept = {"machine": machine_name(), "date": date.today().isoformat(), "command": "make bench"}
    kept["figures"] = {what: {"median": value, "unit": unit} for what, (value, unit) in figures.items()}
    file.write_text(json.dumps(kept, indent=2, ensure_ascii=False) + "\n")
    print(f"Kept in {file.relative_to(Path.cwd()) if file.is_relative_to(Path.cwd()) else file}")


if __name__ == "__main__":
    main()
