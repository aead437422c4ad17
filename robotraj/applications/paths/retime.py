"""Least time along a given path of the joints, under limits of speed, acceleration, torque, jerk and torque rate."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from robotraj._util.checks import is_number
from robotraj._util.errors import InputError
from robotraj.applications.paths.joint_path import JointPath, as_path, check_positions, unwrapped
from robotraj.applications.paths.smooth_path import smoothed
from robotraj.planning.plan import plan
from robotraj.problem.constraints.base import Constraint
from robotraj.problem.constraints.bounds import BoundsLike
from robotraj.problem.constraints.follow_path import FollowPath
from robotraj.problem.constraints.motors.rates import JointJerk, JointTorqueRate
from robotraj.problem.objectives.base import Objective
from robotraj.problem.objectives.duration import Duration
from robotraj.problem.phase import Phase
from robotraj.robot.limits import Limits
from robotraj.robot.robot import Robot
from robotraj.solution.solution import Solution

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from robotraj.applications.many.options import PlanOptions
    from robotraj.dynamics.design.quantity import Quantity

LONGEST = 1e3
"""Upper bound of the duration [s]."""
DEVIATION = 1e-3
"""Largest distance between the path of a plan and the smooth path of a motion of bounded jerk [rad, m]."""


def retime(
    path: JointPath,
    robot: Robot | None = None,
    *,
    parameters: ArrayLike | None = None,
    limits: Limits | None = None,
    jerk: BoundsLike | float = None,
    torque_rate: BoundsLike | float = None,
    start_speed: float | None = 0.0,
    end_speed: float | None = 0.0,
    deviation: float | None = None,
    constraints: Sequence[Constraint] = (),
    design: Mapping[str, Quantity | Sequence[Quantity]] | None = None,
    objective: Objective | None = None,
    **options: Unpack[PlanOptions],
) -> Solution:
    """Plan the motion of least time along a path q(s) of the joints.

    The path parameter s and its speed are the states of the phase, and its acceleration is the control
    (``rt.constraints.FollowPath``). With limits of jerk or torque rate, the control is the derivative of the
    acceleration. The joints are functions of these and stay on the path at every time. The result is a plan of the
    robot like any other, proved by default.

    Parameters
    ----------
    path : array (m, nq), Solution, spline or callable
        See ``rt.applications.as_path``.
    robot : Robot, optional
        The robot of the solution by default, if the path is a solution.
    parameters : array (m,), optional
        Parameters of an array of configurations.
    limits : Limits, optional
        Limits of speed, acceleration and torque; those of the robot by default. The path must lie within the limits of
        position.
    jerk, torque_rate : float, Between, sequence or mapping by joint, optional
        Limits of da/dt [rad/s^3, m/s^3] and of d tau/dt [N m/s, N/s]; a number bounds both signs.
    start_speed, end_speed : float, optional
        ds/dt at both ends: 0 is at rest, None leaves it free. Where dq/ds is 0, as at the rests of a solution, the
        joints rest at any ds/dt, which is then free.
    deviation : float, optional
        Largest distance of a joint between the path and a smooth path that replaces it [rad, m]; 0 keeps the path. The
        default is 1e-3 for a solution under a limit of jerk or torque rate, else 0. The accelerations of a plan jump,
        and jerks are bounded only where the motion stops at the jumps. s is then the length of the path [rad, m], and
        rests of the plan on its way are not kept. Third derivatives of cubic splines jump too: a deviation makes their
        plans quicker. ``FollowPath.deviation`` of the phase is the largest distance.
    constraints : sequence of Constraint
        Further constraints, such as the speed of the tool. ``rt.CollisionFree`` is proved along the path, which no
        timing can change.
    design : mapping, optional
        Payloads and other quantities of the robot, as of ``rt.Phase``.
    objective : Objective, optional
        ``rt.Duration()`` by default.
    **options
        Of ``rt.plan``: mesh, tolerance, check ...

    Returns
    -------
    Solution

    Raises
    ------
    InputError
        There is no robot, the path has another type or shape, or it exceeds a limit of position. Or no spline of 512
        pieces is within the deviation.
    NoSolutionFound
        The limits allow no motion along the path, for example because a joint cannot hold its weight there.

    Notes
    -----
    Source: Bobrow, Dubowsky and Gibson, International Journal of Robotics Research 4 (1985). The benchmarks compare
    with Pham and Pham, IEEE Transactions on Robotics 34 (2018).
    """
    if robot is None and isinstance(path, Solution):
        robot = path.phases[0].phase.robot
    if not isinstance(robot, Robot):
        raise InputError("rt.retime needs robot=, a robot of rt.load(...), except for the path of a robot's solution.")
    given = robot.limits if limits is None else limits
    if isinstance(path, list | tuple | np.ndarray):
        path = unwrapped(path, robot, given)
    joints = as_path(path, parameters)
    check_positions(joints, given, robot.units)
    if deviation is None:
        limited = jerk is not None or torque_rate is not None or bool(np.isfinite(given.jerk).any())
        abrupt = isinstance(path, Solution) and limited
        deviation = DEVIATION if abrupt else 0.0
    if not (is_number(deviation) and 0.0 <= deviation < np.inf):
        raise InputError(f"deviation must be a number of 0 or more [rad, m], got {deviation!r}.")
    if deviation > 0.0:
        joints = smoothed(joints, deviation, *given.positions)
    every: list[Constraint] = [FollowPath(joints, start_speed, end_speed, deviation)]
    for kind, bounds in ((JointJerk, jerk), (JointTorqueRate, torque_rate)):
        if bounds is not None:
            every.append(kind(bounds))
    phase = Phase(
        robot,
        (0.0, LONGEST),
        objective=Duration() if objective is None else objective,
        constraints=[*every, *constraints],
        design=design or {},
        limits=given.with_(position=np.inf),
        name="path",
    )
    return plan(phase, **options)
