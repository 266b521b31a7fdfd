"""The README and model/MODEL.md say what the code says, and name files and sections that exist."""

from __future__ import annotations

import re

import pytest

from model.analysis.figures import figure_table
from model.config.parameters import parameter_table
from model.paper.errata import errata_list
from tests.structure import ROOT

README = ROOT / "README.md"
MODEL = ROOT / "model" / "MODEL.md"
FOLDERS = ("app", "assets", "configs", "model", "tests")
TEXTS = [README, *(path for name in FOLDERS for suffix in ("*.py", "*.md") for path in (ROOT / name).rglob(suffix))]


@pytest.mark.parametrize(
    ("mark", "content"), [("errata", errata_list()), ("figures", figure_table()), ("parameters", parameter_table())]
)
def test_what_is_generated_is_the_code_s(mark: str, content: str):
    text = README.read_text()
    found = text.split(f"<!-- {mark}: make readme -->")[1].split(f"<!-- end of {mark} -->")[0]
    assert found.strip() == content.strip(), "run: make readme"


def files_named() -> dict[str, list[str]]:
    """Files of this project that texts, docstrings and comments name, with or without folder -> where they do so."""
    named: dict[str, list[str]] = {}
    for path in TEXTS:
        for name in re.findall(r"(?<![\w./*\\])(?:\w+/)*\w+\.(?:py|md|js|css)\b", path.read_text()):
            named.setdefault(name, []).append(str(path.relative_to(ROOT)))
    return named


def test_files_that_are_named_exist():
    files = [f"/{path.relative_to(ROOT)}" for name in FOLDERS for path in (ROOT / name).rglob("*.*")] + ["/README.md"]
    missing = {name: at for name, at in files_named().items() if not any(file.endswith(f"/{name}") for file in files)}
    assert not missing


def test_sections_of_the_model_s_contract_that_are_cited_exist():
    sections = set(re.findall(r"^## (.+)$", MODEL.read_text(), re.MULTILINE))
    texts = [" ".join(path.read_text().split()) for path in TEXTS]
    cited = {section for text in texts for section in re.findall(r'model/MODEL\.md, "([^"]+)"', text)}
    assert cited
    assert cited <= sections
