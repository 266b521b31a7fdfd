"""The contact law by itself, against eq. (4)–(7) worked out by hand, and its energies against its forces."""

from __future__ import annotations

import numpy as np
import pytest

from model.dynamics.ground import Ground, depth, force, losses, pressed, shear_energy

GROUND = Ground(k_n=3e7, c_n=3e8, k_t=6e5, c_t=1.7e4, mu=0.7)
DEEP = 0.01  # m
LOAD = 3000.0  # N, at DEEP


def test_a_load_grows_with_the_square_of_the_depth_and_with_the_speed_into_the_ground():
    assert force(GROUND, DEEP, 0.0, 0.0, 0.0) == pytest.approx((LOAD, 0.0, 0.0))
    assert force(GROUND, 2 * DEEP, 0.0, 0.0, 0.0)[0] == pytest.approx(4 * LOAD)
    assert force(GROUND, DEEP, 0.05, 0.0, 0.0)[0] == pytest.approx(LOAD + 1500.0)
    assert force(GROUND, DEEP, -0.05, 0.0, 0.0)[0] == pytest.approx(LOAD - 1500.0)


def test_the_ground_never_pulls_and_ends_at_its_surface():
    assert force(GROUND, DEEP, -1.0, 0.1, 0.0)[:2] == (0.0, 0.0)
    assert force(GROUND, -DEEP, 1.0, 0.1, 0.0)[:2] == (0.0, 0.0)


def test_traction_is_shear_and_its_damping_up_to_the_friction():
    f_n, f_t, xi_dot = force(GROUND, DEEP, 0.0, 0.02, 1e-3)
    assert (f_n, f_t) == pytest.approx((LOAD, -(600.0 + 340.0)))
    assert xi_dot == pytest.approx(0.02)  # sticks: the ground is sheared as fast as the rim moves
    _, f_t, xi_dot = force(GROUND, DEEP, 0.0, 1.0, 1e-3)
    assert f_t == pytest.approx(-0.7 * LOAD)
    assert xi_dot == pytest.approx((2100.0 - 600.0) / 1.7e4)
    assert force(GROUND, DEEP, 0.0, -1.0, 1e-3)[1] == pytest.approx(0.7 * LOAD)


def test_energies_have_the_forces_as_their_slopes():
    z, step = np.array([-0.01, 1e-3, DEEP, 0.03]), 1e-6
    here, ahead, behind = (pressed(GROUND, z + side) for side in (0.0, step, -step))
    np.testing.assert_allclose((ahead.energy - behind.energy) / (2 * step), here.force, rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose((ahead.force - behind.force) / (2 * step), here.stiffness, rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(here.force, [force(GROUND, one, 0.0, 0.0, 0.0)[0] for one in z])
    assert depth(GROUND, LOAD) == pytest.approx(DEEP)
    sheared = (shear_energy(GROUND, 1e-3 + step) - shear_energy(GROUND, 1e-3 - step)) / (2 * step)
    assert sheared == pytest.approx(-force(GROUND, DEEP, 0.0, 0.0, 1e-3)[1], rel=1e-6)


@pytest.mark.parametrize("p_dot", [0.02, 1.0, -1.0])
@pytest.mark.parametrize("z_dot", [0.05, -0.05, -1.0])
def test_all_power_is_stored_or_lost(z_dot, p_dot):
    xi = 1e-3
    f_n, f_t, xi_dot = force(GROUND, DEEP, z_dot, p_dot, xi)
    lost = losses(GROUND, DEEP, z_dot, p_dot, xi, f_n, f_t)
    stored = pressed(GROUND, DEEP).force * z_dot + GROUND.k_t * xi * xi_dot
    assert f_n * z_dot - f_t * p_dot == pytest.approx(stored + lost.damping + lost.friction)
    assert lost.damping >= 0.0
    assert lost.friction >= -1e-9
