"""`trackride limits`: how fast vehicles may go over rough ground and over obstacles."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from app.commands.analysis import FolderOption, ResumeOption, SchedulerOption, remembered, write_results
from app.commands.common import DIVERGED, SetOption, configuration, fail, print_table, say

EXAMPLE = "Example: trackride limits paper m113 marder --seeds 1 --out build/limits"


def limits(
    configs: Annotated[
        list[str] | None,
        typer.Argument(metavar="CONFIG…", help="YAML files or names of presets; several in one figure."),
    ] = None,
    changes: SetOption = None,
    profile: Annotated[
        list[Path] | None,
        typer.Option("--profile", metavar="FILE", help="A measured profile as well; may be repeated."),
    ] = None,
    seeds: Annotated[int, typer.Option(min=1, max=100, help="Random roads of each roughness: the band.")] = 3,
    out: FolderOption = Path("limits"),
    resume: ResumeOption = False,
    scheduler: SchedulerOption = None,
) -> None:
    """Find ride-limited and shock-limited speeds, as the NATO Reference Mobility Model reports them.

    Ride: the fastest speed with an absorbed power of at most 6 W, over the rms roughness of the ground (ISO 8608,
    and measured profiles). Shock: the fastest with at most 2.5 g at the seat, over the height of half-rounds. Exit
    status: 0 done; 2 bad input; 3 no run came to its end; 130 interrupted, the runs kept for --resume.
    """
    bases = [configuration(config, changes) for config in configs or ["paper"]]
    from model.config.config import ConfigError
    from model.config.config_files import read_profile
    from model.study import limits as found

    measured = {}
    for file in profile or ():
        try:
            read = read_profile(file)
        except ConfigError as error:
            fail(f"--profile: {str(error).removeprefix('road.file: ')}")
        say(f"{file.name}: {read.said}.")
        measured[file.name] = read.points
    from app.reports.studies.limits import files, table

    vehicles = []
    for base in bases:
        grounds = found.iso_grounds(base, range(1, seeds + 1))
        for name, points in measured.items():
            grounds += found.profile_grounds(base, name, points)
        vehicles.append((base, [*grounds, *found.half_round_grounds(base)]))
    runs = sum(found.runs_about(grounds) for _, grounds in vehicles)
    with remembered(", ".join(base.name for base in bases), out, resume, runs, scheduler) as evaluate:
        limited = found.limits(vehicles, evaluate)
    if not any(value is not None for limit in limited for value in limit.values):
        fail("No run came to its end.", DIVERGED)
    print_table(table(limited, bases))
    write_results(out, files(limited, bases))
