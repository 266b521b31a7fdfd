"""Shared by all tests: the reference cases of the independent engine."""

from __future__ import annotations

from pathlib import Path

REFERENCE = Path(__file__).parent / "reference"
REFERENCE_CASES = sorted(path.stem for path in REFERENCE.glob("*.yaml"))
