"""What the plots show: no peak lost, nothing that is no number, units, the baseline, the time cursor."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app.colours import wheel_palette
from app.plots import BEYOND, BUCKETS, Plot, load_plots, thin, with_cursor
from model.config import load_config
from model.trajectory import Trajectory
from tests.app.conftest import make_run

PAPER = load_config("paper")


def plots_of(run: Trajectory, baseline: Trajectory | None = None) -> tuple[Plot, ...]:
    palette = wheel_palette(run.system.n, run.system.m)
    return load_plots(run, palette.wheels, palette.hull, baseline)


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


def test_a_short_run_is_not_thinned() -> None:
    t = np.arange(900) / 200
    time, values = thin(t, np.cos(t)[:, None])
    assert np.array_equal(time, t)
    assert np.array_equal(values[:, 0], np.cos(t))


def test_samples_that_are_no_numbers_are_left_out() -> None:
    run = make_run()
    loads = run.normal_load.copy()
    loads[-3:] = np.nan
    acceleration = run.a.copy()
    acceleration[-1] = np.inf
    for plot in plots_of(replace(run, normal_load=loads, a=acceleration)):
        assert np.isfinite(plot.values).all()
        assert len(plot.time) == len(plot.values)
        assert all(np.isfinite(column).all() for column in with_cursor(plot, 2.0))


def test_plots_have_units_names_and_the_wheels_colours() -> None:
    road, imaginary, hull = plots_of(make_run())
    palette = wheel_palette(6, 5)
    assert [curve.label for curve in road.curves] == ["R1", "R2", "R3", "R4", "R5", "R6"]
    assert [curve.colour for curve in road.curves] == list(palette.road)
    assert [curve.label for curve in imaginary.curves] == ["I1", "I2", "I3", "I4", "I5"]
    assert [curve.colour for curve in imaginary.curves] == list(palette.imaginary)
    assert (road.unit, imaginary.unit, hull.unit) == ("kN", "kN", "m/s²")
    assert road.values[0, 0] == pytest.approx(15)  # 15 000 N
    assert hull.values[25, 0] == pytest.approx(15)


def test_a_vehicle_without_imaginary_wheels_has_two_plots() -> None:
    run = make_run(PAPER.replace({"vehicle.imaginary_wheels.enabled": False}))
    assert [plot.title for plot in plots_of(run)] == [
        "Normal load of road wheels",
        "Vertical acceleration of the hull",
    ]


def test_a_baseline_adds_its_curves_at_the_runs_times() -> None:
    run = make_run(PAPER.replace({"drive.speed_kmh": 20}), samples=201)
    baseline = make_run(PAPER.replace({"vehicle.road_wheels.count": 4}), samples=101)
    road, imaginary, hull = plots_of(run, baseline)
    assert [curve.label for curve in road.curves if curve.baseline] == ["R1", "R2", "R3", "R4"]
    assert [curve.label for curve in imaginary.curves if curve.baseline] == ["I1", "I2", "I3"]
    assert road.values.shape == (201, 6 + 4)
    assert road.values[0, 0] == pytest.approx(20)
    assert road.values[0, 6] == pytest.approx(15)
    assert road.curves[6].colour == road.curves[0].colour
    assert hull.values[25, 1] == pytest.approx(15)
    assert plots_of(run)[0].layout != road.layout
    assert plots_of(make_run())[0].layout == plots_of(run)[0].layout


@pytest.mark.parametrize("time", [-1.0, 0.0, 0.7312, 1.0, 2.0, 5.0])
def test_the_cursor_stands_upright_and_the_curves_run_through_it(time: float) -> None:
    plot = plots_of(make_run())[0]
    t, *curves, cursor = with_cursor(plot, time)
    assert (np.diff(t) >= 0).all()
    assert {len(t)} == {len(column) for column in (*curves, cursor)} == {len(plot.time) + 3}
    top = int(cursor.argmax())
    expected = float(np.clip(time, 0, 2))
    assert list(t[top - 1 : top + 2]) == pytest.approx([expected] * 3)
    assert list(cursor[top - 1 : top + 2]) == [-BEYOND, 1 + BEYOND, -BEYOND]
    assert (np.delete(cursor, top) == -BEYOND).all()
    for column, curve in zip(plot.values.T, curves, strict=True):
        assert np.allclose(curve, np.interp(t, plot.time, column))


def test_a_run_without_samples_can_be_plotted() -> None:
    for plot in plots_of(make_run(samples=0)):
        data = with_cursor(plot, 0.0)
        assert len({len(column) for column in data}) == 1
