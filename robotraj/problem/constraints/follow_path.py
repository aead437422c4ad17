"""A robot that follows a given path of its joints, with free timing."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robotraj._util.checks import is_number
from robotraj._util.curves.trajectory import PiecewisePolynomial
from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.dynamics.dae import Dynamics
from robotraj.dynamics.path_body import SPEED, PathBody
from robotraj.dynamics.point import RobotPoint
from robotraj.dynamics.rigid_body import InverseRigidBody
from robotraj.dynamics.row import Row
from robotraj.problem.constraints.base import BoundConstraint, Constraint, robot_of
from robotraj.problem.scalars import Scalar


@dataclass(frozen=True)
class FollowPath(Constraint):
    """The joints stay on a path, q(t) = path(s(t)), along which s never decreases.

    s and s' are the only states of the phase, and s'' its control. Positions, velocities, accelerations and torques of
    the joints are functions of these, so that the joints are on the path at every time. The path determines both ends
    of the phase. ``rt.CollisionFree`` is proved along the path, but cannot change it. ``rt.retime`` plans the motion of
    least time.

    Parameters
    ----------
    path : PiecewisePolynomial
        Joint positions (nq,) [rad, m] over s, with a continuous second derivative. ``rt.applications.as_path`` makes
        one of an array, a spline or a solution.
    start_speed, end_speed : float, optional
        s' at both ends; 0 is at rest, None leaves it free.
    deviation : float
        Largest distance of a joint between the path and another one that it replaces [rad, m], for information.
    speed : float
        Largest s'.
    whole : bool
        Whether the motion ends at the end of the path; otherwise it ends anywhere on it.
    start_acceleration : float, optional
        s'' at the start under limits of jerk or torque rate. None is 0 at rest and free otherwise.
    """

    path: PiecewisePolynomial
    start_speed: float | None = 0.0
    end_speed: float | None = 0.0
    deviation: float = 0.0
    speed: float = np.inf
    whole: bool = True
    start_acceleration: float | None = None

    def __post_init__(self) -> None:
        if not (is_number(self.speed) and self.speed > 0.0):
            raise InputError(f"FollowPath's speed must be a number above 0, the largest ds/dt; got {self.speed!r}.")

    def bind(self, dynamics: Dynamics, parameters: Sequence[str] = ()) -> BoundConstraint:
        """Write the bounds of s'."""
        robot_of(dynamics, "FollowPath")

        def expression(point: RobotPoint) -> list[Scalar]:
            return [point.extra[SPEED]]

        return BoundConstraint("path", (Row("path speed", "1/s", 0.0, self.speed, None, SPEED),), expression)

    def reduce(self, dynamics: Dynamics) -> Dynamics:
        """Return the equations of motion on the path.

        Raises
        ------
        InputError
            The phase moves a System, has contacts, another form of dynamics or a second path, or a robot with a moving
            root or a joint without a motor. Or the path has another number of joints.
        """
        robot = robot_of(dynamics, "FollowPath")
        if isinstance(dynamics, PathBody):
            raise InputError("The phase has several FollowPath constraints; keep one.")
        if not isinstance(dynamics, InverseRigidBody) or dynamics.contacts:
            raise InputError("FollowPath needs rt.dynamics.InverseDynamics() and no contacts; remove the others.")
        return PathBody(
            robot,
            dynamics.design,
            softening=dynamics.softening,
            path=self.path,
            start_speed=self.start_speed,
            end_speed=self.end_speed,
            whole=self.whole,
            start_acceleration=self.start_acceleration,
        )
