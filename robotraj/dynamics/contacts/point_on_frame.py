"""A point fixed in a frame: its place and motion, and the wrench of a force there at the frame's origin."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.dynamics.contacts.vectors import add, cross, dot, scale, turned
from robotraj.dynamics.point import FramePoint
from robotraj.dynamics.variable import Column, Scalar
from robotraj.robot.robot import Robot

Triple = tuple[float, float, float]


@dataclass(frozen=True)
class Spot:
    """The point of a frame where a contact touches: o + R s, with o the origin and R the rotation of the frame.

    Attributes
    ----------
    frame : str
    offset : tuple of 3 float
        s, in the frame's axes [m].
    radius : float
        Radius of the ball about the point that touches [m]; 0 for the point itself.
    """

    frame: str
    offset: Triple = (0.0, 0.0, 0.0)
    radius: float = 0.0

    @property
    def plainly(self) -> str | tuple[str, Triple] | Spot:
        """The frame of an origin, the frame and offset of another point, or the ball."""
        if self.radius:
            return self
        return (self.frame, self.offset) if any(self.offset) else self.frame

    def position(self, point: FramePoint) -> list[Scalar]:
        """Place in the world (3,) [m]."""
        origin = point.frame(self.frame).position
        arm = self._arm(point)
        return [origin[i] for i in range(3)] if arm is None else add(origin, arm)

    def velocity(self, point: FramePoint) -> list[Scalar]:
        """Rate of its place, v + w x R s (3,) [m/s]."""
        motion = point.frame(self.frame).velocity
        linear, angular, arm = _parts(motion)[0], _parts(motion)[1], self._arm(point)
        return linear if arm is None else add(linear, cross(angular, arm))

    def acceleration(self, point: FramePoint) -> list[Scalar]:
        """Rate of its velocity, a + alpha x R s + w x (w x R s) (3,) [m/s^2]; a is the classical acceleration."""
        linear, angular = _parts(point.frame(self.frame).acceleration)
        arm = self._arm(point)
        if arm is None:
            return linear
        spin = self.angular_velocity(point)
        return add(linear, cross(angular, arm), cross(spin, cross(spin, arm)))

    def angular_velocity(self, point: FramePoint) -> list[Scalar]:
        """Angular velocity of the frame in world axes (3,) [rad/s]."""
        return _parts(point.frame(self.frame).velocity)[1]

    def angular_acceleration(self, point: FramePoint) -> list[Scalar]:
        """Angular acceleration of the frame in world axes (3,) [rad/s^2]."""
        return _parts(point.frame(self.frame).acceleration)[1]

    def axis(self, point: FramePoint, vector: Sequence[float]) -> list[Scalar]:
        """Components in world axes of a vector fixed in the frame (3,)."""
        return turned(point.frame(self.frame).rotation, vector)

    def wrench(self, point: FramePoint, force: Sequence[Scalar], moment: Sequence[Scalar]) -> list[Scalar]:
        """Force and moment at the spot as a wrench at the frame's origin, (f, m + R s x f) (6,) [N, N m]."""
        arm = self._arm(point)
        at_origin = list(moment) if arm is None else add(moment, cross(arm, force))
        return [*force, *at_origin]

    def placed(self, robot: Robot, q: Array) -> tuple[Array, Array]:
        """Place (3,) [m] of the spot and rotation (3, 3) of its frame in configuration q, in numbers."""
        model, data = robot.model, robot.model.createData()
        pin.framesForwardKinematics(model, data, np.asarray(q, dtype=float))
        pose = data.oMf[robot.frame(self.frame)]
        return pose.act(np.array(self.offset)), np.array(pose.rotation)

    def jacobian(self, robot: Robot, q: Array) -> Array:
        """Linear velocity of the spot and angular velocity of the frame per joint velocity (6, nv), world axes."""
        model, data = robot.model, robot.model.createData()
        index = robot.frame(self.frame)
        rows = pin.computeFrameJacobian(model, data, q, index, pin.ReferenceFrame.LOCAL_WORLD_ALIGNED)
        rows = np.array(rows).reshape(6, model.nv)  # pinocchio returns a vector for a single joint
        pin.updateFramePlacements(model, data)
        rows[:3] -= pin.skew(data.oMf[index].rotation @ np.array(self.offset)) @ rows[3:]
        return rows

    def _arm(self, point: FramePoint) -> list[Scalar] | None:
        """R s, or None where the spot is the frame's origin."""
        return self.axis(point, self.offset) if any(self.offset) else None


