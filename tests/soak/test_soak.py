"""A short form of each part of the soak."""

from __future__ import annotations

import pytest

from tests.soak.draws import drawn
from tests.soak.files import check_file
from tests.soak.mutants import MUTANTS, ROOT
from tests.soak.outcome import Outcome
from tests.soak.runs import check_run
from tests.soak.server import connects, dragging, driving
from tests.soak.signals import interruptions


def test_random_configurations_run_or_say_why_not() -> None:
    assert [fault for number in range(40) if (fault := check_run(number)[1])] == []


def test_changed_files_are_understood_or_refused_in_words() -> None:
    assert [fault for number in range(120) if (fault := check_file(number)[1])] == []


def test_a_peak_in_the_last_step_or_in_a_long_loose_one_is_seen() -> None:
    """Numbers in which an hour's soak found it missed."""
    assert [check_run(number)[1] for number in (3555, 4655, 5723)] == ["", "", ""]


def test_a_number_names_a_configuration() -> None:
    assert drawn(4) == drawn(4)
    assert drawn(4) != drawn(7)


def test_a_run_that_is_not_what_it_says_is_a_fault(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tests.soak.runs.DRIFT", -1.0)
    assert "joints" in check_run(3)[1]


def test_the_text_that_a_mutant_changes_stands_once_in_its_file() -> None:
    wrong = [m for m in MUTANTS if (ROOT / m.file).read_text().count(m.old) != 1 or m.old == m.new]
    assert wrong == []


@pytest.mark.parametrize(
    "part",
    [lambda: connects(5), lambda: dragging(2.0), lambda: driving(10.0), lambda: interruptions(3, busy=10.0)],
    ids=["connects", "dragging", "driving", "interruptions"],
)
def test_the_explorer_and_its_files_outlast(part: object) -> None:
    outcome: Outcome = part()  # type: ignore[operator]
    assert outcome.faults == []
