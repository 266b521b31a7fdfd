"""What helps a run that needs more steps than it may take: advice that is followed works."""

from __future__ import annotations

import pytest

from model import load_config, simulate
from model.config.config import Config
from model.road.road import build_road
from model.simulation.integrate import Integration
from model.simulation.relief import relief
from model.simulation.simulate import build_system, starting_state
from tests.conftest import ATTACK
from tests.model.support import PAPER, WHEELS

STIFF = {
    "a damper on light arms": load_config(ATTACK / "coherent-155.yaml"),
    "shear of the ground under light wheels": PAPER.replace({"contact.tangential_damping": 1e8, f"{WHEELS}.mass": 1.0}),
}


def at_rest(config: Config) -> Integration:
    system = build_system(config)
    y, _ = starting_state(system)
    return Integration.of(config.simulation, system, build_road(config).table, y, config.simulation.duration)


@pytest.mark.parametrize("config", STIFF.values(), ids=STIFF)
def test_advice_that_is_followed_works(config):
    config = config.replace({"simulation.duration": 0.1})
    run = simulate(config)
    assert "too many steps" in run.status
    changes = relief(config, at_rest(config))
    assert all(f"{key} to {value:g}" in run.advice for key, value in changes.items())
    assert simulate(config.replace(changes)).complete


def test_what_is_not_stiff_needs_no_relief():
    assert relief(PAPER, at_rest(PAPER)) == {}


def test_a_jammed_wheel_is_named_with_its_place_and_a_way_out():
    config = load_config(ATTACK / "coherent-127.yaml")
    run = simulate(config)
    assert "too many steps" in run.status
    assert "Wheel R1 is jammed in a corner of the road at x = 2.59 m" in run.advice
    assert "drive.mode to cruise" in run.advice
    assert simulate(config.replace({"drive.mode": "cruise"})).complete
