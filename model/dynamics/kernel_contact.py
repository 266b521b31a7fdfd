"""Where the wheels meet the road, and the forces there: eq. (4)–(7), compiled, for all chains side by side (lanes.py).

The law itself stands in ground.py. Looking up the road is done wheel by wheel, and so is the search where wheels may
bridge a valley; all else in lanes.
"""

from __future__ import annotations

import numpy as np

from model.compiled import compiled, inlined
from model.dynamics import ground
from model.dynamics.lanes import CONSTANTS_SIZE, HEAD, LANES, SCRATCH_SIZE, STATE_SIZE, C, P, W, Y
from model.road.nearest_point import FAR, approach, halley, nearest, quintic

# Where the rows of a kind of wheel begin: x and what follows it, ξ, its part of scratch space, whether it is there
ROAD, IMAGINARY = (Y.x_w, Y.xi_w, W.X_w, P.road), (Y.x_v, Y.xi_v, W.X_v, P.imaginary)
NEAR = 1e-9  # m: a wheel's centre that is no higher above the road is searched for


_force = inlined(ground.force)


@inlined
def _press(lanes, i, n_x, n_y, d, y, dy, w, wheel):
    """The ground's force on the wheel in lane i, whose centre is d from the ground along n: its normal load."""
    X, XI, AT, _THERE = wheel
    v_x, v_y, omega = y[i + X + 3 * LANES], y[i + X + 4 * LANES], y[i + X + 5 * LANES]
    z_dot, p_dot = -(v_x * n_x + v_y * n_y), v_x * n_y - v_y * n_x + lanes.r * omega
    z = lanes.r - d
    f_n, f_t, xi_dot = _force(lanes.ground, z, z_dot, p_dot, y[i + XI])
    w[i + AT + C.f_n], w[i + AT + C.f_t] = f_n, f_t
    w[i + AT + C.z], w[i + AT + C.power] = z, f_t * p_dot - f_n * z_dot
    w[i + AT + C.F_x], w[i + AT + C.F_y] = f_n * n_x + f_t * n_y, f_n * n_y - f_t * n_x
    dy[i + XI] = xi_dot
    return f_n


@inlined
def load_of(lanes, road, x, y, v_x, v_y):
    """Normal load, N, and depth, m, of one wheel, from its centre's place and velocity."""
    _s, _h, n_x, n_y, d = nearest(road, x, y)
    z = lanes.r - d
    f_n, _f_t, _xi_dot = _force(lanes.ground, z, -(v_x * n_x + v_y * n_y), 0.0, 0.0)
    return f_n, z


@inlined
def _look_up(lanes, road, y, w, p, wheel):
    """What the road is like under one wheel of each chain of a block; `wheel` tells which: ROAD or IMAGINARY."""
    X, _XI, AT, THERE = wheel
    for i in range(lanes.lanes):
        (
            w[AT + C.X + i],
            w[AT + C.s + i],
            w[AT + C.u + i],
            w[AT + C.c_0 + i],
            w[AT + C.c_1 + i],
            w[AT + C.c_2 + i],
            w[AT + C.c_3 + i],
            w[AT + C.c_4 + i],
            w[AT + C.c_5 + i],
            w[AT + C.final + i],
        ) = approach(road, y[X + i], y[X + LANES + i] if p[THERE + i] > 0.0 else FAR)


@inlined
def _touch(lanes, i, y, dy, w, p, wheel):
    """The ground's force on the wheel in lane i: (normal load, 1 where the contact point must be searched for)."""
    X, _XI, AT, _THERE = wheel
    x, s, height = w[i + AT + C.X], w[i + AT + C.s], y[i + X + LANES]
    h, h1, h2, h3 = quintic(
        w[i + AT + C.c_0],
        w[i + AT + C.c_1],
        w[i + AT + C.c_2],
        w[i + AT + C.c_3],
        w[i + AT + C.c_4],
        w[i + AT + C.c_5],
        w[i + AT + C.u],
    )
    step, h = halley(x, height, s, h, h1, h2, h3)
    n_x, n_y = x - s - step, height - h
    found = (abs(step) < w[i + AT + C.final]) & (n_y > NEAR) & (abs(n_x) <= lanes.r)
    touches = 1.0 if found else 0.0
    d = np.sqrt(n_x * n_x + n_y * n_y)
    over_d = 1.0 / d
    n_x, n_y = n_x * over_d, n_y * over_d
    # Until it is searched for, such a wheel is as far away as an empty lane
    f_n = _press(lanes, i, n_x, n_y, d if found else FAR, y, dy, w, wheel)
    w[i + AT + C.final] = touches
    return f_n, 1.0 - touches


@inlined
def _search(lanes, road, y, dy, w, wheel):
    """The same for those that `_touch` left out, one by one: the sum of their normal loads."""
    X, _XI, AT, _THERE = wheel
    total = 0.0
    for i in range(lanes.lanes):
        if w[i + AT + C.final] == 0.0:
            _s, _h, n_x, n_y, d = nearest(road, y[i + X], y[i + X + LANES])
            total += _press(lanes, i, n_x, n_y, d, y, dy, w, wheel)
    return total


@inlined
def block(lanes, b, y, dy, work):
    """Block b of the flat state, of its rates, of the vehicle's constants, and of scratch space."""
    at = HEAD + b * STATE_SIZE
    return (
        y[at : at + STATE_SIZE],
        dy[at : at + STATE_SIZE],
        lanes.constants[b * CONSTANTS_SIZE : (b + 1) * CONSTANTS_SIZE],
        work.blocks[b * SCRATCH_SIZE : (b + 1) * SCRATCH_SIZE],
    )


@compiled
def contact_forces(lanes, road, y, dy, work):
    """Eq. (4)–(7) for every wheel: fills scratch space and ξ̇; the sum of all normal loads."""
    count = len(work.blocks) // SCRATCH_SIZE
    for b in range(count):
        s, _, p, w = block(lanes, b, y, dy, work)
        _look_up(lanes, road, s, w, p, ROAD)
        _look_up(lanes, road, s, w, p, IMAGINARY)
    total, missed = 0.0, 0.0
    for b in range(count):
        s, ds, p, w = block(lanes, b, y, dy, work)
        for i in range(lanes.lanes):
            on_road, off_road = _touch(lanes, i, s, ds, w, p, ROAD)
            on_imaginary, off_imaginary = _touch(lanes, i, s, ds, w, p, IMAGINARY)
            total += on_road + on_imaginary
            missed += off_road + off_imaginary
    if missed > 0.0:
        for b in range(count):
            s, ds, _, w = block(lanes, b, y, dy, work)
            total += _search(lanes, road, s, ds, w, ROAD) + _search(lanes, road, s, ds, w, IMAGINARY)
    return total
