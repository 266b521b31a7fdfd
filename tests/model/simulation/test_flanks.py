"""Wheels in valleys tighter than themselves: steps end where they change flanks, and a jammed one costs little."""

from __future__ import annotations

import numpy as np

from model import load_config, simulate
from tests.conftest import ATTACK


def test_a_default_run_on_very_rough_ground_is_exact():
    """Without ends of steps at changes of flanks its heave was 0.12 mm off."""
    road = {"road.type": "random", "road.roughness_class": "H", "road.seed": 1, "simulation.duration": 6}
    config = load_config("paper_0583").replace(road)
    run, right = simulate(config), simulate(config.replace({"simulation.rtol": 1e-9, "simulation.atol": 1e-11}))
    arms = run.system.road_arms
    load = run.normal_load - right.normal_load
    assert np.abs(run.q[:, 0, 1] - right.q[:, 0, 1]).max() < 1e-4
    assert np.abs(run.q[:, 0, 2] - right.q[:, 0, 2]).max() < 1e-4
    assert np.abs(run.q[:, arms, 2] - right.q[:, arms, 2]).max() < 1e-3
    assert np.sqrt(np.mean(load**2, axis=0)).max() < 1e-3 * right.peaks.load.max()


def test_a_wheel_jammed_in_a_corner_holds_together():
    """Wheels go to and fro between the foot of a wall and the wall: the run comes further than 0.76 s, where it ended
    when each change was followed exactly, and joints stay together.
    """
    run = simulate(load_config(ATTACK / "coherent-127.yaml"))
    assert run.t[-1] > 1.1
    assert run.constraint_residual.max() < 3e-4
