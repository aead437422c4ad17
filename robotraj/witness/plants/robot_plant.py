"""A robot under its planned torques, by plain double-precision Pinocchio."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from robotraj._util.arrays import Array
from robotraj.dynamics.design.binding import realised
from robotraj.robot.coupling.dynamics import accelerations
from robotraj.robot.robot import Robot
from robotraj.robot.tangent import PLACE, difference, floats, normalised, rate_matrix
from robotraj.solution.feedback.linearisation import Linearisation
from robotraj.witness.contacts.stance import Stance, forces_in
from robotraj.witness.planned import robot_sample
from robotraj.witness.plants.plant import RATE_UNITS, Landing
from robotraj.witness.protocols import PhaseSolutionLike, Settle

Feedback = Callable[[Array], Array]
"""``feedback(times)`` returns gains (m, nu, 2 nv) at times (m,)."""

FLYING = ("root_x", "root_y", "root_z", "root_rx", "root_ry", "root_rz")
"""Deviation of a floating root: along the world's axes [m], and a rotation vector in its own axes [rad]."""

QUATERNION_DIFFERENCE = 1e-7
"""Finite difference of the entries of a floating root's configuration."""


class _Given(NamedTuple):
    """The plan at one time: torques, forces of implicit contacts, and gains with the state that they refer to."""

    torques: Array
    forces: dict[str, Array]
    gains: Array | None
    q: Array
    v: Array


