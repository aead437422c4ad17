"""The equations of motion of a phase, linearised about its plan.

A deviation from the plan is e = (difference(q_plan, q), v - v_plan), 2 nv entries in Pinocchio's tangent space. Its
rate is A e + B u, with u the torque that is added to the planned one. The derivatives are Pinocchio's analytical ones.
Source: Carpentier and Mansard, Analytical derivatives of rigid body dynamics algorithms, RSS 2018; Budhiraja et al.,
Differential dynamic programming for multi-phase rigid contact dynamics, Humanoids 2018.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj.dynamics.contacts.base import BoundContact
from robotraj.robot.coupling.coupled_model import uncoupled
from robotraj.robot.coupling.dynamics import accelerations, mass_matrix
from robotraj.robot.robot import Robot
from robotraj.solution.feedback.held_motion import HeldRows, held_rows
from robotraj.symbolic.followers import coordinates

RANK_TOLERANCE = 1e-9
"""Singular values below this, relative to the largest, belong to redundant rows of contacts."""


class Linear(NamedTuple):
    """The linearised motion at one time.

    Attributes
    ----------
    rate : ndarray (2 nv, 2 nv)
        A.
    input : ndarray (2 nv, nu)
        B.
    consistent : ndarray (2 nv, 2 nv)
        Projection of deviations on those whose velocities satisfy the contacts; the identity without contacts.
    """

    rate: Array
    input: Array
    consistent: Array


class _Metric:
    """Rows J of held contacts in the metric of the mass matrix."""

    def __init__(self, mass: Array, jacobian: Array) -> None:
        self.root = np.linalg.cholesky(mass)
        self.jacobian = jacobian
        left, sizes, right = np.linalg.svd(np.linalg.solve(self.root, jacobian.T).T, full_matrices=False)
        kept = sizes > RANK_TOLERANCE * np.max(sizes, initial=0.0)
        self._left, self._right = left[:, kept] / sizes[kept], right[kept]

    def without_rows(self, torque: Array) -> Array:
        """Acceleration M^-1 torque of the free robot."""
        return np.asarray(np.linalg.solve(self.root.T, np.linalg.solve(self.root, torque)))

    def correction(self, gap: Array) -> tuple[Array, Array]:
        """Acceleration of least size in the metric with J a = gap, and the forces f with M a = J' f."""
        along = self._left.T @ gap
        return np.linalg.solve(self.root.T, self._right.T @ along), self._left @ along


class Linearisation:
    """Linearise the motion of a robot with the contacts of a phase.

    Parameters
    ----------
    robot : Robot
        The robot, without symbolic design parameters.
    contacts : sequence of BoundContact
        Contacts that are constraints are linearised. Forces of force laws are given functions of time.
    """

    def __init__(self, robot: Robot, contacts: Sequence[BoundContact]) -> None:
        self._robot = robot
        self._actuation = np.asarray(robot.actuation, dtype=float)
        self._data = robot.model.createData()
        # Pinocchio has no derivatives for followers: they are those of all joints, along the rates S v.
        self._every, self._at = uncoupled(robot.model), coordinates(robot.model)
        self._of_all = self._every.createData()
        self._contacts = tuple(contact for contact in contacts if contact.holds)

    def at(self, q: Array, v: Array, tau: Array) -> Linear:
        """Linearise at positions q (nq,), velocities v (nv,) and torques tau (nu,) of the plan.

        Raises
        ------
        numpy.linalg.LinAlgError
            The mass matrix is not positive definite.
        """
        own, nv = self._robot.model, self._robot.model.nv
        applied = self._actuation @ tau - self._robot.resistance(q, v)
        mass = mass_matrix(own, self._data, q)
        free = accelerations(own, self._data, q, v, applied).copy()
        held = held_rows(self._robot, self._data, q, self._contacts)
        model, data, shares = self._every, self._of_all, self._at.rates
        place, speed = self._at.places @ q + self._at.offsets, shares @ v
        pin.computeForwardKinematicsDerivatives(model, data, place, speed, shares @ free)
        pin.updateFramePlacements(model, data)
        rows = _stack([contact.jacobian(model, data) for contact in held], model.nv) @ shares
        metric = _Metric(mass, rows)
        bias = _sum([contact.acceleration(model, data) for contact in held])
        change, forces = metric.correction(-bias)
        acceleration = free + change
        # The torque J' f and the acceleration of the rows both change with q; f and a are held for the derivative.
        pin.computeForwardKinematicsDerivatives(model, data, place, speed, shares @ acceleration)
        velocity_q, acceleration_q, acceleration_v = (np.zeros((len(rows), nv)) for _ in range(3))
        turning = np.zeros((nv, nv))
        start = 0
        for contact in held:
            part = slice(start, start + contact.count)
            start = part.stop
            slopes = contact.slopes(model, data)
            velocity_q[part], acceleration_q[part], acceleration_v[part] = (slope @ shares for slope in slopes)
            turning += shares.T @ contact.torque_slope(model, data, forces[part]) @ shares
        external = self._external(held, forces)
        slopes = pin.computeRNEADerivatives(model, data, place, speed, shares @ acceleration, external)
        torque_q, torque_v = (shares.T @ np.asarray(slope) @ shares for slope in slopes[:2])
        free_q = -metric.without_rows(torque_q - turning + np.diag(self._robot.stiffness))
        free_v = -metric.without_rows(torque_v + np.diag(self._drag(v)))
        free_u = metric.without_rows(self._actuation)
        rate, push, consistent = np.zeros((2 * nv, 2 * nv)), np.zeros((2 * nv, len(tau))), np.eye(2 * nv)
        rate[:nv, nv:] = np.eye(nv)
        if own.nq > nv:
            # A deviation that is constant in the world rotates and shifts in the axes of a moving body.
            rate[:6, :6] -= pin.Motion(v[:6]).action
        rate[nv:, :nv] = free_q + metric.correction(-acceleration_q - rows @ free_q)[0]
        rate[nv:, nv:] = free_v + metric.correction(-acceleration_v - rows @ free_v)[0]
        push[nv:] = free_u + metric.correction(-rows @ free_u)[0]
        consistent[nv:, :nv] = metric.correction(-velocity_q)[0]
        consistent[nv:, nv:] += metric.correction(-rows)[0]
        return Linear(rate, push, consistent)

    def _drag(self, v: Array) -> Array:
        """Slope of the dissipation with speed (nv,) [N m s/rad, N s/m]."""
        robot = self._robot
        speed = np.tanh(v / robot.friction_speed)
        return np.asarray(robot.damping + robot.friction / robot.friction_speed * (1.0 - speed**2))

    def _external(self, held: Sequence[HeldRows], forces: Array) -> pin.StdVec_Force:
        """Add up the forces of the contacts on the bodies, in the axes of their joints."""
        model, data = self._every, self._of_all
        total = pin.StdVec_Force()
        for _ in range(model.njoints):
            total.append(pin.Force.Zero())
        start = 0
        for contact in held:
            stop = start + contact.count
            for joint, wrench in contact.wrenches(model, data, forces[start:stop]):
                total[joint] = total[joint] + wrench
            start = stop
        return total


def _stack(parts: Sequence[Array], columns: int) -> Array:
    return np.concatenate([*parts, np.zeros((0, columns))])


def _sum(parts: Sequence[Array]) -> Array:
    return np.concatenate([*parts, np.zeros(0)])
