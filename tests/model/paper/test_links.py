"""Records of a track of links, how runs are laid beside them, and the search for the nearest imaginary wheels."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from model import load_config
from model.paper import links
from model.paper.links import (
    AFTER,
    ARM_LENGTH,
    ASSEMBLY,
    AT_ASSEMBLY,
    BEFORE,
    DAMPING,
    RECORDS,
    TRIED,
    WITHOUT,
    Motion,
    compare_all,
    errors_of,
    motion_about,
    read_record,
    study_links,
)
from model.paper.study import PRELOAD_FORCE, STIFFNESS, StudyError

TEXTS = [(Path(__file__).parents[3] / "assets" / "links" / f"{name}.csv").read_text() for name in RECORDS]
T = np.arange(0, 4, 1 / 500)


def test_the_records():
    records = [read_record(text) for text in TEXTS]
    assert [(record.height, record.radius) for record in records] == [(0.1, 0.2), (0.1, 0.2), (0.2, 0.25)]
    assert [record.speed_kmh for record in records] == [14.3, 29.5, 14.2]
    for record in records:
        t, acceleration, pitch, rise = record.motion
        assert (t[0], t[-1]) == (-BEFORE, pytest.approx(AFTER, abs=0.01))
        early, climbing = t < -0.1, (t > 0) & (t < 0.3)
        assert np.abs(acceleration[climbing]).max() > 5 * np.sqrt(np.mean(acceleration[early] ** 2))
        assert abs(pitch[early].mean()) < 1e-12
        assert pitch[climbing].max() > 0.02  # nose up
        assert rise.max() > 0.25 * record.height
        assert rise[-1] < 0.2 * rise.max()


def test_a_motion_is_laid_where_the_first_wheel_has_climbed():
    climbed = np.where(T >= 1.3, 0.05, 0.01)
    wave = np.sin(2 * np.pi * 5 * T)
    motion = motion_about(T, wave, 0.1 + (T > 1.3) * T, 0.3 - 0.02 * (T > 2), climbed)
    at = motion.t + 1.3
    np.testing.assert_allclose(motion.acceleration, np.sin(2 * np.pi * 5 * at), atol=0.03)
    np.testing.assert_allclose(motion.pitch[motion.t > 0.01], at[motion.t > 0.01], atol=1e-9)
    np.testing.assert_allclose(motion.rise[motion.t > 0.71], -0.02, atol=1e-12)
    assert np.abs(motion_about(T, np.sin(2 * np.pi * 60 * T), T, T, climbed).acceleration).max() < 0.01


@pytest.mark.parametrize("climbs_at", [0.3, 3.9, 9.0])
def test_a_motion_without_enough_around_the_climb_is_refused(climbs_at):
    with pytest.raises(ValueError, match="does not climb, or too close"):
        motion_about(T, T, T, T, 0.1 * (climbs_at <= T))


def test_a_record_without_its_obstacle_is_refused():
    with pytest.raises(ValueError, match="must say height"):
        read_record(TEXTS[0].replace("radius", "size"))


def test_errors():
    t = np.arange(4.0)
    record = Motion(t, np.array([0.0, 4, -2, 0]), np.array([1.0, -1, 1, -1]), np.array([0.0, 0, 2, 0]))
    assert errors_of(record, record).rms == (0, 0, 0)
    found = errors_of(record._replace(acceleration=0 * t, pitch=3 * record.pitch), record)
    assert found.rms == (1, 2, 0)
    assert found.peak == (-1, 2, 0)


def test_the_pose_of_the_records_is_the_presets_with_other_arms():
    """Every pivot where the preset has it in the hull, and the arm of which the records tell angles."""
    preset, turned = load_config("m113").vehicle, load_config("m113").replace(AT_ASSEMBLY).vehicle

    def pivots(vehicle):
        length, angle = vehicle.road_arms.length, np.radians(vehicle.road_arms.angle_deg)
        x = np.array(vehicle.road_wheels.x) + length * np.cos(angle)
        return np.append(x, vehicle.road_wheels.radius + length * np.sin(angle) - vehicle.chassis.cg_height)

    np.testing.assert_allclose(pivots(turned), pivots(preset), atol=1.5e-3)
    assert turned.road_arms.length == ARM_LENGTH
    assert np.radians(turned.road_arms.angle_deg) == pytest.approx(ASSEMBLY, abs=2e-3)


def test_the_nearest_imaginary_wheels():
    """What the whole search finds, and the README tells: 54 % off; their neighbours are further off."""
    nearest = {STIFFNESS: 5.3e4, DAMPING: 690.0, PRELOAD_FORCE: 1430.0}
    assembly = load_config("m113").replace(AT_ASSEMBLY)
    others = [{key: value * by} for key, value in nearest.items() for by in (0.5, 2)]
    configs = [assembly.replace(nearest | other) for other in ({}, *others)]
    found = list(compare_all(configs, [read_record(text) for text in TEXTS]))
    errors = [compared.error for compared in found if compared is not None]
    assert errors[0] == pytest.approx(0.538, abs=0.005)
    assert len(errors) == len(configs)
    assert min(errors) == errors[0]


def test_known_imaginary_wheels_are_found_again(monkeypatch):
    """The record is a run of our own, whose springs the search must name."""
    hidden = {STIFFNESS: 4e4, DAMPING: 1e3, PRELOAD_FORCE: 1500.0}
    assembly = load_config("m113").replace(AT_ASSEMBLY)
    record = read_record(TEXTS[0])
    (run,) = compare_all([assembly.replace(hidden)], [record])
    assert run is not None
    monkeypatch.setattr(links, "read_record", lambda text: record._replace(motion=run.motions[0]))
    monkeypatch.setattr(links, "TRIED", {STIFFNESS: (1e4, 8e4), DAMPING: (1e3, 8e3), PRELOAD_FORCE: (750.0, 6e3)})
    monkeypatch.setattr(links, "CLOSER", (2.0,))
    parts: list[float] = []
    found = study_links([""], parts.append)
    assert found.values == hidden
    assert found.nearest.error < 1e-9 < 0.05 < found.assembly.error
    assert found.as_good == {key: (value, value) for key, value in hidden.items()}
    assert parts == sorted(parts)
    assert parts[-1] == 1
    assert not found.without.config.vehicle.imaginary_wheels.enabled


def test_a_vehicle_that_cannot_rest_is_left_out():
    record = read_record(TEXTS[0])
    limp = load_config("m113").replace({**WITHOUT, "vehicle.road_suspension.stiffness": 10})
    assert list(compare_all([limp], [record])) == [None]


def test_a_study_whose_runs_do_not_come_through_says_so(monkeypatch):
    monkeypatch.setattr(links, "compare_all", lambda configs, records: iter([None] * len(configs)))
    with pytest.raises(StudyError, match="did not reach their end"):
        study_links(TEXTS)


def test_what_is_tried_may_be_given():
    for key, values in TRIED.items():
        for value in values:
            load_config("m113").replace({key: value / np.prod(links.CLOSER)})
            load_config("m113").replace({key: value * np.prod(links.CLOSER)})
