"""The contacts of a phase in numbers: rows, Jacobians and forces by plain Pinocchio."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple, Protocol

import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj.dynamics.contacts.base import BoundContact
from robotraj.witness.contacts.constrained import RANK_TOLERANCE, Held, accelerate, impact, project
from robotraj.witness.numbers import as_numbers
from robotraj.witness.protocols import RobotLike

WORLD = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED


class Sampled(Protocol):
    """A sample with algebraic variables by name."""

    @property
    def z(self) -> Mapping[str, float | Array]:
        """Each a float or (m,)."""


class Frame(NamedTuple):
    """Pose and motion of a frame in world axes, for the rows of contacts."""

    position: Array
    rotation: Array
    velocity: Array
    acceleration: Array


class Instant:
    """The frames of a robot at one state with zero joint accelerations.

    Attributes
    ----------
    q, v : ndarray
    by_joint : bool
        Whether velocities of frames are their Jacobians (6, nv). Rows, which are linear in them, are then rows of J.
    """

    def __init__(self, robot: RobotLike, data: pin.Data, q: Array, v: Array) -> None:
        self._robot, self._data = robot, data
        self.q, self.v = q, v
        self.by_joint = False
        pin.forwardKinematics(robot.model, data, q, v, np.zeros(robot.nv))
        pin.computeJointJacobians(robot.model, data, q)
        pin.updateFramePlacements(robot.model, data)

    def frame(self, name: str) -> Frame:
        """Return pose and motion of a frame in world axes."""
        index, model, data = self._robot.frame(name), self._robot.model, self._data
        place = data.oMf[index]
        acceleration = pin.getFrameClassicalAcceleration(model, data, index, WORLD).vector
        velocity = self.jacobian(name) if self.by_joint else pin.getFrameVelocity(model, data, index, WORLD).vector
        return Frame(place.translation, place.rotation, velocity, acceleration)

    def jacobian(self, name: str) -> Array:
        """Return the Jacobian (6, nv) of a frame, world axes."""
        return np.array(pin.getFrameJacobian(self._robot.model, self._data, self._robot.frame(name), WORLD))


def forces_in(sample: Sampled, contacts: Sequence[BoundContact], index: int | None = None) -> dict[str, Array]:
    """Return the planned forces of contacts in a sample, at one of its times where an index is given."""
    found = {}
    for contact in contacts:
        values = [np.asarray(sample.z[force.name], dtype=float) for force in contact.forces]
        found[contact.name] = np.array([value if index is None else value[index] for value in values], dtype=float)
    return found


class Stance:
    """A robot with its contacts.

    Parameters
    ----------
    robot : Robot
    contacts : sequence of BoundContact
    parameters : mapping of str to float
        Parameters of the phase, with the anchors of the contacts.

    Attributes
    ----------
    anchors : list of dict of str to float
        Place of each contact, by anchor name [m, rad].
    """

    def __init__(self, robot: RobotLike, contacts: Sequence[BoundContact], parameters: Mapping[str, float]) -> None:
        self.robot = robot
        self.contacts = tuple(contacts)
        self.anchors = [{anchor.name: float(parameters[anchor.name]) for anchor in c.anchors} for c in self.contacts]
        self._data = robot.model.createData()
        self._shift = np.zeros(sum(len(contact.holds) for contact in self.contacts))

    def stand(self, q: Array) -> Array:
        """Move the anchors to the places of the contacts in q; return the distances from the old ones (m,)."""
        self._shift = np.zeros_like(self._shift)
        self._shift = self.rows(q, np.zeros(self.robot.nv)).gap
        return self._shift.copy()

    def rows(self, q: Array, v: Array) -> Held:
        """Return gaps, Jacobian and bias of all rows."""
        instant = Instant(self.robot, self._data, q, v)
        gaps = [
            as_numbers(contact.position(instant, anchors), f"contact {contact.name!r}")
            for contact, anchors in zip(self.contacts, self.anchors, strict=True)
        ]
        return Held(np.concatenate([*gaps, np.zeros(0)]) - self._shift, *self._rates(instant))

    def _rates(self, instant: Instant) -> tuple[Array, Array]:
        """Return Jacobian and bias of all rows."""
        biases = [as_numbers(c.acceleration(instant), f"contact {c.name!r}") for c in self.contacts]
        instant.by_joint = True
        rows = [np.broadcast_to(row, self.robot.nv) for c in self.contacts for row in c.velocity(instant)]
        instant.by_joint = False
        jacobian = np.array(rows, dtype=float).reshape(len(rows), self.robot.nv)
        return jacobian, np.concatenate([*biases, np.zeros(0)])

    def acceleration(self, q: Array, v: Array, applied: Array) -> Array:
        """Return the acceleration (nv,) under torques on all joints while the contacts hold."""
        instant = Instant(self.robot, self._data, q, v)
        held = Held(np.zeros_like(self._shift), *self._rates(instant))
        return accelerate(self.robot.model, self._data, q, v, applied, held)[0]

    def forces(
        self, q: Array, v: Array, applied: Array, held: Held, planned: Mapping[str, Array]
    ) -> tuple[Array, bool] | None:
        """Solve for the forces (m,) of the rows ``held`` at this state; also return whether they are unique.

        Forces are dual to the rows: J' f has the power f . (J v). Redundant rows, such as four corners of one foot, do
        not determine the internal forces, nor do rows that are redundant to within the accuracy of a plan. There the
        forces are as ``planned``. None where contacts have no forces dual to their rows.
        """
        given = np.concatenate([*(planned[contact.name] for contact in self.contacts), np.zeros(0)])
        if len(given) != len(held.gap) or not np.isfinite(held.jacobian).all():
            return None
        left, sizes, _ = np.linalg.svd(held.jacobian, full_matrices=False)
        determined = left[:, sizes > RANK_TOLERANCE * np.max(sizes, initial=0.0)].T
        rows = Held(determined @ held.gap, determined @ held.jacobian, determined @ held.bias)
        loaded = applied + held.jacobian.T @ given
        missing = accelerate(self.robot.model, self._data, q, v, loaded, rows)[1]
        return given + determined.T @ missing, len(determined) == len(given)

    def strike(self, q: Array, v: Array) -> tuple[Array, Array]:
        """Return the velocities (nv,) after an impact that stops all contacts, and its impulses (m,) [N s, N m s]."""
        return impact(self.robot.model, self._data, q, v, self.rows(q, v))

    def settle(self, x: Array) -> Array:
        """Project a state (q, v) on the rows."""
        nq = self.robot.model.nq
        return np.concatenate(project(self.robot.model, self._data, x[:nq], x[nq:], self.rows))

    def torques(self, q: Array, forces: Mapping[str, Array]) -> Array:
        """Return the torques J' f (nv,) of contact forces on the joints, from the wrenches of the contacts."""
        instant = Instant(self.robot, self._data, q, np.zeros(self.robot.nv))
        total = np.zeros(self.robot.nv)
        for contact in self.contacts:
            if contact.name in forces:
                for frame, wrench in contact.wrench(instant, list(forces[contact.name])):
                    total += instant.jacobian(frame).T @ as_numbers(wrench, f"contact {contact.name!r}")
        return total

    def by_contact(self, rows: Array) -> dict[str, Array]:
        """Return values (..., m) of the rows by contact name."""
        ends = np.cumsum([len(contact.holds) for contact in self.contacts])[:-1]
        return {c.name: part for c, part in zip(self.contacts, np.split(rows, ends, axis=-1), strict=True)}
