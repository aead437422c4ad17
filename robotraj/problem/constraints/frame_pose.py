"""Frames held at a position or at a full pose."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.dynamics.dae import Dynamics
from robotraj.dynamics.point import RobotPoint
from robotraj.dynamics.row import Row
from robotraj.problem.constraints.base import BoundConstraint, Constraint, robot_of
from robotraj.problem.constraints.bounds import BoundsLike, as_bounds
from robotraj.problem.scalars import Scalar
from robotraj.robot.robot import Robot
from robotraj.robot.size.reach import reaches

Triple: TypeAlias = Sequence[float] | NDArray[np.float64]

PoseLike: TypeAlias = "pin.SE3 | NDArray[np.float64] | tuple[Triple, Triple | pin.Quaternion]"
"""A pose, a homogeneous matrix (4, 4), or a position and a rotation: a matrix, or a quaternion (x, y, z, w)."""

FAR = 50.0
"""Distance from the origin, relative to the robot's reach, from which a length is taken for millimetres."""

AXES = ("x", "y", "z")


@dataclass(frozen=True)
class FramePosition(Constraint):
    """Bounds on the origin of a frame in the world: lower <= p_f(q) <= upper, each (3,) [m].

    Numbers are equations, which are imposed with their rates at every knot; see ``PathConstraint``.

    Wrap in ``rt.AtEnd`` or ``rt.AtStart`` to hold it at one end of the phase only.

    Parameters
    ----------
    frame : str
    position : sequence of 3
        Each entry a number, ``rt.between(lower, upper)`` or None, or a dict by ``"x"``, ``"y"``, ``"z"``.
    """

    frame: str
    position: BoundsLike

    def bind(self, dynamics: Dynamics, parameters: Sequence[str] = ()) -> BoundConstraint:
        """Write one row for each bounded axis."""
        robot = robot_of(dynamics, "FramePosition")
        robot.frame(self.frame)
        lower, upper = as_bounds(self.position, AXES, f"position of frame {self.frame!r}", "axis")
        check_metres(robot, lower, upper, f"position of frame {self.frame!r}")
        kept = [i for i in range(3) if np.isfinite(lower[i]) or np.isfinite(upper[i])]
        if not kept:
            raise InputError(f"FramePosition of {self.frame!r} leaves all of x, y and z free; bound at least one.")
        rows = tuple(Row(f"frame position {AXES[i]}", "m", lower[i], upper[i], self.frame) for i in kept)
        frame = self.frame

        def expression(point: RobotPoint) -> list[Scalar]:
            position = point.frame(frame).position
            return [position[i] for i in kept]

        return BoundConstraint("frame position", rows, expression)


@dataclass(frozen=True)
class FramePose(Constraint):
    """A frame held at a pose: p_f(q) = position and R_f(q) = rotation.

    The orientation rows are the three entries of the skew part of R_d' R_f. It is sin(theta) times the axis of the
    error rotation [rad near zero]. The row trace(R_d' R_f) >= 1 excludes the root at a half turn. Along a phase the
    rows are imposed as those of ``FramePosition``.

    Parameters
    ----------
    frame : str
    pose : pinocchio.SE3, array (4, 4) or (position, rotation)
        Position as for ``FramePosition``; entries that are None are free. Rotation as a matrix (3, 3), a
        ``pinocchio.Quaternion`` or a quaternion (x, y, z, w) of unit norm.
    """

    frame: str
    pose: PoseLike

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "pose", own_pose(self.pose))

    def bind(self, dynamics: Dynamics, parameters: Sequence[str] = ()) -> BoundConstraint:
        """Write three rows of position and four of orientation."""
        robot = robot_of(dynamics, "FramePose")
        robot.frame(self.frame)
        what = f"pose of frame {self.frame!r}"
        position, rotation = as_pose(self.pose, what)
        lower, upper = as_bounds(position, AXES, what, "axis")
        check_metres(robot, lower, upper, what)
        rows = [Row(f"frame position {AXES[i]}", "m", lower[i], upper[i], self.frame) for i in range(3)]
        rows += [Row(f"frame orientation {axis}", "rad", 0.0, 0.0, self.frame) for axis in AXES]
        rows.append(Row("frame orientation half turn", "", 1.0, np.inf, self.frame, selects_root=True))
        frame = self.frame

        def expression(point: RobotPoint) -> list[Scalar]:
            view = point.frame(frame)
            error = rotation.T @ view.rotation
            skew = [error[2, 1] - error[1, 2], error[0, 2] - error[2, 0], error[1, 0] - error[0, 1]]
            trace = error[0, 0] + error[1, 1] + error[2, 2]
            return [*(view.position[i] for i in range(3)), *(0.5 * s for s in skew), trace]

        return BoundConstraint("frame pose", tuple(rows), expression)