class RobotPlant:
    """A robot under its planned torques, x = (q, v); see ``Plant``.

    Parameters
    ----------
    planned : PhaseSolution
    feedback : callable, optional
        ``feedback(times)`` returns gains (m, nu, 2 nv): the torque is tau_plan - K (x - x_plan).
    robot : Robot, optional
        Robot that is simulated in place of the planned one.
    """

    def __init__(
        self, planned: PhaseSolutionLike, feedback: Feedback | None = None, robot: Robot | None = None
    ) -> None:
        robot = realised(planned) if robot is None else robot
        self._robot, self._model, self._feedback = robot, robot.model, feedback
        self._data = robot.model.createData()
        self._floats = floats(robot.model)
        self._actuation = np.asarray(robot.actuation, dtype=float)
        speeds = tuple(f"v.{name}" for name in robot.velocity_names)
        self.names = (*(f"q.{name}" for name in robot.position_names), *speeds)
        moved = (*FLYING, *robot.velocity_names[len(FLYING) :]) if self._floats else tuple(robot.velocity_names)
        self.gap_names = (*(f"q.{name}" for name in moved), *speeds)
        self.gap_units = (*robot.units, *(RATE_UNITS[unit] for unit in robot.units))
        self._planned = planned
        contacts = planned.phase.bound_contacts
        self._stance = Stance(robot, contacts, planned.parameters) if contacts else None
        self._implicit = [contact for contact in contacts if not contact.holds]
        held = len(self._implicit) < len(contacts)
        self._linearisation = Linearisation(robot, contacts) if held or len(robot.model.mimicking_joints) else None

    def states(self, times: Array, interval: int | NDArray[np.int_] | None = None) -> Array:
        """Return the planned (q, v), (m, nq + nv)."""
        sample = robot_sample(self._planned, times, interval)
        return np.hstack([sample.q, sample.v])

    def gaps(self, states: Array, planned: Array) -> Array:
        """Return the shift of a floating root in the world, its rotation vector, all other differences, (m, 2 nv)."""
        if not self._floats:
            return states - planned
        nq = self._model.nq
        there, here = states[:, :nq], planned[:, :nq]
        moved = np.full((len(states), self._model.nv), np.nan)
        known = np.isfinite(states).all(axis=1) & np.isfinite(planned).all(axis=1)
        moved[known] = difference(self._model, here[known], there[known])
        moved[:, PLACE] = there[:, PLACE] - here[:, PLACE]
        return np.hstack([moved, states[:, nq:] - planned[:, nq:]])

    def coordinates(self, states: Array) -> Array:
        """Return positions and velocities, (m, 2 nv); of a floating root its shift and turn from the first state."""
        if not self._floats:
            return states
        moved = self.gaps(states, np.broadcast_to(states[0], states.shape))
        return np.hstack([moved[:, : self._model.nv], states[:, self._model.nq :]])

    def spread(self, sizes: Array) -> Array:
        """Return the sizes of positions and velocities; the entries of a quaternion change with the rotation."""
        if not self._floats:
            return sizes
        root = len(FLYING)
        return np.concatenate([sizes[:root], sizes[root // 2 : root].max(keepdims=True), sizes[root:]])

    def given(self, times: Array) -> Array:
        """Return motor torques, forces of implicit contacts, and with feedback the planned states and gains."""
        sample = robot_sample(self._planned, times)
        rows = [sample.tau]
        rows += [forces_in(sample, [contact])[contact.name].T.reshape(len(times), -1) for contact in self._implicit]
        if self._feedback is not None:
            rows += [sample.q, sample.v, self._feedback(times).reshape(len(times), -1)]
        return np.hstack(rows)

    def _read(self, given: Array) -> _Given:
        """Split a row of ``given``."""
        nq, nv, nu = self._model.nq, self._model.nv, self._actuation.shape[1]
        start, forces = nu, {}
        for contact in self._implicit:
            forces[contact.name] = given[start : start + len(contact.forces)]
            start += len(contact.forces)
        if self._feedback is None:
            return _Given(given[:nu], forces, None, given[:0], given[:0])
        gains = given[start + nq + nv :].reshape(nu, 2 * nv)
        return _Given(given[:nu], forces, gains, given[start : start + nq], given[start + nq : start + nq + nv])

    def _motors(self, q: Array, v: Array, plan: _Given) -> Array:
        """Return the motor torques (nu,): planned, and corrected by the feedback."""
        if plan.gains is None:
            return plan.torques
        away = pin.difference(self._model, plan.q, q) if self._floats else q - plan.q
        return np.asarray(plan.torques - plan.gains @ np.concatenate([away, v - plan.v]))

    def _applied(self, q: Array, v: Array, plan: _Given) -> Array:
        """Return the torques on all joints (nv,): B tau - d(v), and those of implicit contacts."""
        applied = self._actuation @ self._motors(q, v, plan) - self._robot.resistance(q, v)
        if self._stance is not None and plan.forces:
            applied = applied + self._stance.torques(q, plan.forces)
        return np.asarray(applied)

    def rate(self, t: float, x: Array, given: Array) -> Array:
        """Return q' and the acceleration: by ABA, or by constrained dynamics where contacts hold.

        Implicit contacts, which hold no rows, act with their planned forces.
        """
        model, nq = self._model, self._model.nq
        q, v = x[:nq], x[nq:]
        moved = rate_matrix(model, q) @ v if self._floats else v
        q = normalised(model, q) if self._floats else q
        applied = self._applied(q, v, self._read(given))
        if self._stance is None:
            return np.concatenate([moved, accelerations(model, self._data, q, v, applied)])
        return np.concatenate([moved, self._stance.acceleration(q, v, applied)])

    def jacobian(self, t: float, x: Array, given: Array) -> Array:
        """Return the derivative (nq + nv, nq + nv) of ``rate``, by Pinocchio's analytical derivatives.

        The planned forces of implicit contacts count as constant in the joints' coordinates.
        Source: Carpentier and Mansard, Analytical derivatives of rigid body dynamics algorithms, RSS 2018.
        """
        model, nq, nv = self._model, self._model.nq, self._model.nv
        q, v, plan = normalised(model, x[:nq]), x[nq:], self._read(given)
        if not (np.isfinite(x).all() and np.isfinite(given).all()):
            return np.full((nq + nv, nq + nv), np.nan)
        if self._linearisation is None:
            slopes = pin.computeABADerivatives(model, self._data, q, v, self._applied(q, v, plan))
            slope_q, slope_v, inverse = (np.array(slope) for slope in slopes)
            # Only the upper triangle of the inverse mass matrix is defined.
            inverse = np.triu(inverse) + np.triu(inverse, 1).T
            slope_q -= inverse * self._robot.stiffness
            slope_v -= inverse * self._drag(v)
            push = inverse @ self._actuation
        else:
            linear = self._linearisation.at(q, v, self._motors(q, v, plan))
            slope_q, slope_v, push = linear.rate[nv:, :nv].copy(), linear.rate[nv:, nv:].copy(), linear.input[nv:]
        if plan.gains is not None:
            correction = push @ plan.gains
            slope_q -= correction[:, :nv]
            slope_v -= correction[:, nv:]
        matrix = np.zeros((nq + nv, nq + nv))
        if not self._floats:
            matrix[:nq, nq:] = np.eye(nv)
            matrix[nq:, :nq] = slope_q
        else:
            turn = rate_matrix(model, x[:nq])
            matrix[:nq, nq:] = turn
            matrix[nq:, :nq] = slope_q @ np.linalg.pinv(turn)
            for i in range(len(FLYING) + 1):
                there = x[:nq].copy()
                there[i] += QUATERNION_DIFFERENCE
                matrix[:nq, i] = (rate_matrix(model, there) - turn) @ v / QUATERNION_DIFFERENCE
        matrix[nq:, nq:] = slope_v
        return matrix

    def _drag(self, v: Array) -> Array:
        """Return the derivative of the dissipation with respect to each velocity (nv,) [N m s/rad, N s/m]."""
        robot = self._robot
        speed = np.tanh(v / robot.friction_speed)
        return np.asarray(robot.damping + robot.friction / robot.friction_speed * (1.0 - speed**2))

    @property
    def settle(self) -> Settle | None:
        """Projection on the rows of contacts, and of quaternions on length 1."""
        stance, model = self._stance, self._model
        if not self._floats:
            return None if stance is None else stance.settle

        def settle(x: Array) -> Array:
            x = normalised(model, x)
            return x if stance is None else stance.settle(x)

        return settle

    def begin(self, x: Array) -> tuple[Array, tuple[Landing, ...]]:
        """Hold the contacts at their places in state x; an impact brings them to rest."""
        stance = self._stance
        x = normalised(self._model, x)
        if stance is None:
            return x, ()
        nq = stance.robot.model.nq
        away = stance.by_contact(stance.stand(x[:nq]))
        after, _ = stance.strike(x[:nq], x[nq:])
        phase, time = self._planned.phase.name, float(self._planned.knots[0])
        landings = tuple(
            Landing(c.name, phase, time, float(np.linalg.norm(away[c.name][[row.unit == "m" for row in c.holds]])))
            for c in stance.contacts
            if c.holds
        )
        return np.concatenate([x[:nq], after]), landings

    def watched(self, landings: tuple[Landing, ...], states: Array) -> tuple[Landing, ...]:
        """Evaluate the rows of the contacts on the simulated states."""
        stance = self._stance
        if stance is None:
            return landings
        nq = stance.robot.model.nq
        # Contacts drift slowly over intervals, so that every fifth state is enough.
        gaps = stance.by_contact(np.array([stance.rows(x[:nq], x[nq:]).gap for x in states[::5]]))
        return tuple(
            replace(landing, moved=float(np.nan_to_num(np.abs(gaps[landing.contact]), nan=np.inf).max(initial=0.0)))
            for landing in landings
        )
