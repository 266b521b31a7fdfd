"""The clock of the playback."""

from __future__ import annotations

import numpy as np
import pytest

from app.runs.playback import AHEAD, SPEEDS, STEP, Playback, of_another_kind, time_to_look
from model import load_config, simulate


def test_it_plays_at_its_speed_and_starts_again_at_the_end() -> None:
    playback = Playback(end=10)
    playback.advance(2)
    assert playback.time == 2
    playback.speed = SPEEDS["1/8×"]
    playback.advance(8)
    assert playback.time == 3
    playback.speed = SPEEDS["8×"]
    playback.advance(1)
    assert playback.time == pytest.approx(1)


def test_scrubbing_and_stepping_pause_it() -> None:
    playback = Playback(end=10)
    playback.scrub(4)
    playback.advance(1)
    assert (playback.time, playback.playing) == (4, False)
    playback.step(10)
    assert playback.time == pytest.approx(4 + 10 * STEP)
    playback.step(-10_000)
    assert playback.time == 0
    playback.step(10_000)
    assert playback.time == 10
    playback.toggle()
    assert (playback.time, playback.playing) == (0, True)


@pytest.mark.parametrize(("given", "expected"), [(-1, 0), (11, 10), (float("inf"), 10), (float("nan"), 0)])
def test_times_outside_the_run_lead_to_its_ends(given: float, expected: float) -> None:
    playback = Playback(end=10)
    playback.scrub(given)
    assert playback.time == expected


def test_a_new_run_goes_on_at_the_same_time() -> None:
    playback = Playback(end=10, time=7)
    playback.fit(20)
    assert (playback.time, playback.playing) == (7, True)
    playback.fit(3)
    assert playback.time == 3
    playback.advance(0.5)
    assert playback.time == pytest.approx(0.5)


def test_without_a_run_time_stands_still() -> None:
    playback = Playback()
    playback.advance(1)
    playback.toggle()
    playback.toggle()
    playback.advance(1)
    assert playback.time == 0


def test_who_looks_at_level_road_behind_an_obstacle_is_led_to_another() -> None:
    half_round = load_config("half_round").replace({"simulation.duration": 4})
    step = simulate(half_round.replace({"road.type": "step"}))
    higher = simulate(half_round.replace({"road.height": 0.05}))
    for run in (step, higher):
        time = time_to_look(run, 3.5)
        front = float(np.interp(time, run.t, run.q[:, run.system.wheel, 0].max(axis=1))) + run.system.r
        assert run.road.uneven is not None
        assert run.road.uneven[0] - AHEAD <= front <= run.road.uneven[0]
        assert time_to_look(run, 0.8) == 0.8  # on it
    waves = simulate(load_config("paper").replace({"simulation.duration": 8}))
    assert time_to_look(waves, 8.0) == 8.0
    level = simulate(half_round.replace({"road.type": "flat"}))
    assert time_to_look(level, 3.5) == 3.5
    assert of_another_kind(step, higher)
    assert not of_another_kind(higher, simulate(half_round))
