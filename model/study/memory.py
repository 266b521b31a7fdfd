"""Runs that an analysis has done, in a file, so that one which was stopped does not do them again."""

from __future__ import annotations

import json
from collections.abc import Callable
from hashlib import sha256
from pathlib import Path

from model.config.config import Config
from model.config.config_files import dump_config
from model.files import write_whole
from model.simulation.batch import in_order
from model.simulation.simulate import warm_up
from model.study.design import DesignError
from model.study.running import Job, Outcome, Spread, done


class StoppedError(Exception):
    """The analysis was asked to stop."""


def part_of(path: Path) -> Path:
    """Where runs are remembered until the analysis is done."""
    return path.with_name(f"{path.name}.part")


class Memory:
    """Does jobs and remembers them: in a file of JSON lines, one a run. An Evaluate.

    An analysis that is the same again asks for the same runs; those of the file are not computed again. Until it is
    done the file is NAME.part.
    """

    def __init__(
        self,
        path: Path,
        version: str,
        go_on: bool = False,
        on_run: Callable[[], None] = lambda: None,
        should_stop: Callable[[], bool] = lambda: False,
        spread: Spread = in_order,
    ) -> None:
        """go_on: with the runs that the file has; else anew. Raises OSError, or DesignError for another file."""
        self.path, self.part = path, part_of(path)
        self.version, self.on_run, self.should_stop, self.spread = version, on_run, should_stop, spread
        self.known: dict[str, Outcome] = {}
        self._digests: dict[int, tuple[Config, str]] = {}
        if go_on:
            for kept in (path, self.part):
                if kept.exists():
                    self.known |= _read(kept)
        write_whole(self.part, "".join(_line(key, known) for key, known in self.known.items()).encode())
        self._file = self.part.open("a", encoding="utf-8")

    def __call__(self, jobs: list[Job]) -> list[Outcome]:
        """Raises StoppedError when it is asked to stop; what was done is kept."""
        for integrator in {job.base.simulation.integrator for job in jobs}:
            warm_up(integrator)
        keys = [self._key(job) for job in jobs]
        new = {key: job for key, job in zip(keys, jobs, strict=True) if key not in self.known}
        found = self.spread(done, new.values())
        try:
            for key, outcome in zip(new, found, strict=True):
                self.known[key] = outcome
                self._file.write(_line(key, outcome))
                self._file.flush()
                self.on_run()
                if self.should_stop():
                    raise StoppedError
        finally:
            found.close()
        return [self.known[key] for key in keys]

    def finish(self) -> None:
        """The analysis is done."""
        self.close()
        self.part.replace(self.path)

    def close(self) -> None:
        """Leave what was done to a later one that goes on; nothing where nothing was."""
        self._file.close()
        if not self.known:
            self.part.unlink(missing_ok=True)

    def _key(self, job: Job) -> str:
        """The same for the same run of the same version."""
        if id(job.base) not in self._digests:
            text = f"{self.version}\n{dump_config(job.base)}"
            self._digests[id(job.base)] = job.base, sha256(text.encode()).hexdigest()[:16]
        changes = dict(sorted(job.changes.items()))
        return json.dumps([self._digests[id(job.base)][1], changes, job.figures])


def _line(key: str, outcome: Outcome) -> str:
    return json.dumps([key, outcome.status, outcome.figures]) + "\n"


def _read(path: Path) -> dict[str, Outcome]:
    """The runs in a file, whose last line may be half written. Raises DesignError for a file that holds no runs."""
    known = {}
    try:
        for line in path.read_text(encoding="utf-8").splitlines(keepends=True):
            if line.endswith("\n"):
                key, status, figures = json.loads(line)
                known[str(key)] = Outcome(str(status), tuple(figures))
    except (ValueError, TypeError):
        raise DesignError(f"{path}: holds no runs of a study; delete it, or leave out --resume") from None
    return known
