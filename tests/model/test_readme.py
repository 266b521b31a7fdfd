"""The README says what the code says."""

from __future__ import annotations

from pathlib import Path

from model.parameters import parameter_table

README = Path(__file__).parents[2] / "README.md"


def test_the_parameter_table_is_the_code_s():
    text = README.read_text()
    found = text.split("<!-- parameters: make readme -->")[1].split("<!-- end of parameters -->")[0]
    assert found.strip() == parameter_table().strip(), "run: make readme"
