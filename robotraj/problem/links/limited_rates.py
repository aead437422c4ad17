"""Accelerations and torques that are continuous from phase to phase, under limits of their rates on both.

A jump is an infinite rate. Where both phases rest at the link, the limits fix the values on each side already
(``constraints.motors.end_accelerations``), and the motors may hold another load after it than before.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import cast

import casadi as ca
import numpy as np

from robotraj.dynamics.path_body import ACCELERATION, PLACES, RESTING, SPEED, PathPoint
from robotraj.dynamics.point import Point, RobotPoint
from robotraj.dynamics.rigid_body import InverseRigidBody
from robotraj.dynamics.row import Row
from robotraj.problem.augmentation import has
from robotraj.problem.constraints.motors.end_accelerations import can_rest, rests
from robotraj.problem.links.base import Joined
from robotraj.problem.phase import Phase
from robotraj.problem.scalars import Scalar

PATH_ROW = Row("continuity", "1/s^2", 0.0, 0.0, "path acceleration")
"""Continuity of the acceleration along a path."""
KINDS = {"a.": ("a", ("rad/s^2", "m/s^2")), "frictionless.": ("tau", ("N m", "N"))}
"""Quantity and units of what is continuous, by the prefix of the variables with bounded rates.

Speeds are continuous, so that torques are where those without dry friction are."""


def joined_rates(before: Phase, after: Phase, images: Mapping[str, tuple[str, float]] | None = None) -> Joined:
    """Return the rows that make accelerations and torques continuous.

    Parameters
    ----------
    before, after : Phase
    images : mapping of str to (str, float), optional
        For every joint that repeats, the joint at the end of ``before`` whose image it is, and the sign; all joints are
        their own images by default.
    """
    if after.path is not None:
        return _along_path(before, after)
    body, other = before.body, after.body
    if not (isinstance(body, InverseRigidBody) and isinstance(other, InverseRigidBody)):
        return []
    resting = rests(body, before.end_bounds) and rests(other, after.start_bounds)
    if not (can_rest(body) and can_rest(other)) or resting:
        return []
    first, second = ({row.variable: row for row in phase.rows.rates} for phase in (before, after))
    found: Joined = []
    joints = body.robot.velocity_names
    for at, joint in enumerate(joints):
        source, sign = (joint, 1.0) if images is None else images.get(joint, ("", 0.0))
        for prefix, (quantity, units) in KINDS.items():
            if sign and f"{prefix}{source}" in first and f"{prefix}{joint}" in second:
                unit = units[body.robot.units[at] == "m"]
                pair = _difference(quantity, _index(body, quantity, source), _index(other, quantity, joint), sign)
                found.append((Row("continuity", unit, 0.0, 0.0, f"{quantity}.{joint}"), pair))
    return found


def _index(body: InverseRigidBody, quantity: str, joint: str) -> int:
    return (body.robot.velocity_names if quantity == "a" else body.robot.actuated).index(joint)


def _difference(quantity: str, i: int, j: int, sign: float) -> Callable[[Point, Point], Scalar]:
    def value(end: Point, start: Point) -> Scalar:
        return cast("Scalar", getattr(start, quantity)[j] - sign * getattr(end, quantity)[i])

    return value


def _along_path(before: Phase, after: Phase) -> Joined:
    """Return the row along p' at the start of the second path, if s'' is a state of both phases.

    Where p' vanishes the joints rest, and the limits fix their accelerations on each side.
    """
    if after.path is None or not all(has(phase.dae, [f"rate.{ACCELERATION}"]) for phase in (before, after)):
        return []
    curve = after.path.curve
    slope = curve.derivative()(curve.breaks[0])
    size, largest = float(slope @ slope), float(np.abs(curve.derivative().inside(PLACES)).max())
    if size <= (RESTING * max(largest, 1.0)) ** 2:
        return []
    direction = slope / size
    return [(PATH_ROW, lambda end, start: ca.dot(direction, _acceleration(start) - _acceleration(end)))]


def _acceleration(point: Point) -> ca.SX | ca.DM:
    """Return the accelerations of the joints at an end of a path, a = p'' s'^2 + p' s''.

    A point of the witness has them as numbers.
    """
    if not isinstance(point, PathPoint):
        return ca.DM(cast("RobotPoint", point).a)
    first, second = point.slopes[:2]
    return second * point.extra[SPEED] ** 2 + first * point.extra[ACCELERATION]
