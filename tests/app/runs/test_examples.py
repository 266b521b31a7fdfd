"""Every example works on every preset, and its words fit."""

from __future__ import annotations

import pytest

from app.panels.plot_panel import TABS
from app.runs.examples import EXAMPLE, EXAMPLES, SPEED, SPEEDS, Example
from app.runs.study_choice import DAMPING
from model.analysis.figures import FIGURE
from model.config.config_files import load_config, preset_names


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda example: example.name)
def test_each_leads_to_a_tab_and_tells_a_figure(example: Example) -> None:
    assert example.tab in TABS
    assert example.figure in FIGURE
    said = example.seen.format(figure="F", before="1", now="2", value="3", count=4)
    assert "F: 1 before, 2 now" in said
    assert "{" not in said


@pytest.mark.parametrize("preset", preset_names())
@pytest.mark.parametrize("example", EXAMPLES, ids=lambda example: example.name)
def test_each_step_is_a_valid_configuration_that_changes_something(example: Example, preset: str) -> None:
    config = load_config(preset)
    steps = [config.replace(dict(changes)) for changes in example.path(config)]
    assert steps
    assert steps[-1] != config or preset == "half_round"


@pytest.mark.parametrize("preset", ["paper", "m113"])  # one value; one for each wheel
def test_half_the_damping_is_half_of_it_on_each_wheel(preset: str) -> None:
    config = load_config(preset)
    before = config.vehicle.road_suspension.damping
    (*_, last) = EXAMPLE["Halve the damping"].path(config)
    wheels = before if isinstance(before, tuple) else (before,)
    after = last[DAMPING] if isinstance(before, tuple) else [last[DAMPING]]
    assert after == pytest.approx([wheel / 2 for wheel in wheels])


def test_the_worst_speed_is_sought_over_the_whole_slider_on_its_steps() -> None:
    config = load_config("paper")
    low, high, step = config.parameter(SPEED).slider(config.drive.speed_kmh)
    speeds = [changes[SPEED] for changes in EXAMPLE["Find the worst speed"].path(config)]
    assert (speeds[0], speeds[-1], len(set(speeds))) == (low, high, SPEEDS)
    assert all((speed / step).is_integer() for speed in speeds)
