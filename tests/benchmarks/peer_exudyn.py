"""Exudyn on our vehicle and road: planar rigid bodies and revolute joints as in our equations, implicit steps.

What differs from ours: a wheel's contact is its overlap with the straight pieces of the road, without friction, since
Exudyn's planar contact does not see that a wheel rolls; so the wheels keep the spin that they start with.
"""

from __future__ import annotations

import sys
from contextlib import redirect_stdout
from io import StringIO

import numpy as np

from model.dynamics.vehicle import GRAVITY
from tests.benchmarks.peer_task import Task


class ExudynPeer:
    """A `Peer`. As it comes, or tuned: solver settings that lose nothing of the loads and take a third of the time."""

    def __init__(self, task: Task, tuned: bool) -> None:
        sys.exudynFast = True  # its build without range checks, which it announces
        with redirect_stdout(StringIO()):
            import exudyn.itemInterface

        self._exudyn, self._task = exudyn, task
        self._container = exudyn.SystemContainer()
        self._mbs = self._container.AddSystem()
        wheels = self._add_vehicle()
        self._add_road(wheels)
        self._mbs.Assemble()
        self._settings = self._settings_of(tuned)

    def run(self) -> None:
        self._mbs.SolveDynamic(self._settings)

    def loads(self) -> np.ndarray:
        mbs, variable = self._mbs, self._exudyn.OutputVariableType
        wheels = len(self._task.static_load)
        t, loads = [0.0], [self._task.static_load]

        def after_step(_: object, now: float) -> bool:
            force = np.nan_to_num(mbs.GetObjectOutput(self._contact, variable.ForceLocal)).reshape(-1, 2)
            wheel = mbs.GetNodeOutput(self._touching, variable.Coordinates).reshape(-1, 3)[:, 0].astype(int)
            of_wheel = [np.bincount(wheel[wheel >= 0], axis[wheel >= 0], wheels) for axis in force.T]
            t.append(now)
            loads.append(np.hypot(*of_wheel))
            return True

        mbs.SetPostStepUserFunction(after_step)
        self.run()
        mbs.SetPostStepUserFunction(0)
        return np.column_stack([np.interp(self._task.t, t, load) for load in np.transpose(loads)])

    def _add_vehicle(self) -> list[int]:
        """Bodies, joints, torsion bars and the constraint that pulls the hull; the markers of the wheels."""
        s, q, mbs, item = self._task.system, self._task.q, self._mbs, self._exudyn.itemInterface
        bodies, angles = [], []
        for b in range(len(s.mass)):
            node = mbs.AddNode(
                item.NodeRigidBody2D(
                    referenceCoordinates=s.q_design[b],
                    initialCoordinates=q[b] - s.q_design[b],
                    initialVelocities=self._task.v[b],
                )
            )
            bodies.append(mbs.AddObject(item.ObjectRigidBody2D(nodeNumber=node, mass=s.mass[b], inertia=s.inertia[b])))
            angles.append(mbs.AddMarker(item.MarkerNodeCoordinate(nodeNumber=node, coordinate=2)))
            weight = mbs.AddMarker(item.MarkerBodyMass(bodyNumber=bodies[b]))
            mbs.AddLoad(item.LoadMassProportional(markerNumber=weight, loadVector=[0, -GRAVITY, 0]))
            if b == s.chassis:
                hull_x = mbs.AddMarker(item.MarkerNodeCoordinate(nodeNumber=node, coordinate=0))
        for i, j, u_i, u_j in zip(s.joint_i, s.joint_j, s.u_i, s.u_j, strict=True):
            pins = [
                mbs.AddMarker(item.MarkerBodyPosition(bodyNumber=bodies[b], localPosition=[*u, 0]))
                for b, u in ((i, u_i), (j, u_j))
            ]
            mbs.AddObject(item.ObjectJointRevolute2D(markerNumbers=pins))
        for i, j, k, c, tau_0 in zip(s.spring_i, s.spring_j, s.k_s, s.c_s, s.tau_0, strict=True):
            ends = [angles[i], angles[j]]
            bar = item.ObjectConnectorCoordinateSpringDamper(
                markerNumbers=ends, stiffness=k, damping=c, offset=tau_0 / k
            )
            mbs.AddObject(bar)
        rest = mbs.AddMarker(item.MarkerNodeCoordinate(nodeNumber=mbs.AddNode(item.NodePointGround()), coordinate=0))
        mbs.AddObject(item.ObjectConnectorCoordinate(markerNumbers=[rest, hull_x], offset=s.v_ref, velocityLevel=True))
        return [mbs.AddMarker(item.MarkerBodyRigid(bodyNumber=bodies[b])) for b in s.wheel]

    def _add_road(self, wheels: list[int]) -> None:
        """Contact by the area of overlap: z deep, a wheel is 2 √(2 r z) long in the road and 4/3 z √(2 r z) large."""
        task, s, mbs, item = self._task, self._task.system, self._mbs, self._exudyn.itemInterface
        corners = np.column_stack([task.x, task.h])[::-1]  # with the air on the right-hand side
        pieces = np.hstack([corners[:-1], corners[1:]])
        z = np.sqrt(task.static_load.mean() / s.ground.k_n)
        length = 2 * np.sqrt(2 * s.r * z)
        initial = np.tile([-1.0, 0.0, 0.0], len(pieces))  # of each piece: the wheel on it, none yet; gap; sliding
        self._touching = mbs.AddNode(
            item.NodeGenericData(numberOfDataCoordinates=len(initial), initialCoordinates=initial)
        )
        ground = mbs.AddMarker(item.MarkerBodyRigid(bodyNumber=mbs.AddObject(item.ObjectGround())))
        self._contact = mbs.AddObject(
            item.ObjectContactCurveCircles(
                markerNumbers=[ground, *wheels],
                nodeNumber=self._touching,
                circlesRadii=[s.r] * len(wheels),
                segmentsData=self._exudyn.MatrixContainer(pieces),
                contactStiffness=s.ground.k_n * z**2 / (2 / 3 * z * length),
                contactDamping=s.ground.c_n * z**2 / length,
                contactModel=1,
            )
        )

    def _settings_of(self, tuned: bool):  # type: ignore[no-untyped-def]
        """Steps of the generalised-α method, Exudyn's usual one."""
        settings = self._exudyn.SimulationSettings()
        time = settings.timeIntegration
        time.numberOfSteps, time.endTime = self._task.steps, self._task.t[-1]
        time.verboseMode = 0
        settings.solutionSettings.writeSolutionToFile = False
        if tuned:
            settings.linearSolver.solverType = self._exudyn.LinearSolverType.EigenSparse
            time.newton.relativeTolerance, time.newton.absoluteTolerance = 1e-5, 1e-6
            time.discontinuous.maxIterations = 1  # a wheel that has just touched or left counts from the next step
        return settings
