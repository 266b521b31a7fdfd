"""The table of figures, and the comparison of two runs, on hand-made runs whose answers are known."""

from __future__ import annotations

import numpy as np
import pytest

from model import load_config, simulate
from model.analysis.figures import AIR_TIME, DRIFT, ENERGY_ERROR, FIGURES, Row, comparison, figures_by_name, overall
from model.analysis.ride import Summary, imaginary_share, lift_offs
from model.simulation.trajectory import Trajectory
from tests.model.analysis.support import FLAT, RATE, standing


def test_every_figure_has_a_name_a_label_and_a_meaning_of_its_own():
    for key in ("name", "label", "meaning"):
        assert len({getattr(figure, key) for figure in FIGURES}) == len(FIGURES)
    assert all(figure.name.replace("_", "").isalpha() and figure.name.islower() for figure in FIGURES)


def test_figures_by_name_are_those_of_each_wheel_and_of_the_worst():
    run = standing()
    run.normal_load[2, 3], run.normal_load[3:, 8] = 9000, 0
    run.normal_load[1, :2] = 0
    of = Summary(run)
    found = figures_by_name(of)
    assert {figure.name for figure in FIGURES} <= set(found)
    assert (found["peak_load"], found["peak_load.R4"], found["peak_load.I1"]) == (9, 9, 5)
    assert found["air_time.I3"] == pytest.approx(2 / RATE)
    assert found["air_time"] == pytest.approx(2 / RATE)  # R1 and R2, a sample each
    assert found["shock"] == of.seat.shock
    assert "travel.I1" not in found


def test_the_checks_of_the_computation_are_figures_too():
    run = simulate(load_config("half_round"))
    found = figures_by_name(Summary(run))
    assert found["energy_error"] == pytest.approx(100 * run.energy_error)
    assert found["drift"] == pytest.approx(1e6 * run.constraint_residual.max())
    assert not {row.figure for row in comparison(run, None)} & {DRIFT.label, ENERGY_ERROR.label}


def test_what_cannot_be_told_is_none_and_stays_in_the_comparison():
    slow = standing(FLAT.replace({"simulation.output_rate": 50}))
    found = figures_by_name(Summary(slow))
    cannot = {name for name, value in found.items() if value is None} - {"energy_error"}  # not known of any of these
    assert cannot == {"shock", "weighted_acceleration", "vibration_dose", "transient", "absorbed_power"}
    row = rows(slow, standing())["Absorbed power at the seat"]
    assert (row.now, row.baseline, row.change) == (None, 0, None)


def test_a_dose_is_compared_over_the_same_time_or_where_a_longer_run_changes_nothing():
    config = load_config("half_round")
    short, long = (simulate(config.replace({"simulation.duration": seconds})) for seconds in (6, 12))
    waves = simulate(load_config("paper").replace({"drive.speed_kmh": 14}))
    paper = simulate(load_config("paper"))
    dose = "Vibration dose (VDV) at the seat"
    assert rows(short, long)[dose].change == pytest.approx(0, abs=1)
    assert rows(waves, paper)[dose].change is None
    assert rows(paper, paper)[dose].change == 0
    assert rows(short, long)[f"{AIR_TIME.label}, R1"].change is None


def rows(now: Trajectory, baseline: Trajectory | None) -> dict[str, Row]:
    found = {row.label: row for row in comparison(now, baseline)}
    assert len(found) == len(comparison(now, baseline))
    return found


def test_a_comparison_gives_now_baseline_and_change_in_readers_units():
    now, before = standing(), standing()
    before.a[:, 0, 1], now.a[:, 0, 1] = [2, -2, 2, -2, 2], [1, -1, 1, -1, 1]
    before.q[3, 0, 2], now.q[3, 0, 2] = np.radians(4), np.radians(-5)
    before.normal_load[1:3, 1], now.normal_load[1:4, 1] = 0, 0
    now.normal_load[0, 6] = 7500
    third = now.system.road_wheels.start + 2
    before.q[1, third, 1] += 0.02
    now.q[1, third, 1] += 0.02
    now.q[2, third, 1] -= 0.01
    found = rows(now, before)

    def row(label: str) -> tuple[str, float, float, float | None]:
        return found[label].unit, found[label].now, found[label].baseline, found[label].change

    assert row("Vertical acceleration, rms") == ("m/s²", 1, 2, -50)
    assert row("Vertical acceleration, peak") == ("m/s²", 1, 2, -50)
    assert row("Weighted acceleration at the seat")[:2] == ("m/s²", pytest.approx(Summary(now).seat.total))
    assert row("Absorbed power at the seat")[3] == pytest.approx(-75, abs=0.5)
    assert row("Pitch, peak to peak") == ("°", pytest.approx(5), pytest.approx(4), pytest.approx(25))
    assert row("Peak load, I1") == ("kN", 7.5, 5, pytest.approx(50))
    assert row("Peak load, R1") == ("kN", 5, 5, 0)
    assert row("Load, rms, R2") == (
        "kN",
        *(pytest.approx(5 * np.sqrt(k / 5)) for k in (2, 3)),
        pytest.approx(-18.35, abs=0.01),
    )
    assert row("Time in the air, R2") == ("s", pytest.approx(3 / RATE), pytest.approx(2 / RATE), pytest.approx(50))
    # R3: the hull's pitch of sample 3 moves its wheels too, so the figures are those of the summary
    up, down = Summary(now).travel_up[2], Summary(now).travel_down[2]
    assert row("Suspension travel, R3")[:2] == ("mm", pytest.approx(1000 * (up - down)))

    def share_of(run: Trajectory) -> float:
        return imaginary_share(run.normal_load, 6)

    share = found["Load on imaginary wheels"]
    assert share.unit == "%"
    assert share.now == pytest.approx(100 * share_of(now))
    assert share.change == pytest.approx(100 * (share_of(now) / share_of(before) - 1))


