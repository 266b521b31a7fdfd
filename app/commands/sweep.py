"""`trackride sweep`: many runs of one configuration with some values varied, as a table."""

from __future__ import annotations

import shlex
import shutil
import sys
from collections.abc import Callable, Iterable
from contextlib import closing
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from app.commands.analysis import SchedulerOption, spreading
from app.commands.common import (
    CANCELLED,
    DIVERGED,
    ConfigArgument,
    SetOption,
    check_folder,
    check_writable,
    configuration,
    counting,
    fail,
    interrupt,
    output,
    say,
    writing,
)

if TYPE_CHECKING:
    from model.config.config import Config
    from model.simulation.trajectory import Trajectory
    from model.study.design import Study, Varied

EXAMPLE = "Example: trackride sweep paper --vary drive.speed_kmh=5:40:8 --vary road.amplitude=0.05,0.1 --out speed.csv"
MEGABYTES = 4.3  # of a kept run of 10 s of the paper's vehicle, compressed; about in proportion to its samples

VaryOption = Annotated[
    list[str],
    typer.Option(
        "--vary",
        metavar="KEY=FROM:TO:N",
        help="Vary a key over a range in N values, or as KEY=a,b,c; may be repeated. With a sample, KEY=FROM:TO.",
    ),
]
FiguresOption = Annotated[
    list[str],
    typer.Option(
        "--figures",
        metavar="NAMES",
        help="Names of figures, with commas between, or once for each; peak_load.R1: of a wheel. Left out: all, of all "
        "wheels.",
    ),
]
SeedOption = Annotated[int, typer.Option(min=0, help="Of the sample: the same seed gives the same runs.")]


def sweep(
    config: ConfigArgument = "paper",
    changes: SetOption = None,
    vary: VaryOption = [],  # noqa: B006 (typer copies it)
    sample: Annotated[str, typer.Option(help="grid, latin-hypercube:N or sobol:N.")] = "grid",
    seed: SeedOption = 0,
    figures: FiguresOption = [],  # noqa: B006
    out: Annotated[Path, typer.Option(help="Where to write the table: a name ending in .parquet or .csv.")] = Path(
        "study.parquet"
    ),
    resume: Annotated[bool, typer.Option("--resume", help="Go on with a table that is not finished.")] = False,
    keep_runs: Annotated[Path | None, typer.Option(metavar="DIR", help="Save each run there too, as .npz.")] = None,
    scheduler: SchedulerOption = None,
) -> None:
    """Run all combinations of values, or a sample of them, and write their figures into a table.

    A run that diverges, or whose vehicle cannot rest, is a row with its status. Ctrl+C keeps what is done; --resume
    goes on from there. Exit status: 0 done; 2 bad input, nothing written; 3 no run came to its end; 130 interrupted.
    """
    base = configuration(config, changes)
    from model.study.design import DesignError, make_study
    from model.study.running import rows
    from model.study.table import SUFFIXES, Made, TableWriter

    check_writable(out, SUFFIXES)
    if keep_runs is not None:
        check_folder(keep_runs, "--keep-runs")
        if scheduler is not None:
            fail("--keep-runs: the runs of a cluster are not here; leave out --keep-runs or --scheduler")
    varied, wanted = parsed(vary, "--vary", base), chosen_figures(figures, base)
    try:
        study = make_study(base, varied, wanted, sample, seed)
    except DesignError as error:
        fail(str(error))
    _check_space(study, out, keep_runs)
    if not resume:
        _check_unfinished(out)
    with spreading(scheduler) as spread:
        made = Made.by(study, version("trackride"), shlex.join(["trackride", *sys.argv[1:]]))
        try:
            with writing(out):
                table = TableWriter(out, study, made, go_on=resume)
        except DesignError as error:
            fail(str(error))
        before, complete = table.done, 0
        if before:
            say(f"{out}: {before} of {len(study.points)} runs are there already.")
        with interrupt() as should_stop, writing(out):
            runs = rows(study, before, _keeper(keep_runs), spread)
            with counting(base.name, len(study.points), before) as count, closing(runs):
                for row in runs:
                    table.add(row)
                    complete += row.outcome.complete
                    count()
                    if should_stop():
                        break
            table.finish()
    done = table.done - before
    lost = f"; incomplete: {done - complete}, see the column status" if complete < done else ""
    output.print(f"{table.done} of {len(study.points)} runs are in {out}{lost}.", markup=False, soft_wrap=True)
    if table.done < len(study.points):
        say("Interrupted: go on with --resume.", style="red")
        raise typer.Exit(CANCELLED)
    if not before and not complete:
        fail("No run came to its end.", DIVERGED)


def parsed(texts: list[str], option: str, base: Config) -> list[Varied]:
    """What varies, as options say; leaves with all faults printed when there are any."""
    from model.study.design import DesignError, parse_varied

    road_varies = any(text.partition("=")[0].strip() == "road.type" for text in texts)
    found, faults = [], []
    for text in texts:
        try:
            found.append(parse_varied(text, base, road_varies))
        except DesignError as error:
            faults.append(f"{option} {error}")
    if faults:
        fail("\n".join(faults))
    return found


def chosen_figures(texts: Iterable[str], base: Config, option: str = "--figures") -> tuple[str, ...]:
    """Names with commas between; leaves when one is unknown."""
    from model.study.design import DesignError, checked_figures

    try:
        return checked_figures([name for text in texts for name in text.split(",") if name.strip()], base)
    except DesignError as error:
        fail(f"{option} {error}")


def _check_unfinished(out: Path) -> None:
    """Leave where a study that was stopped would lose its runs."""
    from model.study.table import part_of, progress_of

    if (part := part_of(out)).exists():
        fail(f"{part}: holds the runs of a study that was stopped; go on with --resume, or delete it")
    done, total = progress_of(out)
    if done < total:
        fail(
            f"{out}: holds {done} of {total} runs of a study that was stopped; go on with --resume, delete it, or give "
            "another name"
        )


def _keeper(folder: Path | None) -> Callable[[int, Trajectory], None] | None:
    """Saves each run into a folder."""
    if folder is None:
        return None
    folder.mkdir(parents=True, exist_ok=True)
    return lambda run, trajectory: trajectory.save(folder / f"run-{run:06d}.npz")


def _check_space(study: Study, out: Path, keep_runs: Path | None) -> None:
    """Leave when the disk cannot hold what the study writes."""
    from model.study.table import bytes_needed

    needed = {out.parent: bytes_needed(study) / 1e6}
    if keep_runs is not None:
        folder = next(folder for folder in (keep_runs, *keep_runs.parents) if folder.exists())
        settings = study.base.simulation
        each = MEGABYTES * settings.duration * settings.output_rate / 2000
        needed[folder] = needed.get(folder, 0.0) + each * len(study.points)
    for folder, megabytes in needed.items():
        free = shutil.disk_usage(folder).free / 1e6
        if megabytes > free:
            fail(
                f"{len(study.points)} runs take about {megabytes:.0f} MB, and {folder.resolve()} has {free:.0f} MB "
                "free: vary less, or write elsewhere"
            )
