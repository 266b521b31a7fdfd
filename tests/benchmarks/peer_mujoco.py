"""MuJoCo on our vehicle and road: joint coordinates, its own contact, its own loop in C.

What differs from ours: the road is a height field in straight pieces; friction resists sliding without ever sticking;
the hull is pulled by a servo that holds the speed to some mm/s; one implicit solution a step, of first order.
"""

from __future__ import annotations

from xml.etree.ElementTree import Element, SubElement, tostring

import numpy as np

from model.dynamics.vehicle import GRAVITY, System
from tests.benchmarks.peer_task import Task

IMPEDANCE = 0.005  # MuJoCo's d of an untouched contact: so small that a contact is a spring and hardly a mass
TOUCHED = 2  # triangles of the road that a wheel stands on at a time: each bears its part
ROAD_WIDTH = 1.0  # m, of the height field, which the wheels touch in its middle
PULL = 3e-3  # s, in which the servo brings the vehicle to its speed


class MujocoPeer:
    """A `Peer`."""

    def __init__(self, task: Task) -> None:
        import mujoco

        self._mujoco, self._task = mujoco, task
        self._parent, pins = _tree(task.system)
        self._model = mujoco.MjModel.from_xml_string(_model_text(task, self._parent, pins))
        self._set_contacts()
        self._data = mujoco.MjData(self._model)

    def run(self) -> None:
        self._start()
        self._mujoco.mj_step(self._model, self._data, self._task.steps)

    def loads(self) -> np.ndarray:
        mujoco, model, data, wheels = self._mujoco, self._model, self._data, self._task.system.wheel
        wheel = {model.geom(f"wheel {b}").id: w for w, b in enumerate(wheels)}
        every = self._task.steps // (len(self._task.t) - 1)
        loads, force = np.zeros((len(self._task.t), len(wheels))), np.zeros(6)
        self._start()
        for sample in loads:
            mujoco.mj_forward(model, data)
            for c, contact in enumerate(data.contact):
                mujoco.mj_contactForce(model, data, c, force)
                sample[wheel[contact.geom[1]]] += force[0]
            mujoco.mj_step(model, data, every)
        return loads

    def _start(self) -> None:
        """Poses and rates at t = 0; a joint's coordinate is an angle to the body that it hangs on."""
        model, data, q, v = self._model, self._data, self._task.q, self._task.v
        self._mujoco.mj_resetData(model, data)
        for axis in (0, 1):
            data.joint(f"hull {axis}").qpos, data.joint(f"hull {axis}").qvel = q[0, axis], v[0, axis]
        for b, i in {0: None, **self._parent}.items():
            joint = data.joint(f"turn {b}")
            joint.qpos, joint.qvel = (q[b, 2], v[b, 2]) if i is None else (q[b, 2] - q[i, 2], v[b, 2] - v[i, 2])
        data.ctrl = self._task.system.v_ref

    def _set_contacts(self) -> None:
        """Stiffness and damping of each wheel's contact: at the static load, force and slope are those of our f_n.

        MuJoCo pushes with D (k z + b ż) at a penetration z, where D = d/((1 − d) A) with A the wheel's mobility,
        k = K d/d_1² and b = B/d_1; −K and −B are given as solref. Its impedance d may grow with z, up to d_1: with
        d = d_0 (1 + z/z_0) and d ≪ 1 the force is nearly quadratic about z_0. K and B follow from our k_n z_0² and
        c_n z_0² ż.
        """
        s, model = self._task.system, self._model
        for b, z_0 in zip(s.wheel, self._task.sinking, strict=True):
            geom, mobility = model.geom(f"wheel {b}"), model.body(f"body {b}").invweight0[0]
            d, d_1 = 2 * IMPEDANCE, 5 * IMPEDANCE  # at z_0, at 4 z_0
            D = d / ((1 - d) * mobility) * TOUCHED
            geom.solimp = d_1 / 5, d_1, 4 * z_0, 0.5, 1
            geom.solref = -s.ground.k_n * z_0 / D * d_1**2 / d, -s.ground.c_n * z_0**2 / D * d_1
        # Sliding is damped impratio times as much as sinking in: at the static load as our ground damps it
        model.opt.impratio = s.ground.c_t / np.mean(s.ground.c_n * self._task.sinking**2)


