"""Integral of the manipulability of a frame, which is low near singular configurations."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca

from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.dynamics.dae import Dynamics
from robotraj.dynamics.point import RobotPoint
from robotraj.problem.constraints.base import robot_of
from robotraj.problem.objectives.base import Integral
from robotraj.problem.scalars import Scalar


@dataclass(frozen=True)
class Manipulability(Integral):
    """Integral over the phase of -log det(J J' + e^2 1) / 2, J (m, nv) rows of the Jacobian of a frame.

    sqrt(det(J J')) is Yoshikawa's manipulability. It is proportional to the volume of the ellipsoid of frame velocities
    for joint velocities of length 1. It is 0 at singular configurations, where e keeps the cost finite.

    Source: Yoshikawa, International Journal of Robotics Research 4 (1985).

    Parameters
    ----------
    frame : str
    linear, angular : bool
        Whether the three rows of the linear and of the angular velocity count.
    smoothing : float
        e [m, 1], above 0.
    """

    frame: str
    linear: bool = True
    angular: bool = True
    smoothing: float = 1e-3

    def rate(self, point: RobotPoint) -> Scalar:
        """Negative logarithm of the manipulability."""
        robot = point.robot
        q, v = ca.SX.sym("q", robot.nq), ca.SX.sym("v", robot.nv)
        velocity = point.symbolic.frame_velocity(self.frame)(q, v)
        jacobian = ca.substitute(ca.jacobian(velocity, v), ca.vertcat(q, v), ca.vertcat(point.q, ca.SX.zeros(robot.nv)))
        rows = [*range(3 * (not self.linear), 3), *range(3, 3 + 3 * self.angular)]
        chosen = jacobian[rows, :]
        square = ca.densify(ca.mtimes(chosen, chosen.T)) + self.smoothing**2 * ca.SX.eye(len(rows))
        # J J' + e^2 1 = L D L' without pivots: the matrix is positive definite.
        return -0.5 * sum((ca.log(d) for d in _pivots(square)), ca.SX(0))

    def check(self, dynamics: Dynamics, parameters: Sequence[str]) -> None:
        """Check the frame, the rows and the smoothing."""
        robot = robot_of(dynamics, "Manipulability")
        robot.frame(self.frame)
        if not (self.linear or self.angular):
            raise InputError("Manipulability has no rows; set linear=True or angular=True.")
        if not self.smoothing > 0.0:
            raise InputError(f"Manipulability: smoothing is {self.smoothing}; it must be above 0.")
        if 3 * (self.linear + self.angular) > robot.nv:
            raise InputError(
                f"Manipulability of {self.frame!r}: {robot.name!r} has {robot.nv} joints, too few for "
                f"{3 * (self.linear + self.angular)} rows; set linear=False or angular=False."
            )


def _pivots(matrix: ca.SX) -> list[ca.SX]:
    """Return the pivots of Gaussian elimination of a symmetric matrix; their product is its determinant."""
    n, found = matrix.size1(), []
    left = [[matrix[i, j] for j in range(n)] for i in range(n)]
    for k in range(n):
        found.append(left[k][k])
        for i in range(k + 1, n):
            factor = left[i][k] / left[k][k]
            for j in range(k, n):
                left[i][j] = left[i][j] - factor * left[k][j]
    return found
