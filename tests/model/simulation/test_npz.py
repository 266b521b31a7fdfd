"""Runs' files that were damaged or made up: each is refused with a sentence, and costs no more than a good one."""

from __future__ import annotations

import io
import random
import tracemalloc
import zipfile
from collections.abc import Callable
from contextlib import suppress

import numpy as np
import pytest

from model import ConfigError, Trajectory, simulate
from model.config.config_files import dump_config
from model.simulation.npz import Npz, NpzError
from tests.model.support import PAPER

Rng = random.Random
ROUNDS = 25
ODD = [
    np.zeros((2, 0)),
    np.array("text"),
    np.array("\ud800"),
    np.array(np.nan),
    np.array(-1),
    np.array(2**63, dtype=np.uint64),
    np.zeros(3, dtype=[("a", "f8"), ("b", "U3")]),
    np.array(1j),
    np.array(1, dtype="M8[s]"),
    np.zeros(4, dtype=">f8"),
    np.zeros(4, dtype=np.longdouble),
    np.array(b"bytes"),
    np.array(True),
]
HEADERS = [
    b"\x93NUMPY\x01\x00\x10\x00{'shape': (1,),\n",
    b"\x93NUMPY\x01\x00\x08\x00" + b"(" * 8,
    b"\x93NUMPY\x01\x00\xf0\x0f" + b"[" * 4080,
    b"\x93NUMPY\x02\x00\xff\xff\xff\xff" + b" " * 100,
    b"\x93NUMPY\x03\x00\x01\x00\x00\x00\n",
    b"\x93NUMPY\x01\x00\x46\x00{'descr': '<f8', 'fortran_order': False, 'shape': (9999999999999999,)}\n",
    b"\x93NUMPY\x01\x00\x46\x00{'descr': '|O', 'fortran_order': False, 'shape': (-1, 2**62, 2**62),  }\n",
    b"",
]


@pytest.fixture(scope="module")
def members() -> dict[str, bytes]:
    """The content of a run's file."""
    run = simulate(PAPER.replace({"simulation.duration": 0.1}))
    with zipfile.ZipFile(io.BytesIO(run.to_bytes(".npz"))) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def packed(members: dict[str, bytes], method: int = zipfile.ZIP_DEFLATED) -> bytes:
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", method) as archive:
        for name, content in members.items():
            archive.writestr(name, content)
    return file.getvalue()


def array_bytes(array: np.ndarray) -> bytes:
    file = io.BytesIO()
    np.save(file, array)
    return file.getvalue()


def flipped(content: bytes, rng: Rng) -> bytes:
    changed = bytearray(content)
    for _ in range(rng.choice((1, 1, 3, 20))):
        changed[rng.randrange(len(changed))] = rng.randrange(256)
    return bytes(changed)


def head_flipped(members: dict[str, bytes], rng: Rng) -> bytes:
    """A member's own heading is changed, and the archive is sound."""
    name = rng.choice(sorted(members))
    return packed(members | {name: flipped(members[name][:128], rng) + members[name][128:]})


def tail_flipped(members: dict[str, bytes], rng: Rng) -> bytes:
    """In the archive's list of contents: methods, flags, sizes, places."""
    whole = packed(members)
    return whole[:-2500] + flipped(whole[-2500:], rng)


def cut(members: dict[str, bytes], rng: Rng) -> bytes:
    whole = packed(members)
    begin, end = sorted(rng.sample(range(len(whole)), 2))
    return rng.choice((whole[:begin], whole[end:], whole[:begin] + whole[end:], whole[:end] + whole[begin:]))


def odd_member(members: dict[str, bytes], rng: Rng) -> bytes:
    return packed(members | {rng.choice(sorted(members)): array_bytes(rng.choice(ODD))})


def odd_header(members: dict[str, bytes], rng: Rng) -> bytes:
    return packed(members | {rng.choice(sorted(members)): rng.choice(HEADERS) + bytes(64)})


