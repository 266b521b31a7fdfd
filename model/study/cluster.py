"""The runs of a study on a dask cluster: blocks of some hundred as one task, results to the last digit as here.

A worker computes as many blocks at a time as it has threads. What a worker that dies was computing is given to another.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator, Sized
from contextlib import contextmanager
from functools import partial
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING, Any

from model.study.design import DesignError
from model.study.running import Spread, blocks

if TYPE_CHECKING:
    from distributed import Client

BLOCK = 200  # runs in a task, at most: some seconds
BLOCKS_EACH = 4  # for each thread, where there are few runs: so that all are busy until the end
AHEAD = 2  # blocks that wait for each thread
PATIENCE = 10.0  # s for an answer of the scheduler


@contextmanager
def on_cluster(address: str) -> Iterator[Spread]:
    """Work on the cluster with this scheduler, tcp://…; raises DesignError where that cannot be."""
    try:
        from distributed import Client
    except ImportError:
        raise DesignError("a cluster needs dask: pip install 'trackride[cluster]'") from None
    try:
        client = Client(address, timeout=PATIENCE, set_as_default=False)
    except (OSError, ValueError, TimeoutError) as error:
        raise DesignError(f"{address}: no scheduler answers there ({error}); start one with: dask scheduler") from None
    with client:
        if not client.nthreads():
            raise DesignError(f"{address}: the scheduler has no workers; start some with: dask worker {address}")
        _check_workers(client)
        yield partial(_spread, client)


def _check_workers(client: Client) -> None:
    """Raises DesignError for workers that would compute something else."""
    mine = fingerprint()
    try:
        other = [worker for worker, theirs in client.run(fingerprint).items() if theirs != mine]
    except ImportError:
        raise DesignError("the workers have no Trackride: install the same one there") from None
    if other:
        raise DesignError(f"the worker {other[0]} has another version of Trackride: install the same one there")


def fingerprint() -> str:
    """Of all files of the model."""
    package = Path(__file__).parents[1]
    files = sorted(package.rglob("*.py"), key=lambda file: file.relative_to(package).as_posix())
    return sha256(b"".join(file.read_bytes() for file in files)).hexdigest()


def _spread(client: Client, work: Callable[[Any], Any], items: Iterable[Any]) -> Generator[Any, None, None]:
    """What the cluster makes of each item, in their order."""
    threads = max(sum(client.nthreads().values()), 1)
    size = BLOCK
    if isinstance(items, Sized):
        size = min(max(len(items) // (BLOCKS_EACH * threads), 1), BLOCK)
    waiting: deque[Any] = deque()
    try:
        for block in blocks(items, size):
            waiting.append(client.submit(_block, work, block, pure=False))
            while len(waiting) > 1 + AHEAD * max(sum(client.nthreads().values()), 1):
                yield from waiting.popleft().result()
        while waiting:
            yield from waiting.popleft().result()
    finally:
        client.cancel(list(waiting))


def _block(work: Callable[[Any], Any], items: list[Any]) -> list[Any]:
    return [work(item) for item in items]
