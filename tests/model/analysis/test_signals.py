"""The window of a run: which stretch of it the figures are taken from."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from model import load_config, simulate
from model.analysis.comfort import ride_comfort
from model.analysis.ride import Summary
from model.analysis.signals import SHORTEST, Window, seat, window
from model.config.config import Config
from model.config.config_files import preset_names
from model.paper.study import run_figures
from model.simulation.trajectory import Trajectory
from tests.model.support import PAPER

FIELD = Path(__file__).parents[2] / "field"


@cache
def run_of(preset: str, **changes: object) -> Trajectory:
    return simulate(load_config(preset).replace({key.replace("__", "."): value for key, value in changes.items()}))


def paper_on(changes: dict[str, object]) -> Trajectory:
    """The motion of the paper's run, said to be on another road."""
    return replace(run_of("paper"), config=PAPER.replace(changes))


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({}, 10 - 3 * 7 / (15 / 3.6)),  # the last whole waves since 4.76 s
        ({"road.ramp": 0, "road.start": 3}, 10 - 4 * 7 / (15 / 3.6)),  # since 3.14 s
        ({"road.wavelength": 100, "road.ramp": 1}, (2.75 + 1 + 1.75) / (15 / 3.6) + 2),  # not one is whole
        ({"road.type": "random"}, (2.75 + 5 + 1.75) / (15 / 3.6) + 2),
        ({"road.type": "random", "road.longest_wave": 60}, (2.75 + 15 + 1.75) / (15 / 3.6) + 2),
        (
            {"road.type": "sum", "road.parts": [{"type": "sine"}, {"type": "half_round", "position": 20}]},
            10 - 3 * 7 / (15 / 3.6),
        ),
        (
            {"road.type": "sum", "road.parts": [{"type": "sine"}, {"type": "random"}]},
            11.5 / (15 / 3.6) + 2,
        ),
    ],
)
def test_on_waves_the_steady_part_counts(changes, expected):
    found = window(paper_on(changes))
    assert found.start == pytest.approx(expected, abs=0.02)
    assert (found.end, found.goes_on, found.shortfall) == (10, True, "")


def test_the_papers_run_has_one_rms_acceleration_everywhere():
    """Runs, report and command line take a summary's, the paper's page that of its study's last waves."""
    told = run_figures(PAPER).acceleration_rms
    for seconds in (10, 15, 30):
        run = run_of("paper", simulation__duration=seconds)
        assert Summary(run).acceleration_rms == pytest.approx(told, rel=1e-3)
    assert window(run_of("paper")).why == "over the last 3 waves, from 5.0 s on, when the start has died away"


def test_waves_that_come_late_leave_half_the_run_and_a_word():
    found = window(paper_on({"road.start": 100}))
    assert (found.start, found.end) == (5, 10)
    assert found.shortfall == ("The start has died away only after 28.1 s: let the run last 31 s or more")


def test_a_level_road_counts_as_a_whole():
    found = window(paper_on({"road.type": "flat"}))
    assert (found.start, found.end, found.why, found.shortfall) == (0, 10, "over the whole run", "")
    missed = window(paper_on({"road.type": "half_round", "road.height": 0.1, "road.position": 500}))
    assert (missed.start, missed.end, missed.why, missed.reached) == (0, 10, "over the whole run", False)
    assert missed.shortfall.startswith(
        "The run ends before a wheel comes to the obstacle: it begins at x = 499.827 m, the wheels came to 4"
    )


def test_a_stretch_of_a_drive_counts_as_a_whole():
    run = run_of("half_round")
    assert window(replace(run, t=run.t + 30)) == Window(30, 36, "over this stretch of the drive")


def figures(run: Trajectory) -> dict[str, float]:
    of, felt = Summary(run), ride_comfort(run, seat(run.config))
    names = ("vertical", "fore_aft", "crest_factor", "dose", "transient", "shock", "absorbed_power", "total")
    found = {name: getattr(felt, name) for name in names}
    found |= {"rms": of.acceleration_rms, "share": of.imaginary_share}
    return found | {f"load rms {k}": load for k, load in enumerate(of.load_rms)}


