"""Limits of motors that couple torque and speed: curves of torque over speed, power."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.dynamics.dae import Dynamics
from robotraj.dynamics.point import RobotPoint
from robotraj.dynamics.row import Row
from robotraj.problem.constraints.base import BoundConstraint, Constraint, robot_of
from robotraj.problem.objectives.weights import WeightsLike, weights_of
from robotraj.problem.scalars import Scalar
from robotraj.robot.robot import Robot


@dataclass(frozen=True)
class SpeedTorqueCurve(Constraint):
    """The line of a motor from its stall torque to its no-load speed: abs(tau_j / stall_j + v_j / no_load_j) <= 1.

    Torque along the motion falls with the speed, as in a direct-current motor at its voltage limit. Limits of torque
    and of speed alone are those of the phase.

    Parameters
    ----------
    stall : float, sequence or mapping by joint
        Torque at rest [N m, N]; joints that a mapping does not name have no row.
    no_load : float, sequence or mapping by joint
        Speed without torque [rad/s, m/s].
    """

    stall: WeightsLike
    no_load: WeightsLike

    def bind(self, dynamics: Dynamics, parameters: Sequence[str] = ()) -> BoundConstraint:
        """Write one row for each motor."""
        robot = robot_of(dynamics, "SpeedTorqueCurve")
        pairs = zip(_above_zero(self.stall, robot, "stall"), _above_zero(self.no_load, robot, "no_load"), strict=True)
        motors = [(k, float(t), float(v)) for k, (t, v) in enumerate(pairs) if np.isfinite(t) and np.isfinite(v)]
        index = [robot.velocity_names.index(joint) for joint in robot.actuated]
        rows = tuple(Row("speed-torque curve", "", -1.0, 1.0, robot.actuated[k]) for k, *_ in motors)

        def expression(point: RobotPoint) -> list[Scalar]:
            return [point.tau[k] / torque + point.v[index[k]] / speed for k, torque, speed in motors]

        return BoundConstraint("speed-torque curve", rows, expression)


@dataclass(frozen=True)
class MotorPower(Constraint):
    """Mechanical power of the motors: abs(tau_j v_j) <= limit_j, and sum_j tau_j v_j <= total [W].

    Parameters
    ----------
    limit : float, sequence or mapping by joint, optional
        Limit of each motor [W]; joints that a mapping does not name have no row.
    total : float, optional
        Limit of the sum over all motors [W], as of a supply; the negative power of braking motors counts.
    """

    limit: WeightsLike = None
    total: float | None = None

    def bind(self, dynamics: Dynamics, parameters: Sequence[str] = ()) -> BoundConstraint:
        """Write one row for each motor, and one for all."""
        robot = robot_of(dynamics, "MotorPower")
        if self.limit is None and self.total is None:
            raise InputError("MotorPower has no limit; give limit= or total= [W].")
        if self.total is not None and not 0.0 < self.total < np.inf:
            raise InputError(f"MotorPower: total is {self.total} W; it must be above 0.")
        limits = np.full(robot.nu, np.inf) if self.limit is None else _above_zero(self.limit, robot, "limit")
        index = [robot.velocity_names.index(joint) for joint in robot.actuated]
        motors = [k for k in range(robot.nu) if np.isfinite(limits[k])]
        rows = [Row("power limit", "W", -float(limits[k]), float(limits[k]), robot.actuated[k]) for k in motors]
        if self.total is not None:
            rows.append(Row("total power limit", "W", -np.inf, float(self.total)))
        whole = self.total is not None

        def expression(point: RobotPoint) -> list[Scalar]:
            powers = [point.tau[k] * point.v[i] for k, i in enumerate(index)]
            return [*(powers[k] for k in motors), *([sum(powers)] if whole else [])]

        return BoundConstraint("power limit", tuple(rows), expression)


def _above_zero(given: WeightsLike, robot: Robot, what: str) -> NDArray[np.float64]:
    """Return one number above 0 for each motor, infinite for joints that a mapping does not name."""
    values = np.array(weights_of(given, robot.actuated, what))
    if isinstance(given, Mapping):
        values[[joint not in given for joint in robot.actuated]] = np.inf
    if not (values > 0).all():
        raise InputError(f"{what} is {given!r}; it must be above 0 for every motor.")
    return values
