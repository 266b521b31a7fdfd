"""The commands of `trackride`: explore, run, show, report, paper.

The model and the viewer are imported inside the commands, so that `--help` answers at once.
"""

from __future__ import annotations

import os
import signal
import socket
import sys
import tempfile
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib import metadata
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NoReturn

import typer
from rich.console import Console
from rich.table import Table

if TYPE_CHECKING:
    from model.analysis.ride import Summary
    from model.config.config import Config
    from model.simulation.trajectory import Trajectory

BAD_INPUT, DIVERGED, CANCELLED = 2, 3, 130  # exit status
STOPPING = 1.5  # s that the explorer has to close its tabs after Ctrl+C
RUN_SUFFIXES, PAGE_SUFFIXES = (".npz", ".csv"), (".html",)

cli = typer.Typer(
    help="Explorer for the ride dynamics of tracked vehicles.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)
output = Console(highlight=False)
errors = Console(highlight=False, stderr=True)

ConfigArgument = Annotated[str, typer.Argument(metavar="CONFIG", help="YAML file or name of a preset.")]
SetOption = Annotated[
    list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="Change one value; may be repeated.")
]


def main() -> None:
    """Do what the command line says."""
    try:
        cli(prog_name="trackride")
    except OSError as error:  # of standard output: what writes files says so itself
        _say(f"cannot go on: {error.strerror or error}", style="red")
        sys.exit(1)


def _print_version(wanted: bool) -> None:
    if wanted:
        try:
            output.print(f"trackride {metadata.version('trackride')}")
        except metadata.PackageNotFoundError:
            output.print("trackride, not installed")
        raise typer.Exit


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
    start = _configuration(config, changes)
    from app.server import serve

    with _ending_soon():
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
) -> None:
    """Run a configuration without a browser, and print its figures.

    Exit status: 0 done; 2 bad input, nothing written; 3 diverged or inaccurate and 130 interrupted, the good part
    written. A second Ctrl+C ends at once, and nothing is written.
    """
    chosen = _configuration(config, changes)
    if out is not None:
        _check_writable(out, RUN_SUFFIXES)
    _compile(chosen)
    with _interrupt() as interrupted:
        trajectory = _simulated(chosen, interrupted)
        if out is not None:
            with _writing(out):
                trajectory.save(out)
    _report(trajectory)
    _leave_unless_complete(trajectory, out, interrupted())


@cli.command(epilog="Example: trackride show paper --set road.amplitude=0.05 > mine.yaml")
def show(config: ConfigArgument = "paper", changes: SetOption = None) -> None:
    """Print the whole of a configuration, defaults included, as YAML."""
    chosen = _configuration(config, changes)
    from model.config.config import dump_config

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
    chosen = _configuration(config, changes)
    _check_writable(out, PAGE_SUFFIXES)
    _compile(chosen)
    from app.reports.run_report import report_page
    from model.files import write_whole

    with _interrupt() as interrupted:
        trajectory = _simulated(chosen, interrupted)
        page = report_page(trajectory, config).encode()
        with _writing(out):
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
    _check_folder(out)
    from app.reports.paper.links import record_texts
    from app.reports.paper.page import paper_files
    from model.config.config import load_config
    from model.files import write_whole
    from model.paper.links import study_links
    from model.paper.study import StudyError, study_paper

    _compile(load_config("paper"))
    with _interrupt() as interrupted:

        def go_on(part: float, on_progress: Callable[[float], None] | None = None) -> None:
            if on_progress is not None:
                on_progress(part)
            if interrupted():
                _fail("Interrupted: nothing was written.", CANCELLED)

        try:
            with _progress("The paper's runs") as on_progress:
                study = study_paper(lambda part: go_on(part / 2, on_progress))
                links = study_links(record_texts(), lambda part: go_on((1 + part) / 2, on_progress))
        except StudyError as error:
            _fail(str(error), DIVERGED)
        files = paper_files(study, links)
        go_on(1.0)
        with _writing(out):
            out.mkdir(parents=True, exist_ok=True)
            for name, content in files.items():
                write_whole(out / name, content)
    output.print(f"The page is {out / 'index.html'}; its figures are beside it.", markup=False, soft_wrap=True)


def _say(message: str, style: str = "") -> None:
    errors.print(message, markup=False, style=style, soft_wrap=True)


def _fail(message: str, status: int = BAD_INPUT) -> NoReturn:
    """Say what is wrong and leave."""
    _say(message, style="red")
    raise typer.Exit(status)


def _configuration(source: str, changes: list[str] | None) -> Config:
    """The configuration with the values of --set; leaves with all faults printed when there are any."""
    from model.config.config import ConfigError, load_config, parse_value, read_profile
    from model.config.parameters import PARAMETER

    faults, values = [], {}
    for change in changes or []:
        key, equals, text = (part.strip() for part in change.partition("="))
        if not (key and equals):
            faults.append(f"--set {change}: give KEY=VALUE, such as drive.speed_kmh=25")
            continue
        is_text = key in PARAMETER and PARAMETER[key].kind == "text"
        try:
            values[key] = text if is_text else parse_value(text)
        except ConfigError as error:
            faults.append(f"--set {change}: {error}")
    reading: dict[str, Any] = {key: values[key] for key in ("road.columns", "road.units") if key in values}
    read: list[str] = []
    try:
        file = values.get("road.file")
        if file and "road.points" not in values:
            profile = read_profile(file, *(reading.get(key, ()) for key in ("road.columns", "road.units")))
            values["road.points"] = profile.points
            config = load_config(source).replace(values)
            read.append(f"{Path(file).name}: {profile.said}")
        else:
            config = load_config(source, reading, read.append).replace(values)
    except ConfigError as error:
        faults.append(str(error))
    if faults:
        _fail("\n".join(faults))
    for sentence in read:
        _say(f"{sentence}.")
    return config


