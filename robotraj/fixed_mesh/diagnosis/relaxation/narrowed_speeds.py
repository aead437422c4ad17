"""Motions of legs under wide speed limits, followed to the limits of the robot.

A jump that the motors barely allow is far from its guess, and so are its relaxed rows: solves end at their iteration
limits. Without speed limits the same motion takes some ten iterations. The limits are therefore narrowed step by step,
each motion the guess of the next. At the robot's own limits the motion is a guess of the problem itself. Otherwise the
last motion shows which joints must turn faster.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from robotraj._util.errors import RobotrajError
from robotraj.fixed_mesh.coarse import CoarseSolves
from robotraj.problem.constraints.base import Constraint
from robotraj.problem.constraints.bounds import Between
from robotraj.problem.constraints.joint_limits import JointVelocity
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.robot.limits import Limits
from robotraj.solution.conflict import NOTICED, Conflict, with_room
from robotraj.solution.phase_solution import PhaseSolution
from robotraj.solution.solution import Solution

WIDTHS = (np.inf, 4.0, 2.0, 1.5, 1.2, 1.1, 1.05, 1.0)
"""Factors on the speed limits, one after the other."""


def narrowed_speeds(problem: Problem, coarse: CoarseSolves) -> tuple[tuple[Conflict, ...], Solution | None]:
    """Return the speed limits beyond which the last motion is, or a motion within them; neither if none was found.

    Parameters
    ----------
    problem : Problem
    coarse : CoarseSolves
    """
    if not any(
        np.isfinite(limits.sides("velocity")).any() for limits in map(_limits, problem.phases) if limits is not None
    ):
        return (), None
    motion: Solution | None = None
    for width in WIDTHS:
        wider = Problem([_widened(phase, width) for phase in problem.phases], problem.links)
        try:
            found = coarse.solve(wider, motion)
        except RobotrajError:
            return (), None
        if not found.success:
            return (() if motion is None else _exceeded(problem, motion)), None
        motion = found
    return (), motion


def _limits(phase: Phase) -> Limits | None:
    """Return the limits of a phase with its tightest speeds: margins of gaits are bounds beside the limits."""
    if phase.robot is None or not isinstance(phase.limits, Limits):
        return None
    bounds = phase.rows.limits() if any(map(_is_margin, phase.constraints)) else {}
    tight = {joint: bounds.get(f"v.{joint}", (-np.inf, np.inf)) for joint in phase.robot.velocity_names}
    finite = {joint: pair for joint, pair in tight.items() if pair[0] < 0.0 < pair[1]}
    return phase.limits.with_(velocity=finite) if finite else phase.limits


def _is_margin(constraint: Constraint) -> bool:
    """Return whether a constraint bounds the speeds of joints in both directions."""
    if not isinstance(constraint, JointVelocity) or not isinstance(constraint.bounds, Mapping):
        return False
    pairs = constraint.bounds.values()
    return all(isinstance(pair, Between) and _straddles(pair) for pair in pairs)


def _straddles(pair: Between) -> bool:
    low, high = (-np.inf if pair.lower is None else pair.lower, np.inf if pair.upper is None else pair.upper)
    return bool(np.all(np.asarray(low, dtype=float) < 0.0) and np.all(np.asarray(high, dtype=float) > 0.0))


def _widened(phase: Phase, width: float) -> Phase:
    """Return a phase with speed limits that are wider by a factor, or without any."""
    limits = _limits(phase)
    if limits is None:
        return phase
    others = [constraint for constraint in phase.constraints if not _is_margin(constraint)]
    return phase.with_(limits=limits.scaled(velocity=width), constraints=others)


def _exceeded(problem: Problem, motion: Solution) -> tuple[Conflict, ...]:
    """Return the speed limits that a motion exceeds, the largest relative excess first; once for each joint."""
    found = [each for phase, part in zip(problem.phases, motion.phases, strict=True) for each in _of(phase, part)]
    greatest: dict[str, Conflict] = {}
    for conflict in sorted(found, key=lambda conflict: -conflict.relative):
        greatest.setdefault(conflict.name, conflict)
    return tuple(greatest.values())


def _of(phase: Phase, part: PhaseSolution) -> list[Conflict]:
    limits, robot = _limits(phase), phase.robot
    if limits is None or robot is None:
        return []
    speeds = part.trajectory.x(part.points)[:, robot.nq : robot.nq + robot.nv]
    reason, found = "a motion was found with these speeds", []
    for i, joint in enumerate(robot.velocity_names):
        low, high = (float(side[i]) for side in limits.sides("velocity"))
        # Limits of one magnitude are stated as that.
        kinds = [(high, np.abs(speeds[:, i]))] if low == -high else [(low, -speeds[:, i]), (high, speeds[:, i])]
        for bound, along in kinds:
            place = int(np.argmax(along))
            excess = float(along[place]) / abs(bound) - 1.0 if bound else 0.0
            if np.isfinite(bound) and excess > NOTICED:
                needed = with_room(bound, float(np.copysign(along[place], bound)))
                unit = "rad/s" if robot.units[i] == "rad" else "m/s"
                time, name = float(part.points[place]), f"velocity limit, {joint}"
                found.append(Conflict(phase.name, name, time, bound, needed, unit, excess, True, reason))
    return found
