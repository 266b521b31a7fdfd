"""Files that users bring along."""

from __future__ import annotations

import numpy as np
import pytest

from app.files.uploads import configuration, run_from
from model.config.config import ConfigError
from model.config.config_files import SIZE_LIMIT
from tests.app.conftest import make_run


def test_files_of_any_content_lead_to_a_message(monkeypatch: pytest.MonkeyPatch) -> None:
    run = make_run(samples=3)
    good = run.to_bytes(".npz")
    assert np.array_equal(run_from("a.npz", good).normal_load, run.normal_load)
    for content in (b"", b"\0" * 100, good[:-100], good[: len(good) // 2], b"PK\x05\x06" + bytes(18)):
        with pytest.raises(ValueError, match="a\\.npz"):
            run_from("a.npz", content)
    monkeypatch.setattr("app.files.uploads.RUN_LIMIT", 2e6)
    with pytest.raises(ValueError, match="larger than 2 MB"):
        run_from("a.npz", bytes(2_000_001))
    monkeypatch.setattr("app.files.uploads.UNPACKED_LIMIT", 7e3)
    with pytest.raises(ValueError, match="more than 0 MB"):
        run_from("a.npz", good)
    for content in (b"\xff\xfe", b"a" * (SIZE_LIMIT + 1), b"[", b"- 1"):
        with pytest.raises(ConfigError):
            configuration("a.yaml", content)
