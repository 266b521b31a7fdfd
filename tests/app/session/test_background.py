"""One job at a time, and one after the other."""

from __future__ import annotations

from app.session.background import BackgroundJob, Job, JobQueue
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


def test_jobs_are_done_one_after_the_other_and_an_error_stops_none() -> None:
    errors: list[Exception] = []
    done: list[str] = []
    queue = JobQueue(errors.append)
    first = Job("first", lambda job: wait_for(job.stopped) and done.append("first"))
    for job in (first, Job("broken", lambda job: 1 / 0), Job("last", lambda job: done.append(job.title))):
        queue.add(job)
    wait_for(lambda: first.begun)
    assert [(job.title, job.begun) for job in queue.jobs] == [("first", True), ("broken", False), ("last", False)]
    queue.stop(first.number)
    wait_for(lambda: not queue.jobs)
    assert done == ["first", "last"]
    assert [type(error) for error in errors] == [ZeroDivisionError]


def test_a_job_that_waits_is_taken_out_at_once() -> None:
    done: list[str] = []
    queue = JobQueue(lambda error: None)
    first, other = Job("first", lambda job: wait_for(job.stopped)), Job("other", lambda job: done.append("other"))
    queue.add(first)
    queue.add(other)
    queue.stop(other.number)
    assert queue.jobs == (first,)
    queue.close()
    wait_for(lambda: not queue.jobs)
    assert done == []
