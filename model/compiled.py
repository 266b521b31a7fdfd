"""How the kernels are compiled: by numba, cached on disk, free of the GIL, dividing as IEEE 754 does.

Sums may be reassociated and multiply-adds contracted; NaN and infinity keep their meaning, since a diverging run is
recognised by them.

Numba keeps a compiled function as long as the function's own file is unchanged, but compiled functions contain others,
from other files. So the cache stands in a folder named after the content of all files with such functions, wherever
that folder lies: where NUMBA_CACHE_DIR says, beside the package, or in the user's cache, the first that can be written.
A file there that is damaged is made anew, and one that cannot be written is done without.
"""

from __future__ import annotations

import logging
import os
import pickle
import tempfile
from collections.abc import Callable
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import Any

from numba import config, njit
from numba.core.caching import CompileResultCacheImpl, FunctionCache, IndexDataCacheFile, UserProvidedCacheLocator

_KERNELS = (
    "compiled.py",
    "road/nearest_point.py",
    "road/table.py",
    "road/thinning.py",
    "dynamics/ground.py",
    "dynamics/vehicle.py",
    "dynamics/suspension.py",
    "dynamics/lanes.py",
    "dynamics/kernel_contact.py",
    "dynamics/kernel.py",
    "simulation/dense.py",
    "simulation/extremes.py",
    "simulation/flanks.py",
    "simulation/steppers.py",
    "simulation/tableaus.py",
)
_package = Path(__file__).parent


def _content() -> str:
    """Of all files with compiled functions, in 16 characters."""
    return sha256(b"".join((_package / name).read_bytes() for name in _KERNELS)).hexdigest()[:16]


def _writable(folder: Path) -> bool:
    """Whether files can be written into a folder, which is made if it is not there."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            return True
    except OSError:
        return False


def _cache_folder() -> Path | None:
    """Where compiled code is kept; None where nothing can be written."""
    own = config.CACHE_DIR  # type: ignore[attr-defined]
    users = os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache")
    places = [Path(own)] if own else [_package / "__pycache__", Path(users) / "trackride"]
    return next(
        (folder for folder in (place / f"compiled-{_content()}" for place in places) if _writable(folder)), None
    )


_folder = _cache_folder()
if _folder is not None:
    config.CACHE_DIR = str(_folder)  # type: ignore[attr-defined]


@cache
def _say(sentence: str) -> None:
    """Once a process; on standard error, unless the program sends its log elsewhere."""
    logging.getLogger("trackride").warning(sentence)


def _say_not_kept(reason: str) -> None:
    _say(
        f"Compiled code cannot be kept, since {reason}: each start takes a minute longer. "
        "Set NUMBA_CACHE_DIR to a folder that can be written."
    )


class _Place(CompileResultCacheImpl):
    """Only our folder: in Numba's other places nobody would notice that a function compiled in has changed."""

    _locator_classes = [UserProvidedCacheLocator]  # noqa: RUF012 (Numba's own way)


class _Files(IndexDataCacheFile):
    """The index and the code of one function, each with a digest in front: LLVM ends the process over half a file."""

    def _dump(self, content: Any) -> bytes:
        data = super()._dump(content)
        return sha256(data).digest() + data

    def _save_index(self, overloads: dict[Any, str]) -> None:
        with self._open_for_write(self._index_path) as file:
            file.write(self._dump((self._version, self._source_stamp, overloads)))

    def _load_index(self) -> dict[Any, str]:
        try:
            version, stamp, overloads = self._sound(self._index_path)
        except (OSError, ValueError):
            return {}
        return overloads if (version, stamp) == (self._version, self._source_stamp) else {}

    def _load_data(self, name: str) -> Any:
        return self._sound(self._data_path(name))

    @staticmethod
    def _sound(path: str) -> Any:
        """Raises OSError, or ValueError for a file that is not as it was written."""
        content = Path(path).read_bytes()
        if sha256(content[32:]).digest() != content[:32]:
            raise ValueError(f"{path} is damaged")
        return pickle.loads(content[32:])


class _Cache(FunctionCache):
    """Of one function: what cannot be read is compiled anew, what cannot be written is not kept."""

    _impl_class = _Place

    def __init__(self, function: Callable[..., Any]) -> None:
        """Raises RuntimeError where nothing can be written."""
        super().__init__(function)
        place = self._impl.locator
        self._cache_file = _Files(place.get_cache_path(), self._impl.filename_base, place.get_source_stamp())

    def load_overload(self, signature: Any, context: Any) -> Any:
        try:
            found = super().load_overload(signature, context)
        except Exception:  # pickle and Numba raise all kinds for what does not suit them
            found = None
        if found is None:
            _say("Compiling for this machine: up to a minute, the first time only.")
        return found

    def save_overload(self, signature: Any, code: Any) -> None:
        try:
            super().save_overload(signature, code)
        except OSError as error:
            _say_not_kept(f"{self.cache_path} cannot be written ({error.strerror})")


def _decorator(**special: Any) -> Callable[[Callable[..., Any]], Any]:
    """Compiles a function when it is first called, with these options of Numba besides those that all have."""

    def decorate(function: Callable[..., Any]) -> Any:
        dispatcher = njit(nogil=True, error_model="numpy", fastmath={"contract", "arcp", "reassoc", "nsz"}, **special)(
            function
        )
        try:
            if _folder is not None:
                dispatcher._cache = _Cache(function)
                return dispatcher
        except RuntimeError:
            pass
        _say_not_kept("no folder for it can be written")
        return dispatcher

    return decorate


allocating = _decorator()
# Without reference counting: for functions that allocate nothing and are handed many arrays, it took most of the time.
compiled = _decorator(_nrt=False)
inlined = _decorator(forceinline=True, _nrt=False)
