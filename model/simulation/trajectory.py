"""What happened in a run: the arrays of the result file, with the configuration that made them."""

from __future__ import annotations

import csv
from dataclasses import asdict, dataclass, fields
from functools import cached_property
from io import BytesIO, StringIO
from math import prod
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

import numpy as np

from model.config.config import Config
from model.config.config_files import SIZE_LIMIT, dump_config, parse_config
from model.dynamics.vehicle import System, build_system, kinetic_energy
from model.files import open_file, write_whole
from model.simulation.npz import Npz, NpzError
from model.simulation.peaks import PEAK_NAMES, Peaks, sampled_peaks

if TYPE_CHECKING:
    from model.road.road import Road

FASTEST = 100.0  # m/s: no run comes further in its time; a file's numbers may be anything
LONGEST_TEXT = 300  # characters of a file's status and advice

Columns = dict[str, np.ndarray]  # heading with its unit in brackets -> (N,)


@dataclass(frozen=True)
class RunStatistics:
    """How much work a run was."""

    steps: int
    rejected_steps: int
    evaluations: int  # of the right-hand side
    smallest_step: float  # s
    seconds: float  # wall-clock time of the whole run, s


@dataclass(frozen=True, kw_only=True)
class Motion:
    """What the figures of a run are read off. N samples, B bodies, W wheels (road 1…n, then imaginary); SI, radians,
    world frame.
    """

    t: np.ndarray  # (N,) s
    q: np.ndarray  # (N, B, 3) x, y, θ of every centre of mass
    v: np.ndarray  # (N, B, 3) their rates
    a: np.ndarray  # (N, B, 3) their accelerations; of the chassis alone, (N, 1, 3), where no more was asked for
    normal_load: np.ndarray  # (N, W) f_n, N
    constraint_residual: np.ndarray  # (N,) max |C(q)|, m
    static_load: np.ndarray  # (W,) f_n at the static equilibrium, N
    config: Config
    status: str  # complete | cancelled | diverged at t = …: reason | inaccurate at t = …: joints | inaccurate: energy
    advice: str  # what to try when it is not complete, else empty
    statistics: RunStatistics
    work: np.ndarray | None = None  # (N,) J, done by all forces but weight and joints since the start; None: not known
    tracked: Peaks | None = None  # by the integration; None: it was not

    @cached_property
    def system(self) -> System:
        """The vehicle of this run."""
        return build_system(self.config)

    @cached_property
    def peaks(self) -> Peaks:
        """What was largest: as the integration found it, or else at the samples."""
        return self.tracked or sampled_peaks(self.system, self.t, self.q, self.a, self.normal_load)

    @cached_property
    def energy_error(self) -> float | None:
        """Energy that is not accounted for, as a share of what was turned over; None where the work is not known.

        What the kinetic energy and the height gained beyond the work done, at worst, over the motion at the start and
        every rise and fall of the kinetic energy and the height since. The work is integrated with the state, so that
        this tells how exact the motion is, whatever the sample rate; 0 where nothing was turned over.
        """
        if self.work is None:
            return None
        kinetic, gravity = kinetic_energy(self.system, self.v), self.q[:, :, 1] @ self.system.weight
        turned_over = kinetic[:1].sum() + np.abs(np.diff(kinetic)).sum() + np.abs(np.diff(gravity)).sum()
        gained = kinetic + gravity - self.work
        return float(np.abs(gained - gained[:1]).max() / turned_over) if turned_over > 0 else 0.0

    @property
    def road(self) -> Road:
        """The road under this run, as far as its wheels came: further than asked for where it rolled away downhill."""
        from model.road.road import SPARE, build_road  # here: Numba takes a third of a second

        furthest = FASTEST * self.config.simulation.duration
        return build_road(self.config, min(float(self.q[..., 0].max(initial=0.0)), furthest) + SPARE)

    @property
    def complete(self) -> bool:
        return self.status == "complete"


