"""The controls say and mean what the parameter table says."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any
from unittest.mock import create_autospec

import pytest
import viser

from app.format.units import METRIC, US
from app.panels.actions import Actions
from app.panels.parameter_panel import ParameterPanel
from model.config.config import Config
from model.config.config_files import load_config
from model.config.parameters import NOTES, PARAMETER, PARAMETERS
from tests.app.conftest import as_typed

PAPER = load_config("paper")
STIFFNESS = "vehicle.road_suspension.stiffness"


def actions() -> Any:
    """Whatever is asked for is let go; errors are raised."""

    def fail(error: Exception) -> None:
        raise error

    return create_autospec(Actions, instance=True, fail=fail)


@pytest.fixture(scope="module")
def server() -> Iterator[viser.ViserServer]:
    server = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
    yield server
    server.stop()


def panel(server: viser.ViserServer, config: Config = PAPER) -> ParameterPanel:
    server.gui.reset()
    controls = ParameterPanel(server.gui, {"paper": config}, "paper", config, actions())
    controls.fill()
    return controls


def test_every_parameter_has_a_control_that_means_its_value(server: viser.ViserServer) -> None:
    controls = panel(server)
    for parameter in PARAMETERS:
        if parameter.group != NOTES and parameter.applies_to("sine"):
            assert controls[parameter.key].value == PAPER.value(parameter.key), parameter.key


@pytest.mark.parametrize("preset", ["half_round", "paper_0583", "short_waves", "random_road", "kerb", "obstacles"])
def test_controls_follow_a_configuration(server: viser.ViserServer, preset: str) -> None:
    controls = panel(server)
    config = load_config(preset).replace({"drive.speed_kmh": 90, "simulation.atol": 1e-9})
    controls.show(config)
    for key in config.values():
        if PARAMETER[key].group != NOTES and PARAMETER[key].kind != "text":
            assert controls[key].value == config.value(key), key


def test_a_list_is_a_text_and_a_number_again(server: viser.ViserServer) -> None:
    stiffness = (60e3, 60e3, 70e3, 70e3, 80e3, 80e3)
    config = PAPER.replace({STIFFNESS: stiffness})
    controls = panel(server, config)
    control = controls[STIFFNESS]
    assert (control._one.visible, control._list.visible) == (False, True)
    assert control.listed_value == stiffness
    assert control._list.value == "60, 60, 70, 70, 80, 80"
    controls.show(PAPER)
    assert (control._one.visible, control._list.visible) == (True, False)
    assert control.value == 75530
    control._list.value = "60 60 70 70 80 80.0"
    controls.show(config)
    assert control._list.visible
    assert control._list.value == "60, 60, 70, 70, 80, 80"


def test_controls_of_other_roads_go_and_their_sliders_turn_grey(server: viser.ViserServer) -> None:
    controls = panel(server)

    def state(key: str) -> tuple[bool, bool]:
        handle = controls[key]._one
        return handle.visible, handle.disabled

    assert state("road.height") == (False, False)
    assert state("road.start") == (True, False)
    controls.show(PAPER.replace({"road.type": "half_round"}))
    assert state("road.height") == (True, False)
    assert state("road.start") == (False, False)
    assert state("road.wavelength") == (True, True)
    controls.show(PAPER.replace({"road.type": "flat"}))
    assert state("road.height") == (False, False)
    controls.show(PAPER.replace({"vehicle.imaginary_wheels.enabled": False}))
    assert state("vehicle.imaginary_suspension.stiffness") == (True, True)
    assert state("vehicle.imaginary_wheels.enabled") == (True, False)
    controls.show(PAPER)
    assert state("vehicle.imaginary_suspension.stiffness") == (True, False)
    assert state("road.wavelength") == (True, False)


def test_what_the_user_touches_is_left_alone(server: viser.ViserServer) -> None:
    controls = panel(server)
    controls["drive.speed_kmh"]._one.value = 31.0
    controls.show(PAPER, touched={"drive.speed_kmh"})
    assert controls["drive.speed_kmh"].value == 31
    controls.show(PAPER)
    assert controls["drive.speed_kmh"].value == 15


def test_sliders_suit_small_vehicles(server: viser.ViserServer) -> None:
    controls = panel(server)
    slider = controls["vehicle.imaginary_suspension.stiffness"]._one
    usual = (slider.min, slider.max, slider.step)
    controls.show(load_config("robot"))
    assert (slider.min, slider.max, slider.step, slider.value) == (0.05, 5, 0.05, 0.4)
    controls.show(PAPER)
    assert (slider.min, slider.max, slider.step) == usual


def test_rates_of_the_torsion_bar_are_shown_in_its_units(server: viser.ViserServer) -> None:
    controls = panel(server)
    damping = "vehicle.road_suspension.damping"
    controls.show(PAPER.replace({"vehicle.road_suspension.basis": "torsion"}))
    assert as_typed(controls[STIFFNESS]._one.label) == "Suspension stiffness, kN m/rad"
    assert "unit kN m/rad" in controls[STIFFNESS]._list.hint
    assert "at the wheel" not in controls[STIFFNESS]._one.hint
    assert as_typed(controls[damping]._one.label) == "Suspension damping, kN m s/rad"
    assert as_typed(controls["vehicle.imaginary_suspension.stiffness"]._one.label) == "Imaginary stiffness, kN/m"
    controls.show(PAPER)
    assert as_typed(controls[STIFFNESS]._one.label) == "Suspension stiffness, kN/m"
    assert as_typed(controls[damping]._one.label) == "Suspension damping, kN s/m"


def test_controls_show_other_units_and_mean_the_same(server: viser.ViserServer) -> None:
    config = PAPER.replace({STIFFNESS: (60e3,) * 5 + (75530.0,), "vehicle.road_suspension.bump_travel": 0.123})
    controls = panel(server, config)
    usual = {key: controls[key].box for key in config.values() if key in PARAMETER and PARAMETER[key].what_if}
    controls.set_units(US)
    for parameter in PARAMETERS:
        if parameter.group != NOTES and parameter.applies_to("sine") and not parameter.per_wheel:
            assert controls[parameter.key].value == config.value(parameter.key), parameter.key
    assert controls[STIFFNESS].listed_value == config.value(STIFFNESS)
    assert controls[STIFFNESS]._list.value == "342.6, 342.6, 342.6, 342.6, 342.6, 431.3"
    speed = controls["drive.speed_kmh"]._one
    assert as_typed(speed.label) == "Speed, mph"
    assert (speed.value, speed.min, speed.max, speed.step) == (9.321, 1.4, 43.4, 0.2)
    assert controls["vehicle.road_suspension.bump_travel"]._one.value == "4.843"
    assert controls["vehicle.chassis.cg_height"]._one.step == 0.2
    speed.value = 20.0
    assert controls["drive.speed_kmh"].value == 32.18688
    controls.set_units(METRIC)  # what the user has moved stays, though no run has come of it yet
    assert (speed.value, speed.min, speed.max, speed.step) == (32.18688, 2, 70, 0.5)
    controls.show(config)
    assert (speed.value, controls[STIFFNESS]._list.value) == (15, "60, 60, 60, 60, 60, 75.53")
    assert {key: controls[key].box for key in usual} == usual


def test_rates_of_the_torsion_bar_have_units_of_choice_too(server: viser.ViserServer) -> None:
    controls = panel(server)
    controls.set_units(US)
    config = PAPER.replace({"vehicle.road_suspension.basis": "torsion"})
    controls.show(config, touched={STIFFNESS})
    assert as_typed(controls[STIFFNESS]._one.label) == "Suspension stiffness, lbf in/rad"
    assert controls[STIFFNESS].value == config.value(STIFFNESS) == 75530
    assert controls[STIFFNESS]._one.value == pytest.approx(75530 * 8.850746, rel=1e-3)


def test_presets_with_the_same_title_can_be_told_apart(server: viser.ViserServer) -> None:
    server.gui.reset()
    config = PAPER.replace({"drive.speed_kmh": 30})
    ParameterPanel(server.gui, {"paper": PAPER, "mine.yaml": config}, "mine.yaml", config, actions())
    dropdowns = [handle for handle in _handles(server) if getattr(handle, "label", "") == "Preset"]
    assert dropdowns[0].options == ("Paper vehicle (paper)", "Paper vehicle (mine.yaml)")
    assert dropdowns[0].value == "Paper vehicle (mine.yaml)"


def _handles(server: viser.ViserServer) -> list[Any]:
    return list(server.gui._gui_input_handle_from_uuid.values())
