"""`make soak`, about an hour: everything that may break it, again and again; what came of it is written to REPORT.md.

For less than an hour give the minutes: `python -m tests.soak 5`. A second number is where the numbers of random
configurations and files begin: with another, others are tried.
"""

from __future__ import annotations

import os
import platform
import signal
import subprocess
import sys
from collections.abc import Callable
from datetime import date
from pathlib import Path

from tests.soak.files import mutated_files
from tests.soak.outcome import Outcome, timed
from tests.soak.runs import random_runs
from tests.soak.server import connects, dragging, driving
from tests.soak.signals import interruptions

REPORT = Path(__file__).with_name("REPORT.md")
HOUR = 60.0  # minutes, for which the counts are


def parts(share: float, first: int) -> list[Callable[[], Outcome]]:
    """What is done, so much of an hour's."""
    return [
        lambda: random_runs(round(10_000 * share), first),
        lambda: mutated_files(round(10_000 * share), first),
        lambda: connects(round(500 * share)),
        lambda: dragging(300 * share),
        lambda: driving(3600 * share),
        lambda: interruptions(round(150 * share)),
    ]


def report(minutes: float, outcomes: list[Outcome]) -> str:
    """The report, in Markdown."""
    faults = sum(len(outcome.faults) for outcome in outcomes)
    commit = subprocess.run(["git", "rev-parse", "--short", "HEAD"], capture_output=True, text=True).stdout.strip()
    seconds = sum(outcome.seconds for outcome in outcomes)
    head = (
        f"# Soak\n\nWritten by `python -m tests.soak {minutes:g}` on {date.today()} at {commit or 'no commit'}, "
        f"Python {platform.python_version()}, {os.cpu_count()} processors. {seconds / 60:.0f} minutes, "
        f"{faults or 'no'} faults.\n\nA fault can be seen again: `check_run(number)` of tests/soak/runs.py, "
        "`check_file(number)` of tests/soak/files.py.\n\n"
    )
    return head + "\n".join(outcome.markdown() for outcome in outcomes)


def main() -> int:
    signal.signal(signal.SIGINT, signal.default_int_handler)  # children would ignore it, too, where we were told to
    minutes = float(sys.argv[1]) if len(sys.argv) > 1 else HOUR
    first = int(sys.argv[2]) if len(sys.argv) > 2 else 0
    outcomes: list[Outcome] = []
    for part in parts(minutes / HOUR, first):
        outcomes.append(timed(part))
        print(outcomes[-1].markdown(), flush=True)
        REPORT.write_text(report(minutes, outcomes))
    return int(any(outcome.faults for outcome in outcomes))


if __name__ == "__main__":
    sys.exit(main())
