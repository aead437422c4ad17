"""Limits on joint positions, velocities, accelerations and efforts."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

import numpy as np

from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.dae import Dynamics
from robotraj.dynamics.point import RobotPoint
from robotraj.dynamics.rigid_body import RATE_UNITS
from robotraj.dynamics.row import Row
from robotraj.problem.constraints.base import BoundConstraint, Constraint, robot_of
from robotraj.problem.constraints.bounds import BoundsLike, as_bounds, as_limits
from robotraj.problem.scalars import Scalar

RATES = ("v", "a", "tau")
"""Joint quantities, in the order of their units in ``RATE_UNITS``."""


@dataclass(frozen=True)
class OwnLimits(OneLine):
    """Impose ``robot.limits`` (the default)."""


@dataclass(frozen=True)
class JointLimit(Constraint):
    """Bounds on one joint quantity, lower <= s_j <= upper for each joint j; the root's entries are named as in q and v.

    Parameters
    ----------
    bounds : Between, number, sequence or mapping by joint
        ``rt.between(-1, 1)`` for all joints, ``{"elbow": rt.between(0, 2)}`` for some. A number x stands for [-x, x],
        as in ``robot.limits.with_``; ``rt.between(x, x)`` fixes the quantity at x.
    """

    bounds: BoundsLike

    prefix: ClassVar[str]
    quantity: ClassVar[str]

    def bind(self, dynamics: Dynamics, parameters: Sequence[str] = ()) -> BoundConstraint:
        """Write one row for each joint that is bounded on a side."""
        robot = robot_of(dynamics, type(self).__name__)
        joints = list({"q": robot.position_names, "tau": robot.actuated}.get(self.prefix, robot.velocity_names))
        lower, upper = as_bounds(as_limits(self.bounds), joints, self.quantity)
        unit_of = dict(zip(robot.velocity_names, robot.units, strict=True))
        unit_of |= dict(zip(robot.position_names, robot.position_units, strict=True))
        known = {v.name for v in (*dynamics.states, *dynamics.algebraic, *dynamics.controls)}
        rows = []
        for joint, low, high in zip(joints, lower, upper, strict=True):
            if np.isinf(low) and np.isinf(high):
                continue
            name = f"{self.prefix}.{joint}"
            position = unit_of[joint]
            unit = position if self.prefix == "q" else RATE_UNITS[position][RATES.index(self.prefix)]
            variable = name if name in known else None
            rows.append(Row(self.quantity, unit, float(low), float(high), joint, variable))
        indices = [joints.index(str(row.joint)) for row in rows]
        prefix = self.prefix

        def expression(point: RobotPoint) -> list[Scalar]:
            values = getattr(point, prefix)
            return [values[i] for i in indices]

        return BoundConstraint(self.quantity, tuple(rows), expression)


@dataclass(frozen=True)
class JointPosition(JointLimit):
    """Bounds on joint positions q [rad, m]."""

    prefix: ClassVar[str] = "q"
    quantity: ClassVar[str] = "position limit"


@dataclass(frozen=True)
class JointVelocity(JointLimit):
    """Bounds on joint velocities v [rad/s, m/s]."""

    prefix: ClassVar[str] = "v"
    quantity: ClassVar[str] = "velocity limit"


@dataclass(frozen=True)
class JointAcceleration(JointLimit):
    """Bounds on joint accelerations a [rad/s^2, m/s^2]."""

    prefix: ClassVar[str] = "a"
    quantity: ClassVar[str] = "acceleration limit"


@dataclass(frozen=True)
class JointEffort(JointLimit):
    """Bounds on the torques and forces tau of the actuated joints [N m, N]."""

    prefix: ClassVar[str] = "tau"
    quantity: ClassVar[str] = "effort limit"
