"""Where compiled code is kept: by the content of its sources, in the first folder that can be written."""

from __future__ import annotations

import shutil

import pytest

from model import compiled
from model.compiled import _KERNELS


@pytest.fixture
def place(monkeypatch, tmp_path):
    """A copy of the sources, and NUMBA_CACHE_DIR at a folder."""
    for name in _KERNELS:
        (tmp_path / "model" / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(compiled._package / name, tmp_path / "model" / name)
    monkeypatch.setattr(compiled, "_package", tmp_path / "model")
    monkeypatch.setattr(compiled.config, "CACHE_DIR", str(tmp_path / "cache"))
    return tmp_path


@pytest.mark.parametrize("source", _KERNELS)
def test_any_source_that_changes_gets_another_folder(place, source):
    before = compiled._cache_folder()
    with (place / "model" / source).open("a", encoding="utf-8") as file:
        file.write("# changed\n")
    assert compiled._cache_folder() != before


def test_it_lies_where_numba_is_told_or_beside_the_package(place, monkeypatch):
    assert compiled._cache_folder().parent == place / "cache"
    monkeypatch.setattr(compiled.config, "CACHE_DIR", "")
    assert compiled._cache_folder().parent == place / "model" / "__pycache__"


def test_a_package_that_cannot_be_written_keeps_it_with_the_user(place, monkeypatch):
    monkeypatch.setattr(compiled.config, "CACHE_DIR", "")
    (place / "model" / "__pycache__").write_text("no folder")
    monkeypatch.setenv("XDG_CACHE_HOME", str(place / "user"))
    assert compiled._cache_folder().parent == place / "user" / "trackride"


def test_where_nothing_can_be_written_nothing_is_kept(place, monkeypatch):
    (place / "file").write_text("no folder")
    monkeypatch.setattr(compiled.config, "CACHE_DIR", str(place / "file" / "cache"))
    assert compiled._cache_folder() is None
