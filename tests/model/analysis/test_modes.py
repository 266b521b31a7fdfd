"""The modes of the vehicle at rest against hand calculations, against other ways to find them, and against a run."""

from __future__ import annotations

import time

import numpy as np
import pytest

from model.analysis.modes import Modes, mode_trajectory, vehicle_modes
from model.config.config import Config
from model.dynamics.equations import constraints
from model.dynamics.equilibrium import rest_pose
from model.dynamics.kernel import rates
from model.dynamics.lanes import coordinates, in_lanes, make_work, pack
from model.dynamics.vehicle import build_system
from model.road.road import build_road
from model.simulation.integrate import Integration
from tests.model.support import FLAT, OPTIONS, PAPER

BARE = {"vehicle.imaginary_wheels.enabled": False}


@pytest.fixture(scope="module")
def modes() -> Modes:
    return vehicle_modes(PAPER)


def test_bounce_and_pitch_of_the_papers_vehicle(modes):
    assert modes.bounce.frequency == pytest.approx(1.55, abs=0.005)
    assert modes.bounce.damping_ratio == pytest.approx(0.55, abs=0.005)
    assert modes.pitch.frequency == pytest.approx(1.04, rel=0.01)
    assert modes.pitch.damping_ratio == pytest.approx(0.34, abs=0.005)
    assert modes.fastest_decay == pytest.approx(-353, rel=0.005)


def test_all_modes_are_named_and_in_order(modes):
    names = [mode.name for mode in modes.swinging]
    assert names[:2] == ["Pitch", "Bounce"]
    assert {"Hop of I5", "Hop of I4", "Hop of I3", "Hop of I1", "Hop of R6"} == set(names[2:])
    assert all(np.diff([mode.frequency for mode in modes.swinging]) >= 0)
    for mode in modes.swinging:
        assert sum(share for _, share in mode.shares) == pytest.approx(1, abs=0.15)  # without the wheels' way forward
        assert mode.shares[0][0] == mode.name
    creeping = {creep.name for creep in modes.creeping}
    assert {"Fore and aft", "Hop of R1", "Hop of R5", "Spin of R3"} <= creeping  # the imaginary dampers hold R1…R5
    assert all(np.diff([creep.decay for creep in modes.creeping]) >= 0)
    assert modes.creeping[-1].decay == -modes.fastest_decay


@pytest.mark.parametrize("option", sorted(set(OPTIONS) - {"twenty wheels"}))
def test_the_modes_are_those_of_the_whole_state(option):
    """All q and v perturbed one by one, joints and all: Baumgarte adds eigenvalues but moves none."""
    config = PAPER.replace(OPTIONS[option])
    found = vehicle_modes(config)
    system = build_system(config)._replace(v_ref=0.0)
    road = build_road(config.replace({"road.type": "flat"})).table
    q, _ = rest_pose(system)
    rest = pack(system, q, np.zeros_like(q), np.zeros(len(system.wheel)), 0.0)
    lanes, work, place = in_lanes(system), make_work(system), coordinates(system)

    def rate(nudge):
        state, change = rest.copy(), np.empty_like(rest)
        state[place] += nudge
        rates(lanes, road, 0.0, state, change, work)
        return change[place]

    nudges = 1e-6 * np.eye(len(place))
    eigenvalues = np.linalg.eigvals(np.column_stack([(rate(e) - rate(-e)) / 2e-6 for e in nudges]))
    assert found.fastest_decay == pytest.approx(eigenvalues.real.min(), rel=1e-4)
    for mode in found.swinging:
        assert np.abs(eigenvalues - mode.eigenvalue).min() < 2e-4 * abs(mode.eigenvalue)
    swinging = (eigenvalues.imag > 1e-2) & (eigenvalues.real > -15)  # Baumgarte's lie beyond
    assert swinging.sum() == sum(mode.eigenvalue.real > -15 for mode in found.swinging)


def test_bounce_of_a_hull_on_springs():
    """With light wheels on hard ground and level arms, all there is is a mass on n springs and dampers."""
    changes = BARE | {
        "vehicle.road_wheels.mass": 0.5,
        "vehicle.road_arms.mass": 0.5,
        "vehicle.road_arms.angle_deg": 0.0,
        "vehicle.road_suspension.damping": 1000.0,
        "contact.normal_stiffness": 1e10,
    }
    bounce = vehicle_modes(PAPER.replace(changes)).bounce
    omega = np.sqrt(6 * 75530 / 5125)
    assert bounce.frequency == pytest.approx(omega / (2 * np.pi), rel=0.01)
    assert bounce.damping_ratio == pytest.approx(6 * 1000 / (2 * 5125 * omega), rel=0.02)
    assert bounce.shape[0, 1] == pytest.approx(1, abs=0.05)  # the whole hull moves by what is 1


