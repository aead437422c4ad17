"""One motion for several payloads: limits of torque hold for each of them."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np
import pinocchio as pin

from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.dynamics.dae import Dynamics
from robotraj.dynamics.point import RobotPoint, symbolic_model
from robotraj.dynamics.row import Row
from robotraj.problem.constraints.base import BoundConstraint, Constraint, robot_of
from robotraj.problem.scalars import Scalar
from robotraj.robot.carried_body import CarriedBody, carrying
from robotraj.robot.robot import Robot


@dataclass(frozen=True)
class PayloadScenarios(Constraint):
    """The limits of torque of the robot hold for the same motion with each of several payloads.

    With payload k the motors need tau_k = tau + B' (RNEA_k(q, v, a) - RNEA(q, v, a)), RNEA_k with the body carried.

    Parameters
    ----------
    payloads : sequence of CarriedBody
        The bodies, each carried alone; the robot of the phase carries none of them.
    """

    payloads: Sequence[CarriedBody]

    def bind(self, dynamics: Dynamics, parameters: Sequence[str] = ()) -> BoundConstraint:
        """Write one row for each payload and motor with a limit.

        Raises
        ------
        InputError
            The phase moves a System, there is no payload, or no motor has a limit.
        """
        robot = robot_of(dynamics, "PayloadScenarios")
        if not self.payloads or not all(isinstance(body, CarriedBody) for body in self.payloads):
            raise InputError(f"PayloadScenarios takes rt.robot.CarriedBody values; got {self.payloads!r}.")
        loaded = [carrying(robot, body) for body in self.payloads]
        index = [robot.velocity_names.index(joint) for joint in robot.actuated]
        lower, upper = (side[index].tolist() for side in robot.limits.sides("effort"))
        motors = [k for k, ends in enumerate(zip(lower, upper, strict=True)) if np.isfinite(ends).any()]
        if not motors:
            raise InputError(
                f"PayloadScenarios: no motor of {robot.name!r} has a limit of torque; set one with limits=."
            )
        units = ["N m" if robot.units[i] == "rad" else "N" for i in index]
        rows = tuple(
            Row(f"effort limit with payload {number}", units[k], lower[k], upper[k], robot.actuated[k])
            for number in range(len(loaded))
            for k in motors
        )

        def expression(point: RobotPoint) -> list[Scalar]:
            alone = _inverse_dynamics(robot, point)
            needed = [_inverse_dynamics(each, point) for each in loaded]
            return [point.tau[k] + each[index[k]] - alone[index[k]] for each in needed for k in motors]

        return BoundConstraint("effort limit with payload", rows, expression)


def _inverse_dynamics(robot: Robot, point: RobotPoint) -> ca.SX | np.ndarray:
    """Return RNEA(q, v, a) (nv,), symbolic or numeric as the point is."""
    if isinstance(point.q, ca.SX):
        no_force = ca.SX(6, robot.model.njoints)
        return symbolic_model(robot).inverse_dynamics(point.q, point.v, point.a, no_force)
    q, v, a = (np.array(each, dtype=float).ravel() for each in (point.q, point.v, point.a))
    return np.array(pin.rnea(robot.model, robot.model.createData(), q, v, a))
