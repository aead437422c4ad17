"""A program of moves as one problem of phases along paths, from stop to stop."""

from __future__ import annotations

from collections.abc import Sequence
from typing import cast

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from robotraj._util.arrays import Array
from robotraj._util.curves.trajectory import PiecewisePolynomial
from robotraj._util.errors import InputError, warn
from robotraj._util.values import dataclass
from robotraj.applications.paths.joint_path import check_positions
from robotraj.applications.programs.corners import JointMove, ProgramPart, blend
from robotraj.applications.programs.moves import Move, MoveC, MoveJ, MoveL
from robotraj.applications.programs.tool_curves import ToolBlend, ToolMove, arc, line
from robotraj.applications.programs.tool_joints import ToolJoints
from robotraj.guess.reaching.inverse_kinematics import Target, reach
from robotraj.problem.constraints.base import Constraint
from robotraj.problem.constraints.follow_path import FollowPath
from robotraj.problem.constraints.frame_pose import check_metres
from robotraj.problem.links.continuity import Continuity
from robotraj.problem.objectives.base import Objective
from robotraj.problem.objectives.duration import Duration
from robotraj.problem.objectives.terminal_pose import target_of
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.robot.limits import Limits
from robotraj.robot.loading.other_units import in_other_unit
from robotraj.robot.robot import Robot
from robotraj.robot.size.reach import reach as reach_of

LONGEST = 1e3
"""Upper bound of the duration from stop to stop [s]."""
LEAST = 1e-9
"""Least length of a move and of a part of it [m]."""


class Program(Problem):
    """Joint moves, straight lines and circular arcs of the tool with blended corners, as controllers run them.

    Each move and each blend is a phase along a path q(s) (``rt.constraints.FollowPath``); the second derivative of q is
    continuous from stop to stop. A corner with a radius is passed on a polynomial of degree 5. It begins and ends at
    the same distance along both moves, and stays in the ball of that radius around the corner. The joints of tool
    moves are those of inverse kinematics on the branch of the posture where they begin; between these the tool is off
    its curve by 1e-6 [m, rad] at most. A redundant arm keeps the posture N' (q - q0) = 0, with the null space N of the
    Jacobian there. ``rt.plan`` finds and proves the motion of least time.

    Parameters
    ----------
    robot : Robot
        With a fixed root and a motor at every joint.
    start : array (nq,) or mapping by joint
        Positions at rest [rad, m].
    moves : sequence of rt.MoveJ, rt.MoveL and rt.MoveC
    tool : str
        Frame that lines, arcs and radii refer to.
    objective : Objective, optional
        Of every phase; ``rt.Duration()`` by default.
    constraints : sequence of Constraint
        Of every phase, such as limits of the tool's speed or ``rt.constraints.JointJerk``. ``rt.CollisionFree`` is
        proved along the paths.
    limits : Limits, optional
        Those of the robot by default.

    Raises
    ------
    InputError
        There is no move, or a target is where its move begins, or it is no pose. The arm cannot follow a line, or the
        path exceeds a limit of position. Blends overlap, or the last move has a radius.

    Notes
    -----
    A polynomial of degree 5 with vanishing second derivatives is in the hull of its Bezier points; see Farin, Curves
    and Surfaces for CAGD (2002). Speeds and accelerations are continuous at stops and blends, jerks are bounded.

    Examples
    --------
    >>> moves = [rt.MoveJ(above, radius=0.1), rt.MoveL(down, radius=0.03), rt.MoveL(aside)]  # doctest: +SKIP
    >>> solution = rt.plan(rt.Program(ur5, home, moves, tool="tool0"))  # doctest: +SKIP
    """

    def __init__(
        self,
        robot: Robot,
        start: ArrayLike,
        moves: Sequence[Move],
        *,
        tool: str,
        objective: Objective | None = None,
        constraints: Sequence[Constraint] = (),
        limits: Limits | None = None,
    ) -> None:
        if not isinstance(robot, Robot) or robot.root != "fixed" or robot.nq != robot.nv:
            raise InputError(f"rt.Program moves a robot of rt.load(...) with a fixed root; got {robot!r}.")
        if not moves or not all(isinstance(move, MoveJ | MoveL | MoveC) for move in moves):
            raise InputError(f"The moves of rt.Program are a list of rt.MoveJ, rt.MoveL and rt.MoveC; got {moves!r}.")
        if moves[-1].radius > 0.0:
            raise InputError("The last move of rt.Program ends at rest; give it no radius.")
        given = robot.limits if limits is None else limits
        parts = _parts(robot, robot.configuration(start, "start of rt.Program"), moves, robot.frame(tool), tool, given)
        phases = []
        for path in (each for run in _runs(parts) for each in _paths(run)):
            check_positions(path.curve, given, robot.units)
            phases.append(
                Phase(
                    robot,
                    (0.0, LONGEST),
                    objective=Duration() if objective is None else objective,
                    constraints=[FollowPath(path.curve, path.start_speed, path.end_speed), *constraints],
                    limits=given.with_(position=np.inf),
                    name=path.name,
                )
            )
        super().__init__(phases, [Continuity(k, k + 1) for k in range(len(phases) - 1)])


