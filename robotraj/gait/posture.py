"""The default objectives of gaits."""

from __future__ import annotations

from collections.abc import Mapping

import casadi as ca
import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from robotraj._util.values import dataclass
from robotraj.dynamics.point import RobotPoint
from robotraj.dynamics.variable import Scalar
from robotraj.guess.legs.stance import root_freedoms
from robotraj.problem.objectives.base import Objective
from robotraj.problem.objectives.effort import Effort
from robotraj.problem.objectives.expressions import Lagrange, Mayer
from robotraj.problem.objectives.tracking import Tracking
from robotraj.robot.robot import Robot

SHARE = 0.2
"""Torque that costs as much as 1 rad from the posture, as a fraction of weight times height of the centre of mass."""
CALM = 2e-3
"""Weight of accelerations relative to that of angles, times (h / g)^2."""
HASTE = 0.16
"""Price of a short phase: one that costs as much as 1 rad from the posture is best 0.4 sqrt(h / g) long."""


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


@dataclass(frozen=True)
class Haste:
    """Inverse of the duration of a phase [1/s]."""

    def __call__(self, start: RobotPoint, end: RobotPoint) -> Scalar:
        """Evaluate 1 / T."""
        return 1.0 / (end.t - start.t)


def gait_objective(robot: Robot, standing: NDArray[np.float64]) -> Objective:
    """Return the default objective of gaits: effort for planar robots, in space ``posture_objective``.

    Motions of planar robots from rest to rest have ``posture_objective``, too, where a duration is free: a robot that
    balances needs no torque, so that by effort alone its phases last as long as they may. Where the objective of a gait
    is not given, phases of free duration pay for ``haste`` besides.

    Parameters
    ----------
    robot : Robot
    standing : ndarray (nq,)
        The posture, as ``rt.gait.stand`` returns it.
    """
    return Effort() if robot.root == "planar" else posture_objective(robot, standing)


def posture_objective(robot: Robot, standing: NDArray[np.float64]) -> Objective:
    """Return effort, the distance of the joints from a posture, and their accelerations.

    The integral of  sum tau^2 + w [sum (q_j - q_j,standing)^2 + 0.002 (h / g)^2 sum a_j^2],  w = (0.2 m g h)^2, h the
    height of the centre of mass. The second term keeps legs from stretching, where the equations are singular. The
    third term suppresses oscillations of humanoids between the collocation points.

    Parameters
    ----------
    robot : Robot
    standing : ndarray (nq,)
        The posture, as ``rt.gait.stand`` returns it.
    """
    worth, pendulum = _sizes(robot, standing)
    joints = {name: 1.0 for name in robot.joint_names if name in robot.position_names}
    posture = Tracking(FixedPosture(tuple(float(v) for v in standing)), q=joints)
    calm = Lagrange(SquaredAccelerations(root_freedoms(robot)))
    return Effort() + worth * posture + worth * CALM * pendulum**2 * calm


def haste(robot: Robot, standing: NDArray[np.float64]) -> Objective:
    """Return a price of short phases: 0.16 w (h / g) / T [N^2 m^2 s], w = (0.2 m g h)^2, T the duration of the phase.

    A phase in which nothing needs to happen costs c T at rest, and would end at its least duration. With this term
    it is best 0.4 sqrt(w / c) sqrt(h / g) long. The term does not change motions with fixed durations.
    People, too, pay for force in short bursts: Doke, Donelan and Kuo, Journal of Experimental Biology 208 (2005) 439.

    Parameters
    ----------
    robot : Robot
    standing : ndarray (nq,)
        The posture, as ``rt.gait.stand`` returns it, by which h, the height of the centre of mass, is measured.
    """
    worth, pendulum = _sizes(robot, standing)
    return worth * HASTE * pendulum * Mayer(Haste())


def _sizes(robot: Robot, standing: NDArray[np.float64]) -> tuple[float, float]:
    """Return w [N^2 m^2], the cost of 1 rad from the posture per second, and h / g [s^2]."""
    standing = robot.configuration(standing, "standing")
    height = abs(float(pin.centerOfMass(robot.model, robot.model.createData(), standing)[2]))
    gravity = float(np.linalg.norm(robot.model.gravity.linear))
    return (SHARE * pin.computeTotalMass(robot.model) * gravity * height) ** 2, height / gravity
