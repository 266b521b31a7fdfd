"""The table of a study on disk: a row a run, as Parquet or CSV, with what made it.

Rows go to NAME.part while the study runs, in CSV, so that memory stays flat and a study that is killed loses no run
that was done; `finish` makes the table of them. Floats have as many digits as it takes to read the same ones back.
"""

from __future__ import annotations

import csv
import json
import math
import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from io import StringIO
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any

from model.config.config_files import dump_config
from model.config.parameters import PARAMETER
from model.files import write_whole
from model.study.design import DesignError, Study, Values
from model.study.running import Outcome, Row

if TYPE_CHECKING:
    import pyarrow

SUFFIXES = (".parquet", ".csv")
BATCH = 1000  # rows read or written at once
KEY = b"trackride"  # of the metadata in Parquet
TOTAL = 3  # where the number of runs stands in what is told of a study
ROW_BYTES = 40, 20  # on disk: of a row, and for each of its columns


@dataclass(frozen=True)
class Made:
    """What made a table."""

    configuration: str  # YAML of the base
    version: str  # of Trackride
    command: str
    study: str  # in JSON: what varies, how the points were chosen, how many runs, which figures

    @classmethod
    def by(cls, study: Study, version: str, command: str) -> Made:
        varied = [[of.key, of.values if isinstance(of, Values) else (of.low, of.high)] for of in study.varied]
        told = [varied, study.sample, study.seed, len(study.points), study.figures]  # the fourth is TOTAL
        return cls(dump_config(study.base), version, command, json.dumps(told))

    def same_runs(self, other: Made) -> bool:
        """Whether both have the same rows, to the last digit."""
        return (self.configuration, self.version, self.study) == (other.configuration, other.version, other.study)


def part_of(path: Path) -> Path:
    """Where the rows of a table go while its study runs."""
    return path.with_name(f"{path.name}.part")


class TableWriter:
    """Takes the rows of a study in their order, and writes its table. Raises OSError when it cannot."""

    def __init__(self, path: Path, study: Study, made: Made, go_on: bool = False) -> None:
        """go_on: after the rows that a table of the same study has already. Raises DesignError for one of another."""
        self.path, self.part = path, part_of(path)
        self.study, self.made = study, made
        self.done = 0  # rows that are written
        if go_on and (self.part.exists() or path.exists()):
            self._take_over(self.part if self.part.exists() else path)
        else:
            _begin(self.part, study, made)
        self._file = self.part.open("a", encoding="utf-8", newline="")

    def _take_over(self, path: Path) -> None:
        """Begin with the sound rows of a table that was not finished, whose last line may be half written."""
        made = read_made(path)
        if not made.same_runs(self.made):
            raise DesignError(f"{path}: is the table of another study, or of another version; give another name")
        fresh = self.part.with_name(f"{self.part.name}.new")
        _begin(fresh, self.study, self.made)
        with fresh.open("a", encoding="utf-8", newline="") as file:
            for row in read_rows(path, self.study):
                if row.run != self.done:
                    raise DesignError(f"{path}: run {self.done} is missing; delete it, and leave out --resume")
                file.write(_line(row))
                self.done += 1
        os.replace(fresh, self.part)

    def add(self, row: Row) -> None:
        """The next row; on disk at once, so that not even a kill loses it."""
        self._file.write(_line(row))
        self._file.flush()
        self.done += 1

    def finish(self) -> None:
        """Make the table of what has been added."""
        self._file.flush()
        os.fsync(self._file.fileno())
        self._file.close()
        if self.path.suffix == ".csv":
            os.replace(self.part, self.path)
            return
        _write_parquet(self.path, self.study, self.made, read_rows(self.part, self.study))
        self.part.unlink()

    def close(self) -> None:
        """Leave what has been added to a later writer that goes on."""
        self._file.close()


def columns(study: Study) -> list[str]:
    """Headings: the run, a column for each key, the status, one for each figure."""
    return ["run", *study.keys, "status", *study.figures]


def bytes_needed(study: Study) -> int:
    """About, for the table and what is written on the way to it."""
    each, of_column = ROW_BYTES
    return 2 * len(study.points) * (each + of_column * (len(study.keys) + len(study.figures)))


def read_made(path: Path) -> Made:
    """What made a table. Raises OSError, or DesignError for a file that is no such table."""
    no_table = DesignError(f"{path}: is no table of a study")
    try:
        if path.suffix == ".parquet":
            from pyarrow import ArrowInvalid, parquet

            try:
                text = (parquet.read_schema(path).metadata or {})[KEY].decode()
            except ArrowInvalid:
                raise no_table from None
        else:
            with path.open(encoding="utf-8", newline="") as file:
                text = file.readline().removeprefix("# ")
        return Made(**json.loads(text))
    except (KeyError, TypeError, ValueError):
        raise no_table from None


