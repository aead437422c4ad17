"""Accelerations at the ends of a phase: those given, and those of a rest under limits of jerks or torque rates.

A robot with a motor at every joint has no acceleration at rest, and its motors hold it. A limit of jerks therefore
starts from zero acceleration, and a limit of torque rates from the torque that holds the robot. Without this the first
instant has a jump that the limit forbids. Where the robot moves at an end, the acceleration beyond it is unknown, and
is free unless it is given.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

from robotraj._util.values import dataclass
from robotraj.dynamics.dae import Dynamics
from robotraj.dynamics.point import RobotPoint
from robotraj.dynamics.rigid_body import InverseRigidBody
from robotraj.dynamics.row import Row
from robotraj.problem.constraints.base import AtEnd, AtStart, BoundConstraint, Constraint, Where, robot_of
from robotraj.problem.constraints.bounds import Bounds, BoundsLike, between
from robotraj.problem.constraints.joint_limits import JointAcceleration
from robotraj.problem.constraints.motors.rates import JointJerk, JointTorqueRate, RateLimit
from robotraj.problem.scalars import Scalar
from robotraj.robot.robot import Robot


@dataclass(frozen=True)
class EndAcceleration(JointAcceleration):
    """Bounds on accelerations at an end [rad/s^2, m/s^2]."""

    quantity: ClassVar[str] = "acceleration at an end"


@dataclass(frozen=True)
class HoldingTorque(Constraint):
    """The motors of some joints hold a robot at rest, while other joints may accelerate.

    tau_j = g_j(q) + k_j (q_j - rest_j) [N m, N], against gravity and a spring.
    """

    joints: tuple[str, ...]

    def bind(self, dynamics: Dynamics, parameters: Sequence[str] = ()) -> BoundConstraint:
        """Write one row for each joint."""
        robot = robot_of(dynamics, "HoldingTorque")
        moved = robot.velocity_names
        units = {joint: "N" if unit == "m" else "N m" for joint, unit in zip(moved, robot.units, strict=True)}
        rows = tuple(Row("torque beyond the holding one", units[joint], 0.0, 0.0, joint) for joint in self.joints)
        places = [(robot.actuated.index(joint), moved.index(joint)) for joint in self.joints]
        pulls = {moved.index(joint): (k, rest, robot.position_names.index(joint)) for joint, k, rest in robot.springs}

        def expression(point: RobotPoint) -> list[Scalar]:
            torques, held = point.tau, point.gravity
            springs = {joint: k * (point.q[at] - rest) for joint, (k, rest, at) in pulls.items()}
            return [torques[motor] - held[joint] - springs.get(joint, 0.0) for motor, joint in places]

        return BoundConstraint("holding torque", rows, expression)


def end_accelerations(
    body: Dynamics, imposed: Sequence[Constraint], ends: Sequence[tuple[Where, BoundsLike, Bounds]]
) -> tuple[Constraint, ...]:
    """Return the constraints on accelerations at both ends.

    Parameters
    ----------
    body : Dynamics
        The dynamics of the phase.
    imposed : sequence of Constraint
        All constraints of the phase.
    ends : sequence of (Where, BoundsLike, Bounds)
        ``Where.START`` or ``Where.END``, the acceleration given there, and the bounds on the state.
    """
    limits = [each for each in imposed if isinstance(each, RateLimit)]
    found: list[Constraint] = []
    for where, given, state in ends:
        own: list[Constraint] = []
        if given is not None:
            own.append(EndAcceleration(given))
        elif limits and isinstance(body, InverseRigidBody) and can_rest(body) and rests(body, state):
            own += _at_rest(limits, body.robot)
        found += [AtStart(each) if where is Where.START else AtEnd(each) for each in own]
    return tuple(found)


def can_rest(body: InverseRigidBody) -> bool:
    """Whether motors alone hold a robot in any configuration."""
    robot = body.robot
    return robot.root == "fixed" and robot.nq == robot.nv == robot.nu and not body.contacts


def rests(body: InverseRigidBody, state: Bounds) -> bool:
    """Whether the bounds on the state at an end leave no speed."""
    speeds = slice(body.robot.nq, body.robot.nq + body.robot.nv)
    return not (state.lower[speeds].any() or state.upper[speeds].any())


def _at_rest(limits: Sequence[RateLimit], robot: Robot) -> list[Constraint]:
    """Return what limits of rates require of a robot at rest."""
    still, holding = set[str](), set[str]()
    for limit in limits:
        joints = {joint for joint, _, _ in limit.limited(robot)}
        if isinstance(limit, JointJerk) or joints == set(robot.velocity_names):
            still |= joints
        elif isinstance(limit, JointTorqueRate):
            holding |= joints
    found: list[Constraint] = []
    if still:
        found.append(EndAcceleration({joint: between(0.0, 0.0) for joint in robot.velocity_names if joint in still}))
    if holding and len(still) < robot.nv:
        found.append(HoldingTorque(tuple(joint for joint in robot.actuated if joint in holding)))
    return found
