"""Hard limits on jerks and on the rates of torques."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

import numpy as np

from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.dynamics.dae import Dynamics
from robotraj.dynamics.path_body import PathBody
from robotraj.dynamics.point import RobotPoint
from robotraj.dynamics.row import Row
from robotraj.problem.augmentation import FrictionlessTorques, body_of, has
from robotraj.problem.constraints.base import BoundConstraint, Constraint, Where, robot_of
from robotraj.problem.constraints.bounds import BoundsLike, as_bounds, as_limits
from robotraj.problem.rates_as_variables import with_control_rates
from robotraj.problem.scalars import Scalar
from robotraj.robot.robot import Robot


@dataclass(frozen=True)
class RateLimit(Constraint):
    """Bounds on the time derivative of a quantity of each joint, at every time.

    The quantity is a polynomial on every interval of the mesh, and the Bernstein coefficients of its derivative are
    bounded. It must be continuous at the knots. The scheme therefore needs points at both ends of an interval, as
    ``rt.HermiteSimpson()`` has. On a path (``FollowPath``) they are path rows of s, s', s'' and s''' instead.

    The limit holds across the ends: from rest and to rest the quantity is that of a robot at rest
    (``motors.end_accelerations``).

    Parameters
    ----------
    bounds : Between, number, sequence or mapping by joint
        ``500`` or ``rt.between(-500, 500)`` for all joints, ``{"elbow": rt.between(-100, 50)}`` for some. A number x
        stands for [-x, x].
    """

    bounds: BoundsLike

    prefix: ClassVar[str]
    quantity: ClassVar[str]
    units: ClassVar[tuple[str, str]]
    bounded: ClassVar[str]
    """Prefix of the variables whose polynomials are bounded."""

    def bind(self, dynamics: Dynamics, parameters: Sequence[str] = ()) -> BoundConstraint:
        """Write one row for each joint that is bounded on a side.

        Raises
        ------
        InputError
            The phase moves a System, or a robot by forward dynamics, or a joint is unknown.
        """
        robot = robot_of(dynamics, type(self).__name__)
        known = {v.name for v in (*dynamics.algebraic, *dynamics.controls)}
        on_path = isinstance(dynamics, PathBody)
        if not on_path and f"{self.prefix}.{robot.actuated[0]}" not in known:
            raise InputError(
                f"{type(self).__name__} bounds rates of unknowns, and forward dynamics have no accelerations among "
                "them; use rt.dynamics.InverseDynamics()."
            )
        units = {j: self.units[unit == "m"] for j, unit in zip(robot.velocity_names, robot.units, strict=True)}
        rows = tuple(
            Row(self.quantity, units[j], low, high, j, None if on_path else f"{self.bounded}{j}")
            for j, low, high in self.limited(robot)
        )

        def expression(point: RobotPoint) -> list[Scalar]:
            return [point.extra[f"rate.{self.prefix}.{row.joint}"] for row in rows]

        return BoundConstraint(self.quantity, rows, expression, Where.THROUGHOUT if on_path else Where.RATE)

    def limited(self, robot: Robot) -> list[tuple[str, float, float]]:
        """Joints that are bounded on a side, with both bounds."""
        joints = list(robot.actuated if self.prefix == "tau" else robot.velocity_names)
        lower, upper = as_bounds(as_limits(self.bounds), joints, self.quantity)
        pairs = zip(joints, lower.tolist(), upper.tolist(), strict=True)
        return [(j, low, high) for j, low, high in pairs if np.isfinite(low) or np.isfinite(high)]

    def augment(self, dynamics: Dynamics) -> Dynamics:
        """On a path, make its acceleration a state; elsewhere the rates are those of polynomials."""
        return with_control_rates(dynamics) if isinstance(body_of(dynamics), PathBody) else dynamics


@dataclass(frozen=True)
class JointJerk(RateLimit):
    """Bounds on the jerks da_j/dt of the joints [rad/s^3, m/s^3], at every time."""

    prefix: ClassVar[str] = "a"
    quantity: ClassVar[str] = "jerk limit"
    units: ClassVar[tuple[str, str]] = ("rad/s^3", "m/s^3")
    bounded: ClassVar[str] = "a."


@dataclass(frozen=True)
class JointTorqueRate(RateLimit):
    """Bounds on the rates of the motors' torques and forces without dry friction [N m/s, N/s], at every time.

    The rate of joint j is d/dt (tau_j - F_j tanh(v_j / v_s)), with the dry friction F_j of the URDF and the robot's
    ``friction_speed`` v_s. Dry friction jumps by 2 F_j where the joint reverses: its rate, F_j / v_s times the
    acceleration, is not bounded. Joints without dry friction have the rates of tau_j. The bounded polynomials agree
    with these torques at the collocation points, where they are further variables.
    """

    prefix: ClassVar[str] = "tau"
    quantity: ClassVar[str] = "torque rate limit"
    units: ClassVar[tuple[str, str]] = ("N m/s", "N/s")
    bounded: ClassVar[str] = "frictionless."

    def augment(self, dynamics: Dynamics) -> Dynamics:
        """Add the torques without dry friction, except on a path."""
        body = body_of(dynamics)
        if isinstance(body, PathBody):
            return super().augment(dynamics)
        limited = [joint for joint, _, _ in self.limited(robot_of(body, type(self).__name__))]
        added = tuple(joint for joint in limited if not has(dynamics, [f"{self.bounded}{joint}"]))
        return FrictionlessTorques(dynamics, added) if added else dynamics
