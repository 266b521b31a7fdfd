"""Scripts and styles of the pages."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

from app.format.assets import EXPLORER, asset

ROOT = Path(__file__).parents[3]


def test_an_asset_is_the_text_of_its_file() -> None:
    assert asset("plots.js") == (ROOT / "assets" / "plots.js").read_text(encoding="utf-8")


def test_a_missing_one_is_named() -> None:
    with pytest.raises(FileNotFoundError, match=r"assets/no_such_file"):
        asset("no_such_file")


def test_the_explorer_asks_for_those_that_its_panels_use() -> None:
    files = (path for part in ("panels", "web") for path in (ROOT / "app" / part).glob("*.py"))
    sources = "".join(path.read_text(encoding="utf-8") for path in files)
    assert set(re.findall(r'asset\("([^"]+)"\)', sources)) == set(EXPLORER)


def test_assets_are_found_from_any_folder(tmp_path: Path) -> None:
    program = f"import sys; sys.path.insert(0, {str(ROOT)!r}); from app.format.assets import asset; asset('page.css')"
    subprocess.run([sys.executable, "-c", program], cwd=tmp_path, check=True)
