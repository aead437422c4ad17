"""A robot that follows a given path of its joints, with free timing."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from robotraj._util.errors import InputError
from robotraj._util.trajectory import PiecewisePolynomial
from robotraj._util.values import dataclass
from robotraj.dynamics.row import Row
from robotraj.problem.augmentation import has
from robotraj.problem.constraints.base import BoundConstraint, Constraint, robot_of
from robotraj.problem.path_parameter import PARAMETER, SPEED, PathParameter, values_on

if TYPE_CHECKING:
    from robotraj.dynamics.dae import Dynamics
    from robotraj.dynamics.point import RobotPoint
    from robotraj.problem.scalars import Scalar


@dataclass(frozen=True)
class FollowPath(Constraint):
    """The joints stay on a path, q(t) = path(s(t)), along which s never decreases.

    s and s' become states of the phase and s'' a control; s moves from the start of the path to its end. The equations
    hold with their rates at every knot, and to the scheme's order inside intervals. ``rt.retime`` plans the motion of
    least time.

    Parameters
    ----------
    path : PiecewisePolynomial
        Joint positions (nq,) [rad, m] over s, with a continuous second derivative. ``rt.planning.as_path`` makes one of
        an array, a spline or a solution.
    start_speed, end_speed : float, optional
        s' at both ends; 0 is at rest, None leaves it free.
    """

    path: PiecewisePolynomial
    start_speed: float | None = 0.0
    end_speed: float | None = 0.0

    def bind(self, dynamics: Dynamics, parameters: Sequence[str] = ()) -> BoundConstraint:
        """Write one equation for each joint, and the bounds of s and s'.

        Raises
        ------
        InputError
            The phase moves a System or a robot with a moving root, or the path has another number of joints.
        """
        robot = robot_of(dynamics, "FollowPath")
        if robot.root != "fixed":
            raise InputError(
                f"FollowPath needs a robot with a fixed root; that of {robot.name!r} moves. Load it with root='fixed'."
            )
        if self.path.size != robot.nq:
            raise InputError(
                f"FollowPath: the path has {self.path.size} joints, but {robot.name!r} has {robot.nq}; give a path of "
                "all joints."
            )
        first, last = float(self.path.breaks[0]), float(self.path.breaks[-1])
        joints = zip(robot.position_names, robot.position_units, strict=True)
        rows = [Row("path", unit, 0.0, 0.0, joint) for joint, unit in joints]
        rows += [
            Row("path parameter", "", first, last, None, PARAMETER),
            Row("path speed", "1/s", 0.0, np.inf, None, SPEED),
        ]
        path, n = self.path, robot.nq

        def expression(point: RobotPoint) -> list[Scalar]:
            s = point.extra[PARAMETER]
            wanted = values_on(path, s)
            return [*(point.q[i] - wanted[i] for i in range(n)), s, point.extra[SPEED]]

        return BoundConstraint("path", tuple(rows), expression)

    def augment(self, dynamics: Dynamics) -> Dynamics:
        """Add the path parameter, its speed and its acceleration."""
        if has(dynamics, [PARAMETER]):
            raise InputError("The phase has several FollowPath constraints; keep one.")
        speeds = (self.start_speed, self.end_speed)
        ends = (float(self.path.breaks[0]), float(self.path.breaks[-1]))
        fixed = [
            {PARAMETER: place} | ({} if speed is None else {SPEED: float(speed)})
            for place, speed in zip(ends, speeds, strict=True)
        ]
        return PathParameter(dynamics, *fixed)
