"""The line that says what is being done."""

from __future__ import annotations

from app.panels.status_line import FIRST_START, SLOW_START, progress_line


def test_only_a_model_that_loads_slowly_is_said_to_be_compiled():
    assert FIRST_START in progress_line(1, None, 2 * SLOW_START)
    assert FIRST_START not in progress_line(1, None, 0.5 * SLOW_START)
    assert "0 %" in progress_line(1, 0.0, 60.0)  # one step of a run may take long
