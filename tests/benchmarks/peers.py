"""MuJoCo and Exudyn on the paper's vehicle and road: how long they take next to us, and how near their loads come.

`python -m tests.benchmarks.peers`, or within `make bench`. All pull the hull along at constant speed, the drive that
each of them has of its own. Our time is that of the whole run, from the configuration to all samples; a peer's is that
of its steps alone, its model set up before and nothing recorded.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib.metadata import version
from importlib.util import find_spec
from statistics import median
from time import perf_counter

import numpy as np

from model import load_config, simulate
from model.simulation.trajectory import Trajectory
from tests.benchmarks.peer_exudyn import ExudynPeer
from tests.benchmarks.peer_mujoco import MujocoPeer
from tests.benchmarks.peer_task import Peer, Task, task_of

ROUNDS = 5
OWN_RUNS = 5  # before each run of a peer
PEERS: tuple[tuple[str, str, float, Callable[[Task], Peer]], ...] = (  # name, package, step in s, how to set it up
    ("MuJoCo {}", "mujoco", 1e-3, MujocoPeer),
    ("MuJoCo {}", "mujoco", 5e-3, MujocoPeer),
    ("Exudyn {} as it comes", "exudyn", 1e-3, lambda task: ExudynPeer(task, tuned=False)),
    ("Exudyn {} tuned", "exudyn", 1e-3, lambda task: ExudynPeer(task, tuned=True)),
    ("Exudyn {} tuned", "exudyn", 2.5e-3, lambda task: ExudynPeer(task, tuned=True)),
)  # the longer steps: of 2.5, 5 and 10 ms the longest at which the loads are still about as near to ours


def measure() -> dict[str, tuple[float, str]]:
    """Name -> figure and its unit; none of a peer that is not installed."""
    for package in sorted({package for _, package, _, _ in PEERS if not find_spec(package)}):
        print(f"{package} is left out, it is not installed: pip install -e .[peers]")
    there = [peer for peer in PEERS if find_spec(peer[1])]
    if not there:
        return {}
    config = load_config("paper").replace({"drive.mode": "prescribed"})
    ours = simulate(config)
    peers = {
        f"{name.format(version(package))}, steps of {1e3 * step:g} ms": set_up(task_of(ours, step))
        for name, package, step, set_up in there
    }
    own: list[float] = []  # s
    times: dict[str, list[float]] = {name: [] for name in peers}  # s
    ratios: dict[str, list[float]] = {name: [] for name in peers}
    for _ in range(ROUNDS):
        for name, peer in peers.items():
            runs = [simulate(config).statistics.seconds for _ in range(OWN_RUNS)]
            began = perf_counter()
            peer.run()
            times[name].append(perf_counter() - began)
            ratios[name].append(times[name][-1] / median(runs))
            own += runs
    figures = {"paper's 10 s, hull pulled": (1e3 * median(own), "ms")}
    for name, peer in peers.items():
        figures[f"the same, {name}"] = (1e3 * median(times[name]), "ms")
        figures[f"faster than {name}"] = (median(ratios[name]), "times")
        figures[f"loads apart from ours, {name}"] = (_apart(peer.loads(), ours), "% of the peak")
    return figures


def _apart(loads: np.ndarray, ours: Trajectory) -> float:
    """How far a peer's loads (N, W) are from ours: rms of the worst wheel, % of our peak."""
    off = np.sqrt(np.mean((loads - ours.normal_load) ** 2, axis=0)).max()
    return 100 * float(off / ours.normal_load.max())


if __name__ == "__main__":
    for what, (value, unit) in measure().items():
        print(f"{what}: {value:.4g} {unit}")
