"""`trackride fit`: the values with which a run comes nearest to a measured acceleration."""

from __future__ import annotations

from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from app.commands.analysis import FolderOption, OverOption, SchedulerOption, spreading, write_results
from app.commands.common import (
    CANCELLED,
    ConfigArgument,
    SetOption,
    check_folder,
    configuration,
    counting,
    fail,
    interrupt,
    output,
    print_table,
    say,
    writing,
)
from app.commands.sensitivity import only_ranges
from app.commands.sweep import SeedOption, parsed

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

EXAMPLE = (
    "Example: trackride fit half_round --measured record.csv --over vehicle.road_suspension.damping=1000:20000 "
    "--low-pass 20 --out build/fit. A record to try it on: trackride run half_round "
    "--set vehicle.road_suspension.damping=6000 --out record.csv"
)


def fit(
    config: ConfigArgument = "paper",
    changes: SetOption = None,
    measured: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE", help='CSV of time and vertical acceleration, headed such as "t \\[s],a \\[m/s^2]".'
        ),
    ] = None,
    columns: Annotated[str, typer.Option(help="Names of both columns, with a comma between.")] = "",
    over: OverOption = [],  # noqa: B006 (typer copies it)
    low_pass: Annotated[float | None, typer.Option(min=0.1, help="Hz above which nothing is compared.")] = None,
    seat: Annotated[
        bool, typer.Option("--seat", help="Measured at the driver's seat, not at the hull's centre.")
    ] = False,
    seed: SeedOption = 0,
    out: FolderOption = Path("fit"),
    scheduler: SchedulerOption = None,
) -> None:
    """Fit values to a measured vertical acceleration by least squares, with confidence intervals at 95 %.

    CONFIG and --set give the road and the speed of the record. When the record began and by how much its sensor is
    off are found too; up is positive. Writes YAML of the fitted vehicle, and the curves laid over each other in time
    and in the spectrum. A fit takes some hundred runs, so that there is no --resume. Exit status: 0 done; 2 bad
    input; 130 interrupted, nothing written.
    """
    base = configuration(config, changes)
    ranges = only_ranges(parsed(over, "--over", base))
    check_folder(out)
    if low_pass is not None and not isfinite(low_pass):
        fail("--low-pass: give a number of Hz, such as 20")
    if measured is None:
        fail("give --measured FILE")
    from app.reports.studies.fit import doubts, files, table, told
    from model.analysis import signals
    from model.config.profile_points import FILE_LIMIT
    from model.files import read_file
    from model.study import fit as fitting
    from model.study.design import DesignError

    try:
        text = read_file(measured, FILE_LIMIT).decode("utf-8", errors="replace")
        record = fitting.read_record(text, [name.strip() for name in columns.split(",") if name.strip()])
    except OSError as error:
        fail(f"--measured {measured}: {error.strerror}")
    except DesignError as error:
        fail(f"--measured {measured}: {error}")
    point = signals.seat(base) if seat else signals.CENTRE_OF_MASS
    runs = fitting.SPREAD * len(ranges) + 15 * fitting.STARTS * (len(ranges) + 1)
    with spreading(scheduler) as everywhere, interrupt() as should_stop, counting(base.name, runs) as count:

        def spread(work: Callable[[Any], Any], items: Iterable[Any]) -> Iterator[Any]:
            for found in everywhere(work, items):
                count()
                if should_stop():
                    fail("Interrupted: nothing was written.", CANCELLED)
                yield found

        try:
            found = fitting.fit(base, record, ranges, low_pass, point, seed, spread)
        except DesignError as error:
            fail(str(error))
    for doubt in doubts(found, ranges):
        say(doubt, style="yellow")
    print_table(table(found, ranges))
    output.print(told(found), markup=False, soft_wrap=True)
    with writing(out):
        out.mkdir(parents=True, exist_ok=True)
    write_results(out, files(found, base, ranges, measured.name))