def progress_of(path: Path) -> tuple[int, int]:
    """Rows that a table has, and those that its study has; both 0 where there is no table of a study."""
    try:
        total = int(json.loads(read_made(path).study)[TOTAL])
        if path.suffix == ".parquet":
            from pyarrow import parquet

            return parquet.read_metadata(path).num_rows, total
        with path.open(encoding="utf-8", newline="") as file:
            return max(sum(line.endswith("\n") for line in file) - 2, 0), total
    except (OSError, DesignError, LookupError, TypeError, ValueError):
        return 0, 0


def read_rows(path: Path, study: Study) -> Iterator[Row]:
    """The rows of a table of that study; the last line of one that was cut off is left out."""
    keys = len(study.keys)
    if path.suffix == ".parquet":
        from pyarrow import parquet

        for batch in parquet.ParquetFile(path).iter_batches(BATCH):
            for entries in zip(*(column.to_pylist() for column in batch.columns), strict=True):
                run, *rest = entries
                yield Row(run, study.points[run], Outcome(rest[keys], tuple(rest[keys + 1 :])))
        return
    with path.open(encoding="utf-8", newline="") as file:
        whole = (line for line in file if line.endswith("\n"))
        for cells in csv.reader(islice(whole, 2, None)):
            run = int(cells[0])
            figures = tuple(float(cell) if cell else None for cell in cells[keys + 2 :])
            yield Row(run, study.points[run], Outcome(cells[keys + 1], figures))


def read_table(path: str | Path) -> pyarrow.Table:
    """A table of a study, .parquet or .csv, with configuration, version and command in its schema's metadata.

    Raises OSError, or DesignError for another file.
    """
    path = Path(path)
    made = read_made(path)
    if path.suffix == ".parquet":
        from pyarrow import parquet

        return parquet.read_table(path)
    from pyarrow import csv as arrow_csv

    options = arrow_csv.ReadOptions(skip_rows=1)
    return arrow_csv.read_csv(path, options).replace_schema_metadata({KEY: _json(made)})


def rows_table(study: Study, found: Sequence[Row]) -> pyarrow.Table:
    """Rows of a study as a pyarrow table, which pandas and polars read."""
    import pyarrow

    schema = _schema(study)
    entries: list[list[Any]] = [[row.run for row in found]]
    for k, of in enumerate(study.varied):
        values = [row.point[k] for row in found]
        entries.append([_text(value) for value in values] if of.listed else values)
    entries += [[row.outcome.status for row in found]]
    entries += [[_finite(row.outcome.figures[k]) for row in found] for k in range(len(study.figures))]
    arrays = [pyarrow.array(column, field.type) for column, field in zip(entries, schema, strict=True)]
    return pyarrow.Table.from_arrays(arrays, schema=schema)


def _begin(path: Path, study: Study, made: Made) -> None:
    write_whole(path, f"# {_json(made)}\n{_csv(columns(study))}".encode())


def _line(row: Row) -> str:
    cells = [row.run, *map(_text, row.point), row.outcome.status, *map(_text, row.outcome.figures)]
    return _csv(cells)


def _csv(cells: Sequence[object]) -> str:
    """One line."""
    text = StringIO()
    csv.writer(text, lineterminator="\n").writerow(cells)
    return text.getvalue()


def _text(value: Any) -> str:
    """A cell: empty for what is not there, a list as YAML has it."""
    if value is None or (isinstance(value, float) and not math.isfinite(value)):
        return ""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, tuple):
        return str(list(value))
    return repr(value) if isinstance(value, float) else str(value)


def _finite(value: float | None) -> float | None:
    return value if value is not None and math.isfinite(value) else None


def _schema(study: Study) -> pyarrow.Schema:
    import pyarrow

    kinds = {"integer": pyarrow.int64(), "choice": pyarrow.string(), "flag": pyarrow.bool_(), "list": pyarrow.string()}
    fields = [("run", pyarrow.int64())]
    for of in study.varied:
        listed = pyarrow.string() if of.listed else pyarrow.float64()
        fields.append((of.key, kinds.get(PARAMETER[of.key].kind, listed)))
    fields += [("status", pyarrow.string()), *((name, pyarrow.float64()) for name in study.figures)]
    return pyarrow.schema(fields)


def _write_parquet(path: Path, study: Study, made: Made, found: Iterator[Row]) -> None:
    from pyarrow import parquet

    fresh = path.with_name(f"{path.name}.new")
    schema = _schema(study).with_metadata({KEY: _json(made)})
    with parquet.ParquetWriter(fresh, schema) as writer:
        while batch := list(islice(found, BATCH)):
            writer.write_table(rows_table(study, batch).replace_schema_metadata(schema.metadata))
    os.replace(fresh, path)


def _json(made: Made) -> str:
    return json.dumps(made.__dict__, ensure_ascii=False)
