"""Two wheels on one axle that roll without slip."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np

from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.dynamics.dae import Dynamics
from robotraj.dynamics.point import RobotPoint
from robotraj.dynamics.row import Row
from robotraj.problem.constraints.base import BoundConstraint, Constraint, robot_of
from robotraj.problem.scalars import Scalar
from robotraj.robot.mobile import JOINTS

SIDES = ("left wheel", "right wheel")


@dataclass(frozen=True)
class DifferentialDrive(Constraint):
    """Two wheels on one axle that roll without slip, for a base of ``rt.robot.on_wheels``.

    With the heading c = (cos yaw, sin yaw), s = (-sin yaw, cos yaw), the velocity v of the base and its turning rate w,

        s . v = 0,
        wheel speeds  (c . v -+ track w / 2) / radius      within +-speed [rad/s],
        wheel torques (c . f / 2 -+ m / track) radius      within +-torque [N m],
        s . f                                              within +-lateral_force [N],

    for the force f and the moment m of the ground on the base. The wheels' inertia about their axle is neglected; add
    it to the base's mass.

    Parameters
    ----------
    radius : float
        Radius of the wheels [m].
    track : float
        Distance of the wheels [m].
    speed, torque, lateral_force : float
        Limits of each wheel, and of the friction across the heading; infinite by default.

    Raises
    ------
    InputError
        A length or limit is not above 0. On binding: the robot has no such base.
    """

    radius: float
    track: float
    speed: float = np.inf
    torque: float = np.inf
    lateral_force: float = np.inf

    def __post_init__(self) -> None:
        for name in ("radius", "track", "speed", "torque", "lateral_force"):
            value = getattr(self, name)
            if not value > 0.0 or (name in ("radius", "track") and np.isinf(value)):
                raise InputError(f"DifferentialDrive({name}) is {value!r}; it must be above 0.")

    def bind(self, dynamics: Dynamics, parameters: Sequence[str] = ()) -> BoundConstraint:
        """Write the row of rolling, and those of the finite limits."""
        robot = robot_of(dynamics, "DifferentialDrive")
        if robot.velocity_names[: len(JOINTS)] != JOINTS or robot.actuated[: len(JOINTS)] != JOINTS:
            raise InputError(
                f"DifferentialDrive moves the base of rt.robot.on_wheels(robot, ...), but {robot.name!r} does not "
                f"start with the joints {', '.join(JOINTS)}."
            )
        limits = (
            ("wheel speed", "rad/s", self.speed, SIDES),
            ("wheel torque", "N m", self.torque, SIDES),
            ("lateral force", "N", self.lateral_force, ("base",)),
        )
        rows = [Row("lateral speed", "m/s", 0.0, 0.0, "base")]
        rows += [
            Row(name, unit, -bound, bound, joint)
            for name, unit, bound, joints in limits
            if np.isfinite(bound)
            for joint in joints
        ]

        def expression(point: RobotPoint) -> list[Scalar]:
            yaw = point.q[2]
            cosine, sine = ca.cos(yaw), ca.sin(yaw)
            v = point.v
            values = [cosine * v[1] - sine * v[0]]
            if np.isfinite(self.speed):
                forward, turning = cosine * v[0] + sine * v[1], 0.5 * self.track * v[2]
                values += [(forward - turning) / self.radius, (forward + turning) / self.radius]
            if np.isfinite(self.torque):
                tau = point.tau
                half, couple = 0.5 * (cosine * tau[0] + sine * tau[1]), tau[2] / self.track
                values += [(half - couple) * self.radius, (half + couple) * self.radius]
            if np.isfinite(self.lateral_force):
                values.append(cosine * point.tau[1] - sine * point.tau[0])
            return values

        return BoundConstraint("differential drive", tuple(rows), expression)
