"""How the kernels are compiled: by numba, cached on disk, free of the GIL, dividing as IEEE 754 does.

Sums may be reassociated and multiply-adds contracted; NaN and infinity keep their meaning, since a diverging run is
recognised by them.

Numba keeps a compiled function as long as the function's own file is unchanged, but compiled functions contain others,
from other files. So the cache stands in a folder named after the content of all files with such functions.
"""

from __future__ import annotations

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
    "dynamics/contact.py",
    "dynamics/kernel.py",
    "simulation/dense.py",
    "simulation/extremes.py",
    "simulation/steppers.py",
)
_package = Path(__file__).parent

if not config.CACHE_DIR:  # type: ignore[attr-defined]
    _content = sha256(b"".join((_package / name).read_bytes() for name in _KERNELS)).hexdigest()
    config.CACHE_DIR = str(_package / "__pycache__" / f"compiled-{_content[:16]}")  # type: ignore[attr-defined]

_OPTIONS: dict[str, Any] = {
    "cache": True,
    "nogil": True,
    "error_model": "numpy",
    "fastmath": {"contract", "arcp", "reassoc", "nsz"},
}
allocating = njit(**_OPTIONS)
# Without reference counting: for functions that allocate nothing and are handed many arrays, it took most of the time.
_OPTIONS["_nrt"] = False
compiled = njit(**_OPTIONS)
inlined = njit(forceinline=True, **_OPTIONS)