def _tree(s: System) -> tuple[dict[int, int], dict[int, tuple[np.ndarray, np.ndarray]]]:
    """Each body's parent, parents first, and its pin in the parent's frame and its own, from their centres of mass.

    An imaginary arm hangs on the road arm, at the pin of the wheel between: the same place, without the wheel's spin.
    """
    parent = dict(zip(s.joint_j.tolist(), s.joint_i.tolist(), strict=True))
    pins = dict(zip(parent, zip(s.u_i, s.u_j, strict=True), strict=True))
    for b, i in parent.items():
        if i in s.wheel:
            parent[b], pins[b] = parent[i], (pins[i][0], pins[b][1])
    return parent, pins


def _model_text(task: Task, parent: dict[int, int], pins: dict[int, tuple[np.ndarray, np.ndarray]]) -> str:
    """The model in MuJoCo's XML: x forward, z up; a body's frame has its origin at the pin that it hangs on."""
    s = task.system
    root = Element("mujoco")
    SubElement(root, "compiler", angle="radian", inertiafromgeom="false")
    SubElement(
        root, "option", timestep=str(task.step), gravity=f"0 0 {-GRAVITY}", integrator="implicitfast", cone="elliptic"
    )
    world = SubElement(root, "worldbody")
    middle, length, low, rise = (task.x[0] + task.x[-1]) / 2, np.ptp(task.x), task.h.min(), np.ptp(task.h)
    SubElement(
        SubElement(root, "asset"),
        "hfield",
        name="road",
        nrow="2",
        ncol=str(len(task.x)),
        size=_text(length / 2, ROAD_WIDTH / 2, rise, 1.0),
        elevation=_text(*task.h, *task.h),
    )
    SubElement(
        world, "geom", type="hfield", hfield="road", pos=_text(middle, 0, low), conaffinity="1", contype="0", condim="1"
    )

    centre = {0: np.zeros(2)} | {b: -u_j for b, (_, u_j) in pins.items()}  # of mass, from the body's origin
    spring = {b: k for k, b in enumerate(s.spring_j.tolist())}
    bodies: dict[int, Element] = {}
    for b, i in {0: None, **parent}.items():
        at = np.zeros(2) if i is None else centre[i] + pins[b][0]
        bodies[b] = SubElement(world if i is None else bodies[i], "body", name=f"body {b}", pos=_text(at[0], 0, at[1]))
        inertia = _text(*[s.inertia[b]] * 3)
        pos = _text(centre[b][0], 0, centre[b][1])
        SubElement(bodies[b], "inertial", mass=_text(s.mass[b]), pos=pos, diaginertia=inertia)
        if i is None:
            for axis, along in enumerate(("1 0 0", "0 0 1")):
                SubElement(bodies[b], "joint", name=f"hull {axis}", type="slide", axis=along)
        turn = SubElement(bodies[b], "joint", name=f"turn {b}", type="hinge", axis="0 -1 0")
        if b in spring:
            k = spring[b]  # the preload is a spring's turn from where it would rest
            turn.attrib |= {"stiffness": _text(s.k_s[k]), "damping": _text(s.c_s[k])}
            turn.set("springref", _text(s.tau_0[k] / s.k_s[k]))
    for b in s.wheel.tolist():
        size, friction = _text(s.r), _text(s.ground.mu)
        wheel = SubElement(bodies[b], "geom", name=f"wheel {b}", type="sphere", size=size, friction=friction)
        wheel.attrib |= {"contype": "1", "conaffinity": "0", "condim": "3", "priority": "1"}

    SubElement(SubElement(root, "actuator"), "velocity", joint="hull 0", kv=_text(s.mass.sum() / PULL))
    return tostring(root, encoding="unicode")


def _text(*values: float) -> str:
    return " ".join(repr(float(value)) for value in values)
