"""One job at a time."""

from __future__ import annotations

from app.session.background import BackgroundJob
from tests.app.conftest import wait_for


def test_an_error_in_a_job_is_told_and_the_next_one_begins() -> None:
    errors: list[Exception] = []
    job = BackgroundJob(errors.append)
    assert job.start(lambda: 1 / 0)
    wait_for(lambda: errors and not job.busy)
    done: list[bool] = []
    assert job.start(lambda: wait_for(job.stopped) and done.append(True))
    assert not job.start(lambda: None)
    job.close()
    assert done == [True]
