"""The README says what the code says."""

from __future__ import annotations

from pathlib import Path

import pytest

from model.config.parameters import parameter_table
from model.paper.errata import errata_list

README = Path(__file__).parents[1] / "README.md"


@pytest.mark.parametrize(("mark", "content"), [("errata", errata_list()), ("parameters", parameter_table())])
def test_what_is_generated_is_the_code_s(mark: str, content: str):
    text = README.read_text()
    found = text.split(f"<!-- {mark}: make readme -->")[1].split(f"<!-- end of {mark} -->")[0]
    assert found.strip() == content.strip(), "run: make readme"