def test_hop_of_a_wheel_under_a_hull_that_stands_still():
    """Wheel and level arm swing between suspension and ground; a ground of f = k z² is 2√(k f) stiff."""
    k, c, m_w, m_a = 75530.0, 1000.0, 75.0, 30.0
    changes = BARE | {
        "vehicle.chassis.mass": 2000.0,
        "vehicle.chassis.pitch_inertia": 1e7,
        "vehicle.road_wheels.count": 2,
        "vehicle.road_arms.angle_deg": 0.0,
        "vehicle.road_suspension.damping": c,
    }
    config = PAPER.replace(changes)
    found = {mode.name: mode for mode in vehicle_modes(config).swinging}
    system = build_system(config)
    load = rest_pose(system)[1][0]
    # The hull, 2000 kg, goes along a little: both wheels together against it
    ground, ground_damping = 2 * np.sqrt(system.ground.k_n * load), system.ground.c_n * load / system.ground.k_n
    wheel = m_w + m_a / 3
    M = np.array([[wheel, m_a / 6], [m_a / 6, (2000 + 2 * m_a / 3) / 2]])  # wheel, half the hull; an arm between
    K = np.array([[k + ground, -k], [-k, k]])
    C = np.array([[c + ground_damping, -c], [-c, c]])
    matrix = np.block([[np.zeros((2, 2)), np.eye(2)], [-np.linalg.solve(M, K), -np.linalg.solve(M, C)]])
    expected = max(np.linalg.eigvals(matrix), key=lambda s: s.imag)
    hop = min((found["Hop of R1"], found["Hop of R2"]), key=lambda mode: abs(mode.eigenvalue - expected))
    assert hop.eigenvalue == pytest.approx(expected, rel=0.01)
    alone = np.sqrt((k + ground) / wheel) / (2 * np.pi)
    assert hop.frequency == pytest.approx(alone, rel=0.02)


def test_pitch_is_the_one_that_slows_with_the_pitch_inertia(modes):
    after = vehicle_modes(PAPER.replace({"vehicle.chassis.pitch_inertia": 4 * 14630}))
    assert after.pitch.frequency == pytest.approx(modes.pitch.frequency / 2, rel=0.1)
    assert after.bounce.frequency == pytest.approx(modes.bounce.frequency, rel=0.05)


def test_what_does_not_swing_is_no_mode():
    stiffly_damped = BARE | {"vehicle.road_suspension.damping": 30000.0, "contact.normal_damping": 1e10}
    found = vehicle_modes(PAPER.replace(stiffly_damped))
    assert (found.bounce, found.pitch) == (None, None)
    assert {"Bounce", "Pitch"} <= {creep.name for creep in found.creeping}


def test_the_modes_are_the_vehicles_alone(modes):
    other = PAPER.replace({"drive.speed_kmh": 36, "road.wavelength": 4, "vehicle.seat.x": 0})
    assert vehicle_modes(other).swinging == vehicle_modes(FLAT).swinging == modes.swinging


@pytest.mark.parametrize("name", ["Bounce", "Pitch", "Hop of R6"])
def test_the_vehicle_swings_freely_as_its_mode_says(modes, name):
    """Put 2 mm into the mode, a run of the whole model from there follows it to its end."""
    mode = next(mode for mode in modes.swinging if mode.name == name)
    system = build_system(FLAT)._replace(v_ref=0.0)
    q, _ = rest_pose(system)
    size = 0.002
    v = size * (mode.eigenvalue * mode.shape).real
    y = pack(system, q + size * mode.shape.real, v, np.zeros(len(system.wheel)), 0.0)
    seconds, rate = 2 / mode.frequency, 200 * mode.frequency
    run = Integration(system, build_road(FLAT).table, y, seconds, rate, rtol=1e-7, atol=1e-9)
    while run.advance(seconds).name == "RUNNING":
        pass
    t = np.arange(run.samples_done) / rate
    expected = size * (mode.shape * np.exp(mode.eigenvalue * t)[:, None, None]).real
    body, axis = {"Bounce": (0, 1), "Pitch": (0, 2), "Hop of R6": (12, 1)}[name]
    found = run.samples.q[: len(t), body, axis] - q[body, axis]
    assert len(t) > 350
    np.testing.assert_allclose(found, expected[:, body, axis], atol=0.04 * np.abs(expected[0, body, axis]))


@pytest.mark.parametrize("config", [PAPER, PAPER.replace(OPTIONS["prescribed, reacts on chassis, uneven"])])
def test_a_mode_can_be_played_as_a_run(config: Config):
    mode = vehicle_modes(config).bounce
    run = mode_trajectory(config, mode, amplitude=0.08, period=1.5, x=30.0)
    system = run.system
    rest, load = rest_pose(system)
    assert run.t[[0, -1]] == pytest.approx([0, 1.5])
    np.testing.assert_allclose(run.q[-1], run.q[0], atol=1e-9)  # round and round
    assert run.q[:, 0, 0].mean() == pytest.approx(30, abs=0.01)
    heave = run.q[:, 0, 1] - rest[0, 1]
    assert np.abs(heave).max() == pytest.approx(0.08 * abs(mode.shape[0, 1]), rel=0.01)
    assert (run.normal_load == load).all()
    assert max(np.abs(constraints(system._replace(prescribed=False), q, 0.0)).max() for q in run.q) < 1e-12
    still = mode_trajectory(config, mode, amplitude=0.0)
    np.testing.assert_allclose(still.q, np.broadcast_to(rest, still.q.shape), atol=1e-9)


def test_of_a_mode_the_furthest_joint_or_rim_moves_by_the_amplitude(modes):
    for mode in modes.swinging:
        run = mode_trajectory(PAPER, mode, amplitude=1e-4)
        system, moved = run.system, run.q - mode_trajectory(PAPER, mode, amplitude=0.0).q
        centres = np.abs(moved[:, system.wheel, :2]).max()
        rims = system.r * np.abs(moved[:, system.wheel, 2]).max()
        ends = np.abs(moved[:, 0, 1, None] + moved[:, 0, 2, None] * system.u_i[: system.n, 0]).max()
        assert max(centres, rims, ends) == pytest.approx(1e-4, rel=0.02), mode.name


def test_the_modes_are_quick_enough_for_every_settled_run():
    def seconds() -> float:
        began = time.process_time()
        vehicle_modes(PAPER)
        return time.process_time() - began

    assert min(seconds() for _ in range(5)) < 0.12
