"""What the commands have in common: reading the configuration, progress, Ctrl+C, messages, exit status.

The model is imported inside the functions, so that `--help` answers at once.
"""

from __future__ import annotations

import os
import signal
import socket
import tempfile
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from datetime import timedelta
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING, Annotated, Any, NoReturn

import typer
from rich.console import Console

if TYPE_CHECKING:
    from rich.table import Table

    from model.config.config import Config
    from model.simulation.trajectory import Trajectory

BAD_INPUT, DIVERGED, CANCELLED = 2, 3, 130  # exit status
TELL_EVERY = 10.0  # s between lines of progress where standard error is no terminal
UNBROKEN = 200  # characters of a table's line where standard output is no terminal
STOPPING = 1.5  # s that the explorer has to close its tabs after Ctrl+C

output = Console(highlight=False)
errors = Console(highlight=False, stderr=True)

ConfigArgument = Annotated[str, typer.Argument(metavar="CONFIG", help="YAML file or name of a preset.")]
SetOption = Annotated[
    list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="Change one value; may be repeated.")
]


def print_table(table: Table) -> None:
    """A table; nothing is broken to fit where standard output is no terminal."""
    (output if output.is_terminal else Console(highlight=False, width=UNBROKEN)).print(table)


def say(message: str, style: str = "") -> None:
    errors.print(message, markup=False, style=style, soft_wrap=True)


def fail(message: str, status: int = BAD_INPUT) -> NoReturn:
    """Say what is wrong and leave."""
    say(message, style="red")
    raise typer.Exit(status)


def configuration(source: str, changes: list[str] | None) -> Config:
    """The configuration with the values of --set; leaves with all faults printed when there are any."""
    from model.config.config import ConfigError
    from model.config.config_files import load_config, parse_value, read_profile
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
        fail("\n".join(faults))
    for sentence in read:
        say(f"{sentence}.")
    return config


def compile_for(config: Config) -> None:
    """What its run needs, while Ctrl+C still ends the process at once: a compiler heeds no other way."""
    from model.simulation.simulate import warm_up

    warm_up(config.simulation.integrator)


def simulated(config: Config, interrupted: Callable[[], bool]) -> Trajectory:
    """The run, with a progress bar, until it is interrupted."""
    from model import simulate
    from model.dynamics.equilibrium import NoEquilibriumError

    try:
        with progress(config.name) as on_progress:
            return simulate(config, on_progress, interrupted)
    except NoEquilibriumError as error:
        fail(str(error))


def check_writable(out: Path, suffixes: tuple[str, ...]) -> None:
    """Leave when a file could not be written there: better now than after computing."""
    if out.suffix not in suffixes:
        fail(f"--out {out}: the name must end in {' or '.join(suffixes)}")
    with _checking(out):
        if out.is_dir():
            fail(f"--out {out}: is a folder; give the name of a file")
        _check_writes_into(out, out.parent)


def check_folder(out: Path, option: str = "--out") -> None:
    """Leave when files could not be written into that folder, which need not be there yet."""
    with _checking(out, option):
        if out.exists() and not out.is_dir():
            fail(f"{option} {out}: is a file; give the name of a folder")
        _check_writes_into(out, next(folder for folder in (out, *out.parents) if folder.exists()), option)


@contextmanager
def _checking(out: Path, option: str = "--out") -> Iterator[None]:
    """Leave with a message for a name that no file can have."""
    try:
        yield
    except OSError as error:
        fail(f"{option} {out}: {error.strerror}")


def _check_writes_into(out: Path, folder: Path, option: str = "--out") -> None:
    try:
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        refused = isinstance(error, FileNotFoundError) and folder.exists()  # what is missing is the file to be made
        reason = "the system lets nobody make files there" if refused else error.strerror
        fail(f"{option} {out}: cannot write into the folder {folder}: {reason}")


@contextmanager
def writing(out: Path) -> Iterator[None]:
    """Leave with a message when writing fails after all."""
    try:
        yield
    except OSError as error:
        fail(f"cannot write {out}: {error.strerror}", status=1)


@contextmanager
def progress(name: str) -> Iterator[Callable[[float], None] | None]:
    """A progress bar on standard error; a line now and then where that is no terminal."""
    if not errors.is_terminal:
        due = _now_and_then()

        def tell(part: float) -> None:
            if due():
                say(f"{name}: {100 * part:.0f} %")

        yield tell
        return
    from rich.markup import escape
    from rich.progress import Progress

    with Progress(console=errors, transient=True) as bar:
        task = bar.add_task(escape(name), total=1.0)
        yield lambda part: bar.update(task, completed=part)


@contextmanager
def counting(name: str, total: int, done: int = 0) -> Iterator[Callable[[], None]]:
    """The same for about so many runs, with their rate and the time left; called after each."""
    if not errors.is_terminal:
        yield _counting_in_lines(name, total, done)
        return
    from rich.markup import escape
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        Progress,
        ProgressColumn,
        Task,
        TextColumn,
        TimeRemainingColumn,
    )
    from rich.text import Text

    class Rate(ProgressColumn):
        def render(self, task: Task) -> Text:
            return Text(f"{task.speed:.3g} runs/s" if task.speed else "")

    parts = TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), Rate(), TimeRemainingColumn()
    with Progress(*parts, console=errors, transient=True) as bar:
        task = bar.add_task(escape(name), total=total, completed=done)
        yield lambda: bar.advance(task)


def _counting_in_lines(name: str, total: int, done: int) -> Callable[[], None]:
    """Called after each run."""
    due, began, before = _now_and_then(), monotonic(), done

    def count() -> None:
        nonlocal done
        done += 1
        if due():
            rate = (done - before) / max(monotonic() - began, 1e-9)
            left = timedelta(seconds=round(max(total - done, 0) / rate))
            say(f"{name}: {done} of {max(total, done)} runs, {rate:.3g} runs/s, {left} left")

    return count


def _now_and_then() -> Callable[[], bool]:
    """Whether TELL_EVERY has passed since it last had."""
    last = monotonic()

    def due() -> bool:
        nonlocal last
        if monotonic() - last < TELL_EVERY:
            return False
        last = monotonic()
        return True

    return due


@contextmanager
def interrupt() -> Iterator[Callable[[], bool]]:
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
        fail("Interrupted.", CANCELLED)
    finally:
        signal.signal(signal.SIGINT, before)


@contextmanager
def ending_soon() -> Iterator[None]:
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
