"""The replay as a file: how long it may be, and that making one can be stopped."""

from __future__ import annotations

import re
import threading
from dataclasses import replace

import numpy as np

from app.files import replay
from app.files.replay import replay_html
from model.config.config_files import load_config
from tests.app.conftest import make_run, wait_for


def test_a_long_run_is_cut_and_says_so(monkeypatch):
    monkeypatch.setattr(replay, "LONGEST", 0.2)
    page = replay_html(make_run(), None, "Long")
    assert page is not None
    assert "<title>Long (the first 0.2 s of 2 s)</title>" in page


def key(run, baseline=None, title="") -> str:
    page = replay_html(run, baseline, "One", baseline_title=title)
    assert page is not None
    return page.rpartition('class="trackride-key"')[2].partition("<script>")[0]


def test_a_key_says_what_the_colours_mean(monkeypatch):
    monkeypatch.setattr(replay, "LONGEST", 0.05)
    run = make_run()
    assert "Imaginary wheel" in key(run)
    assert "Baseline" not in key(run)
    assert "in the air" not in key(run)
    flying = replace(run, normal_load=np.where(run.t[:, None] > 1, 0.0, run.normal_load))
    assert "Wheel in the air" in key(flying)
    assert "Baseline: Half &amp; half" in key(run, run, "Half & half")
    small = make_run(load_config("robot"))
    assert "Baseline" not in key(run, small, "Robot")  # of another size: it is not drawn


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
