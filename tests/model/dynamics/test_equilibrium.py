"""Rest pose: nothing accelerates, the ground carries the weight, and impossible vehicles get a message."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import event, given, settings
from hypothesis import strategies as st

from model import simulate
from model.dynamics import equations
from model.dynamics.equations import State
from model.dynamics.equilibrium import NoEquilibriumError, rest_pose
from model.dynamics.vehicle import System, build_system
from model.road.road import build_road
from tests.model.support import ARMS, FLAT, IMAGINARY, OPTIONS, PAPER, ROAD_SPRING, WHEELS

G = 9.81
GROUND = build_road(FLAT)


def unbalanced(system: System, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """M q̈ (B, 3), N and N m, of a vehicle at rest at q on flat ground without drive; and the normal loads (W,)."""
    still = system._replace(prescribed=False, v_ref=0.0)
    road = GROUND if system.r == GROUND.radius else build_road(FLAT.replace({f"{WHEELS}.radius": system.r}))
    away = q + np.array([20.0, 0.0, 0.0])  # from the ends of the road's piece, which brute force tries as well
    rates = equations.rates(still, road, 0.0, State(away, np.zeros_like(q), np.zeros(len(system.wheel)), 0.0))
    return rates.v_dot * np.column_stack([system.mass, system.mass, system.inertia]), rates.f_n


def assert_at_rest(system: System, q: np.ndarray, static_load: np.ndarray) -> None:
    residual, f_n = unbalanced(system, q)
    assert np.abs(residual).max() <= 1e-6
    np.testing.assert_allclose(static_load, f_n, atol=1e-6)
    assert static_load.sum() == pytest.approx(system.mass.sum() * G, abs=1e-5)
    np.testing.assert_allclose(equations.constraints(system, q, 0.0), 0.0, atol=1e-12)
    assert q[0, 0] == 0.0


@pytest.mark.parametrize("option", OPTIONS)
def test_rest_pose_of_every_option(option):
    system = build_system(PAPER.replace(OPTIONS[option]))
    assert_at_rest(system, *rest_pose(system))


def test_static_loads_of_the_papers_vehicle():
    q, load = rest_pose(build_system(PAPER))
    np.testing.assert_allclose(load[:6], [8825, 8646, 8468, 8291, 8113, 8973], atol=0.6)
    assert ((load[6:] > 1811.5) & (load[6:] < 1814.5)).all()
    # It differs from the design pose only by the wheels' sinking in
    sunk = build_system(PAPER).q_design[:, 1] - q[:, 1]
    assert sunk[0] == pytest.approx(0.0127, abs=5e-4)
    assert ((sunk > 0.005) & (sunk < 0.015)).all()


@pytest.mark.parametrize("stiffness", [4e4, 75530.0, 1e6])
def test_the_pose_hardly_depends_on_the_stiffness(stiffness):
    """The torsion bars are indexed to the ride height."""
    system = build_system(PAPER.replace({f"{ROAD_SPRING}.stiffness": stiffness}))
    q, _ = rest_pose(system)
    assert np.abs(q[: 1 + system.n, 2]).max() < np.radians(0.6)
    assert np.abs(q[system.imaginary_arms, 2]).max() < np.radians(1.2)  # their wheels carry less and sink in less
    assert np.abs(q[:, 1] - system.q_design[:, 1]).max() < 0.02


def log_uniform(low: float, high: float) -> st.SearchStrategy[float]:
    return st.floats(np.log(low), np.log(high)).map(lambda exponent: float(np.exp(exponent).clip(low, high)))


VEHICLES = st.fixed_dictionaries(
    {
        f"{WHEELS}.count": st.integers(2, 20),
        f"{WHEELS}.spacing": st.floats(0.4, 1.5),
        f"{WHEELS}.offset": st.floats(-0.15, 0.15),
        f"{WHEELS}.radius": st.sampled_from([0.05, 0.32, 1.0]),
        f"{WHEELS}.mass": log_uniform(5.0, 500.0),
        f"{ARMS}.length": st.floats(0.15, 0.8),
        f"{ARMS}.angle_deg": st.floats(-40.0, 60.0),
        "vehicle.chassis.mass": log_uniform(500.0, 50_000.0),
        "vehicle.chassis.cg_height": st.floats(0.4, 2.0),
        f"{ROAD_SPRING}.stiffness": log_uniform(5e3, 1e6),
        f"{IMAGINARY}.stiffness": log_uniform(5e2, 2e5),
        f"{IMAGINARY}.preload_deflection": st.floats(0.0, 0.3),
        f"{IMAGINARY}.reacts_on": st.sampled_from(["road_arm", "chassis"]),
        "vehicle.imaginary_wheels.enabled": st.booleans(),
        "contact.normal_stiffness": log_uniform(1e6, 1e10),
    }
)


@given(VEHICLES)
@settings(max_examples=150, deadline=None)
def test_any_vehicle_rests_or_says_why_not(changes):
    system = build_system(PAPER.replace(changes))
    try:
        q, load = rest_pose(system)
    except NoEquilibriumError as error:
        message = str(error)
        event("no rest pose")
    else:
        assert_at_rest(system, q, load)
        assert (load >= 0.0).all()
        return
    assert "rest" in message
    assert "Stiffen" in message  # what to try


@given(VEHICLES)
@settings(max_examples=60, deadline=None)
def test_stiff_vehicles_always_rest(changes):
    """Springs far stiffer than the weight needs, wheels far apart: none of these vehicles may be refused."""
    weight_at_wheel = changes["vehicle.chassis.mass"] * G / changes[f"{WHEELS}.count"]
    changes = changes | {
        f"{ROAD_SPRING}.stiffness": 50.0 * weight_at_wheel / changes[f"{ARMS}.length"],
        f"{IMAGINARY}.preload_deflection": 0.0,
        f"{WHEELS}.spacing": 1.5,
        "vehicle.chassis.cg_height": 0.5,
    }
    system = build_system(PAPER.replace(changes))
    q, load = rest_pose(system)
    assert_at_rest(system, q, load)


@pytest.mark.parametrize("wheels", [2, 20])
@pytest.mark.parametrize("radius", [0.05, 2.0])
def test_rounding_does_not_refuse_the_heaviest_vehicle(wheels, radius):
    """A hundred tonnes on the hardest ground: forces in the ground round to 1e-7 N."""
    heavy = {"vehicle.chassis.mass": 1e5, f"{WHEELS}.mass": 5000.0, "vehicle.imaginary_wheels.mass": 5000.0}
    stiff = {"contact.normal_stiffness": 1e10, f"{ROAD_SPRING}.stiffness": 1e8}
    size = {f"{WHEELS}.count": wheels, f"{WHEELS}.radius": radius, f"{WHEELS}.spacing": 5.0}
    system = build_system(PAPER.replace(heavy | stiff | size))
    q, load = rest_pose(system)
    assert np.abs(unbalanced(system, q)[0]).max() <= 3e-6
    assert load.sum() == pytest.approx(system.mass.sum() * G, rel=1e-11)


def test_a_link_may_carry_the_vehicle():
    """Imaginary springs ten times as stiff lift road wheels off the ground; that is a rest pose, too."""
    system = build_system(PAPER.replace({f"{IMAGINARY}.stiffness": 1e5}))
    q, load = rest_pose(system)
    assert_at_rest(system, q, load)
    assert (load[:6] == 0.0).any()


def test_a_vehicle_that_would_tip_gets_a_message():
    """Wheels 0.7 m apart cannot hold five tonnes 0.95 m up: the weight tips faster than the springs right it."""
    two = PAPER.replace({f"{WHEELS}.count": 2})
    with pytest.raises(NoEquilibriumError, match=r"tips over forwards.*Stiffen the suspension"):
        rest_pose(build_system(two))
    with pytest.raises(NoEquilibriumError):
        simulate(two)


def test_a_preload_that_folds_the_arms_gets_a_message():
    with pytest.raises(NoEquilibriumError, match=r"arm of imaginary wheel 5 turns right over, its wheel downwards"):
        rest_pose(build_system(PAPER.replace({"vehicle.imaginary_suspension.preload_force": 6e4})))


def test_weak_springs_get_a_message():
    weak = {f"{ROAD_SPRING}.stiffness": 100.0, f"{IMAGINARY}.stiffness": 10.0, f"{IMAGINARY}.preload_deflection": 0.0}
    with pytest.raises(NoEquilibriumError, match=r"arm of road wheel 6 turns .*vehicle\.road_suspension\.stiffness"):
        rest_pose(build_system(PAPER.replace(weak)))


CHASSIS = "vehicle.chassis"
# Vehicles for which Newton's method alone runs past the minimum or ends at a saddle: hull's and arms' largest turn, rad
HIDDEN = {
    "runs past": (
        {
            f"{CHASSIS}.mass": 6400,
            f"{CHASSIS}.cg_height": 1.23,
            f"{WHEELS}.count": 3,
            f"{WHEELS}.spacing": 1.03,
            f"{WHEELS}.radius": 0.38,
            f"{ARMS}.length": 0.226,
            f"{ARMS}.angle_deg": 22.2,
            f"{ROAD_SPRING}.stiffness": 42000,
            f"{IMAGINARY}.stiffness": 11500,
            "contact.normal_stiffness": 3.2e7,
        },
        0.085,
    ),
    "saddle": (
        {
            f"{CHASSIS}.mass": 7035,
            f"{CHASSIS}.cg_height": 0.529,
            f"{WHEELS}.count": 4,
            f"{WHEELS}.spacing": 0.398,
            f"{WHEELS}.radius": 0.4086,
            f"{WHEELS}.mass": 46.7,
            "vehicle.imaginary_wheels.mass": 94.1,
            f"{ARMS}.length": 0.2184,
            f"{ARMS}.angle_deg": 27.3,
            f"{ROAD_SPRING}.stiffness": 46064,
            f"{IMAGINARY}.stiffness": 13506,
            f"{IMAGINARY}.preload_deflection": 0.0637,
            "contact.normal_stiffness": 3.515e7,
        },
        0.263,
    ),
    "leaning": (
        {
            f"{WHEELS}.count": 3,
            f"{WHEELS}.spacing": 0.45,
            f"{WHEELS}.offset": 0.2,
            f"{ROAD_SPRING}.stiffness": 6e4,
            "vehicle.imaginary_wheels.enabled": False,
        },
        1.218,
    ),
    "soft": ({f"{ROAD_SPRING}.stiffness": 500.0, f"{IMAGINARY}.stiffness": 500.0}, 0.631),
}


@pytest.mark.parametrize("name", HIDDEN)
def test_a_rest_pose_that_newtons_method_misses_is_found(name):
    changes, turn = HIDDEN[name]
    system = build_system(PAPER.replace(changes))
    q, load = rest_pose(system)
    assert_at_rest(system, q, load)
    assert np.abs(q[: 1 + system.n, 2]).max() == pytest.approx(turn, abs=0.01)
    run = simulate(PAPER.replace(changes | {"road.type": "flat", "simulation.duration": 0.5}))
    assert np.abs(run.q[:, 0, 2] - q[0, 2]).max() < 0.02  # it stands: only the drive's start moves it


def test_a_rest_pose_on_one_side_of_a_saddle_is_found_leaning(monkeypatch):
    """From the upright pose alone the way down may lead over; the search begins again, leaning."""
    system = build_system(PAPER.replace(HIDDEN["saddle"][0]))
    monkeypatch.setattr("model.dynamics.equilibrium.STARTS", ((0.1, 0.2),))
    q, load = rest_pose(system)
    assert_at_rest(system, q, load)


def test_vehicles_that_differ_only_in_motion_share_their_rest_pose():
    """To the last digit; what matters at rest makes another one."""
    resting = rest_pose(build_system(PAPER))
    for changes in ({"drive.speed_kmh": 30}, {"contact.normal_damping": 1e5}, {f"{ROAD_SPRING}.damping": 100}):
        for mine, other in zip(resting, rest_pose(build_system(PAPER.replace(changes))), strict=True):
            assert (mine == other).all()
            assert mine is not other
    for changes in ({"contact.normal_stiffness": 1e7}, {"vehicle.chassis.mass": 9000}):
        assert (rest_pose(build_system(PAPER.replace(changes)))[0] != resting[0]).any()
