"""What the commands that analyse have in common: runs that are remembered, and a folder of results."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from app.commands.common import CANCELLED, check_folder, counting, fail, interrupt, output, writing

if TYPE_CHECKING:
    from model.study.memory import Memory
    from model.study.running import Spread

RUNS = "runs.jsonl"  # the runs that were done, in the folder

FolderOption = Annotated[Path, typer.Option(help="Folder to write into; it is made if it is not there.")]
ResumeOption = Annotated[bool, typer.Option("--resume", help="Do not repeat the runs that the folder has.")]
OverOption = Annotated[
    list[str], typer.Option("--over", metavar="KEY=LO:HI", help="Change a key within a range; may be repeated.")
]
SchedulerOption = Annotated[
    str | None, typer.Option(metavar="ADDRESS", help="Run on this dask cluster, such as tcp://10.0.0.5:8786.")
]


@contextmanager
def spreading(scheduler: str | None) -> Iterator[Spread]:
    """Runs on all cores here, or on a cluster; leaves when that cannot be reached.

    Before Ctrl+C is noted: a compiler heeds it in no other way.
    """
    from model.simulation.batch import in_order
    from model.simulation.simulate import warm_up

    warm_up()
    if scheduler is None:
        yield in_order
        return
    from model.study.cluster import on_cluster
    from model.study.design import DesignError

    with ExitStack() as stack:
        try:
            spread = stack.enter_context(on_cluster(scheduler))
        except DesignError as error:
            fail(f"--scheduler {error}")
        yield spread


@contextmanager
def remembered(name: str, folder: Path, resume: bool, total: int, scheduler: str | None) -> Iterator[Memory]:
    """Does an analysis's runs, about `total`, with a progress bar; leaves with what is wrong, or on Ctrl+C.

    Runs that were done are kept whatever ends it. A folder that was made for nothing is taken away again.
    """
    check_folder(folder)
    from model.study.design import DesignError
    from model.study.memory import Memory, StoppedError, part_of

    part = part_of(folder / RUNS)
    if not resume and part.exists() and part.stat().st_size:
        fail(f"{part}: holds the runs of a study that was stopped; go on with --resume, or delete it")
    made = [each for each in (folder, *folder.parents) if not each.exists()]
    with spreading(scheduler) as spread, writing(folder), interrupt() as should_stop, counting(name, total) as count:
        folder.mkdir(parents=True, exist_ok=True)
        try:
            memory = Memory(folder / RUNS, version("trackride"), resume, count, should_stop, spread)
        except DesignError as error:
            fail(str(error))
        try:
            yield memory
            memory.finish()
        except StoppedError:
            fail(f"Interrupted: what was done is kept in {part}; go on with --resume.", CANCELLED)
        except DesignError as error:
            kept = f"\nThe runs are kept in {part}: --resume does not repeat them." if memory.known else ""
            fail(f"{error}{kept}")
        finally:
            memory.close()
            if not memory.known:
                with suppress(OSError):  # of one that holds other files
                    for each in made:
                        each.rmdir()


def write_results(folder: Path, files: Mapping[str, bytes]) -> None:
    """Write the results of an analysis and say where they are."""
    from model.files import write_whole

    with writing(folder):
        for name, content in files.items():
            (folder / name).parent.mkdir(exist_ok=True)
            write_whole(folder / name, content)
    others = ", ".join(dict.fromkeys(name.partition("/")[0] for name in files if name != "index.html"))
    output.print(f"The page is {folder / 'index.html'}; beside it: {others}.", markup=False, soft_wrap=True)
