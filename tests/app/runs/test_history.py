"""Undo and redo, and the runs that are kept: pure, without a tab."""

from __future__ import annotations

import pytest

import app.runs.history
from app.runs.history import REST, RUN_COLOURS, RUNS, Changes, Runs, differences, run_name, size
from app.runs.request import Request
from model.config.config_files import load_config
from tests.app.conftest import make_run

PAPER, HALF_ROUND = load_config("paper"), load_config("half_round")
SPEED, AMPLITUDE = "drive.speed_kmh", "road.amplitude"


def faster(speed: float) -> Request:
    return Request(PAPER).changed(SPEED, speed)


def named(request: Request) -> str:
    return run_name(request.base, request.config())


def test_each_rested_change_is_a_step_back_and_forth():
    changes = Changes(Request(PAPER))
    changes.note(faster(20), 10.0)
    changes.note(faster(20).changed(AMPLITUDE, 0.2), 20.0)
    assert changes.go(-1).changes == {SPEED: 20}
    assert changes.go(-1).changes == {}
    assert changes.go(-1) is None
    assert changes.go(+2).changes == {SPEED: 20, AMPLITUDE: 0.2}
    assert changes.go(+1) is None


def test_a_drag_is_one_step():
    changes = Changes(Request(PAPER))
    for k in range(50):
        changes.note(faster(16 + k), 10 + k * REST / 2)
    assert changes.present.changes == {SPEED: 65}
    assert changes.go(-1).changes == {}


def test_quick_changes_of_two_parameters_are_two_steps():
    changes = Changes(Request(PAPER))
    changes.note(faster(20), 10.0)
    changes.note(faster(20).changed(AMPLITUDE, 0.2), 10.1)
    changes.note(faster(20).changed(AMPLITUDE, 0.25), 10.2)
    assert changes.go(-1).changes == {SPEED: 20}


def test_two_presets_loaded_quickly_are_two_steps():
    changes = Changes(Request(PAPER))
    changes.note(Request(HALF_ROUND), 10.0)
    changes.note(Request(load_config("short_waves")), 10.1)
    assert changes.go(-1).base == HALF_ROUND


def test_a_change_after_undo_forgets_what_was_undone_and_does_not_join_the_step_before():
    changes = Changes(Request(PAPER))
    changes.note(faster(20), 10.0)
    changes.note(faster(30), 20.0)
    changes.go(-1)
    changes.note(faster(20), 20.1)  # the run of what was gone back to
    changes.note(faster(40), 25.0)
    assert changes.go(+1) is None
    assert changes.go(-1).changes == {SPEED: 20}
    assert changes.go(-1).changes == {}


def test_a_reset_in_the_middle_of_a_drag_is_a_step_of_its_own():
    changes = Changes(Request(PAPER))
    changes.note(faster(20), 10.0)
    changes.note(faster(30), 20.0)
    changes.note(Request(PAPER), 20.1)
    assert changes.go(-1).changes == {SPEED: 30}


