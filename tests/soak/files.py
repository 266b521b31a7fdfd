"""Files and texts that were changed at random are read: they are understood, or refused in words."""

from __future__ import annotations

import tempfile
import tracemalloc
from functools import cache
from pathlib import Path
from time import perf_counter

import numpy as np

from app.files.uploads import ProfileQuestion, configuration, profile, profile_changes, run_from
from app.runs.request import first_request
from app.runs.storage import state_from, state_text
from model.config.config_files import dump_config, load_config, preset_names
from model.config.validation import ConfigError
from model.simulation.simulate import simulate
from model.simulation.trajectory import Trajectory
from tests.soak.outcome import Outcome, try_all

KINDS = ("YAML", "profile", "NPZ", "state")
SLOWEST = 5.0  # s for one file
LARGEST = 300e6  # bytes that reading one may take
PROFILES = tuple(
    path for path in sorted((Path(__file__).parents[1] / "field").iterdir()) if path.suffix in (".csv", ".txt", ".erd")
)
NASTY = (
    b"\x00",
    b"\xff\xfe",
    b"nan",
    b"1e400",
    b"-",
    b"{",
    b"]",
    b"\n\n",
    b"\t",
    b"!!python/object:os.system",
    b"&a *a",
)


def mutated_files(count: int, first: int = 0) -> Outcome:
    """So many files, of every kind in turn."""
    outcome = Outcome("Changed files and texts")
    outcome.tried = f"{count} files ({', '.join(KINDS)}), numbers {first} to {first + count - 1}."
    try_all(outcome, check_file, range(first, first + count))
    return outcome


def check_file(number: int) -> tuple[str, str]:
    """What became of a file, and what is wrong with that."""
    rng, kind = np.random.default_rng(number), KINDS[number % len(KINDS)]
    content = mutated(original(kind, int(rng.integers(1000))), rng)
    tracemalloc.start()
    began = perf_counter()
    ending = f"{kind}: understood"
    try:
        _read(kind, content)
    except (ConfigError, ValueError) as error:
        ending = f"{kind}: refused"
        if not str(error):
            return "", f"{kind} is refused without a word"
    except OSError as error:
        return "", f"{kind}: {error!r}"
    finally:
        most = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
    took = perf_counter() - began
    if took > SLOWEST or most > LARGEST:
        return "", f"{kind} took {took:.1f} s and {most / 1e6:.0f} MB"
    return ending, ""


def mutated(content: bytes, rng: np.random.Generator) -> bytes:
    """With a few bytes changed, cut, doubled or put in."""
    data = bytearray(content)
    for _ in range(int(rng.choice([1, 1, 2, 5]))):
        if not data:
            break
        place = int(rng.integers(len(data)))
        match int(rng.integers(6)):
            case 0:
                data[place] = int(rng.integers(256))
            case 1:
                data[place] ^= 1 << int(rng.integers(8))
            case 2:
                del data[place : place + int(rng.integers(1, 40))]
            case 3:
                data[place:place] = data[place : place + int(rng.integers(1, 200))]
            case 4:
                data[place:place] = NASTY[int(rng.integers(len(NASTY)))]
            case 5:
                del data[place:]
    return bytes(data)


@cache
def original(kind: str, choice: int) -> bytes:
    """A good file of a kind."""
    names = preset_names()
    config = load_config(names[choice % len(names)])
    if kind == "YAML":
        return dump_config(config).encode()
    if kind == "profile":
        return PROFILES[choice % len(PROFILES)].read_bytes()
    if kind == "NPZ":
        return simulate(config.replace({"simulation.duration": 0.2})).to_bytes(".npz")
    return state_text(config, first_request(config, config), [config], [], None, True).encode()


def _read(kind: str, content: bytes) -> None:
    """As the explorer and the command line do."""
    if kind == "YAML":
        configuration("a.yaml", content)
    elif kind == "profile":
        found, reading = profile("a.csv", content), None
        if isinstance(found, ProfileQuestion):
            reading = found.reading
            found = found.source.read(reading.columns, reading.units)
        profile_changes("a.csv", found, reading, load_config("paper"))
    elif kind == "NPZ":
        run_from("a.npz", content)
        with tempfile.NamedTemporaryFile(suffix=".npz") as file:
            file.write(content)
            file.flush()
            Trajectory.load(file.name)
    else:
        state_from(content.decode(errors="replace"))
