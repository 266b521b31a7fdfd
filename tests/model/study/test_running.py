"""Runs of a study, and those that come to grief."""

from __future__ import annotations

from functools import partial

import pytest

from model import Trajectory, load_config, simulate
from model.analysis.figures import figures_by_name
from model.analysis.ride import Summary
from model.simulation.batch import in_order
from model.simulation.simulate import simulate_motion
from model.study.design import Range, Values, make_study
from model.study.running import rows
from tests.model.support import FLAT, PAPER, ROAD_SPRING

SHORT = PAPER.replace({"simulation.duration": 2})


def test_rows_are_the_figures_of_single_runs_in_order():
    study = make_study(SHORT, [Range("drive.speed_kmh", 10, 30, 7)], ["peak_load", "peak_load.R3", "shock", "air_time"])
    kept = {}
    found = list(rows(study, keep=lambda run, trajectory: kept.update({run: trajectory})))
    for number, row in enumerate(found):
        single = simulate(SHORT.replace({"drive.speed_kmh": row.point[0]}))
        named = figures_by_name(Summary(single))
        assert (row.run, row.outcome.status) == (number, "complete")
        assert row.outcome.figures == tuple(named[name] for name in study.figures)
        assert kept[number].config == single.config
    assert list(rows(study, first=5, spread=partial(in_order, workers=1))) == found[5:]


def test_runs_that_come_to_grief_are_rows():
    stiffness = Values(f"{ROAD_SPRING}.stiffness", (10.0, 5e4))
    step = Values("simulation.step", (0.02, 0.001))
    settings = {"simulation.integrator": "rk4", "simulation.duration": 0.5}
    statuses = [row.outcome.status for row in rows(make_study(PAPER.replace(settings), [stiffness, step]))]
    assert statuses[0].startswith("no rest pose: ")
    assert statuses[2].startswith("inaccurate at t = ")
    assert statuses[3] == "complete"


def test_values_that_do_not_go_together_are_a_row():
    base = FLAT.replace({"road.type": "half_round", "simulation.duration": 1})
    found = list(rows(make_study(base, [Values("road.height", (0.1, 0.3))], ["shock", "pitch"])))
    assert found[0].outcome.complete
    assert found[1].outcome.status == "not allowed: road.height: must not be greater than the radius, 0.2 m"
    assert found[1].outcome.figures == (None, None)


@pytest.mark.parametrize("preset", ["paper", "half_round", "m113"])
def test_a_run_for_figures_alone_is_the_same_to_the_last_digit(preset):
    config = load_config(preset).replace({"simulation.duration": 4, "drive.speed_kmh": 30})
    motion, run = simulate_motion(config), simulate(config)
    assert figures_by_name(Summary(motion)) == figures_by_name(Summary(run))
    assert motion.a.shape == (len(motion.t), 1, 3)
    assert not isinstance(motion, Trajectory)
