"""The paper's study: its figures of merit against known signals and model/MODEL.md's, and how far claims reach."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from model import simulate
from model.config.parameters import ASSUMED, PARAMETERS
from model.paper import study as paper_study
from model.paper.study import (
    ALTERNATIVES,
    AMPLITUDE,
    BAUMGARTE,
    PRELOAD,
    STIFFNESS,
    TIGHT,
    Figures,
    StudyError,
    figures_of,
    reach,
    run_figures,
    study_paper,
)
from tests.model.support import PAPER

NO_MATTER = (
    "stop_stiffness",
    "stop_damping",
    "seat.x",
    "seat.y",
    "belly_height",
)  # to the motion of the paper's vehicle


@pytest.fixture(scope="module")
def stiffness() -> dict[float, Figures]:
    return {factor: run_figures(PAPER.replace({STIFFNESS: 1e4 * factor})) for factor in (0.1, 0.5, 1, 2, 3, 5)}


def test_the_claims_have_the_numbers_of_the_independent_engine(stiffness):
    """Shares and rms accelerations of model/MODEL.md; whole waves make the acceleration a little higher than 0.649."""
    shares = [figures.share for figures in stiffness.values()]
    accelerations = [figures.acceleration_rms for figures in stiffness.values()]
    np.testing.assert_allclose(shares, [0.07, 0.11, 0.15, 0.23, 0.32, 0.47], atol=0.01)
    np.testing.assert_allclose(accelerations, [0.648, 0.648, 0.649, 0.660, 0.680, 0.768], atol=0.015)


def test_the_papers_run(stiffness):
    figures = stiffness[1]
    assert figures.excitation == pytest.approx(0.5952, abs=1e-4)
    assert figures.follows_waves
    assert figures.peak_frequency == pytest.approx(0.6, abs=0.01)
    assert figures.harmonics[0] == pytest.approx(0.904, abs=0.01)
    assert figures.load_peak == pytest.approx(19e3, rel=0.03)
    assert figures.static_road_load == pytest.approx(np.mean([8825, 8646, 8468, 8291, 8113, 8973]), abs=1)
    assert figures.static_share == pytest.approx(5 * 1813 / (5 * 1813 + 51316), abs=1e-3)
    assert 0.2 < figures.air < 0.3
    assert 0 < figures.speed_swing < 0.3


def test_figures_of_a_known_signal():
    """Harmonics are amplitudes, whatever their phase; a share is that of the loads given."""
    frequency = 0.5
    run = simulate(PAPER.replace({"simulation.duration": 2 * paper_study.WAVES / frequency}))
    t = run.t
    acceleration = np.zeros_like(run.a)
    acceleration[:, 0, 1] = 2 * np.sin(2 * np.pi * frequency * t + 0.4) + 3 * np.cos(6 * np.pi * frequency * t)
    load = np.full_like(run.normal_load, 1000.0)
    load[:, 6:] = 300.0
    load[t > t[-1] - 1, 0] = 0.0
    known = replace(run, a=acceleration, normal_load=load, traction=0.7 * load)
    figures = figures_of(known, frequency)
    assert figures.harmonics == pytest.approx((2, 0, 3), abs=1e-9)
    assert figures.acceleration_rms == pytest.approx(np.sqrt(2 + 4.5))
    assert figures.peak_frequency == pytest.approx(1.5, abs=0.01)
    assert not figures.follows_waves
    assert figures.load_peak == 1000
    assert figures.air == pytest.approx(frequency / paper_study.WAVES, rel=0.01)
    assert figures.slipping == 1
    assert figures.share == pytest.approx(0.2, abs=0.01)


def test_drift_without_stabilisation_is_the_integrators_error():
    """It goes with the tolerance: 0.5 mm and 4.7 nm in 10 s."""
    bare = PAPER.replace(dict.fromkeys(BAUMGARTE, 0.0))
    coarse, fine = (simulate(bare.replace(more)).constraint_residual.max() for more in ({}, TIGHT))
    assert 1e-4 < coarse < 2e-3
    assert fine < 1e-7


def test_a_statement_reaches_as_far_as_it_holds_without_a_gap(stiffness):
    sweep = {
        k: replace(stiffness[1], acceleration_rms=rms)
        for k, rms in zip((1, 2, 3, 4, 5, 6), (9, 1, 1, 1, 9, 1), strict=True)
    }
    assert reach(sweep, 3, lambda figures: figures.acceleration_rms < 2) == (2, 4)
    assert reach(sweep, 3, lambda figures: False) == (3, 3)
    assert reach(sweep, 3, lambda figures: True) == (1, 6)


def test_every_assumption_about_the_papers_vehicle_has_an_alternative():
    assumed = {parameter.key for parameter in PARAMETERS if parameter.source == ASSUMED}
    assert {key for key in assumed - set(ALTERNATIVES) if not key.endswith(NO_MATTER)} == set()
    for key, values in ALTERNATIVES.items():
        for value in values:
            assert PAPER.replace({key: value}) != PAPER


def test_a_run_that_ends_early_ends_the_study():
    coarse = PAPER.replace({"simulation.integrator": "rk4", "simulation.step": 0.02})
    with pytest.raises(StudyError, match="not complete: inaccurate at t = "):
        run_figures(coarse)


def test_progress_goes_from_nothing_to_all(monkeypatch, stiffness):
    for name in ("FACTORS", "SPEEDS", "AMPLITUDES"):
        monkeypatch.setattr(paper_study, name, getattr(paper_study, name)[:1])
    monkeypatch.setattr(paper_study, "ALTERNATIVES", {STIFFNESS: (2e4,), PRELOAD: (0.2,)})
    ran = []
    monkeypatch.setattr(paper_study, "run_figures", lambda config: ran.append(config) or stiffness[1])
    parts: list[float] = []
    study = study_paper(parts.append)
    assert parts == pytest.approx([k / len(ran) for k in range(1, len(ran) + 1)])
    assert study.alternatives[0].value == 2e4
    stiff = study.run.config.replace({"vehicle.imaginary_suspension.preload_force": 1000.0, STIFFNESS: 1e3})
    assert stiff in ran
    assert study.half is not None
    assert study.half.run.config.road.amplitude == 0.05
    assert [(other.key, other.value) for other in study.half.alternatives] == [(PRELOAD, 0.2)]
    assert study.run.config.replace({AMPLITUDE: 0.05, STIFFNESS: 1e3}) in ran


def test_without_stabilisation_joints_may_drift_as_far_as_they_like():
    """A run of any other kind ends there, and the study with it."""
    assert run_figures(PAPER.replace(dict.fromkeys(BAUMGARTE, 0.0))).drift > 1e-3
