"""The limits of a robot as constraints."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robotraj.problem.constraints.base import Constraint
from robotraj.problem.constraints.bounds import Between
from robotraj.problem.constraints.joint_limits import JointAcceleration, JointEffort, JointPosition, JointVelocity
from robotraj.problem.constraints.motors.rates import JointJerk
from robotraj.robot.limits import Limits


def own_limits(limits: Limits, actuated: Sequence[str]) -> tuple[Constraint, ...]:
    """Write limits as constraints: position, velocity, acceleration, effort of the motors; jerk where it is limited."""
    indices = [list(limits.joints).index(joint) for joint in actuated]
    every = (
        JointPosition(Between(*limits.positions)),
        JointVelocity(Between(*limits.sides("velocity"))),
        JointAcceleration(Between(*limits.sides("acceleration"))),
        JointEffort(Between(limits.effort_lower[indices], limits.effort_upper[indices])),
    )
    jerks = limits.sides("jerk")
    return (*every, JointJerk(Between(*jerks))) if np.isfinite(jerks).any() else every