def swapped(members: dict[str, bytes], rng: Rng) -> bytes:
    one, other = rng.sample(sorted(members), 2)
    return packed(members | {one: members[other], other: members[one]})


def dropped(members: dict[str, bytes], rng: Rng) -> bytes:
    gone = rng.choice(sorted(members))
    return packed({name: content for name, content in members.items() if name != gone})


def config_flipped(members: dict[str, bytes], rng: Rng) -> bytes:
    text = dump_config(PAPER)
    place = rng.randrange(len(text))
    changed = text[:place] + chr(rng.choice((0, 10, 48, 57, 125, 0xD800, 0x10FFFF))) + text[place + 1 :]
    return packed(members | {"config.npy": array_bytes(np.array(changed))})


WAYS: dict[str, Callable[[dict[str, bytes], Rng], bytes]] = {
    "bytes": lambda members, rng: flipped(packed(members, rng.choice((zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED))), rng),
    **{f.__name__: f for f in (head_flipped, tail_flipped, cut, odd_member, odd_header, swapped, dropped)},
    "config": config_flipped,
}


@pytest.mark.parametrize("way", WAYS)
def test_what_is_not_a_run_any_more_is_refused_with_a_sentence(members: dict[str, bytes], way: str) -> None:
    rng = Rng(f"{way} 1")
    said = []
    for _ in range(ROUNDS):
        content = WAYS[way](members, rng)
        try:
            Trajectory.load(io.BytesIO(content), "mine.npz")
        except (ValueError, ConfigError) as error:
            said.append(str(error))
    assert said  # some changes hit nothing that is read
    assert all(text.startswith(("mine.npz is not a run saved by", "mine.npz: config")) for text in said)


def test_a_file_on_disk_is_refused_as_well(members: dict[str, bytes], tmp_path) -> None:
    """A place far beyond the file's end is another error there."""
    rng = Rng(5)
    for _ in range(ROUNDS):
        (tmp_path / "mine.npz").write_bytes(tail_flipped(members, rng))
        with suppress(ValueError, ConfigError):
            Trajectory.load(tmp_path / "mine.npz")


@pytest.mark.parametrize("name", ["q", "t", "extra", "status", "steps", "peak_load"])
def test_no_array_is_unpacked_that_is_larger_than_the_configuration_says(members: dict[str, bytes], name: str) -> None:
    large = members | {f"{name}.npy": array_bytes(np.zeros(3_000_000))}
    content = packed(large)
    tracemalloc.start()
    try:
        with suppress(ValueError):
            Trajectory.load(io.BytesIO(content))
        assert tracemalloc.get_traced_memory()[1] < 4e6
    finally:
        tracemalloc.stop()


def test_other_arrays_and_other_members_are_no_hindrance(members: dict[str, bytes]) -> None:
    more = members | {"sinkage.npy": array_bytes(np.zeros((21, 11))), "read me.txt": b"a note"}
    assert Trajectory.load(io.BytesIO(packed(more))).complete


def test_a_packing_that_may_ask_for_any_memory_is_refused(members: dict[str, bytes]) -> None:
    with pytest.raises(NpzError, match="packed in a way"):
        Npz(io.BytesIO(packed(members, zipfile.ZIP_LZMA))).number("steps")
    assert Npz(io.BytesIO(packed(members, zipfile.ZIP_STORED))).number("steps") > 0


def test_a_heading_may_not_be_of_any_length(members: dict[str, bytes]) -> None:
    long = b"\x93NUMPY\x02\x00" + (3_000_000).to_bytes(4, "little") + bytes(3_000_000)
    with pytest.raises(NpzError, match="written in a way"):
        Npz(io.BytesIO(packed({"steps.npy": long}))).number("steps")


def test_a_text_of_what_are_no_characters_is_refused():
    """Python makes a text of them, at which others fail in ways that no one expects."""
    buffer = io.BytesIO()
    np.savez(buffer, text=np.array([0x110000], np.uint32).view("<U1").reshape(()))
    with pytest.raises(NpzError, match="text holds what are no characters"):
        Npz(buffer).text("text", 10)
