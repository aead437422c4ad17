"""The default objectives of gaits."""

from __future__ import annotations

from collections.abc import Mapping

import casadi as ca
import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from robotraj._util.values import dataclass
from robotraj.dynamics.point import RobotPoint
from robotraj.guess.legs.stance import ROOT_FREEDOMS
from robotraj.problem.objectives.base import Objective
from robotraj.problem.objectives.effort import Effort
from robotraj.problem.objectives.expressions import Lagrange
from robotraj.problem.objectives.tracking import Tracking
from robotraj.robot.robot import Robot

SHARE = 0.2
"""Torque that costs as much as 1 rad from the posture, as a fraction of weight times height of the centre of mass."""
CALM = 2e-3
"""Weight of accelerations relative to that of angles, times (h / g)^2."""


@dataclass(frozen=True)
class FixedPosture:
    """A constant reference of ``rt.objectives.Tracking``.

    Attributes
    ----------
    q : tuple of float
        Configuration (nq,).
    """

    q: tuple[float, ...]

    def __call__(self, t: ca.SX) -> Mapping[str, tuple[float, ...]]:
        """Return q at any time."""
        return {"q": self.q}


@dataclass(frozen=True)
class SquaredAccelerations:
    """Sum of the squared accelerations of the joints at a point [rad^2/s^4].

    Attributes
    ----------
    first : int
        Index in v of the first joint behind the root.
    """

    first: int

    def __call__(self, point: RobotPoint) -> ca.SX:
        """Evaluate the sum."""
        return ca.sumsqr(point.a[self.first :])


def gait_objective(robot: Robot, standing: NDArray[np.float64]) -> Objective:
    """Return the default objective of gaits: effort for planar robots, in space ``posture_objective``.

    Parameters
    ----------
    robot : Robot
    standing : ndarray (nq,)
        The posture, as ``rt.gait.stand`` returns it.
    """
    return Effort() if robot.root == "planar" else posture_objective(robot, standing)


def posture_objective(robot: Robot, standing: NDArray[np.float64]) -> Objective:
    """Return effort, the distance of the joints from a posture, and their accelerations.

    The integral of  sum tau^2 + (0.2 m g h)^2 [sum (q_j - q_j,standing)^2 + 0.002 (h / g)^2 sum a_j^2],  h the height
    of the centre of mass. The second term keeps legs from stretching, where the equations are singular. The third term
    suppresses oscillations of humanoids between the collocation points.

    Parameters
    ----------
    robot : Robot
    standing : ndarray (nq,)
        The posture, as ``rt.gait.stand`` returns it.
    """
    height = abs(float(pin.centerOfMass(robot.model, robot.model.createData(), standing)[2]))
    gravity = float(np.linalg.norm(robot.model.gravity.linear))
    worth = (SHARE * pin.computeTotalMass(robot.model) * gravity * height) ** 2
    joints = {name: 1.0 for name in robot.joint_names if name in robot.position_names}
    posture = Tracking(FixedPosture(tuple(float(v) for v in standing)), q=joints)
    calm = Lagrange(SquaredAccelerations(ROOT_FREEDOMS[robot.root]))
    return Effort() + worth * posture + worth * CALM * (height / gravity) ** 2 * calm
