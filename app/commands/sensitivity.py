"""`trackride sensitivity`: which values matter for which figures."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from app.commands.analysis import FolderOption, OverOption, ResumeOption, SchedulerOption, remembered, write_results
from app.commands.common import ConfigArgument, SetOption, configuration, fail, print_table, say
from app.commands.sweep import SeedOption, chosen_figures, parsed

if TYPE_CHECKING:
    from model.study.design import Range, Varied

EXAMPLE = (
    "Example: trackride sensitivity paper --over drive.speed_kmh=10:30 --over road.amplitude=0.05:0.1 "
    "--figures absorbed_power,peak_load --out build/sensitivity"
)


def sensitivity(
    config: ConfigArgument = "paper",
    changes: SetOption = None,
    over: OverOption = [],  # noqa: B006 (typer copies it)
    figures: Annotated[
        list[str],
        typer.Option("--figures", metavar="NAMES", help="Names of figures, with commas between, or once for each."),
    ] = ["absorbed_power,peak_load"],  # noqa: B006
    trajectories: Annotated[int, typer.Option(min=2, max=1000, help="Of Morris's screening.")] = 10,
    samples: Annotated[int, typer.Option(min=2, help="Of Sobol's indices, a power of 2; times keys + 2 runs.")] = 64,
    seed: SeedOption = 0,
    out: FolderOption = Path("sensitivity"),
    resume: ResumeOption = False,
    scheduler: SchedulerOption = None,
) -> None:
    """Tell which values matter: Morris's screening and Sobol's indices, with bounds, as table and bar chart.

    Exit status: 0 done; 2 bad input, or too many runs came to grief; 130 interrupted, the runs kept for --resume.
    """
    base = configuration(config, changes)
    if samples & (samples - 1):
        fail(f"--samples {samples}: give a power of 2, such as {2 ** samples.bit_length()}")
    ranges = only_ranges(parsed(over, "--over", base))
    chosen = chosen_figures(figures, base)
    from app.reports.studies.sensitivity import files, table
    from model.study.design import DesignError, check_analysis
    from model.study.sensitivity import runs_of
    from model.study.sensitivity import sensitivity as found_sensitivity

    runs = runs_of(len(ranges), trajectories, samples)
    try:
        check_analysis(ranges, runs, least=2)
    except DesignError as error:
        fail(str(error))
    with remembered(base.name, out, resume, runs, scheduler) as evaluate:
        found = found_sensitivity(base, ranges, chosen, trajectories, samples, seed, evaluate)
    if found.lost:
        say(f"Incomplete: {found.lost} of {found.runs} runs; what these lack counts as the mean.", style="yellow")
    print_table(table(found))
    write_results(out, files(found, base, ranges))


def only_ranges(varied: list[Varied]) -> list[Range]:
    """Ranges of numbers; leaves when there are others."""
    from model.study.design import Range

    for of in varied:
        if not isinstance(of, Range):
            fail(f"--over {of.key}: give a range, KEY=LO:HI")
        if of.count is not None:
            fail(f"--over {of.key}: any value of the range is taken, not {of.count} of them; give KEY=LO:HI")
    keys = [of.key for of in varied]
    for key in keys:
        if keys.count(key) > 1:
            fail(f"--over {key}: is given twice")
    if not varied:
        fail("nothing may change: give --over KEY=LO:HI")
    return [of for of in varied if isinstance(of, Range)]
