"""Maps of a figure over two parameters."""

from __future__ import annotations

import numpy as np

from model.config.config_files import load_config
from model.study.figure_map import GRIDS, figure_maps
from model.study.profiler import axis_of
from model.study.running import COMPLETE, Job, Outcome

BASE = load_config("paper")
SPEED, DAMPING = "drive.speed_kmh", "vehicle.road_suspension.damping"
AXES = axis_of(BASE, SPEED), axis_of(BASE, DAMPING)


class Runs:
    """The figure is the speed, and the damping in MN s/m; from 60 km/h on there is none."""

    def __init__(self) -> None:
        self.jobs: list[Job] = []

    def __call__(self, jobs: list[Job]) -> list[Outcome]:
        self.jobs += jobs
        return [
            Outcome("diverged at 1 s", (None,))
            if job.changes[SPEED] >= 60
            else Outcome(COMPLETE, (job.changes[SPEED] + 1e-6 * job.changes[DAMPING],))
            for job in jobs
        ]


def test_each_grid_holds_the_runs_of_the_grid_before():
    runs = Runs()
    coarse, fine = figure_maps(BASE, *AXES, "peak_load", runs, {})
    assert coarse.values.shape == (GRIDS[0],) * 2
    assert fine.values.shape == (GRIDS[1],) * 2
    assert len(runs.jobs) == GRIDS[1] ** 2
    np.testing.assert_array_equal(fine.values[::2, ::2], coarse.values)


def test_rows_and_columns_stand_where_their_values_say():
    fine = list(figure_maps(BASE, *AXES, "peak_load", Runs(), {}))[-1]
    expected = fine.columns[None, :] + 1e-6 * fine.rows[:, None]
    known = np.isfinite(fine.values)
    assert (known == (fine.columns < 60)[None, :]).all()
    np.testing.assert_allclose(fine.values[known], np.broadcast_to(expected, fine.values.shape)[known])


def test_what_is_known_takes_no_run_and_comes_as_fine_as_it_is():
    runs, known = Runs(), {}
    list(figure_maps(BASE, *AXES, "peak_load", runs, known))
    runs.jobs.clear()
    again = list(figure_maps(BASE, *AXES, "peak_load", runs, known))
    assert [one.level for one in again] == [GRIDS[-1]]
    assert runs.jobs == []