@pytest.mark.parametrize(
    ("preset", "obstacle", "lengths"),
    [
        ("half_round", {}, (6, 12, 24)),
        ("kerb", {}, (6, 12, 40)),
        ("m113", {"road.type": "trapezoid", "road.position": 6}, (8, 16)),
        ("robot", {"road.type": "half_round", "road.position": 1, "road.height": 0.02, "road.radius": 0.05}, (6, 24)),
    ],
)
def test_on_an_obstacle_figures_do_not_depend_on_the_runs_length(preset, obstacle, lengths):
    config = load_config(preset).replace(obstacle)
    first, *longer = (simulate(config.replace({"simulation.duration": seconds})) for seconds in lengths)
    assert window(first).shortfall == ""
    assert not window(first).goes_on
    for run in longer:
        for name, value in figures(run).items():
            assert value == pytest.approx(figures(first)[name], rel=0.01), name


def test_the_window_of_an_obstacle_goes_from_the_first_contact_until_the_hull_has_settled():
    run = run_of("half_round")
    found, wheels = window(run), run.q[:, run.system.wheel, 0]
    foot = np.sqrt(0.2**2 - 0.1**2)  # of the round, from its middle
    before, after = run.t < found.start, run.t > found.end
    assert wheels[before].max() + run.system.r < 4 - foot <= wheels[~before].max() + run.system.r
    assert wheels[after].min() - run.system.r > 4 + foot
    v = np.abs(run.v[:, 0, 1:])
    assert (v[after].max(axis=0) < 0.05 * v.max(axis=0)).all()
    assert (v[run.t > found.end - 1].max(axis=0) > 0.05 * v.max(axis=0)).any()
    assert found.why == (
        f"from {found.start:.2f} s, when the first wheel comes to the obstacle, to {found.end:.2f} s, when the last is "
        "off it and the hull has settled"
    )


@pytest.mark.parametrize(
    ("seconds", "shortfall"),
    [
        (0.3, "The run ends before a wheel comes to the obstacle"),
        (1.2, "The run ends while wheels are on the obstacle"),
        (2.0, "The run ends before the hull has settled behind the obstacle"),
        (6.0, ""),
    ],
)
def test_a_run_that_is_too_short_for_an_obstacle(seconds, shortfall):
    found = window(run_of("half_round", simulation__duration=seconds))
    assert found.shortfall.partition(":")[0] == shortfall
    assert found.goes_on is bool(shortfall)


@pytest.mark.parametrize("preset", preset_names())
def test_presets_are_long_enough_for_their_figures(preset):
    found = window(run_of(preset))
    assert (found.shortfall, found.length > 2) == ("", True)


def test_a_window_moves_little_where_the_run_changes_little():
    """So that comparisons show what a change does, not by which half swing the window ended."""
    ends = [window(run_of("half_round", drive__speed_kmh=30 + k / 4)).end for k in range(9)]
    assert np.abs(np.diff(ends)).max() < 0.05


def test_a_measured_profile_that_ends_inside_the_run_counts_as_far_as_it_goes():
    run = simulate(load_config(str(FIELD / "profile_runs_out.yaml")))
    found = window(run)
    assert found.start == pytest.approx(0.23, abs=0.02)
    assert 10.7 < found.end < 12  # the last wheel leaves it at 10.86 s
    assert ride_comfort(run, seat(run.config)).total == pytest.approx(0.818, abs=0.003)  # over the whole run: 0.286


def test_a_measured_profile_longer_than_the_run_is_no_run_too_short():
    points = ", ".join(f"{x} {0.02 * np.sin(1.3 * x):.4f}" for x in range(200))
    run = simulate(PAPER.replace({"road.type": "profile", "road.points": points, "road.start": 3}))
    found = window(run)
    assert (found.end, found.shortfall, found.goes_on) == (10, "", True)
    short = simulate(run.config.replace({"simulation.duration": SHORTEST - 0.5}))
    assert window(short).shortfall == "The run ends while wheels are on the profile"


def test_two_obstacles_are_one_stretch():
    parts = [{"type": "half_round", "position": 4}, {"type": "step", "position": 12, "height": 0.1}]
    config = PAPER.replace({"road.type": "sum", "road.parts": parts, "simulation.duration": 10})
    found = window(simulate(config))
    assert 0 < found.start < 1
    assert found.end > (12 + 1.75) / (15 / 3.6)
    assert "comes to the obstacles" in found.why


def test_an_obstacle_of_no_height_is_none():
    flat = Config().replace({"road.type": "profile", "road.points": "0 0, 10 0, 20 0"})
    assert window(simulate(flat)).why == "over the whole run"
