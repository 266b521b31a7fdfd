"""Files that are read only where they are files, and written whole or not at all."""

from __future__ import annotations

import os
import socket
import threading
from pathlib import Path

import pytest

from model import ConfigError, Trajectory, load_config
from model.config.config_files import read_profile
from model.files import open_file, read_file, write_whole

READERS = [lambda path: read_file(path, 10), open_file, Trajectory.load, load_config, read_profile]


@pytest.mark.parametrize("read", READERS)
@pytest.mark.parametrize("what", ["a pipe", "a folder", "a device"])
def test_what_is_no_file_is_refused_at_once(tmp_path: Path, read, what: str) -> None:
    path = tmp_path / "some"
    if what == "a pipe":
        os.mkfifo(path)
    elif what == "a folder":
        path.mkdir()
    else:
        path.symlink_to("/dev/zero")
    with pytest.raises((OSError, ConfigError), match=f"it is {what}, not a file"):
        read(path)


def test_a_socket_is_refused(tmp_path: Path) -> None:
    with socket.socket(socket.AF_UNIX) as one:
        one.bind(str(tmp_path / "some"))
        with pytest.raises(OSError, match="some"):
            open_file(tmp_path / "some")


def test_a_profile_that_is_no_file_is_a_fault_of_its_key(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "course.csv")
    (tmp_path / "mine.yaml").write_text("road: {type: profile, file: course.csv}")
    with pytest.raises(ConfigError, match=r"road\.file: .*course\.csv cannot be read: it is a pipe, not a file"):
        load_config(tmp_path / "mine.yaml")


def test_a_file_is_read_up_to_a_byte_over_the_limit(tmp_path: Path) -> None:
    (tmp_path / "some").write_bytes(b"0123456789")
    assert read_file(tmp_path / "some", 20) == b"0123456789"
    assert read_file(tmp_path / "some", 5) == b"012345"


def test_writers_of_one_name_do_not_mix(tmp_path: Path) -> None:
    path = tmp_path / "run.npz"
    contents = [bytes([number]) * 3_000_000 for number in range(4)]
    writers = [threading.Thread(target=write_whole, args=(path, content)) for content in contents]
    for writer in writers:
        writer.start()
    seen = set()
    while any(writer.is_alive() for writer in writers):
        if path.exists():
            seen.add(path.read_bytes())
    assert seen | {path.read_bytes()} <= set(contents)
    assert list(tmp_path.iterdir()) == [path]


def test_no_link_of_the_files_name_is_followed_in_writing(tmp_path: Path) -> None:
    (tmp_path / "victim").write_bytes(b"precious")
    (tmp_path / "run.npz").symlink_to(tmp_path / "victim")
    write_whole(tmp_path / "run.npz", b"new")
    assert not (tmp_path / "run.npz").is_symlink()
    assert (tmp_path / "victim").read_bytes() == b"precious"


def test_no_link_of_the_name_before_the_file_is_whole_is_followed(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setattr("model.files.secrets.token_hex", lambda count: "guessed")
    (tmp_path / "victim").write_bytes(b"precious")
    (tmp_path / ".guessed.part").symlink_to(tmp_path / "victim")
    with pytest.raises(FileExistsError):
        write_whole(tmp_path / "run.npz", b"new")
    assert (tmp_path / ".guessed.part").is_symlink()
    assert (tmp_path / "victim").read_bytes() == b"precious"


def test_a_file_may_be_read_by_whom_others_may(tmp_path: Path) -> None:
    (tmp_path / "other").touch()
    write_whole(tmp_path / "some", b"new")
    assert (tmp_path / "some").stat().st_mode == (tmp_path / "other").stat().st_mode