def _parts(
    robot: Robot, start: Array, moves: Sequence[Move], tool: int, name: str, limits: Limits
) -> list[ProgramPart]:
    """Return the moves without blends, each from the end of the one before."""
    parts, q, joints = list[ProgramPart](), start, ToolJoints(robot, tool, start)
    extent = reach_of(robot.model)
    for number, move in enumerate(moves):
        what = f"Move {number} ({type(move).__name__}) of rt.Program"
        if isinstance(move, MoveJ):
            after = _configuration(robot, move, name, q, limits, what)
            made: JointMove | ToolMove = JointMove(q, after, extent * float(np.linalg.norm(after - q)))
        else:
            made = _tool_move(joints.pose(q), move, what)
            check_metres(robot, made.last.translation, made.last.translation, f"target of {what}")
        if not made.length > LEAST:
            raise InputError(f"{what} ends where it begins; leave it out.")
        if isinstance(made, ToolMove):
            if robot.nv < 6:
                raise InputError(f"{what} needs six joints at least, but {robot.name!r} has {robot.nv}; use MoveJ.")
            after = joints.along(made, 0.0, made.length, q, what)(made.length)
        parts.append(ProgramPart(number, what, made, joints, (q, after), move.radius))
        q = after
        if isinstance(move, MoveJ) or move.radius == 0.0:
            joints = ToolJoints(robot, tool, q)
    return parts


def _configuration(robot: Robot, move: MoveJ, tool: str, near: Array, limits: Limits, what: str) -> Array:
    target = move.target
    is_pose = isinstance(target, pin.SE3) or np.ndim(target if isinstance(target, np.ndarray) else target[0]) > 0  # type: ignore[index]
    if is_pose and not (isinstance(target, np.ndarray) and target.ndim == 1):
        return reach(robot, tool, cast("Target", target), near, *limits.positions, what)
    return robot.configuration(cast("ArrayLike", target), what)


def _tool_move(first: pin.SE3, move: Move, what: str) -> ToolMove:
    assert isinstance(move, MoveL | MoveC)
    position, rotation = target_of(move.target, f"target of {what}")
    last = pin.SE3(first.rotation if rotation is None else rotation, position)
    if isinstance(move, MoveL):
        return line(first, last)
    return arc(first, target_of(move.through, f"middle of {what}")[0], last, what)


def _runs(parts: Sequence[ProgramPart]) -> list[list[ProgramPart]]:
    """Return the moves from stop to stop."""
    found: list[list[ProgramPart]] = [[]]
    for part in parts:
        found[-1].append(part)
        if part.radius == 0.0:
            found.append([])
    return found[:-1]


@dataclass(frozen=True, eq=False)
class _Stretch:
    """A move without its blended ends, or a blend; the joints rest where a speed is 0."""

    name: str
    curve: PiecewisePolynomial
    start_speed: float | None
    end_speed: float | None


def _paths(run: Sequence[ProgramPart]) -> list[_Stretch]:
    """Return the paths of the joints from a stop to the next, one for every move and blend."""
    for before, after in zip(run, run[1:], strict=False):
        if before.radius > before.length + after.length:
            warn(
                f"{before.what} has the radius {before.radius:g} m, but it and the next move are "
                f"{before.length:.3g} m and {after.length:.3g} m long. {in_other_unit(before.radius, 'm')}"
            )
    blends = [blend(before, after) for before, after in zip(run, run[1:], strict=False)]
    cuts = [0.0, *(cut for cut, _ in blends), 0.0]
    curves = list[tuple[str, PiecewisePolynomial]]()
    q = run[0].ends[0]
    for i, part in enumerate(run):
        first, last = cuts[i], part.length - cuts[i + 1]
        if last < first - LEAST:
            raise InputError(
                f"{part.what} is too short for the blends at both of its ends; give them smaller radii than "
                f"{run[i - 1].radius:g} and {part.radius:g} m."
            )
        if last - first > LEAST:
            curves.append((f"move {part.number}", _straight(part, first, last, q)))
            q = _end(curves[-1][1])
        if i < len(blends):
            curve = blends[i][1]
            if isinstance(curve, ToolBlend):
                curve = part.joints.along(curve, 0.0, 2.0 * cuts[i + 1], q, part.what)
            curves.append((f"blend {part.number}", curve))
            q = _end(curve)
    last = len(curves) - 1
    return [
        _Stretch(name, curve, None if k else 0.0, None if k < last else 0.0) for k, (name, curve) in enumerate(curves)
    ]


def _end(curve: PiecewisePolynomial) -> Array:
    return curve(curve.breaks[-1])


def _straight(part: ProgramPart, first: float, last: float, near: Array) -> PiecewisePolynomial:
    if isinstance(part.move, ToolMove):
        return part.joints.along(part.move, first, last, near, part.what)
    values = np.array([part.move.state(s)[0] for s in (first, last)])
    return PiecewisePolynomial(np.array([first, last]), [np.array([0.0, 1.0])], [values])
