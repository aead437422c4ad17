"""The shapes of a phase's robot that must not overlap."""

from __future__ import annotations

import numpy as np

from robotraj._util.errors import InputError
from robotraj.problem.constraints.collision_free import disabled_pairs
from robotraj.problem.phase import Phase
from robotraj.robot.collision.own_body import OwnBody, own_body

MARGIN = 1e-3
"""Least height of points of a link's surface that rows keep above that of another link [m]."""


def own_shapes(phase: Phase) -> OwnBody | None:
    """Return the shapes that must not overlap in a phase; None where there are none, or they cannot be read."""
    robot = phase.robot
    if robot is None or not phase.self_collision or phase.design:
        return None
    try:
        body = own_body(robot, disabled_pairs(phase.constraints))
    except InputError:
        # The URDF or a mesh was removed after the robot was loaded. A plan does not need them; the witness names them.
        return None
    return body if len(body.pairs) else None


def least_at_ends(phase: Phase, body: OwnBody, pair: int) -> tuple[float, float]:
    """Return half the distance of a pair at each end that is fixed [m], infinite at others."""
    assert phase.robot is not None
    least = []
    for bounds in phase.joint_ends.values():
        q = np.asarray(bounds.lower[: phase.robot.nq])
        fixed = np.array_equal(q, bounds.upper[: phase.robot.nq])
        least.append(0.5 * body.distance(phase.robot, q, pair) if fixed else np.inf)
    return least[0], least[1]
