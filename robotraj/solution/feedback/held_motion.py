"""Rows of held contacts as matrices on the motion of their frames: rows = C (velocity of the frame), C constant."""

from __future__ import annotations

from collections.abc import Sequence
from types import SimpleNamespace

import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.contacts.base import BoundContact
from robotraj.robot.robot import Robot

WORLD = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
LOCAL = pin.ReferenceFrame.LOCAL


@dataclass(frozen=True, eq=False)
class HeldRows(OneLine):
    """The rows of one contact on the motion of its frames: one frame, or the two that close a loop.

    Attributes
    ----------
    frames : tuple of int
        Indices in Pinocchio's model.
    matrices : tuple of ndarray (m, 6)
        For each frame C: rows of the contact by linear and angular velocity of the frame in world axes.
    """

    frames: tuple[int, ...]
    matrices: tuple[Array, ...]

    @property
    def count(self) -> int:
        """Number of rows m."""
        return len(self.matrices[0])

    def jacobian(self, model: pin.Model, data: pin.Data) -> Array:
        """Jacobian (m, nv) of the rows."""
        parts = zip(self.frames, self.matrices, strict=True)
        return np.asarray(sum(matrix @ pin.getFrameJacobian(model, data, frame, WORLD) for frame, matrix in parts))

    def acceleration(self, model: pin.Model, data: pin.Data) -> Array:
        """Acceleration (m,) of the rows, for the joint accelerations that the kinematics were computed with."""
        total = np.zeros(self.count)
        for frame, matrix in zip(self.frames, self.matrices, strict=True):
            total += matrix @ pin.getFrameClassicalAcceleration(model, data, frame, WORLD).vector
        return total

    def slopes(self, model: pin.Model, data: pin.Data) -> tuple[Array, Array, Array]:
        """Return the derivatives (m, nv) of the rows' velocity by q, of their acceleration by q and by v."""
        found = np.zeros((3, self.count, model.nv))
        for frame, matrix in zip(self.frames, self.matrices, strict=True):
            velocity_q, acceleration_q, acceleration_v, jacobian = (
                np.asarray(part) for part in pin.getFrameAccelerationDerivatives(model, data, frame, LOCAL)
            )
            motion = pin.getFrameVelocity(model, data, frame, LOCAL)
            change = pin.getFrameAcceleration(model, data, frame, LOCAL)
            # A matrix that is constant in the axes of the frame rotates with it in world axes.
            axes = np.kron(np.eye(2), data.oMf[frame].rotation)
            velocity_q = axes @ (velocity_q - _crossed(motion) @ jacobian[3:])
            acceleration_q = axes @ (acceleration_q - _crossed(change) @ jacobian[3:])
            acceleration_v, jacobian = axes @ acceleration_v, axes @ jacobian
            # The classical acceleration of a point is the spatial one plus omega x velocity.
            motion = pin.getFrameVelocity(model, data, frame, WORLD)
            turn, move = pin.skew(motion.angular), pin.skew(motion.linear)
            acceleration_q[:3] += turn @ velocity_q[:3] - move @ velocity_q[3:]
            acceleration_v[:3] += turn @ jacobian[:3] - move @ jacobian[3:]
            found += np.array([matrix @ velocity_q, matrix @ acceleration_q, matrix @ acceleration_v])
        return found[0], found[1], found[2]

    def wrenches(self, model: pin.Model, data: pin.Data, forces: Array) -> list[tuple[int, pin.Force]]:
        """Return the forces on the bodies from those of the rows (m,), each in the axes of its joint."""
        pairs = zip(self.frames, self.matrices, strict=True)
        return [
            (model.frames[frame].parentJoint, model.frames[frame].placement.act(_local(data, frame, matrix, forces)))
            for frame, matrix in pairs
        ]

    def torque_slope(self, model: pin.Model, data: pin.Data, forces: Array) -> Array:
        """Return the derivative (nv, nv) of J' f by q due to the rotation of the frames, f constant in world axes."""
        total = np.zeros((model.nv, model.nv))
        for frame, matrix in zip(self.frames, self.matrices, strict=True):
            local = _local(data, frame, matrix, forces)
            jacobian = np.asarray(pin.getFrameJacobian(model, data, frame, LOCAL))
            total += jacobian.T @ (np.vstack([pin.skew(local.linear), pin.skew(local.angular)]) @ jacobian[3:])
        return total


def _crossed(motion: pin.Motion) -> Array:
    """Return the matrix (6, 3) of the cross products of both parts of a motion with an angle."""
    return np.vstack([pin.skew(motion.linear), pin.skew(motion.angular)])


def _local(data: pin.Data, frame: int, matrix: Array, forces: Array) -> pin.Force:
    """Force of rows (m,) in the axes of the frame."""
    world = matrix.T @ forces
    back = data.oMf[frame].rotation.T
    return pin.Force(back @ world[:3], back @ world[3:])


def held_rows(robot: Robot, data: pin.Data, q: Array, contacts: Sequence[BoundContact]) -> list[HeldRows]:
    """Return the matrices of contacts from their velocity rows, which are linear in the motion of the frames."""
    if not contacts:
        return []
    pin.framesForwardKinematics(robot.model, data, q)
    found = []
    for contact in contacts:
        point = _Moving(robot, data)
        point.rows(contact)
        names = tuple(point.read)
        matrices = [np.column_stack([point.rows(contact, name, unit) for unit in np.eye(6)]) for name in names]
        found.append(HeldRows(tuple(point.read[name] for name in names), tuple(matrices)))
    return found


class _Moving:
    """A point at which one frame moves and all others are at rest."""

    def __init__(self, robot: Robot, data: pin.Data) -> None:
        self._robot, self._data = robot, data
        self._moving: tuple[str, Array] = ("", np.zeros(6))
        self.read: dict[str, int] = {}

    def rows(self, contact: BoundContact, name: str = "", motion: Array | None = None) -> Array:
        """Velocity rows of a contact where frame ``name`` moves with ``motion`` (6,)."""
        self._moving = name, np.zeros(6) if motion is None else motion
        return np.array([float(row) for row in contact.velocity(self)])

    def frame(self, name: str) -> SimpleNamespace:
        """Pose of a frame, and its velocity in world axes."""
        index = self.read.setdefault(name, self._robot.frame(name))
        place, (moving, motion) = self._data.oMf[index], self._moving
        velocity = motion if name == moving else np.zeros(6)
        return SimpleNamespace(position=place.translation, rotation=place.rotation, velocity=velocity)
