"""The motion of small deviations from a planned phase, with all contacts that carry load.

A deviation is e = (difference(q_plan, q), v - v_plan), 2 nv entries, in Pinocchio's tangent space; its rate is
A e + B u, with u the torques added to the planned ones. Contacts are held by Baumgarte's terms, like a soft ground.
Source: Baumgarte, Stabilization of constraints and integrals of motion, Comp. Meth. Appl. Mech. Eng. 1 (1972).
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from types import SimpleNamespace

import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj.dynamics.contacts.base import BoundContact
from robotraj.dynamics.contacts.implicit import BoundImplicitContact
from robotraj.robot.coupling.dynamics import accelerations
from robotraj.robot.robot import Robot
from robotraj.solution.feedback.riccati import transition
from robotraj.witness.contacts.constrained import Held, accelerate, impact
from robotraj.witness.mujoco.feet import Foot, place
from robotraj.witness.mujoco.roots import RootCoordinates
from robotraj.witness.numbers import as_numbers

STEP = 1e-6
"""Finite difference of positions [rad, m] and velocities [rad/s, m/s]."""

SLOWEST = 0.05
"""Speed of touchdown [m/s] below which its time does not depend on the deviation."""

WORLD = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED

STIFFNESS = 50.0
"""Rate [1/s] at which violations of contacts decay in the linearised motion."""


class LinearPhase:
    """The linearised motion of a robot with the contacts of a phase.

    Parameters
    ----------
    robot : Robot
        The robot, without symbolic design parameters.
    contacts : sequence of BoundContact
    """

    def __init__(self, robot: Robot, contacts: Sequence[BoundContact]) -> None:
        self.robot = robot
        self._actuation = np.asarray(robot.actuation, dtype=float)
        self._data = robot.model.createData()
        self._contacts = tuple(contacts)

    def rates(self, q: Array, v: Array, tau: Array, pushing: Collection[str] = ()) -> tuple[Array, Array]:
        """Return A (2 nv, 2 nv) and B (2 nv, nu) of the rate of a deviation at a planned state.

        Of implicit contacts those named ``pushing`` hold.
        """
        model, nv = self.robot.model, self.robot.model.nv
        joints = self._actuation @ tau
        rows = self._rows(q, pushing)
        held = self._held(rows, q, v)
        here = self._acceleration(q, v, joints, held)
        rate = np.zeros((2 * nv, 2 * nv))
        rate[:nv, nv:] = np.eye(nv)
        if model.nq > nv:
            # A deviation that is constant in the world rotates and shifts in the axes of a moving body.
            rate[:6, :6] -= pin.Motion(v[:6]).action
        for i, unit in enumerate(STEP * np.eye(nv)):
            there = pin.integrate(model, q, unit)
            rate[nv:, i] = (self._acceleration(there, v, joints, self._held(rows, there, v), held, unit) - here) / STEP
            rate[nv:, nv + i] = (self._acceleration(q, v + unit, joints, self._held(rows, q, v + unit)) - here) / STEP
        push = np.zeros((2 * nv, self._actuation.shape[1]))
        for j, column in enumerate(self._actuation.T):
            # The acceleration is linear in the torque: a difference of 1 N m is exact.
            push[nv:, j] = self._acceleration(q, v, joints + column, held) - here
        return rate, push

    def step(
        self, q: Array, v: Array, tau: Array, duration: float, pushing: Collection[str] = ()
    ) -> tuple[Array, Array]:
        """Return transition matrices (2 nv, 2 nv) and (2 nv, nu) over a short time [s], u constant."""
        return transition(*self.rates(q, v, tau, pushing), duration)

    def touchdown(self, q: Array, rate: Array, feet: Sequence[Foot], root: RootCoordinates) -> Array:
        """Return the matrix (2 nv, 2 nv) from a deviation before the impact at the start of the phase to one after it.

        The impact occurs when the feet reach the ground, not at its planned time; afterwards the plan is shifted to
        their places. The matrix contains impact, change of time and shift.
        Source: Saccon, van de Wouw and Nijmeijer, Sensitivity analysis of hybrid systems with state jumps, CDC 2014.

        Parameters
        ----------
        q : ndarray (nq,)
            Planned position at the impact.
        rate : ndarray (2 nv,)
            Planned rate of (q, v) just before it.
        feet : sequence of Foot
            Those that touch down.
        root : RootCoordinates
        """
        nv = self.robot.model.nv
        landed = np.eye(2 * nv)
        held = self._held(self._rows(q), q, np.zeros(nv))
        if held is not None:
            for i, unit in enumerate(np.eye(nv)):
                landed[nv:, nv + i] = impact(self.robot.model, self._data, q, unit, held)[0]
        if not feet:
            return landed
        model, data = self.robot.model, self._data
        pin.computeJointJacobians(model, data, q)
        pin.updateFramePlacements(model, data)
        moves, upward = np.zeros((3, nv)), np.zeros(nv)
        for foot in feet:
            motion = pin.getFrameJacobian(model, data, foot.frame, WORLD)
            arm = data.oMf[foot.frame].rotation @ foot.pose.translation
            jacobian = motion[:3] - pin.skew(arm) @ motion[3:]
            moves += jacobian / len(feet)
            at = place(foot, data.oMf)
            upward += np.array(foot.touched(at).normal_at(at.tolist())) @ jacobian / len(feet)
        height = np.concatenate([upward, np.zeros(nv)])
        if (speed := height @ rate) < -SLOWEST:
            landed = landed @ (np.eye(2 * nv) - np.outer(rate, height) / speed)
        shift = np.eye(2 * nv)
        shift[:nv, :nv] -= root.along(q) @ moves
        return np.asarray(shift @ landed)

    def _rows(self, q: Array, pushing: Collection[str] = ()) -> list[tuple[int, str, Array]]:
        """Return frames and matrices (m, 6) from their motion to the rows of each contact."""
        pin.framesForwardKinematics(self.robot.model, self._data, q)
        found = []
        for contact in self._contacts:
            velocity = contact.velocity
            if isinstance(contact, BoundImplicitContact):
                if contact.name not in pushing:
                    continue
                velocity = contact.spot.velocity
            point = _SingleFrameMotion(self.robot, self._data)
            as_numbers(velocity(point), contact.name)
            for name, index in tuple(point.read.items()):
                columns = [as_numbers(velocity(point.with_motion(name, unit)), contact.name) for unit in np.eye(6)]
                found.append((index, contact.name, np.column_stack(columns)))
        return found

    def _held(self, rows: list[tuple[int, str, Array]], q: Array, v: Array) -> Held | None:
        """Return the rows of the contacts at a state near the planned one."""
        if not rows:
            return None
        model, data, nv = self.robot.model, self._data, self.robot.model.nv
        pin.forwardKinematics(model, data, q, v, np.zeros(nv))
        pin.computeJointJacobians(model, data, q)
        pin.updateFramePlacements(model, data)
        jacobians: dict[str, Array] = {}
        biases: dict[str, Array] = {}
        for index, name, matrix in rows:
            bias = matrix @ pin.getFrameClassicalAcceleration(model, data, index, WORLD).vector
            jacobian = matrix @ pin.getFrameJacobian(model, data, index, WORLD)
            # The rows of a closed loop depend on two frames.
            biases[name] = biases.get(name, 0.0) + bias
            jacobians[name] = jacobians.get(name, 0.0) + jacobian
        bias = np.concatenate(list(biases.values()))
        return Held(np.zeros_like(bias), np.concatenate(list(jacobians.values())), bias)

    def _acceleration(
        self,
        q: Array,
        v: Array,
        joints: Array,
        held: Held | None,
        planned: Held | None = None,
        away: Array | float = 0.0,
    ) -> Array:
        """Return the acceleration (nv,) under torques of all joints; ``away`` is the deviation of q."""
        applied = joints - self.robot.resistance(q, v)
        if held is None:
            return accelerations(self.robot.model, self._data, q, v, applied)
        # The planned state satisfies the rows up to the error of the plan, which is not corrected.
        gap = np.zeros_like(held.bias) if planned is None else planned.jacobian @ away
        pull = 2.0 * STIFFNESS * (held.jacobian @ v) + STIFFNESS**2 * gap
        return accelerate(self.robot.model, self._data, q, v, applied, held._replace(bias=held.bias + pull))[0]


class _SingleFrameMotion:
    """A point at which one frame moves and all others are at rest: rows of contacts are linear in such motions."""

    def __init__(self, robot: Robot, data: pin.Data) -> None:
        self._robot, self._data = robot, data
        self._moving: tuple[str, Array] = ("", np.zeros(6))
        self.read: dict[str, int] = {}

    def with_motion(self, name: str, motion: Array) -> _SingleFrameMotion:
        """Move a frame, with velocity (6,) in world axes."""
        self._moving = name, motion
        return self

    def frame(self, name: str) -> SimpleNamespace:
        """Return pose of a frame and its velocity in world axes."""
        index = self.read.setdefault(name, self._robot.frame(name))
        place, (moving, motion) = self._data.oMf[index], self._moving
        velocity = motion if name == moving else np.zeros(6)
        return SimpleNamespace(position=place.translation, rotation=place.rotation, velocity=velocity)
