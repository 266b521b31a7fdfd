"""What the plots show: no peak lost, nothing that is no number, units, the baseline, a wheel singled out."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app.format.colours import wheel_palette
from app.format.units import US
from app.plots.curves import Beside, Plot, load_plots
from app.plots.ride import ride_plots
from app.plots.thinning import BUCKETS, thin
from model.config.config_files import load_config
from model.simulation.trajectory import Trajectory
from tests.app.conftest import make_run

PAPER = load_config("paper")
PALETTE = wheel_palette(6, 5)


def loads(run: Trajectory, baseline: Trajectory | None = None, wheel: int | None = None) -> tuple[Plot, ...]:
    return load_plots(run, wheel_palette(run.system.n, run.system.m), baseline, wheel)


def all_plots(run: Trajectory, baseline: Trajectory | None = None) -> tuple[Plot, ...]:
    return loads(run, baseline) + ride_plots(run, wheel_palette(run.system.n, run.system.m), baseline)


def column(plot: Plot, label: str, kind: str = "run") -> np.ndarray:
    [k] = [k for k, curve in enumerate(plot.curves) if (curve.label, curve.kind) == (label, kind)]
    return plot.values[:, k]


@pytest.mark.parametrize("samples", [1, 2, 999, 1000, 1001, 2001, 6001, 100_000])
@pytest.mark.parametrize("at", [0.0, 0.37, 0.998, 1.0])
def test_a_spike_of_one_sample_survives(samples: int, at: float) -> None:
    t = np.arange(samples) / 200
    values = np.zeros((samples, 3))
    index = int(at * (samples - 1))
    values[index] = (7, -5, 0)
    time, thinned = thin(t, values)
    assert len(time) <= 2 * BUCKETS
    assert thinned[:, 0].max() == 7
    assert thinned[:, 1].min() == -5
    drawn_at = time[thinned[:, 0].argmax()]
    assert abs(drawn_at - t[index]) <= t[-1] / BUCKETS + 1 / 200


def test_thinned_curves_rise_in_time_and_span_all_of_it() -> None:
    t = np.linspace(0, 10, 5003)
    time, values = thin(t, np.sin(t)[:, None])
    assert (np.diff(time) >= 0).all()
    assert (time[0], time[-1]) == (0, 10)
    assert values.max() == np.sin(t).max()
    assert np.abs(np.interp(t, time, values[:, 0]) - np.sin(t)).max() < 0.03


def test_what_is_left_out_lies_on_the_lines_that_are_drawn() -> None:
    t = np.linspace(0, 10, 5003)
    waves = np.column_stack([np.sin(t), np.abs(np.sin(1.7 * t)) - 0.5, np.where(t < 6, 0.3, np.nan)])
    time, values = thin(t, waves)
    assert len(time) < 500
    assert np.isin(time, t).all()
    assert np.diff(time).max() <= 10 / 160
    for given, drawn in zip(waves.T[:2], values.T[:2], strict=True):
        assert np.abs(np.interp(t, time, drawn) - given).max() <= 2.5e-3 * 2.0001
        assert (drawn.min(), drawn.max()) == (given.min(), given.max())
    ends = np.isfinite(values[:, 2])
    assert time[ends].max() == t[t < 6].max()


def test_a_rough_run_keeps_the_extremes_of_every_stretch() -> None:
    t = np.arange(20_000) / 200
    noise = np.random.default_rng(0).normal(size=(len(t), 2))
    time, values = thin(t, noise)
    assert len(time) == 2 * BUCKETS
    for first in range(0, len(t), 50):
        here = (time >= t[first]) & (time <= t[first + 49])
        np.testing.assert_array_equal(values[here].max(axis=0), noise[first : first + 50].max(axis=0))
        np.testing.assert_array_equal(values[here].min(axis=0), noise[first : first + 50].min(axis=0))


def test_a_short_run_is_not_thinned() -> None:
    t = np.arange(2 * BUCKETS) / 200
    time, values = thin(t, np.cos(t)[:, None])
    assert np.array_equal(time, t)
    assert np.array_equal(values[:, 0], np.cos(t))


def test_samples_that_are_no_numbers_are_left_out() -> None:
    run = make_run()
    load, a = run.normal_load.copy(), run.a.copy()
    load[-3:] = np.nan
    a[-1] = np.inf
    for plot in all_plots(replace(run, normal_load=load, a=a)):
        assert len(plot.x) == len(plot.values) > 150
        assert all(np.isfinite(column).all() for column in plot.data)


def test_plots_have_units_names_and_the_wheels_colours() -> None:
    road, imaginary, share = loads(make_run())
    assert [c.label for c in road.curves if c.kind == "run"] == ["R1", "R2", "R3", "R4", "R5", "R6"]
    assert [c.colour for c in road.curves if c.kind == "run"] == list(PALETTE.road)
    assert [c.label for c in imaginary.curves if c.kind == "run"] == ["I1", "I2", "I3", "I4", "I5"]
    assert [c.colour for c in imaginary.curves if c.kind == "run"] == list(PALETTE.imaginary)
    assert (road.unit, imaginary.unit, share.unit) == ("kN", "kN", "%")
    assert column(road, "R1")[0] == pytest.approx(15)  # 15 000 N
    assert column(share, "Share")[0] == pytest.approx(100 * 5 / 11, abs=0.01)


def test_with_all_wheels_in_the_air_the_imaginary_ones_carry_nothing() -> None:
    run = make_run()
    *_, share = loads(replace(run, normal_load=np.zeros_like(run.normal_load)))
    assert (column(share, "Share") == 0).all()


def test_the_ride_in_the_units_of_its_plots() -> None:
    run = make_run()
    q, v = run.q.copy(), run.v.copy()
    q[:, 0, 2] = np.radians(3)
    q[100:, run.system.road_wheels.start + 1, 1] += 0.02
    v[:, 0, 0] = 10
    acceleration, pitch, speed, travel = ride_plots(replace(run, q=q, v=v), PALETTE)
    assert [plot.unit for plot in (acceleration, pitch, speed, travel)] == ["m/s²", "degrees", "km/h", "mm"]
    assert column(acceleration, "Hull").max() == pytest.approx(15)
    assert column(pitch, "Hull") == pytest.approx(3)
    assert column(speed, "Hull") == pytest.approx(36)
    assert column(travel, "R2")[[0, -1]] == pytest.approx([0, 20], abs=0.1)
    assert (column(travel, "R1") == 0).all()


def test_a_vehicle_without_imaginary_wheels_has_one_plot_of_loads() -> None:
    run = make_run(PAPER.replace({"vehicle.imaginary_wheels.enabled": False}))
    assert [plot.title for plot in loads(run)] == ["Normal load of road wheels"]


def test_a_baseline_adds_its_curves_at_the_runs_times_as_far_as_it_goes() -> None:
    run = make_run(PAPER.replace({"drive.speed_kmh": 20}), samples=201)
    baseline = make_run(PAPER.replace({"vehicle.road_wheels.count": 4}), samples=101)
    road, imaginary, _ = loads(run, baseline)
    assert [c.label for c in road.curves if c.kind == "baseline"] == ["R1", "R2", "R3", "R4"]
    assert [c.label for c in imaginary.curves if c.kind == "baseline"] == ["I1", "I2", "I3"]
    assert len(road.values) == 201
    assert column(road, "R1")[0] == pytest.approx(20)
    assert column(road, "R1", "baseline")[0] == pytest.approx(15)
    assert np.isfinite(column(road, "R1", "baseline")[:101]).all()
    assert np.isnan(column(road, "R1", "baseline")[101:]).all()
    assert road.curves[6].colour == road.curves[0].colour
    hull = ride_plots(run, PALETTE, baseline)[0]
    assert column(hull, "Hull", "baseline")[25] == pytest.approx(15)


def test_the_load_at_rest_is_marked_for_the_family_or_for_the_wheel_that_is_singled_out() -> None:
    run = make_run()
    run = replace(run, static_load=np.arange(11) * 1e3)
    road, imaginary, _ = loads(run)
    assert column(road, "at rest", "static") == pytest.approx(2.5)
    assert column(imaginary, "at rest", "static") == pytest.approx(8)
    road, imaginary, _ = loads(run, wheel=7)
    assert column(imaginary, "at rest", "static") == pytest.approx(7)
    assert [c.colour for c in imaginary.curves if c.kind == "static"] == [PALETTE.imaginary[1]]
    assert all(c.faded for c in road.curves)


def test_a_wheel_singled_out_leaves_the_others_faded() -> None:
    run, baseline = make_run(), make_run()
    road, imaginary, share = loads(run, baseline, wheel=2)
    assert {c.label for c in road.curves if not c.faded} == {"R3", "at rest"}
    assert sum(not c.faded for c in road.curves) == 3  # with the baseline's
    assert all(c.faded for c in imaginary.curves)
    assert not any(c.faded for c in share.curves)
    travel = ride_plots(run, PALETTE, None, wheel=2)[-1]
    assert [c.label for c in travel.curves if not c.faded] == ["R3"]
    assert not any(c.faded for c in ride_plots(run, PALETTE, None, wheel=7)[-1].curves)  # an imaginary wheel has none


def test_a_peak_between_samples_is_marked_with_its_own_time_and_value() -> None:
    run = make_run()
    found = run.peaks
    load, when = found.load.copy(), found.load_time.copy()
    load[1], when[1], load[7], when[7] = 27e3, 0.4567, 29e3, 3.0  # the last one after the run's end
    hull = {"acceleration": np.array(31.0), "acceleration_time": np.array(0.7533)}  # where samples are negative
    run = replace(run, tracked=replace(found, load=load, load_time=when, **hull))
    road, imaginary, share = loads(run)
    assert len(road.peaks) == 6
    assert (road.peaks[1].curve, road.peaks[1].time, road.peaks[1].value) == (1, 0.4567, 27.0)
    assert road.values.max() < 27
    assert [peak.curve for peak in imaginary.peaks] == [0, 2, 3, 4]
    assert not share.peaks
    [peak] = ride_plots(run, PALETTE)[0].peaks
    assert (peak.curve, peak.time, peak.value) == (0, 0.7533, -31.0)


def test_loads_of_a_vehicle_of_another_size_are_left_out_and_it_is_said() -> None:
    robot, paper = make_run(load_config("robot")), make_run()
    for run, other in ((robot, paper), (paper, robot)):
        road, imaginary, share = loads(run, other)
        for plot in (road, imaginary):
            assert plot.note == "baseline: other size"
            assert {curve.kind for curve in plot.curves} == {"run", "static"}
        assert not share.note
        assert "baseline" in {curve.kind for curve in share.curves}
    assert not loads(paper, make_run(load_config("marder")))[0].note


def test_a_run_without_samples_can_be_plotted() -> None:
    for plot in all_plots(make_run(samples=0), make_run()) + all_plots(make_run(), make_run(samples=0)):
        assert len({len(column) for column in plot.data}) == 1
        assert len(plot.data[0]) > 0


def test_a_run_beside_adds_one_curve_to_each_plot_in_its_colour():
    run = make_run()
    other = make_run(run.config.replace({"drive.speed_kmh": 30}), samples=101)
    plots = load_plots(run, PALETTE, beside=[Beside("Faster", "#112233", other)])
    for plot in plots:
        (at,) = [k for k, curve in enumerate(plot.curves) if curve.kind == "beside"]
        assert (plot.curves[at].label, plot.curves[at].colour) == ("Faster", "#112233")
        assert np.isnan(plot.values[-1, at])  # it is shorter
    road, *_ = plots
    at = [curve.kind for curve in road.curves].index("beside")
    largest = other.normal_load[:, : other.system.n].max(axis=1) / 1e3
    near = np.interp(road.x[road.x <= 1], other.t, largest)
    assert np.allclose(road.values[road.x <= 1, at], near, atol=0.02)
    single, *_ = load_plots(run, PALETTE, wheel=1, beside=[Beside("Faster", "#112233", other)])
    one = np.interp(single.x[single.x <= 1], other.t, other.normal_load[:, 1] / 1e3)
    assert np.allclose(single.values[single.x <= 1, at], one, atol=0.02)


def test_a_run_beside_without_the_singled_wheel_has_no_curve_there():
    run = make_run()
    four = make_run(run.config.replace({"vehicle.road_wheels.count": 4}))
    road, *_ = load_plots(run, PALETTE, wheel=5, beside=[Beside("Four", "#112233", four)])
    assert "beside" not in [curve.kind for curve in road.curves]


def test_all_plots_in_other_units_show_the_same_motion() -> None:
    run, baseline = make_run(), make_run(PAPER.replace({"drive.speed_kmh": 20}))
    told = load_plots(run, PALETTE, baseline, units=US) + ride_plots(run, PALETTE, baseline, units=US)
    assert [plot.unit for plot in told] == ["lbf", "lbf", "%", "g", "degrees", "mph", "in"]
    factors = 224.80894, 224.80894, 1.0, 1 / 9.80665, 1.0, 0.62137119, 1 / 25.4
    for plot, usual, factor in zip(told, all_plots(run, baseline), factors, strict=True):
        np.testing.assert_allclose(plot.values, usual.values * factor, atol=0.006 * max(factor, 1))
        assert [peak.value for peak in plot.peaks] == pytest.approx(
            [peak.value * factor for peak in usual.peaks], abs=0.006 * max(factor, 1)
        )
        assert plot.least == (None if usual.least is None else pytest.approx(np.multiply(usual.least, factor)))
    assert np.ptp(told[3].values[:, 0]) == pytest.approx(np.ptp(run.a[:, 0, 1]) / 9.80665, abs=0.002)  # a decimal more