def test_changes_that_mean_nothing_are_left_out():
    quiet, shaken = standing(), standing()
    quiet.a[:, 0, 1], shaken.a[:, 0, 1] = 1e-9, 1
    shaken.normal_load[2, 0] = 0
    found = rows(shaken, quiet)
    assert found["Vertical acceleration, rms"].change is None
    assert found["Time in the air, R1"].change is None  # before: never
    assert found["Time in the air, R1"].now == pytest.approx(1 / RATE)
    assert found["Time in the air, R1"].resolution == pytest.approx(1 / RATE)
    assert (found["Lift-offs, R1"].now, found["Lift-offs, R1"].baseline, found["Lift-offs, R1"].resolved) == (
        1,
        0,
        True,
    )
    assert found["Peak load, R1"].resolution == 0
    assert found["Suspension travel, R1"].change is None
    longer = standing(samples=9)
    longer.normal_load[2, 0] = 0
    assert rows(longer, shaken)["Time in the air, R1"].change is None
    assert rows(shaken, shaken)["Time in the air, R1"].change == 0


def test_without_a_baseline_there_is_only_now():
    assert all(
        row.now is not None and row.baseline is None and row.change is None for row in comparison(standing(), None)
    )


def test_vehicles_with_different_wheels_are_compared_wheel_by_wheel():
    four = standing(FLAT.replace({"vehicle.road_wheels.count": 4}))
    bare = standing(FLAT.replace({"vehicle.imaginary_wheels.enabled": False}))
    found = rows(four, bare)
    peaks = [row.wheel for row in found.values() if row.figure == "Peak load"]
    assert peaks == ["R1", "R2", "R3", "R4", "R5", "R6", "I1", "I2", "I3"]
    assert (found["Peak load, R5"].now, found["Peak load, R5"].baseline) == (None, 5)
    assert (found["Peak load, I3"].now, found["Peak load, I3"].baseline) == (5, None)
    assert found["Peak load, I3"].change is None
    assert "Suspension travel, I1" not in found
    assert next(iter(found)) == "Vertical acceleration, rms"


def test_a_figure_of_each_wheel_is_told_for_all_of_them():
    now, before = standing(), standing()
    now.normal_load[2, 3], before.normal_load[2, 6] = 9000, 7500
    now.normal_load[[1, 3], 1], now.normal_load[1, 8] = 0, 0
    before.normal_load[1, 0] = 0
    found = {of.row.figure: of for of in overall(comparison(now, before))}
    peak = found["Peak load"]
    assert (peak.row.wheel, peak.row.now, peak.baseline_wheel, peak.row.baseline) == ("R4", 9, "I1", 7.5)
    assert peak.row.change == pytest.approx(20)
    lift_offs = found["Lift-offs"].row
    assert (lift_offs.wheel, lift_offs.now, lift_offs.baseline, lift_offs.change) == ("", 2, 1, 100)
    assert found["Time in the air"].row.now == pytest.approx(2 / RATE)
    alone = {of.row.figure: of.row for of in overall(comparison(now, None))}
    assert (alone["Peak load"].now, alone["Peak load"].baseline, alone["Lift-offs"].baseline) == (9, None, None)


def test_a_difference_counts_only_where_the_figure_resolves_it():
    def resolved(now: float, baseline: float | None, label: str = "Peak load", resolution: float = 0.0) -> bool:
        return Row(label, "R1", "kN", now, baseline, None, resolution).resolved

    assert not resolved(10, 10.05)
    assert resolved(10, 10.2)
    assert not resolved(10, None)
    assert not resolved(0, 0)
    assert not resolved(0.01, 0.012, AIR_TIME.label, resolution=0.005)
    assert resolved(0.01, 0.02, AIR_TIME.label, resolution=0.005)


def test_lift_offs_count_each_time_that_a_load_is_lost():
    load = np.array([[1, 0, 1], [0, 0, 1], [0, 1, 0], [1, 0, 1], [0, 1, 0.0]])
    assert lift_offs(load).tolist() == [2, 1, 2]
