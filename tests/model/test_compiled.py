"""Where compiled code is kept: by the content of its sources, in the first folder that can be written; and what happens
when it cannot be read or written there.
"""

from __future__ import annotations

import shutil
from pathlib import Path

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


def twice(x):
    return 2 * x


@pytest.fixture
def folder(monkeypatch, tmp_path) -> Path:
    """Where compiled code is kept."""
    monkeypatch.setattr(compiled, "_folder", tmp_path)
    monkeypatch.setattr(compiled.config, "CACHE_DIR", str(tmp_path))
    compiled._say.cache_clear()
    yield tmp_path
    compiled._say.cache_clear()


def called() -> bool:
    """Call a compiled function, as a new process would; whether it was found compiled."""
    function = compiled.compiled(twice)
    assert function(3) == 6
    return bool(function.stats.cache_hits)


def test_it_is_said_once_that_it_compiles(folder, caplog):
    assert not called()
    assert compiled.compiled(twice)(2.5) == 5.0
    assert caplog.messages == ["Compiling for this machine: up to a minute, the first time only."]
    caplog.clear()
    assert called()
    assert not caplog.messages


@pytest.mark.parametrize("suffix", [".nbi", ".nbc"])
@pytest.mark.parametrize(
    "damage",
    [lambda content: b"", lambda content: content[: len(content) // 2], lambda content: content[:-1] + b"?", None],
    ids=["empty", "cut off", "changed", "a folder"],
)
def test_what_is_damaged_is_compiled_anew(folder, suffix, damage):
    assert not called()
    (path,) = folder.rglob(f"*{suffix}")
    if damage is None:
        path.unlink()
        path.mkdir()
    else:
        path.write_bytes(damage(path.read_bytes()))
    assert not called()
    assert called() == (damage is not None)


def test_code_that_a_full_disk_does_not_take_is_done_without(folder, full_disk, caplog):
    with full_disk():
        assert not called()
    assert caplog.messages[-1].startswith("Compiled code cannot be kept, since ")
    assert "cannot be written (File too large): each start takes a minute longer." in caplog.messages[-1]
    assert not called()
    assert called()


def test_code_for_which_there_is_no_place_is_done_without(folder, monkeypatch, caplog):
    (folder / "file").touch()
    monkeypatch.setattr(compiled.config, "CACHE_DIR", str(folder / "file" / "cache"))
    assert not called()
    assert not called()
    assert len(caplog.messages) == 1
    assert "no folder for it can be written: each start takes a minute longer." in caplog.messages[0]
