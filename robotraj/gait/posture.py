"""What a gait minimises where nothing else is asked for."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from robotraj._util.values import dataclass
from robotraj.problem.objectives.base import Objective
from robotraj.problem.objectives.effort import Effort
from robotraj.problem.objectives.tracking import Tracking
from robotraj.robot.robot import Robot

SHARE = 0.2
"""Torque [as a share of weight times height of the centre of mass] that a radian away from the posture costs."""


@dataclass(frozen=True)
class Still:
    """The reference of ``rt.objectives.Tracking`` that does not move.

    Attributes
    ----------
    q : tuple of float
    """

    q: tuple[float, ...]

    def __call__(self, t: Any) -> Mapping[str, Any]:
        """Give q at any time."""
        return {"q": self.q}


def gait_objective(robot: Robot, standing: NDArray[np.float64]) -> Objective:
    """Effort; in space also the distance of the joints from how the robot stands.

    The integral of  sum tau^2 + (0.2 m g h)^2 sum (q_j - q_j,standing)^2,  h the height of the centre of mass. Legs of
    which many postures carry the robot need the second term: without it the least torque is that of legs stretched
    out, however far apart, where the equations are singular. Planar robots have the first alone.
    """
    if robot.root == "planar":
        return Effort()
    data = robot.model.createData()
    feet_below = float(pin.centerOfMass(robot.model, data, standing)[2])
    weight = pin.computeTotalMass(robot.model) * float(np.linalg.norm(robot.model.gravity.linear))
    worth = (SHARE * weight * abs(feet_below)) ** 2
    joints = {name: 1.0 for name in robot.joint_names if name in robot.position_names}
    return Effort() + worth * Tracking(Still(tuple(float(v) for v in standing)), q=joints)
