"""Arrays from a .npz file that anybody may have made: none is unpacked before its declared kind and size are known to
be as wanted, and whatever is wrong is one error with a reason.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import IO
from zipfile import ZIP_DEFLATED, ZIP_STORED, ZipExtFile, ZipFile

import numpy as np
from numpy.lib import format as npy

LARGEST = 1e50  # of a file's numbers: far above any run's, and their fourth powers can still be added up


class NpzError(ValueError):
    """A file that is no .npz, or has not the arrays that are wanted; the message says what is wrong with it."""


class Npz:
    """The arrays in an open .npz file, by name."""

    def __init__(self, file: IO[bytes]) -> None:
        """Raises NpzError when it is no such file."""
        with _as_npz_error("it is no NPZ file"):
            self._archive = ZipFile(file)
            self._entries = {entry.filename.removesuffix(".npy"): entry for entry in self._archive.infolist()}

    def __contains__(self, name: str) -> bool:
        return name in self._entries

    def shape(self, name: str) -> tuple[int, ...]:
        """That an array is declared to have. Raises NpzError."""
        return self._declared(name)[0]

    def text(self, name: str, longest: int) -> str:
        """A text of at most so many characters. Raises NpzError."""
        shape, dtype = self._declared(name)
        if shape != () or dtype.kind != "U" or dtype.itemsize > 4 * longest:
            raise NpzError(f"{name} must be a text of at most {longest} characters")
        values = self._values(name)
        if not dtype.isnative or (np.frombuffer(values.tobytes(), np.uint32) > sys.maxunicode).any():
            raise NpzError(f"{name} holds what are no characters")
        return str(values.item())

    def number(self, name: str) -> int | float:
        """A count, which may be 0, or a fraction above 0. Raises NpzError."""
        shape, dtype = self._declared(name)
        value = self._values(name).item() if shape == () and dtype in (np.int64, np.float64) else -1
        if not (value > 0 or (value == 0 and type(value) is int)):
            raise NpzError(f"{name} must be a positive number")
        return value

    def numbers(self, name: str, shape: tuple[int, ...]) -> np.ndarray:
        """An array of this shape. Raises NpzError."""
        if self._declared(name) == (shape, np.dtype(float)):
            values = self._values(name)
            if (np.abs(values) < LARGEST).all():
                return values
        raise NpzError(f"{name} must hold {shape} finite numbers")

    def _declared(self, name: str) -> tuple[tuple[int, ...], np.dtype]:
        """The shape and the kind of an array, and nothing unpacked but its heading."""
        with self._opened(name) as stream:
            if npy.read_magic(stream) != (1, 0):  # others have headings of up to 4 GB
                raise NpzError(f"{name} is written in a way that is not used here")
            shape, _, dtype = npy.read_array_header_1_0(stream)
            return shape, dtype

    def _values(self, name: str) -> np.ndarray:
        with self._opened(name) as stream:
            values = npy.read_array(stream, allow_pickle=False)
            if stream.read(1):  # to the end, where the checksum is looked at
                raise NpzError(f"{name} holds more than it says")
            return values

    @contextmanager
    def _opened(self, name: str) -> Iterator[ZipExtFile]:
        if name not in self:
            raise NpzError(f"it lacks {name}")
        with _as_npz_error(f"{name} is damaged"):
            entry = self._entries[name]
            if entry.compress_type not in (ZIP_STORED, ZIP_DEFLATED):  # others may ask for any memory
                raise NpzError(f"{name} is packed in a way that is not used here")
            with self._archive.open(entry) as stream:
                yield stream  # type: ignore[misc]


@contextmanager
def _as_npz_error(what: str) -> Iterator[None]:
    """ZipFile and NumPy raise all kinds of errors for a file that is damaged or made up."""
    try:
        yield
    except NpzError:
        raise
    except Exception as error:
        raise NpzError(what) from error
