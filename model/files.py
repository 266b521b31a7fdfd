"""Files of users: read only where they are plain files, written whole or not at all."""

from __future__ import annotations

import os
import secrets
import stat
from pathlib import Path
from typing import BinaryIO

_OTHER_KINDS = {
    stat.S_IFDIR: "a folder",
    stat.S_IFIFO: "a pipe",
    stat.S_IFCHR: "a device",
    stat.S_IFBLK: "a device",
}
# Opening a pipe would wait for somebody who writes into it; each system knows one of the two.
_READING = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)


class NoFileError(OSError):
    """What stands under a name is no file: a folder, a pipe, a device."""

    def __init__(self, what: str, path: str | Path) -> None:
        super().__init__(0, f"it is {what}, not a file", str(path))


def open_file(path: str | Path) -> BinaryIO:
    """Open a user's file to read it. Raises OSError, at once also for a folder, a pipe or a device (NoFileError)."""
    descriptor = os.open(path, _READING)
    kind = stat.S_IFMT(os.fstat(descriptor).st_mode)
    if kind in _OTHER_KINDS:
        os.close(descriptor)
        raise NoFileError(_OTHER_KINDS[kind], path)
    return open(descriptor, "rb")


def read_file(path: str | Path, limit: int) -> bytes:
    """The content of a user's file, but no more than a byte over the limit. Raises OSError as `open_file` does."""
    with open_file(path) as file:
        return file.read(limit + 1)


def write_whole(path: Path, content: bytes) -> None:
    """Write a file, which takes the place of one of that name when it is complete. Raises OSError.

    Several may write the same name at once: the last one's stands.
    """
    partial = path.with_name(f".{secrets.token_hex(8)}.part")
    file = partial.open("xb")  # x: no file or link of that name is touched
    try:
        with file:
            file.write(content)
        partial.replace(path)
    except BaseException:
        partial.unlink(missing_ok=True)
        raise
