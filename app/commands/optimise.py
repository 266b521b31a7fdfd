"""`trackride optimise`: the best values for one figure, or the front of two."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from app.commands.analysis import FolderOption, OverOption, ResumeOption, SchedulerOption, remembered, write_results
from app.commands.common import ConfigArgument, SetOption, configuration, fail, print_table
from app.commands.sensitivity import only_ranges
from app.commands.sweep import SeedOption, chosen_figures, parsed

EXAMPLE = (
    "Example: trackride optimise paper --minimise absorbed_power --over vehicle.road_suspension.damping=1000:20000 "
    "--subject-to 'peak_load<=30' --out build/damper"
)


def optimise(
    config: ConfigArgument = "paper",
    changes: SetOption = None,
    minimise: Annotated[
        list[str], typer.Option(metavar="FIGURE", help="What is to be small; twice: the front of both.")
    ] = [],  # noqa: B006 (typer copies it)
    over: OverOption = [],  # noqa: B006
    subject_to: Annotated[
        list[str] | None, typer.Option("--subject-to", metavar="'FIGURE<=VALUE'", help="A bound; may be repeated.")
    ] = None,
    roads: Annotated[
        list[str] | None,
        typer.Option(
            metavar="CONFIG", help="On the road of this file or preset as well, at CONFIG's speed; may be repeated."
        ),
    ] = None,
    mean: Annotated[
        bool, typer.Option("--mean/--worst", help="Of several roads the mean counts, or the worst.")
    ] = False,
    generations: Annotated[int, typer.Option(min=1, max=10_000, help="Rounds of the search.")] = 30,
    seed: SeedOption = 0,
    out: FolderOption = Path("optimum"),
    resume: ResumeOption = False,
    scheduler: SchedulerOption = None,
) -> None:
    """Find the values that make a figure small, or the front of two figures that cannot both be smallest.

    A damper that is best on one road only is no answer: give several with --roads. Writes YAML files of the best,
    the table and the figure. Exit status: 0 done; 2 bad input, or no point keeps the bounds, the runs kept for
    --resume with other bounds; 130 interrupted, the runs kept for --resume.
    """
    base = configuration(config, changes)
    ranges = only_ranges(parsed(over, "--over", base))
    goals = tuple(goal for name in minimise if name.strip() for goal in chosen_figures([name], base, "--minimise"))
    if len(goals) not in (1, 2) or len(set(goals)) < len(goals):
        fail("give --minimise FIGURE once, or twice for the front of two figures")
    from app.reports.studies.optimum import files, table
    from model.study import optimum
    from model.study.design import DesignError, check_analysis, check_key

    try:
        bounds = [optimum.parse_bound(text, base) for text in subject_to or ()]
    except DesignError as error:
        fail(f"--subject-to {error}")
    bases = [base, *(optimum.on_road(base, configuration(road, None)) for road in roads or ())]
    runs = optimum.members(len(ranges)) * (generations + 1) * len(bases)
    try:
        check_analysis(ranges, runs)
        for of in ranges:
            for on in bases:
                check_key(of.key, on)
    except DesignError as error:
        fail(f"--over {error}")
    with remembered(base.name, out, resume, runs, scheduler) as evaluate:
        found = optimum.optimise(bases, ranges, goals, bounds, mean, generations, seed, evaluate)
    print_table(table(found))
    write_results(out, files(found, bases, ranges, mean))
