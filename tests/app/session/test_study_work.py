"""What the tab "Study" is filled with: runs made by hand, or short true ones."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from app.format.units import US
from app.plots.study_data import Data
from app.runs.study_choice import LIMITS, MAP, MEASURED, PROFILER, StudyChoice
from app.session.study_work import Means, Record, Situation, StudyWork
from model.analysis.signals import CENTRE_OF_MASS, point_acceleration
from model.config.config import Config
from model.config.config_files import load_config
from model.simulation.simulate import simulate
from model.study.running import COMPLETE, Job, Outcome

PAPER = load_config("paper")
CHOICE = StudyChoice(columns=("drive.speed_kmh",), rows=("peak_load",), figure="peak_load", strips=False)
SITUATION = Situation(number=1, shown=1, touched=False, config=PAPER, baseline=None, front=True, hurries=False)


class Bench:
    """Outcomes that follow the speed, and what is shown meanwhile."""

    def __init__(self) -> None:
        self.work = StudyWork({"paper": PAPER})
        self.jobs: list[Job] = []
        self.meanwhile: list[Data] = []

    def evaluate(self, jobs: list[Job]) -> list[Outcome]:
        self.jobs += jobs
        return [Outcome(COMPLETE, (self.speed(job) / 4,) * len(job.figures)) for job in jobs]

    @staticmethod
    def speed(job: Job) -> float:
        return float(job.changes.get("drive.speed_kmh", job.base.drive.speed_kmh))  # type: ignore[arg-type]

    def spread(self, work: Callable[..., object], items: Iterable[object]) -> list[object]:
        return [work(item) for item in items]

    def of(self, choice: StudyChoice, **otherwise: Any) -> list[tuple[str, Data]]:
        means = Means(self.evaluate, self.spread, lambda kind, data: self.meanwhile.append(data))
        found = list(self.work.of(replace(SITUATION, **otherwise), choice, means))
        json.dumps(found, allow_nan=False)  # as the page gets it
        return found


@pytest.fixture
def bench() -> Bench:
    return Bench()


def test_studies_are_told_in_units_of_choice_and_know_the_metric_ones(bench: Bench) -> None:
    _, usual = bench.of(CHOICE)[-1]
    _, data = bench.of(CHOICE, units=US)[-1]
    figure, column = data["figures"][0], data["columns"][0]
    assert (figure["unit"], column["unit"], column["now"]) == ("lbf", "mph", 9.321)
    unit, factor = figure["metric"]
    assert (unit, figure["now"] / factor) == ("kN", pytest.approx(usual["figures"][0]["now"], rel=1e-5))
    unit, factor = column["metric"]
    assert (unit, column["high"] / factor) == ("km/h", pytest.approx(usual["columns"][0]["high"], rel=1e-3))
    assert column["first"] / column["step"] == pytest.approx(round(column["first"] / column["step"]))
    assert column["y"][0][0] / figure["metric"][1] == pytest.approx(usual["columns"][0]["y"][0][0], rel=1e-5)
    assert data["commands"] == usual["commands"]
    _, mapped = bench.of(replace(CHOICE, view=MAP), units=US)[-1]
    assert (mapped["x"]["unit"], mapped["y"]["unit"]) == ("mph", "lbf s/in")
    assert mapped["x"]["at"][-1] == pytest.approx(mapped["x"]["high"], rel=1e-3)


def test_a_profile_names_figures_parameters_and_what_matters(bench: Bench) -> None:
    kind, data = bench.of(CHOICE)[-1]
    assert kind == PROFILER
    (figure,) = data["figures"]
    assert (figure["label"], figure["unit"], figure["now"]) == ("Peak load", "kN", 3.75)
    column = next(column for column in data["columns"] if column["shown"])
    assert (column["label"], column["unit"], column["now"]) == ("Speed", "km/h", 15.0)
    assert figure["effects"][0] == ["drive.speed_kmh", 17.0, 1]
    assert figure["decisive"] == 1
    assert column["y"][0] == pytest.approx([x / 4 for x in column["x"]], rel=1e-4)


def test_sliders_that_are_no_column_have_curves_for_their_strips(bench: Bench) -> None:
    _, data = bench.of(CHOICE)[-1]
    shown = {column["key"]: column["shown"] for column in data["columns"]}
    assert shown["road.amplitude"] is False


def test_a_run_that_diverges_has_no_figures_but_the_curves_around_it(bench: Bench) -> None:
    complete = bench.evaluate
    bench.evaluate = lambda jobs: [  # type: ignore[method-assign]
        Outcome("diverged at 1 s", (None,) * len(job.figures)) if bench.speed(job) == 15 else complete([job])[0]
        for job in jobs
    ]
    _, data = bench.of(CHOICE)[-1]
    assert data["figures"][0]["now"] is None
    column = next(column for column in data["columns"] if column["shown"])
    assert [x for x, y in zip(column["x"], column["y"][0], strict=True) if y is None] == [15.0]


def test_loads_of_a_light_vehicle_are_told_in_newtons(bench: Bench) -> None:
    _, data = bench.of(CHOICE, config=load_config("robot"))[-1]
    assert data["figures"][0]["unit"] == "N"


def test_a_map_is_made_once_however_its_own_parameters_change(bench: Bench) -> None:
    choice = replace(CHOICE, view=MAP)
    kind, data = bench.of(choice)[-1]
    assert kind == MAP
    assert data["done"]
    assert data["values"][0] == pytest.approx([x / 4 for x in data["x"]["at"]], rel=1e-4)
    bench.jobs.clear()
    _, again = bench.of(choice, config=PAPER.replace({"drive.speed_kmh": 30.0}))[-1]
    assert again["x"]["now"] == 30.0
    assert bench.jobs == []


def test_a_map_on_a_road_without_its_parameters_takes_others(bench: Bench) -> None:
    choice = replace(CHOICE, view=MAP, x="road.amplitude", y="road.wavelength")
    _, data = bench.of(choice, config=PAPER.replace({"road.type": "flat"}))[-1]
    assert len({data["x"]["key"], data["y"]["key"]}) == 2
    assert "road.amplitude" not in (data["x"]["key"], data["y"]["key"])


def test_limits_come_ground_by_ground_and_do_not_depend_on_road_and_speed(bench: Bench) -> None:
    choice = replace(CHOICE, view=LIMITS)
    found = bench.of(choice)
    assert [data["part"] for _, data in found] == sorted(data["part"] for _, data in found)
    kind, data = found[-1]
    assert kind == LIMITS
    assert data["done"]
    assert {round(one["speed"], 1) for one in data["own"]["ride"]} == {24.0}  # where speed / 4 is 6 W
    assert {round(one["speed"], 1) for one in data["own"]["shock"]} == {10.0}
    bench.jobs.clear()
    again = bench.of(choice, config=PAPER.replace({"drive.speed_kmh": 30.0, "road.type": "flat"}))
    assert bench.jobs == []
    assert again[-1][1]["own"] == data["own"]


def test_the_baselines_limits_stand_beside(bench: Bench) -> None:
    softer = PAPER.replace({"vehicle.road_suspension.stiffness": 50e3})
    _, data = bench.of(replace(CHOICE, view=LIMITS), baseline=softer)[-1]
    assert len(data["baseline"]["shock"]) == len(data["own"]["shock"])


def record(config: Config) -> Record:
    run = simulate(config)
    return Record("ride.csv", (run.t + 0.5, point_acceleration(run, CENTRE_OF_MASS)[:, 1] + 0.2))


def test_a_record_is_laid_over_the_run_and_fitted_when_that_is_asked_for(bench: Bench) -> None:
    short = PAPER.replace({"simulation.duration": 5.0})
    measured = record(short.replace({"road.amplitude": 0.15}))
    choice = replace(CHOICE, view=MEASURED)
    ((kind, data),) = bench.of(choice, config=short, record=measured)
    assert kind == MEASURED
    assert data["rms"] > 0.05
    assert data["fit"] is None
    found = bench.of(replace(choice, fitted=("road.amplitude",), fit=1), config=short, record=measured)
    assert found[0][1]["busy"]
    assert bench.meanwhile[-1]["busy"].endswith("%")
    (row,) = found[-1][1]["fit"]["rows"]
    assert (row["label"], row["unit"]) == ("Amplitude", "mm")
    assert row["value"] == pytest.approx(150, abs=1)
    assert found[-1][1]["lag"] == pytest.approx(0.5, abs=0.1)
    assert found[-1][1]["commands"][0].startswith("trackride fit paper --set simulation.duration=5 --measured ride.csv")


def test_a_fit_is_made_once(bench: Bench) -> None:
    short = PAPER.replace({"simulation.duration": 3.0})
    measured = record(short)
    choice = replace(CHOICE, view=MEASURED, fitted=("road.amplitude",), fit=1)
    bench.of(choice, config=short, record=measured)
    (again,) = bench.of(choice, config=short, record=measured)
    assert again[1]["fit"] is not None
    other = bench.of(choice, config=short.replace({"road.amplitude": 0.12}), record=measured)
    assert [data["fit"] for _, data in other] == [None]


def test_a_record_that_is_much_longer_says_so(bench: Bench) -> None:
    t = np.linspace(0, 100, 10_000)
    short = PAPER.replace({"simulation.duration": 1.0})
    ((_, data),) = bench.of(replace(CHOICE, view=MEASURED), config=short, record=Record("long.csv", (t, np.sin(t))))
    assert "said" in data
