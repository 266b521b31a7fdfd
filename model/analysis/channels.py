"""The table of a run as CSV, with the columns that are asked for."""

from __future__ import annotations

from collections.abc import Callable, Collection
from typing import NamedTuple

from model.analysis.ride import suspension_travel
from model.analysis.signals import point_acceleration, seat
from model.simulation.trajectory import (
    Columns,
    Trajectory,
    csv_bytes,
    load_columns,
    motion_columns,
    traction_columns,
    wheel_names,
)


class Channel(NamedTuple):
    """Columns that go together."""

    label: str
    what: str  # they are
    columns: Callable[[Trajectory], Columns]


def run_csv(run: Trajectory, channels: Collection[str]) -> bytes:
    """A row a sample: the time, then the columns of these CHANNELS, in their order. The run needs a sample.

    With USUAL it is the file that Trajectory.save writes. Raises ValueError for a name that is no channel.
    """
    unknown = [name for name in channels if name not in CHANNELS]
    if unknown:
        raise ValueError(f"{unknown[0]!r} is no channel; give some of {', '.join(CHANNELS)}")
    columns: Columns = {"t [s]": run.t}
    for name, channel in CHANNELS.items():
        if name in channels:
            columns |= channel.columns(run)
    return csv_bytes(columns)


def _travel(run: Trajectory) -> Columns:
    travel = suspension_travel(run)
    return {f"travel {name} [m]": travel[:, k] for k, name in enumerate(wheel_names(run.system)[: run.system.n])}


def _seat(run: Trajectory) -> Columns:
    forward, up = point_acceleration(run, seat(run.config)).T
    return {"seat forward acceleration [m/s2]": forward, "seat vertical acceleration [m/s2]": up}


def _arms(run: Trajectory) -> Columns:
    system = run.system
    angles = run.q[:, system.spring_j[: system.n], 2] - run.q[:, [system.chassis], 2]
    return {f"arm angle {name} [rad]": angles[:, k] for k, name in enumerate(wheel_names(system)[: system.n])}


CHANNELS = {
    "motion": Channel("Motion", "Of the hull: place, pitch, speed, vertical acceleration; drive force", motion_columns),
    "loads": Channel("Loads", "Normal load of each wheel", load_columns),
    "traction": Channel("Traction", "Force of each wheel along the road", traction_columns),
    "travel": Channel("Travel", "Rise of each road wheel in the hull, from the pose at rest", _travel),
    "seat": Channel("Seat", "Acceleration at the driver's seat, forward and up", _seat),
    "arms": Channel("Arm angles", "Of each road arm in the hull, from the design pose, counter-clockwise", _arms),
}
USUAL = ("motion", "loads", "traction")