def _compile(config: Config) -> None:
    """What its run needs, while Ctrl+C still ends the process at once: a compiler heeds no other way."""
    from model.simulation.simulate import warm_up

    warm_up(config.simulation.integrator)


def _simulated(config: Config, interrupted: Callable[[], bool]) -> Trajectory:
    """The run, with a progress bar, until it is interrupted."""
    from model import simulate
    from model.dynamics.equilibrium import NoEquilibriumError

    try:
        with _progress(config.name) as on_progress:
            return simulate(config, on_progress, interrupted)
    except NoEquilibriumError as error:
        _fail(str(error))


def _check_writable(out: Path, suffixes: tuple[str, ...]) -> None:
    """Leave when a file could not be written there: better now than after computing."""
    if out.suffix not in suffixes:
        _fail(f"--out {out}: the name must end in {' or '.join(suffixes)}")
    with _checking(out):
        if out.is_dir():
            _fail(f"--out {out}: is a folder; give the name of a file")
        _check_writes_into(out, out.parent)


def _check_folder(out: Path) -> None:
    """Leave when files could not be written into that folder, which need not be there yet."""
    with _checking(out):
        if out.exists() and not out.is_dir():
            _fail(f"--out {out}: is a file; give the name of a folder")
        _check_writes_into(out, next(folder for folder in (out, *out.parents) if folder.exists()))


@contextmanager
def _checking(out: Path) -> Iterator[None]:
    """Leave with a message for a name that no file can have."""
    try:
        yield
    except OSError as error:
        _fail(f"--out {out}: {error.strerror}")


def _check_writes_into(out: Path, folder: Path) -> None:
    try:
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        _fail(f"--out {out}: cannot write into the folder {folder}: {error.strerror}")


@contextmanager
def _writing(out: Path) -> Iterator[None]:
    """Leave with a message when writing fails after all."""
    try:
        yield
    except OSError as error:
        _fail(f"cannot write {out}: {error.strerror}", status=1)


@contextmanager
def _progress(name: str) -> Iterator[Callable[[float], None] | None]:
    """A progress bar on standard error while that is a terminal."""
    if not errors.is_terminal:
        yield None
        return
    from rich.markup import escape
    from rich.progress import Progress

    with Progress(console=errors, transient=True) as bar:
        task = bar.add_task(escape(name), total=1.0)
        yield lambda part: bar.update(task, completed=part)


@contextmanager
def _interrupt() -> Iterator[Callable[[], bool]]:
    """Ctrl+C is noted, so that the good part can be kept and a file finished; a second one ends at once."""
    asked = False

    def ask(number: int, frame: object) -> None:
        nonlocal asked
        asked = True
        signal.signal(signal.SIGINT, signal.default_int_handler)

    before = signal.signal(signal.SIGINT, ask)
    try:
        yield lambda: asked
    except KeyboardInterrupt:
        _fail("Interrupted.", CANCELLED)
    finally:
        signal.signal(signal.SIGINT, before)


@contextmanager
def _ending_soon() -> Iterator[None]:
    """Ctrl+C raises KeyboardInterrupt, which has a short while to end what is done here; then the process is ended.

    Code that is being loaded may lose the exception, and threads that compile are waited for.
    """
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        yield
        return
    told, tell = socket.socketpair()
    tell.setblocking(False)
    ended = threading.Event()

    def watch() -> None:
        while heard := told.recv(1):
            if signal.SIGINT in heard and not ended.wait(STOPPING):
                os._exit(0)

    threading.Thread(target=watch, name="interrupt", daemon=True).start()
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    signal.set_wakeup_fd(tell.fileno(), warn_on_full_buffer=False)  # told also while no Python code runs
    try:
        yield
    finally:
        signal.set_wakeup_fd(-1)
        signal.signal(signal.SIGINT, before)
        ended.set()
        tell.close()


def _report(trajectory: Trajectory) -> None:
    from model.analysis.ride import summary, warnings

    of = summary(trajectory)
    output.print(_load_table(of))
    output.print(_figure_table(trajectory, of))
    for warning in warnings(trajectory):
        _say(f"Warning: {warning}", style="yellow")


def _load_table(of: Summary) -> Table:
    table = Table("Wheel", title="Normal load, N", title_justify="left")
    for heading in ("min", "mean", "max"):
        table.add_column(heading, justify="right")
    for name, *loads in zip(of.names, of.load_min, of.load_mean, of.load_max, strict=True):
        table.add_row(name, *(f"{load:.0f}" for load in loads))
    return table


def _figure_table(trajectory: Trajectory, of: Summary) -> Table:
    from model.analysis.figures import AIR_TIME, FIGURES, WEIGHTED, figures_by_name
    from model.analysis.signals import WHOLE

    table = Table(show_header=False, box=None, pad_edge=False)
    values = figures_by_name(of)
    for figure in FIGURES:
        value = values[figure.name]
        words = f", {of.seat.reaction}" if figure is WEIGHTED and of.seat is not None else ""
        worst = f", {'all road wheels' if figure is AIR_TIME else 'worst wheel'}" if figure.per_wheel else ""
        table.add_row(figure.label + worst, "–" if value is None else f"{value:.4g} {figure.unit}{words}")
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
            _fail("Interrupted when the run was complete.", CANCELLED)
        return
    _say(f"The run is not complete: {trajectory.status}.", style="red")
    if trajectory.advice:
        _say(trajectory.advice)
    if out is not None:
        _say(f"The good part, up to t = {trajectory.t[-1]:g} s, is in {out}.")
    raise typer.Exit(CANCELLED if interrupted else DIVERGED)
