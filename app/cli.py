"""The commands of `trackride`: explore, run, show.

The model and the viewer are imported inside the commands, so that `--help` answers at once.
"""

from __future__ import annotations

import signal
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib import metadata
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NoReturn

import typer
from rich.console import Console
from rich.table import Table

if TYPE_CHECKING:
    from model.config import Config
    from model.ride import Summary
    from model.trajectory import Trajectory

BAD_INPUT, DIVERGED, CANCELLED = 2, 3, 130  # exit status
OUT_SUFFIXES = (".npz", ".csv")

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
    """Entry point of the `trackride` command."""
    cli(prog_name="trackride")


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
) -> None:
    """Serve the explorer and open it in a browser."""
    start = _configuration(config, changes)
    from app.server import serve

    serve(start, Path(config).name, host=host, port=port, open_browser=browser)


@cli.command(epilog="Example: trackride run paper --set drive.speed_kmh=25 --out run.npz")
def run(
    config: ConfigArgument = "paper",
    changes: SetOption = None,
    out: Annotated[Path | None, typer.Option(help="Where to write the run: a name ending in .npz or .csv.")] = None,
) -> None:
    """Run a configuration without a browser, and print its figures.

    Exit status: 0 done; 2 bad input, nothing written; 3 diverged and 130 interrupted, the good part written.
    """
    chosen = _configuration(config, changes)
    if out is not None:
        _check_writable(out)
    from model import simulate
    from model.equilibrium import NoEquilibriumError

    try:
        with _progress(chosen.name) as on_progress, _interrupt() as should_stop:
            trajectory = simulate(chosen, on_progress, should_stop)
    except NoEquilibriumError as error:
        _fail(str(error))
    if out is not None:
        try:
            trajectory.save(out)
        except OSError as error:
            _fail(f"cannot write {out}: {error.strerror}", status=1)
    _report(trajectory)
    if not trajectory.complete:
        _say_how_it_ended(trajectory, out)
        raise typer.Exit(CANCELLED if trajectory.status == "cancelled" else DIVERGED)


@cli.command(epilog="Example: trackride show paper --set road.amplitude=0.05 > mine.yaml")
def show(config: ConfigArgument = "paper", changes: SetOption = None) -> None:
    """Print the whole of a configuration, defaults included, as YAML."""
    chosen = _configuration(config, changes)
    from model.config import dump_config

    sys.stdout.write(dump_config(chosen))


def _say(message: str, style: str = "") -> None:
    errors.print(message, markup=False, style=style, soft_wrap=True)


def _fail(message: str, status: int = BAD_INPUT) -> NoReturn:
    """Say what is wrong and leave."""
    _say(message, style="red")
    raise typer.Exit(status)


def _configuration(source: str, changes: list[str] | None) -> Config:
    """The configuration with the values of --set; leaves with all faults printed when there are any."""
    from model.config import ConfigError, load_config, parse_value, read_profile
    from model.parameters import PARAMETER

    faults, values = [], {}
    for change in changes or []:
        key, equals, text = (part.strip() for part in change.partition("="))
        if not equals:
            faults.append(f"--set {change}: give KEY=VALUE, such as drive.speed_kmh=25")
            continue
        is_text = key in PARAMETER and PARAMETER[key].kind == "text"
        try:
            values[key] = text if is_text else parse_value(text)
        except ConfigError as error:
            faults.append(f"--set {change}: {error}")
    try:
        if values.get("road.file") and "road.points" not in values:
            values |= read_profile(values["road.file"])
        config = load_config(source).replace(values)
    except ConfigError as error:
        faults.append(str(error))
    if faults:
        _fail("\n".join(faults))
    return config


def _check_writable(out: Path) -> None:
    """Leave when the run could not be written there: better now than after computing."""
    if out.suffix not in OUT_SUFFIXES:
        _fail(f"--out {out}: the name must end in {' or '.join(OUT_SUFFIXES)}")
    if out.is_dir():
        _fail(f"--out {out}: is a folder; give the name of a file")
    try:
        with tempfile.TemporaryFile(dir=out.parent):
            pass
    except OSError as error:
        _fail(f"--out {out}: cannot write into the folder {out.parent}: {error.strerror}")


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
    """Ctrl+C asks for an end between chunks, so that the good part can be kept; a second one ends at once."""
    asked = False

    def ask(number: int, frame: object) -> None:
        nonlocal asked
        asked = True
        signal.signal(signal.SIGINT, before)

    before = signal.signal(signal.SIGINT, ask)
    try:
        yield lambda: asked
    finally:
        signal.signal(signal.SIGINT, before)


def _report(trajectory: Trajectory) -> None:
    from model.ride import summary, warnings

    figures = summary(trajectory)
    output.print(_load_table(figures))
    output.print(_figure_table(trajectory, figures))
    for warning in warnings(trajectory):
        _say(f"Warning: {warning}", style="yellow")


def _load_table(figures: Summary) -> Table:
    table = Table("Wheel", title="Normal load, N", title_justify="left")
    for heading in ("min", "mean", "max"):
        table.add_column(heading, justify="right")
    for name, *loads in zip(figures.names, figures.load_min, figures.load_mean, figures.load_max, strict=True):
        table.add_row(name, *(f"{load:.0f}" for load in loads))
    return table


def _figure_table(trajectory: Trajectory, figures: Summary) -> Table:
    work = trajectory.statistics
    table = Table(show_header=False, box=None, pad_edge=False)
    for what, value in (
        ("Vertical acceleration of the hull, rms", f"{figures.acceleration_rms:.4g} m/s²"),
        ("Vertical acceleration of the hull, peak", f"{figures.acceleration_peak:.4g} m/s²"),
        ("Weighted acceleration at the seat", f"{figures.seat.total:.4g} m/s², {figures.seat.reaction}"),
        ("Absorbed power at the seat", f"{figures.seat.absorbed_power:.3g} W"),
        ("Mean share of imaginary wheels in the load", f"{100 * figures.imaginary_share:.1f} %"),
        ("Constraint drift, largest", f"{1e6 * figures.drift:.3g} µm"),
        ("Steps (rejected)", f"{work.steps} ({work.rejected_steps})"),
        ("Simulated time", f"{trajectory.t[-1]:g} s"),
        ("Time taken", f"{work.seconds:.3f} s"),
        ("Real-time factor", f"{figures.real_time_factor:.3g}"),
    ):
        table.add_row(what, value)
    return table


def _say_how_it_ended(trajectory: Trajectory, out: Path | None) -> None:
    _say(f"The run ended early: {trajectory.status}.", style="red")
    if trajectory.advice:
        _say(trajectory.advice)
    if out is not None:
        _say(f"The good part, up to t = {trajectory.t[-1]:g} s, is in {out}.")
