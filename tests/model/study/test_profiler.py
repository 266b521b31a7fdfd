"""Profiles: curves of true runs along each parameter, what they are worth, and which runs they take."""

from __future__ import annotations

import numpy as np
import pytest

from model.config.config import Config
from model.config.config_files import load_config
from model.study.design import Range
from model.study.profiler import (
    LEVELS,
    SEEDS,
    Found,
    axis_of,
    decisive,
    effects,
    known_profile,
    profiles,
    range_text,
    steps,
)
from model.study.running import COMPLETE, Job, Outcome, outcome

SPEED, STIFFNESS = "drive.speed_kmh", "vehicle.road_suspension.stiffness"
BASE = load_config("paper")


class Runs:
    """Runs made by hand: the figure is the speed, doubled, plus the stiffness in MN/m, plus the road's seed."""

    def __init__(self, diverges_at: float = np.inf) -> None:
        self.jobs: list[Job] = []
        self.diverges_at = diverges_at

    def __call__(self, jobs: list[Job]) -> list[Outcome]:
        self.jobs += jobs
        return [self.of(job) for job in jobs]

    def of(self, job: Job) -> Outcome:
        config = job.base.replace(job.changes)
        speed = config.drive.speed_kmh
        if speed >= self.diverges_at:
            return Outcome("diverged at 1 s", (None,))
        seed = config.value("road.seed") if config.road.type == "random" else 0
        return Outcome(COMPLETE, (2 * speed + 1e-6 * config.value(STIFFNESS) + seed,))


def axes(base: Config = BASE) -> list[Range]:
    return [axis_of(base, SPEED), axis_of(base, STIFFNESS)]  # type: ignore[list-item]


def profile(runs: Runs, base: Config = BASE, found: Found | None = None):
    return list(profiles(base, axes(base), ("peak_load",), runs, found or Found()))


def test_each_level_holds_the_values_of_the_level_before():
    axis = axis_of(BASE, SPEED)
    coarse, middle, fine = (steps(axis, level) for level in LEVELS)
    assert (len(coarse), len(middle), len(fine)) == LEVELS
    assert set(coarse) < set(middle) < set(fine)
    assert (fine[0], fine[-1]) == (axis.low, axis.high)


def test_whole_numbers_are_taken_once():
    axis = axis_of(BASE, "vehicle.road_wheels.count")
    assert steps(axis, LEVELS[-1]) == list(range(2, 21))
    assert range_text(axis, LEVELS[-1]) == "vehicle.road_wheels.count=2:20:19"


def test_a_range_is_the_sliders_with_the_present_value_in_it():
    assert axis_of(BASE.replace({SPEED: 90}), SPEED).high == 90
    assert axis_of(BASE, "road.height") is None  # of another road
    assert axis_of(BASE, "road.type") is None
    assert axis_of(BASE.replace({STIFFNESS: (75e3,) * 6}), STIFFNESS) is None  # one for each wheel


def test_curves_go_through_the_present_value():
    for made in profile(Runs()):
        for curve in made.curves:
            at = curve.values.tolist().index(BASE.value(curve.axis.key))
            assert curve.figures[at, 0] == made.present[0] == pytest.approx(30.07553)
            assert (np.diff(curve.values) > 0).all()


def test_a_true_run_stands_at_each_point():
    axis = Range(SPEED, 14.0, 16.0)
    base = BASE.replace({"simulation.duration": 1.0})
    made = next(iter(profiles(base, [axis], ("peak_load",), lambda jobs: [outcome(*job) for job in jobs], Found())))
    expected = outcome(base.replace({SPEED: 14.0}), {}, ("peak_load",)).figures[0]
    assert made.curves[0].figures[0, 0] == expected


def test_a_run_that_diverges_is_a_gap():
    made = profile(Runs(diverges_at=60.0))[-1]
    speed = made.curves[0]
    assert np.isnan(speed.figures[speed.values >= 60, 0]).all()
    assert np.isfinite(speed.figures[speed.values < 60, 0]).all()
    assert effects(made, "peak_load")[0].reach == pytest.approx(2 * (np.max(speed.values[speed.values < 60]) - 2))


def test_the_curve_of_a_slider_that_has_moved_is_known():
    found, runs = Found(), Runs()
    profile(runs, found=found)
    runs.jobs.clear()
    profile(runs, BASE.replace({SPEED: 20.0}), found)
    varied = [job for job in runs.jobs if SPEED in job.changes]
    assert varied == []
    assert len(runs.jobs) > LEVELS[-1] - 1


def test_after_an_undo_nothing_is_run():
    found, runs = Found(), Runs()
    profile(runs, found=found)
    profile(runs, BASE.replace({SPEED: 20.0}), found)
    runs.jobs.clear()
    again = profile(runs, found=found)
    assert runs.jobs == []
    assert [made.level for made in again] == [LEVELS[-1]]


def test_what_is_known_after_a_study_was_given_up_is_kept():
    found, runs = Found(), Runs()
    first = next(profiles(BASE, axes(), ("peak_load",), runs, found))
    known = known_profile(BASE, axes(), ("peak_load",), found)
    assert known is not None
    assert known.level == first.level == LEVELS[0]
    assert known_profile(BASE, axes(), ("travel",), found) is None


def test_on_a_random_road_a_band_over_several_seeds_follows_the_first_curve():
    base = BASE.replace({"road.type": "random", "road.seed": 3})
    runs = Runs()
    first, second, *_, last = profile(runs, base)
    assert first.curves[0].band is None
    assert len({job.changes["road.seed"] for job in runs.jobs if "road.seed" in job.changes}) == SEEDS
    for made in (second, last):
        band = made.curves[0].band
        assert np.ptp([band.low[0, 0], band.high[0, 0]]) == pytest.approx(SEEDS)


def test_effects_are_told_with_the_strongest_first_and_their_way():
    made = profile(Runs())[-1]
    speed, stiffness = effects(made, "peak_load")
    assert (speed.key, speed.reach, speed.way) == (SPEED, pytest.approx(2 * 68), 1)
    assert (stiffness.key, stiffness.reach) == (STIFFNESS, pytest.approx(0.295))
    assert decisive((speed, stiffness)) == (speed,)


def test_what_goes_up_and_down_again_has_no_way():
    def humped(jobs: list[Job]) -> list[Outcome]:
        return [Outcome(COMPLETE, (-((job.base.replace(job.changes).drive.speed_kmh - 36) ** 2),)) for job in jobs]

    made = next(profiles(BASE, axes()[:1], ("peak_load",), humped, Found()))
    assert effects(made, "peak_load")[0].way == 0


def test_what_changes_nothing_does_not_matter():
    made = next(profiles(BASE, axes(), ("peak_load",), lambda jobs: [Outcome(COMPLETE, (1.0,)) for _ in jobs], Found()))
    assert decisive(effects(made, "peak_load")) == ()


def test_of_too_many_curves_the_oldest_are_forgotten():
    found = Found(most=2)
    for speed in (10.0, 20.0, 30.0):
        found.curve(BASE.replace({SPEED: speed}), axis_of(BASE, STIFFNESS), ("peak_load",), None)[1.0] = Outcome("", ())
    assert not found.curve(BASE.replace({SPEED: 10.0}), axis_of(BASE, STIFFNESS), ("peak_load",), None)