@dataclass(frozen=True)
class RollingSpot(Spot):
    """The place where a ball or cylinder about a point of a frame touches a plane: c - r n.

    c is the point at ``offset``, and r the radius. Its velocity is that of the body there, which is zero where the body
    rolls without slipping.

    Attributes
    ----------
    normal : tuple of 3 float
        n, the plane's unit normal in world axes.
    up : tuple of 3 float
        Axis of the foot in the frame's axes, along n where the foot is upright.
    """

    normal: Triple = (0.0, 0.0, 1.0)
    up: Triple = (0.0, 0.0, 1.0)

    def position(self, point: FramePoint) -> list[Scalar]:
        """Place in the world, c - r n (3,) [m]."""
        return add(super().position(point), scale(-self.radius, self.normal))

    def velocity(self, point: FramePoint) -> list[Scalar]:
        """Velocity of the body where it touches, dc/dt - r w x n (3,) [m/s]."""
        return add(super().velocity(point), scale(-self.radius, cross(self.angular_velocity(point), self.normal)))

    def acceleration(self, point: FramePoint) -> list[Scalar]:
        """Rate of ``velocity`` (3,) [m/s^2]."""
        turning = cross(self.angular_acceleration(point), self.normal)
        return add(super().acceleration(point), scale(-self.radius, turning))

    def wrench(self, point: FramePoint, force: Sequence[Scalar], moment: Sequence[Scalar]) -> list[Scalar]:
        """Force and moment where it touches as a wrench at the frame's origin (6,) [N, N m]."""
        about_centre = add(moment, scale(-self.radius, cross(self.normal, force)))
        return super().wrench(point, force, about_centre)

    def placed(self, robot: Robot, q: Array) -> tuple[Array, Array]:
        """Place (3,) [m] where it touches, and rotation (3, 3) of its frame in configuration q, in numbers."""
        place, rotation = super().placed(robot, q)
        return place - self.radius * np.array(self.normal), rotation

    def rolled(self, point: FramePoint, ahead: Sequence[Scalar]) -> Scalar:
        """Way r a [m] that it has rolled along a heading since the foot was upright, a between -pi and pi."""
        up = self.axis(point, self.up)
        return self.radius * ca.atan2(dot(up, ahead), dot(up, self.normal))

    def rolled_in(self, robot: Robot, q: Array, ahead: Sequence[Scalar]) -> float:
        """Return ``rolled`` in configuration q, in numbers."""
        up = super().placed(robot, q)[1] @ np.array(self.up)
        forward = up @ np.array([float(part) for part in ahead])
        return self.radius * float(np.arctan2(forward, up @ np.array(self.normal)))


def offset_of(value: object, what: str) -> Triple:
    """Read an offset [m]; ``what`` names the contact in errors."""
    return vector_of(value, f"offset of {what}", "metres in the frame's axes")


def vector_of(value: object, what: str, advice: str) -> Triple:
    """Read three finite numbers."""
    try:
        array = np.asarray(value, dtype=float)
    except (TypeError, ValueError):
        array = np.array([np.nan])
    if array.shape != (3,) or not np.isfinite(array).all():
        raise InputError(f"The {what} is {value!r}; give three finite numbers, {advice}.")
    return float(array[0]), float(array[1]), float(array[2])


def _parts(motion: Column) -> tuple[list[Scalar], list[Scalar]]:
    """Linear and angular part of a spatial vector."""
    return [motion[i] for i in range(3)], [motion[i] for i in range(3, 6)]