def own_pose(pose: PoseLike) -> PoseLike:
    """Copy a ``pinocchio.SE3``, which the caller may change later; ``own_fields`` copies poses of arrays."""
    if isinstance(pose, np.ndarray) and pose.shape == (4, 4):
        position, rotation = as_pose(pose, "pose of a frame")
        return pin.SE3(rotation, position)
    return pin.SE3(pose) if isinstance(pose, pin.SE3) else pose


def as_pose(pose: object, what: str) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Read a pose as its position and rotation matrix; ``what`` names it in errors."""
    if isinstance(pose, pin.SE3):
        return pose.translation, np.array(pose.rotation)
    if isinstance(pose, np.ndarray) and pose.shape == (4, 4):
        if not np.allclose(pose[3], (0.0, 0.0, 0.0, 1.0), atol=1e-9):
            turned = np.allclose(pose[:, 3], (0.0, 0.0, 0.0, 1.0), atol=1e-9)
            raise InputError(
                f"The last row of the matrix in the {what} is {pose[3].round(6).tolist()}; it must be [0, 0, 0, 1]."
                + " The transposed matrix, pose.T, has this row." * turned
            )
        return np.array(pose[:3, 3], dtype=float), _rotation(pose[:3, :3], what)
    if not isinstance(pose, Sequence) or len(pose) != 2:
        array = np.asarray(pose, dtype=object)
        given = f"an array of shape {array.shape}" if array.dtype != object or array.size > 1 else repr(pose)
        six = " The pair of a position and roll, pitch, yaw is (xyz, pinocchio.rpy.rpyToMatrix(*rpy))."
        seven = " Seven numbers x, y, z, qx, qy, qz, qw are pinocchio.XYZQUATToSE3(pose)."
        raise InputError(
            f"The {what} must be a pinocchio.SE3, a matrix (4, 4) or a pair (position, rotation), the rotation a "
            f"matrix or a quaternion (x, y, z, w); got {given}.{six * (array.size == 6)}{seven * (array.size == 7)}"
        )
    return pose[0], _rotation(pose[1], what)


def check_metres(robot: Robot, lower: NDArray[np.float64], upper: NDArray[np.float64], what: str) -> None:
    """Refuse a place that a robot with a fixed root cannot come near to, whose lengths may be millimetres.

    Raises
    ------
    InputError
        Bounds lie farther from the origin than ``FAR`` times the reach and the travels of sliding joints.
    """
    travels = (
        [
            max(abs(low), abs(high))
            for low, high, unit in zip(
                robot.limits.position_lower, robot.limits.position_upper, robot.units, strict=True
            )
            if unit == "m"
        ]
        if robot.root == "fixed"
        else [np.inf]
    )
    far = FAR * (reaches(robot.model)[0] + sum(travels))
    nearest = np.maximum(np.maximum(lower, -upper), 0.0)
    if far < np.inf and nearest.max() > far > 0.0:
        axis = int(nearest.argmax())
        given = lower[axis] if lower[axis] > 0.0 else upper[axis]
        raise InputError(
            f"The {what} has {AXES[axis]} = {given:g} m, but {robot.name!r} reaches {far / FAR:.2g} m. "
            f"Lengths are in metres: {given:g} mm are {1e-3 * given:g}."
        )


def _rotation(value: Triple | pin.Quaternion, what: str) -> NDArray[np.float64]:
    """Convert a matrix or a quaternion (x, y, z, w) to a rotation matrix, and check it."""
    if isinstance(value, pin.Quaternion):
        value = value.coeffs()
    array = np.asarray(value, dtype=float)
    if array.shape == (4,):
        norm = np.linalg.norm(array)
        if not abs(norm - 1.0) < 1e-6:
            raise InputError(f"The quaternion (x, y, z, w) in the {what} has norm {norm:.6g}, not 1; normalise it.")
        return np.array(pin.Quaternion(array / norm).matrix())
    if array.shape != (3, 3):
        raise InputError(f"The rotation in the {what} has shape {array.shape}; give (3, 3) or a quaternion (4,).")
    if not np.allclose(array @ array.T, np.eye(3), atol=1e-6) or np.linalg.det(array) < 0:
        raise InputError(f"The matrix in the {what} is not a rotation; give one with R R' = 1 and det R = 1.")
    return array
