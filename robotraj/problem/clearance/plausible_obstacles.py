"""Warnings of obstacles whose lengths are in millimetres, or whose quaternions have w first."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from robotraj._util.errors import warn
from robotraj.dynamics.obstacles.base import Obstacle
from robotraj.problem.constraints.base import Constraint
from robotraj.problem.constraints.collision_free import CollisionFree
from robotraj.robot.loading.other_units import in_other_unit
from robotraj.robot.robot import Robot
from robotraj.robot.size.reach import reach

FAR = 20.0
"""Distance of an obstacle, or its depth, relative to the reach of the robot above which its unit is doubtful."""
EXACT = 1e-9
"""Largest entry of a quaternion that counts as 0."""


def warn_of_obstacles(phase: str, constraints: Iterable[Constraint], robot: Robot) -> None:
    """Warn of obstacles out of all proportion to the robot, and of quaternions that seem to have w first.

    Warns
    -----
    UserWarning
    """
    free = [each for each in constraints if isinstance(each, CollisionFree)]
    obstacles = [obstacle for each in free for obstacle in each.obstacles]
    margin, far = max((float(each.margin) for each in free), default=0.0), reach(robot.model)
    if margin > far > 0.0:
        warn(
            f"Phase {phase!r}: the margin of CollisionFree is {margin:g} m, and the robot reaches {far:.2g} m. "
            f"{in_other_unit(margin, 'm')}"
        )
    _warn_of_lengths(phase, obstacles, robot)
    for obstacle in obstacles:
        _warn_of_order(phase, obstacle)


def _warn_of_lengths(phase: str, obstacles: Iterable[Obstacle], robot: Robot) -> None:
    """Warn of obstacles that are far from a robot that stands still, or far larger than it."""
    if robot.root != "fixed":
        return
    slides = [i for i, unit in enumerate(robot.units) if unit == "m"]
    limits = robot.limits
    span = reach(robot.model) + float(
        np.sum(np.maximum(np.abs(limits.position_lower[slides]), np.abs(limits.position_upper[slides])))
    )
    if not 0.0 < span < np.inf:
        return
    base = robot.model.jointPlacements[1].translation
    found = []
    for obstacle in obstacles:
        position, rotation = (np.asarray(part, dtype=float) for part in obstacle.pose(0.0))
        origin = np.zeros(3) if obstacle.frame is not None else base
        (away,) = obstacle.distance(((origin - position) @ rotation)[None, :])
        (depth,) = -obstacle.distance(np.zeros((1, 3)))
        if away > FAR * span:
            found.append(f"{obstacle.label!r} is {away:.4g} m away")
        elif depth > FAR * span:
            found.append(f"{obstacle.label!r} is solid for {depth:.4g} m around its centre")
    if found:
        more = f", and {len(found) - 1} more are as doubtful" if len(found) > 1 else ""
        warn(
            f"Phase {phase!r}: the robot reaches {span:.2g} m, and the obstacle {found[0]}{more}. Lengths and "
            "positions are in metres: 500 mm are 0.5 m."
        )


def _warn_of_order(phase: str, obstacle: Obstacle) -> None:
    """Warn of a quaternion that is a turn about one axis by less than a right angle in the order (w, x, y, z) only.

    (c, 0, 0, s) with c > s turns about x by more than a right angle, which nobody writes for a shape that is symmetric;
    as (w, x, y, z) it is a turn about z by less. (c, s, 0, 0) and (c, 0, s, 0) are half turns about oblique axes.
    """
    if callable(obstacle.quaternion) or obstacle.kind == "sphere":
        return
    first, *rest = np.abs(np.array(obstacle.quaternion, dtype=float))
    others = [value for value in rest if value > EXACT]
    if len(others) == 1 and first > others[0] + EXACT:
        values = ", ".join(f"{value:.6g}" for value in obstacle.quaternion)
        angle = 2.0 * np.degrees(np.arctan2(others[0], first))
        axis = "xyz"[int(np.argmax(rest))]
        warn(
            f"Phase {phase!r}: the obstacle {obstacle.label!r} has the quaternion (x, y, z, w) = ({values}). In the "
            f"order (w, x, y, z) it would be a turn about {axis} by {angle:.3g} degrees; if that is meant, put w last."
        )
