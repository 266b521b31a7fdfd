"""The commands of `trackride`: explore, run, show, report, paper; those of studies are in app/commands.

The model and the viewer are imported inside the commands, so that `--help` answers at once.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from importlib import metadata
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.table import Table

from app.commands.common import (
    CANCELLED,
    DIVERGED,
    ConfigArgument,
    SetOption,
    check_folder,
    check_writable,
    compile_for,
    configuration,
    ending_soon,
    fail,
    interrupt,
    output,
    progress,
    say,
    simulated,
    writing,
)
from app.commands.fit import fit
from app.commands.limits import limits
from app.commands.optimise import optimise
from app.commands.sensitivity import sensitivity
from app.commands.sweep import sweep

if TYPE_CHECKING:
    from model.analysis.ride import Summary
    from model.simulation.trajectory import Trajectory

CHANNELS_HELP = "Columns of a .csv, some of motion,loads,traction,travel,seat,arms; the first three if left out."
RUN_SUFFIXES, PAGE_SUFFIXES = (".npz", ".csv"), (".html",)

cli = typer.Typer(
    help="Explorer for the ride dynamics of tracked vehicles.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def main() -> None:
    """Do what the command line says."""
    try:
        cli(prog_name="trackride")
    except OSError as error:  # of standard output: what writes files says so itself
        say(f"cannot go on: {error.strerror or error}", style="red")
        sys.exit(1)


def _print_version(wanted: bool) -> None:
    if wanted:
        try:
            output.print(f"trackride {metadata.version('trackride')}")
        except metadata.PackageNotFoundError:
            output.print("trackride, not installed")
        raise typer.Exit


for study in (sweep, sensitivity, limits, optimise, fit):
    cli.command(epilog=sys.modules[study.__module__].EXAMPLE)(study)


@cli.callback()
def common(
    version: Annotated[
        bool, typer.Option("--version", help="Print the version and leave.", is_eager=True, callback=_print_version)
    ] = False,
) -> None:
    pass


@cli.command(epilog="Example: trackride explore half_round --set drive.speed_kmh=25 --port 8090")
def explore(
    config: ConfigArgument = "paper",
    changes: SetOption = None,
    host: Annotated[str, typer.Option(help="Address to listen on.")] = "127.0.0.1",
    port: Annotated[
        int, typer.Option(min=0, max=65535, help="Port to listen on; the next free one if it is taken.")
    ] = 8080,
    browser: Annotated[bool, typer.Option("--browser/--no-browser", help="Open the page in a browser.")] = True,
    max_tabs: Annotated[int, typer.Option(min=1, help="Tabs that may be open at a time.")] = 20,
    allow_origin: Annotated[
        list[str] | None,
        typer.Option(metavar="ORIGIN", help="Let the page of a proxy connect, such as https://ride.example.org."),
    ] = None,
    no_token: Annotated[
        bool, typer.Option("--no-token", help="Let other machines in without a token in the address.")
    ] = False,
) -> None:
    """Serve the explorer and open it in a browser.

    With --host, other machines can open it too: with the token in the address that is printed.
    """
    start = configuration(config, changes)
    from app.server import serve

    with ending_soon():
        serve(
            start,
            Path(config).name,
            host=host,
            port=port,
            open_browser=browser,
            max_tabs=max_tabs,
            allowed_origins=allow_origin or (),
            with_token=not no_token,
        )


@cli.command(epilog="Example: trackride run paper --set drive.speed_kmh=25 --out run.npz")
def run(
    config: ConfigArgument = "paper",
    changes: SetOption = None,
    out: Annotated[Path | None, typer.Option(help="Where to write the run: a name ending in .npz or .csv.")] = None,
    channels: Annotated[str | None, typer.Option(help=CHANNELS_HELP)] = None,
) -> None:
    """Run a configuration without a browser, and print its figures.

    Exit status: 0 done; 2 bad input, nothing written; 3 diverged or inaccurate and 130 interrupted, the good part
    written. A second Ctrl+C ends at once, and nothing is written.
    """
    chosen = configuration(config, changes)
    if out is not None:
        check_writable(out, RUN_SUFFIXES)
    columns = _channels(channels, out)
    compile_for(chosen)
    from model.analysis.channels import run_csv
    from model.files import write_whole

    with interrupt() as interrupted:
        trajectory = simulated(chosen, interrupted)
        if out is not None:
            with writing(out):
                if columns:
                    write_whole(out, run_csv(trajectory, columns))
                else:
                    trajectory.save(out)
    _report(trajectory)
    _leave_unless_complete(trajectory, out, interrupted())


@cli.command(epilog="Example: trackride show paper --set road.amplitude=0.05 > mine.yaml")
def show(config: ConfigArgument = "paper", changes: SetOption = None) -> None:
    """Print the whole of a configuration, defaults included, as YAML."""
    chosen = configuration(config, changes)
    from model.config.config_files import dump_config

    sys.stdout.write(dump_config(chosen))
    sys.stdout.flush()


@cli.command(epilog="Example: trackride report half_round --set drive.speed_kmh=25 --out report.html")
def report(
    config: ConfigArgument = "paper",
    changes: SetOption = None,
    out: Annotated[Path, typer.Option(help="Where to write the page: a name ending in .html.")] = Path("report.html"),
) -> None:
    """Run a configuration and write a report: one page to read, print and pass on.

    Exit status: 0 done; 2 bad input, nothing written; 3 diverged or inaccurate and 130 interrupted, the good part
    reported.
    """
    chosen = configuration(config, changes)
    check_writable(out, PAGE_SUFFIXES)
    compile_for(chosen)
    from app.reports.run_report import report_page
    from model.files import write_whole

    with interrupt() as interrupted:
        trajectory = simulated(chosen, interrupted)
        page = report_page(trajectory, config).encode()
        with writing(out):
            write_whole(out, page)
    _leave_unless_complete(trajectory, out, interrupted())
    output.print(f"The report is in {out}.", markup=False, soft_wrap=True)


@cli.command(epilog="Example: trackride paper --out build/paper")
def paper(
    out: Annotated[Path, typer.Option(help="Folder to write into; it is made if it is not there.")],
) -> None:
    """Repeat what the paper ran: its figures, its statements one by one, and what our assumptions do to them.

    Then lay the M113 on imaginary wheels beside runs of a track of links, and seek the wheels that come nearest.

    Exit status: 0 done; 2 bad folder, 3 a run diverged or was inaccurate, 130 interrupted: nothing written.
    """
    check_folder(out)
    from app.reports.paper.links import record_texts
    from app.reports.paper.page import paper_files
    from model.config.config_files import load_config
    from model.files import write_whole
    from model.paper.links import study_links
    from model.paper.study import StudyError, study_paper

    compile_for(load_config("paper"))
    with interrupt() as interrupted:

        def go_on(part: float, on_progress: Callable[[float], None] | None = None) -> None:
            if on_progress is not None:
                on_progress(part)
            if interrupted():
                fail("Interrupted: nothing was written.", CANCELLED)

        try:
            with progress("The paper's runs") as on_progress:
                study = study_paper(lambda part: go_on(part / 2, on_progress))
                links = study_links(record_texts(), lambda part: go_on((1 + part) / 2, on_progress))
        except StudyError as error:
            fail(str(error), DIVERGED)
        files = paper_files(study, links)
        go_on(1.0)
        with writing(out):
            out.mkdir(parents=True, exist_ok=True)
            for name, content in files.items():
                write_whole(out / name, content)
    output.print(f"The page is {out / 'index.html'}; its figures are beside it.", markup=False, soft_wrap=True)


def _channels(text: str | None, out: Path | None) -> list[str]:
    """The columns that are asked for; none: the usual ones. Leaves where they cannot be."""
    if text is None:
        return []
    if out is None or out.suffix != ".csv":
        fail("--channels are columns of a table; give --out a name that ends in .csv")
    from model.analysis.channels import CHANNELS

    names = [name.strip() for name in text.split(",")]
    unknown = [name for name in names if name not in CHANNELS]
    if unknown:
        fail(f"--channels {text}: {unknown[0]!r} is none; give some of {','.join(CHANNELS)}")
    return names


def _report(trajectory: Trajectory) -> None:
    from model.analysis.ride import Summary
    from model.analysis.ride_warnings import warnings

    of = Summary(trajectory)
    output.print(_load_table(of))
    output.print(_figure_table(trajectory, of))
    for warning in warnings(trajectory):
        say(f"Warning: {warning}", style="yellow")


def _load_table(of: Summary) -> Table:
    table = Table("Wheel", title="Normal load, N", title_justify="left")
    for heading in ("min", "mean", "max"):
        table.add_column(heading, justify="right")
    for name, *loads in zip(of.names, of.load_min, of.load_mean, of.load_max, strict=True):
        table.add_row(name, *(f"{load:z.0f}" for load in loads))
    return table


def _figure_table(trajectory: Trajectory, of: Summary) -> Table:
    from model.analysis.figures import FIGURES, WEIGHTED, figures_by_name
    from model.analysis.signals import WHOLE

    table = Table(show_header=False, box=None, pad_edge=False)
    values = figures_by_name(of)
    for figure in FIGURES:
        value = values[figure.name]
        words = f", {of.seat.reaction}" if figure is WEIGHTED and of.seat is not None else ""
        worst = f", {'all road wheels' if figure.together else 'worst wheel'}" if figure.per_wheel else ""
        table.add_row(figure.label + worst, "–" if value is None else f"{value:z.4g} {figure.unit}{words}".rstrip())
    table.add_row("Figures taken", f"{of.window.why}; {WHOLE}")
    work = trajectory.statistics
    for what, text in (
        ("Steps (rejected)", f"{work.steps} ({work.rejected_steps})"),
        ("Simulated time", f"{trajectory.t[-1]:g} s"),
        ("Time taken", f"{work.seconds:.3f} s"),
        ("Real-time factor", f"{of.real_time_factor:.3g}"),
    ):
        table.add_row(what, text)
    return table


def _leave_unless_complete(trajectory: Trajectory, out: Path | None, interrupted: bool) -> None:
    """Say why a run is not complete, or that only what came after it was interrupted; leave with the status for it."""
    if trajectory.complete:
        if interrupted:
            fail("Interrupted when the run was complete.", CANCELLED)
        return
    say(f"The run is not complete: {trajectory.status}.", style="red")
    if trajectory.advice:
        say(trajectory.advice)
    if out is not None:
        say(f"The good part, up to t = {trajectory.t[-1]:g} s, is in {out}.")
    raise typer.Exit(CANCELLED if interrupted else DIVERGED)
