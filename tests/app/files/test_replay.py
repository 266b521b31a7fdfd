"""The replay as a file: how long it may be, and that making one can be stopped."""

from __future__ import annotations

import re
import threading

from app.files import replay
from app.files.replay import replay_html
from tests.app.conftest import make_run, wait_for


def test_a_long_run_is_cut_and_says_so(monkeypatch):
    monkeypatch.setattr(replay, "LONGEST", 0.2)
    page = replay_html(make_run(), None, "Long")
    assert page is not None
    assert "<title>Long (the first 0.2 s of 2 s)</title>" in page


def test_it_can_be_stopped_and_leaves_nothing_behind(capsys):
    before = set(threading.enumerate())
    asked = []

    def should_stop() -> bool:
        asked.append(True)
        return len(asked) > 3

    assert replay_html(make_run(), None, "Stopped", should_stop=should_stop) is None
    assert len(asked) == 4
    wait_for(lambda: set(threading.enumerate()) <= before, "the server's threads to end")
    assert re.sub(r"\s", "", capsys.readouterr().out) == ""
