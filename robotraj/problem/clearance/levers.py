"""Bounds on how far a joint moves a point of the robot, in any configuration."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from robotraj._util.errors import InputError
from robotraj.robot.collision.placements import joint_tree
from robotraj.robot.robot import Robot

Array = NDArray[np.float64]
Indices = NDArray[np.int_]

UNLIMITED = 10.0
"""Way of a joint that slides without limits [m], beyond which its bound does not hold."""


def levers(robot: Robot, joints: Indices, points: Array) -> Array:
    """Return bounds (n, nv): a point moves by at most ``levers @ abs(v)`` a second [m].

    A joint that turns moves a point at most at the distance of the point from its origin; that is at most the sum of
    the lengths of the links between them. A joint that slides moves every point alike.

    Parameters
    ----------
    robot : Robot
    joints : ndarray of int (n,)
        Joint that carries each point.
    points : ndarray (n, 3)
        In the frame of the joint [m].

    Raises
    ------
    InputError
        A joint is of a kind that turns about no axis and slides along none.
    """
    tree, model = joint_tree(robot), robot.model
    lengths = np.linalg.norm(tree.translations, axis=1)
    ways = np.zeros(len(lengths))
    for j in range(1, len(lengths)):
        joint = model.joints[j]
        if joint.nv == 1 and not tree.turns[j]:
            limits = (robot.limits.position_lower[joint.idx_v], robot.limits.position_upper[joint.idx_v])
            ways[j] = max(abs(limit) if np.isfinite(limit) else UNLIMITED for limit in limits)
        elif joint.nv not in (1, 6):
            raise InputError(f"CollisionFree: the joint {model.names[j]!r} neither turns about an axis nor slides.")
    found = np.zeros((len(joints), robot.nv))
    for row, joint, point in zip(found, joints.tolist(), points, strict=True):
        reach, at = float(np.linalg.norm(point)), joint
        while at > 0:
            own = model.joints[at]
            if own.nv == 6:
                # Linear velocity, then angular velocity about the origin of the root: abs(w) <= sum abs(w_i).
                row[own.idx_v : own.idx_v + 3] = 1.0
                row[own.idx_v + 3 : own.idx_v + 6] = reach
            else:
                row[own.idx_v] = reach if tree.turns[at] else 1.0
            reach += lengths[at] + ways[at]
            at = tree.parents[at]
    return found