def test_steps_are_bounded(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(app.runs.history, "STEPS", 5)
    changes = Changes(Request(PAPER))
    for k in range(20):
        changes.note(faster(10 + k), 10.0 * k)
    assert changes.go(-100).changes == {SPEED: 24}


def test_a_run_is_named_after_its_changes_in_shown_units():
    assert named(Request(PAPER)) == PAPER.name
    assert named(faster(22)) == "Speed 15 → 22 km/h"
    assert named(faster(15)) == PAPER.name  # as it was
    both = Request(PAPER).changed("vehicle.road_suspension.damping", 2366.0).changed(AMPLITUDE, 0.15)
    assert named(both) == "Suspension damping 4.732 → 2.366 kN s/m, Amplitude 100 → 150 mm"
    many = both.changed(SPEED, 22).changed("contact.friction", 0.5)
    assert named(many).endswith(" and 2 more")
    assert named(Request(PAPER).changed("vehicle.imaginary_wheels.enabled", False)) == "Imaginary wheels on → off"
    flat = named(Request(PAPER).changed("road.type", "flat"))
    assert flat == "Road type sine → flat"
    assert "left out → 3" in named(Request(PAPER).changed("road.start", 3.0))


def test_runs_are_told_apart_and_kept_once():
    runs = Runs()
    first = runs.keep(Request(PAPER), make_run(PAPER))
    second = runs.keep(faster(20), make_run(faster(20).config()))
    assert first.colour != second.colour
    assert [kept.number for kept in runs] == [1, 2]
    assert runs.keep(faster(20), make_run(faster(20).config())) is second
    assert runs.find(PAPER) is first
    assert runs.find(HALF_ROUND) is None


def test_a_run_is_renamed_and_gets_its_old_name_back():
    runs = Runs()
    runs.keep(faster(20), make_run(faster(20).config()))
    kept = runs.rename(1, "  the\nquick one ")
    assert (kept.name, kept.named) == ("the quick one", True)
    assert runs.rename(1, "x" * 1000).name == "x" * app.runs.history.NAME_LIMIT
    kept = runs.rename(1, " ")
    assert (kept.name, kept.named) == ("Speed 15 → 20 km/h", False)


def test_the_oldest_unnamed_run_makes_room():
    runs = Runs()
    for k in range(RUNS):
        runs.keep(faster(10 + k), make_run(faster(10 + k).config(), samples=2))
    runs.rename(1, "mine")
    runs.keep(faster(60), make_run(faster(60).config(), samples=2))
    numbers = [kept.number for kept in runs]
    assert len(numbers) == RUNS
    assert 1 in numbers
    assert 2 not in numbers
    runs.delete(1)
    assert len(runs) == RUNS - 1
    assert len({kept.colour for kept in runs}) == len(RUN_COLOURS)


def test_memory_is_bounded_by_letting_the_oldest_trajectories_go(monkeypatch: pytest.MonkeyPatch):
    runs = Runs()
    first = runs.keep(faster(10), make_run(faster(10).config(), samples=100), name="mine")
    monkeypatch.setattr(app.runs.history, "MEMORY", 2.5 * size(first))
    for k in range(1, 4):
        runs.keep(faster(10 + k), make_run(faster(10 + k).config(), samples=100))
    assert [kept.run is not None for kept in runs] == [False, False, True, True]
    assert [kept.config.drive.speed_kmh for kept in runs] == [10, 11, 12, 13]
    huge = runs.keep(faster(90), make_run(faster(90).config(), samples=1000))
    assert [kept.number for kept in runs if kept.run is not None] == [huge.number]  # the newest stays, however large
    runs.complete(make_run(faster(10).config(), samples=100))
    assert next(iter(runs)).run is not None


def test_what_was_kept_at_an_earlier_visit_is_kept_once_with_name_and_colour():
    runs, earlier = Runs(), Runs()
    now = runs.keep(Request(PAPER), make_run(PAPER))
    earlier.keep(Request(PAPER), make_run(PAPER))
    then = earlier.keep(faster(20), make_run(faster(20).config()), name="mine")
    assert runs.take_back(next(iter(earlier))) is now
    back = runs.take_back(then)
    assert (back.name, back.named, back.colour) == ("mine", True, then.colour)
    assert [kept.number for kept in runs] == [1, 2]


def test_rates_of_torsion_bars_are_told_in_their_own_unit():
    stiffness = "vehicle.road_suspension.stiffness"
    bars = PAPER.replace({"vehicle.road_suspension.basis": "torsion", stiffness: 9000})
    assert named(Request(bars).changed(stiffness, 8000)) == "Suspension stiffness 9 → 8 kN m/rad"
    assert "Suspension stiffness 75.53 kN/m → 9 kN m/rad" in differences(PAPER, bars)