@dataclass(frozen=True, kw_only=True)
class Trajectory(Motion):
    """One whole run: its motion, with the accelerations of all bodies, and the forces."""

    traction: np.ndarray  # (N, W) f_t along the road, N
    tangential_displacement: np.ndarray  # (N, W) ξ, m
    drive_force: np.ndarray  # (N,) F, N
    multipliers: np.ndarray  # (N, rows of C) λ

    def save(self, path: str | Path) -> None:
        """Write the run as .npz (everything) or .csv (a table of motion and loads, a row a sample).

        Raises ValueError for another suffix, OSError when it cannot be written; a file is there whole or not at all.
        """
        path = Path(path)
        if path.suffix not in (".npz", ".csv"):
            raise ValueError(f"cannot save a run as {path.name!r}: the name must end in .npz or .csv")
        write_whole(path, self.to_bytes(path.suffix))

    @classmethod
    def load(cls, path: str | Path | IO[bytes], name: str = "", largest: float = np.inf) -> Trajectory:
        """Read a run from .npz, a file that messages call `name`, with arrays of `largest` bytes in all at most.

        Nothing is unpacked that does not fit the configuration in the file. Raises OSError, ValueError (not such a
        file) or ConfigError (its configuration).
        """
        name = name or str(path)
        try:
            if not isinstance(path, str | Path):
                return cls._read(Npz(path), name, largest)
            with open_file(path) as file:
                return cls._read(Npz(file), name, largest)
        except NpzError as error:
            raise ValueError(f"{name} is not a run saved by trackride run --out: {error}") from error

    @classmethod
    def _read(cls, file: Npz, name: str, largest: float) -> Trajectory:
        """Raises NpzError or ConfigError."""
        config = parse_config(file.text("config", SIZE_LIMIT), source=f"{name}: config")
        texts: dict[str, Any] = {key: file.text(key, LONGEST_TEXT) for key in ("status", "advice")}
        for key, text in texts.items():
            if not text.isprintable():
                raise NpzError(f"{key} must be of printable characters")
        statistics = RunStatistics(**{f.name: file.number(f.name) for f in fields(RunStatistics)})  # type: ignore[arg-type]
        samples, most = prod(file.shape("t")), sample_count(config.simulation.duration, config.simulation.output_rate)
        if not 0 < samples <= most:
            raise NpzError(f"t must hold 1 to {most} numbers")
        shapes = _shapes(build_system(config), samples)
        given = [*_ARRAYS, *(key for key in (*_PEAKS, "work") if key in file)]
        if 8 * sum(prod(shapes[key]) for key in given) > largest:
            raise NpzError(f"it holds more than {largest / 1e6:.0f} MB")
        arrays: dict[str, Any] = {key: file.numbers(key, shapes[key]) for key in given}
        if arrays["t"][0] != 0.0 or (np.diff(arrays["t"]) <= 0.0).any():
            raise NpzError("t must begin at 0 and grow")
        peaks = {name: arrays.pop(key) for key, name in _PEAKS.items() if key in arrays}
        tracked = Peaks(**peaks) if len(peaks) == len(_PEAKS) else None
        return cls(**arrays, **texts, config=config, statistics=statistics, tracked=tracked)

    def to_bytes(self, suffix: str) -> bytes:
        """The content of the file that `save` would write: ".npz" or ".csv"."""
        buffer = BytesIO()
        {".npz": self._write_npz, ".csv": self._write_csv}[suffix](buffer)
        return buffer.getvalue()

    def _write_npz(self, file: IO[bytes]) -> None:
        entries: dict[str, Any] = {name: getattr(self, name) for name in _ARRAYS}
        entries |= {"config": dump_config(self.config), "status": self.status, "advice": self.advice}
        entries |= {key: getattr(self.peaks, name) for key, name in _PEAKS.items()}
        if self.work is not None:
            entries |= {"work": self.work, "energy_error": self.energy_error}
        np.savez_compressed(file, **entries, **asdict(self.statistics))

    def _write_csv(self, file: IO[bytes]) -> None:
        columns = {"t [s]": self.t} | motion_columns(self) | load_columns(self) | traction_columns(self)
        file.write(csv_bytes(columns))


def motion_columns(run: Trajectory) -> Columns:
    """How the hull moves, and what drives it."""
    return {
        "hull x [m]": run.q[:, 0, 0],
        "hull y [m]": run.q[:, 0, 1],
        "hull pitch [rad]": run.q[:, 0, 2],
        "hull speed [m/s]": run.v[:, 0, 0],
        "hull vertical acceleration [m/s2]": run.a[:, 0, 1],
        "drive force [N]": run.drive_force,
    }


def load_columns(run: Trajectory) -> Columns:
    """Of each wheel."""
    return {f"normal load {name} [N]": run.normal_load[:, w] for w, name in enumerate(wheel_names(run.system))}


def traction_columns(run: Trajectory) -> Columns:
    """Of each wheel."""
    return {f"traction {name} [N]": run.traction[:, w] for w, name in enumerate(wheel_names(run.system))}


def csv_bytes(columns: Columns) -> bytes:
    """The content of a CSV file: a row of headings, then a row a sample, nine digits each."""
    text = StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    table = np.column_stack(list(columns.values())) + 0.0  # no minus before zero
    writer.writerows([f"{value:.9g}" for value in row] for row in table)
    return text.getvalue().encode()


def sample_count(duration: float, rate: float) -> int:
    """Samples of a run of `duration`, s, at `rate`, 1/s, when it is complete."""
    return int(np.floor(duration * rate + 1e-9)) + 1


def wheel_names(system: System) -> list[str]:
    """R1…Rn for road wheels, I1…Im for imaginary wheels, front first: the order of all (…, W) arrays."""
    return [f"R{i + 1}" for i in range(system.n)] + [f"I{i + 1}" for i in range(system.m)]


def _shapes(system: System, N: int) -> dict[str, tuple[int, ...]]:
    """The shape of each array of a run of N samples."""
    B, W, rows = len(system.mass), len(system.wheel), 2 * len(system.joint_i) + system.prescribed
    shapes: dict[str, tuple[int, ...]] = {"multipliers": (N, rows), "static_load": (W,)}
    shapes |= dict.fromkeys(("q", "v", "a"), (N, B, 3))
    shapes |= dict.fromkeys(("normal_load", "traction", "tangential_displacement"), (N, W))
    shapes |= dict.fromkeys(("t", "drive_force", "constraint_residual", "work"), (N,))
    sizes = {"arm": (system.n,), "acceleration": ()}
    return shapes | {key: sizes.get(name.split("_")[0], (W,)) for key, name in _PEAKS.items()}


_TEXTS = ("config", "status", "advice")
_ADDED = ("work", "tracked")  # what older files do not have
_ARRAYS = tuple(f.name for f in fields(Trajectory) if f.name not in (*_TEXTS, *_ADDED, "statistics"))
_PEAKS = {name if name == "air_time" else f"peak_{name}": name for name in PEAK_NAMES}  # in a file -> in Peaks
