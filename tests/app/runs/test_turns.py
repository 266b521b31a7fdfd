"""Many tabs at once: a few work, the others wait in their order, and nobody waits for ever."""

from __future__ import annotations

import threading

from app.runs.turns import Turns
from tests.app.conftest import PATIENCE, wait_for


class Worker(threading.Thread):
    """Has a turn until it may leave."""

    def __init__(self, turns: Turns, order: list[str], name: str) -> None:
        super().__init__(name=name, daemon=True)
        self._turns, self._order = turns, order
        self.may_leave, self.passes_on = threading.Event(), threading.Event()
        self.start()

    def run(self) -> None:
        with self._turns.turn():
            self._order.append(self.name)
            assert self.may_leave.wait(PATIENCE)
            if self.passes_on.is_set():
                self._turns.pass_on()
                self._order.append(f"{self.name} again")


def queue(turns: Turns, order: list[str], names: str) -> dict[str, Worker]:
    """Workers that came one after the other."""
    workers = {}
    for count, name in enumerate(names, len(order)):
        workers[name] = Worker(turns, order, name)
        wait_for(lambda count=count: len(order) + len(turns._waiting) > count, "its place or its place in the queue")
    return workers


def test_those_who_wait_come_in_their_order() -> None:
    turns, order = Turns(2, longest_wait=PATIENCE), []
    workers = queue(turns, order, "abcde")
    assert sorted(order) == ["a", "b"]
    for name, then in (("b", "c"), ("a", "d"), ("c", "e")):
        workers[name].may_leave.set()
        wait_for(lambda then=then: order[-1] == then, then)
        assert len(order) == 2 + "cde".index(then) + 1
    for worker in workers.values():
        worker.may_leave.set()
        worker.join(PATIENCE)
    assert turns._free == 2


def test_who_passes_on_comes_after_those_who_wait() -> None:
    turns, order = Turns(1, longest_wait=PATIENCE), []
    workers = queue(turns, order, "abc")
    workers["a"].passes_on.set()
    for name in "abc":
        workers[name].may_leave.set()
    for worker in workers.values():
        worker.join(PATIENCE)
    assert order == ["a", "b", "c", "a again"]


def test_one_who_takes_long_does_not_stop_the_others() -> None:
    turns, order = Turns(1, longest_wait=0.05), []
    workers = queue(turns, order, "a")
    late = Worker(turns, order, "b")
    wait_for(lambda: order == ["a", "b"], "the one who has waited enough")
    for worker in (workers["a"], late):
        worker.may_leave.set()
        worker.join(PATIENCE)
    assert turns._free == 1


def test_a_turn_ends_with_an_error_too() -> None:
    turns = Turns(1)
    try:
        with turns.turn():
            raise ValueError
    except ValueError:
        pass
    assert turns._free == 1
