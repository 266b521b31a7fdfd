"""How the kernels are compiled: by numba, cached on disk, free of the GIL, dividing as IEEE 754 does.

Sums may be reassociated and multiply-adds contracted; NaN and infinity keep their meaning, since a diverging run is
recognised by them.

Numba keeps a compiled function as long as the function's own file is unchanged, but compiled functions contain others,
from other files. So the cache stands in a folder named after the content of all files with such functions, wherever
that folder lies: where NUMBA_CACHE_DIR says, beside the package, or in the user's cache, the first that can be written.
"""

from __future__ import annotations

import logging
import os
import tempfile
from hashlib import sha256
from pathlib import Path
from typing import Any

from numba import config, njit

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
if _folder is None:
    logging.getLogger("trackride").warning(
        "Compiled code cannot be kept, since no folder for it can be written: each start takes a minute longer. "
        "Set NUMBA_CACHE_DIR to a folder that can be written."
    )
else:
    config.CACHE_DIR = str(_folder)  # type: ignore[attr-defined]

_OPTIONS: dict[str, Any] = {
    "cache": _folder is not None,
    "nogil": True,
    "error_model": "numpy",
    "fastmath": {"contract", "arcp", "reassoc", "nsz"},
}
allocating = njit(**_OPTIONS)
# Without reference counting: for functions that allocate nothing and are handed many arrays, it took most of the time.
_OPTIONS["_nrt"] = False
compiled = njit(**_OPTIONS)
inlined = njit(forceinline=True, **_OPTIONS)
