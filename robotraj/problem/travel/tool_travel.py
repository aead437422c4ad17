"""Checks of limits on a frame's speed against the way between its places at both ends.

A frame that moves from p_0 to p_1 with |dp/dt| <= V takes at least |p_1 - p_0| / V.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from robotraj._util.errors import InputError, warn
from robotraj._util.precision import SAME
from robotraj.problem.constraints.base import Constraint, Where
from robotraj.problem.constraints.frame_pose import AXES
from robotraj.problem.constraints.task_space.tool_motion import FrameSpeed
from robotraj.problem.feasibility import Ends
from robotraj.problem.rows import RowTable
from robotraj.robot.loading.other_units import in_other_unit, seems_other
from robotraj.robot.robot import Robot
from robotraj.robot.size.reach import reaches


def check_tool_travel(
    table: RowTable, robot: Robot, constraints: Iterable[Constraint], durations: tuple[float, float], ends: Ends
) -> None:
    """Refuse a frame that must travel faster than its ``FrameSpeed`` allows in the longest of both durations [s].

    Raises
    ------
    InputError
        The message names the frame, the distance, and the duration or the speed that suffices.

    Warns
    -----
    UserWarning
        A limit is above all speeds that the joints allow, and plausible in mm/s.
    """
    longest = durations[1]
    for each in constraints:
        if not isinstance(each, FrameSpeed) or each.linear is None:
            continue
        fastest = greatest_speed(robot)
        if seems_other(each.linear, fastest, "m/s"):
            warn(
                f"Phase {table.phase!r}: the speed limit {each.linear:g} m/s of frame {each.frame!r} has no effect, "
                f"since the joints allow {fastest:.2g} m/s at most. {in_other_unit(each.linear, 'm/s')}"
            )
        first, last = (_place(table, robot, each.frame, where, ends) for where in (Where.START, Where.END))
        if first is None or last is None:
            continue
        way = float(np.linalg.norm(last - first))
        if way > each.linear * longest * (1 + SAME):
            raise InputError(
                f"Phase {table.phase!r}: frame {each.frame!r} must travel {way:.4g} m, but its speed limit of "
                f"{each.linear:.4g} m/s allows {each.linear * longest:.4g} m in {longest:.4g} s. Allow more than "
                f"{way / each.linear:.4g} s, or a speed above {way / longest:.4g} m/s."
            )


def greatest_speed(robot: Robot) -> float:
    """Return a bound on the speed of a robot's masses [m/s] with a fixed root: sum_j v_j r_j, r_j = 1 where it slides.

    It is infinite where the root moves or a joint has no limit of speed.
    """
    if robot.root != "fixed":
        return float(np.inf)
    levers = np.ones(robot.nv)
    far = reaches(robot.model)
    for joint in range(1, robot.model.njoints):
        for k in range(robot.model.nvs[joint]):
            i = robot.model.idx_vs[joint] + k
            levers[i] = 1.0 if robot.units[i] == "m" else far[joint]
    return float(levers @ robot.limits.largest("velocity"))


def _place(table: RowTable, robot: Robot, frame: str, where: Where, ends: Ends) -> NDArray[np.float64] | None:
    """Return the place of a frame at an end [m]: of fixed positions, or of rows; None where it is free."""
    bounds = ends[where]
    q = bounds.lower[: robot.nq]
    if np.array_equal(q, bounds.upper[: robot.nq]):
        data = robot.model.createData()
        pin.framesForwardKinematics(robot.model, data, q)
        return np.array(data.oMf[robot.frame(frame)].translation)
    fixed = {
        row.name: row.lower
        for row in table
        if row.joint == frame and row.lower == row.upper and row.where in (Where.THROUGHOUT, where)
    }
    names = [f"frame position {axis}" for axis in AXES]
    return np.array([fixed[name] for name in names]) if all(name in fixed for name in names) else None
