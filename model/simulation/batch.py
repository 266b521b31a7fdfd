"""Many runs at once, on all cores: the kernel frees the GIL, so that threads of one process suffice."""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from typing import TypeVar

from model.config.config import Config
from model.dynamics.equilibrium import NoEquilibriumError
from model.simulation.simulate import simulate, warm_up
from model.simulation.trajectory import Trajectory

A = TypeVar("A")
T = TypeVar("T")
AHEAD = 4  # runs a worker may be ahead of what has been taken, so that memory stays bounded


def simulate_many(
    configs: Iterable[Config], read: Callable[[Trajectory], T], workers: int | None = None
) -> Iterator[T | NoEquilibriumError]:
    """What `read` makes of each configuration's run, in their order; of a vehicle that cannot rest, the error.

    `read` runs beside the simulations and should keep figures, not the run: a run of 10 s holds about 4 MB.
    workers: as many runs at a time; left out, one for each core.
    """

    def one(config: Config) -> T | NoEquilibriumError:
        try:
            return read(simulate(config))
        except NoEquilibriumError as error:
            return error

    def warmed() -> Iterator[Config]:
        for config in configs:
            warm_up(config.simulation.integrator)  # compiled once, not by each worker
            yield config

    return in_order(one, warmed(), workers)


def in_order(work: Callable[[A], T], items: Iterable[A], workers: int | None = None) -> Generator[T, None, None]:
    """What `work`, which simulates, makes of each item, in their order; items are taken as they are needed.

    workers: as many items at a time; left out, one for each core. What waits is given up when the iterator is closed.
    """
    workers = workers or os.cpu_count() or 1
    waiting: deque[Future[T]] = deque()
    with ThreadPoolExecutor(workers, thread_name_prefix="trackride-study") as pool:
        try:
            for item in items:
                waiting.append(pool.submit(work, item))
                if len(waiting) > workers * AHEAD:
                    yield waiting.popleft().result()
            while waiting:
                yield waiting.popleft().result()
        finally:
            for future in waiting:
                future.cancel()
