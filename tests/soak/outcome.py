"""What a part of the soak comes to."""

from __future__ import annotations

import resource
from collections import Counter
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass, field
from multiprocessing import get_context
from pathlib import Path
from time import perf_counter

MOST_SHOWN = 20  # faults in the report
WORKERS = 2
BATCH = 50  # numbers that a process is given at a time


@dataclass
class Outcome:
    """One part: what was tried, how each try ended, and what is wrong."""

    name: str
    tried: str = ""  # in words, with the seed
    endings: Counter[str] = field(default_factory=Counter)  # how tries ended that are as they should be
    faults: list[str] = field(default_factory=list)  # each with what is needed to see it again
    notes: list[str] = field(default_factory=list)  # figures
    seconds: float = 0.0

    def markdown(self) -> str:
        """Its section of the report."""
        lines = [f"## {self.name}", "", f"{self.tried} Took {self.seconds:.0f} s.", ""]
        if self.endings:
            lines += ["| Ended as | Times |", "| --- | --- |"]
            lines += [f"| {ending} | {count} |" for ending, count in self.endings.most_common()]
            lines.append("")
        lines += [f"- {note}" for note in self.notes]
        lines += ["", f"**{len(self.faults)} faults.**" if self.faults else "No fault.", ""]
        lines += [f"- {fault}" for fault in self.faults[:MOST_SHOWN]]
        return "\n".join(lines) + "\n"


def timed(part: Callable[[], Outcome]) -> Outcome:
    """An outcome with the time that it took."""
    began = perf_counter()
    outcome = part()
    outcome.seconds = perf_counter() - began
    return outcome


def try_all(
    outcome: Outcome, check: Callable[[int], tuple[str, str]], numbers: Sequence[int], workers: int = WORKERS
) -> None:
    """Check each number in processes of their own: (how it ended, what is wrong or empty), added to the outcome.

    A process that dies is a fault of the batch that it was at.
    """
    with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
        batches = [numbers[first : first + BATCH] for first in range(0, len(numbers), BATCH)]
        waiting = [(batch, pool.submit(_check_batch, check, batch)) for batch in batches]
        for batch, future in waiting:
            try:
                for number, (ending, fault) in zip(batch, future.result(), strict=True):
                    if fault:
                        outcome.faults.append(f"{number}: {fault}")
                    else:
                        outcome.endings[ending] += 1
            except BrokenProcessPool:
                outcome.faults.append(f"{batch[0]} to {batch[-1]}: the process died in one of these, or before")


def _check_batch(check: Callable[[int], tuple[str, str]], batch: Sequence[int]) -> list[tuple[str, str]]:
    found = []
    for number in batch:
        try:
            found.append(check(number))
        except Exception as error:
            found.append(("", f"{type(error).__name__}: {str(error)[:200]}"))
    return found


def memory_of(process: int) -> float:
    """What a process holds in memory now, MB."""
    return int(Path(f"/proc/{process}/statm").read_text().split()[1]) * resource.getpagesize() / 1e6
