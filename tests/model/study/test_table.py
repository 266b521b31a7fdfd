"""Tables of studies: what is written is read back, and a study that was cut off goes on."""

from __future__ import annotations

import pytest

from model.study.design import DesignError, Range, Study, Values, make_study
from model.study.running import Outcome, Row
from model.study.table import KEY, Made, TableWriter, read_made, read_rows, read_table
from tests.model.support import PAPER, WHEELS

SUFFIXES = (".csv", ".parquet")


@pytest.fixture(params=SUFFIXES)
def suffix(request):
    return request.param


def made_study(figures=("shock", "peak_load.R1"), count: int = 5) -> Study:
    positions = Values(f"{WHEELS}.positions", ((1.0, 0.0, -1.0), None))
    seats = Range("vehicle.seat.x", -0.1, 0.7, count)
    return make_study(PAPER, [seats, positions, Values("drive.mode", ("cruise",))], figures)


def made_rows(study: Study) -> list[Row]:
    """With values that need all their digits, none, and words with commas."""
    found = [Row(k, point, Outcome("complete", (k / 3 + 1e-16, -1e-300))) for k, point in enumerate(study.points)]
    found[1] = Row(1, study.points[1], Outcome('no rest pose: "no", it said', (None, None)))
    return found


def write(path, study, found, go_on=False, finish=True) -> TableWriter:
    writer = TableWriter(path, study, Made.by(study, "1.0", "trackride sweep"), go_on)
    for row in found[writer.done :]:
        writer.add(row)
    writer.finish() if finish else writer.close()
    return writer


def test_rows_are_read_back_to_the_last_digit(tmp_path, suffix):
    study, path = made_study(), tmp_path / f"table{suffix}"
    write(path, study, made_rows(study))
    assert list(read_rows(path, study)) == made_rows(study)
    assert read_made(path) == Made.by(study, "1.0", "trackride sweep")
    assert [path.name for path in tmp_path.iterdir()] == [path.name]


def test_python_reads_the_table_with_what_made_it(tmp_path, suffix):
    study, path = made_study(), tmp_path / f"table{suffix}"
    write(path, study, made_rows(study))
    table = read_table(path)
    assert table.column_names == [
        "run", "vehicle.seat.x", f"{WHEELS}.positions", "drive.mode", "status", "shock", "peak_load.R1",
    ]  # fmt: skip
    assert table["shock"].to_pylist() == [row.outcome.figures[0] for row in made_rows(study)]
    assert table[f"{WHEELS}.positions"].to_pylist()[:2] == ["[1.0, 0.0, -1.0]", ""]
    assert b"Paper vehicle" in table.schema.metadata[KEY]


def test_a_table_that_was_cut_off_anywhere_goes_on_to_the_same_table(tmp_path, suffix):
    study = made_study(count=2)
    whole = tmp_path / f"whole{suffix}"
    write(whole, study, made_rows(study))
    path, part = tmp_path / f"table{suffix}", tmp_path / f"table{suffix}.part"
    write(path, study, made_rows(study), finish=False)
    content = part.read_bytes()
    start = content.index(b"\n", content.index(b"\nrun,") + 1) + 1
    for end in range(start, len(content), 7):
        part.write_bytes(content[:end])
        write(path, study, made_rows(study), go_on=True)
        assert path.read_bytes() == whole.read_bytes()
        path.unlink()


def test_an_interrupted_table_goes_on(tmp_path, suffix):
    study, path = made_study(), tmp_path / f"table{suffix}"
    write(path, study, made_rows(study)[:4])
    assert len(list(read_rows(path, study))) == 4
    assert write(path, study, made_rows(study), go_on=True).done == 10
    assert list(read_rows(path, study)) == made_rows(study)


def test_a_table_of_another_study_does_not_go_on(tmp_path, suffix):
    study, path = made_study(), tmp_path / f"table{suffix}"
    write(path, study, made_rows(study)[:4])
    for other in (made_study(("shock", "pitch")), made_study(count=6)):
        with pytest.raises(DesignError, match="is the table of another study"):
            write(path, other, [], go_on=True)


def test_other_files_are_no_tables(tmp_path, suffix):
    path = tmp_path / f"table{suffix}"
    for content in (b"", b"# {}\nrun\n", b"\xff\xfe", b"a,b\n1,2\n"):
        path.write_bytes(content)
        with pytest.raises(DesignError, match="is no table of a study"):
            read_table(path)
