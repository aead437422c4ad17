"""Bounds on the speed of a point of the robot per joint velocity, in any configuration."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from robotraj._util.errors import InputError
from robotraj.robot.collision.placements import joint_tree
from robotraj.robot.robot import Robot

Array = NDArray[np.float64]
Indices = NDArray[np.int_]

UNLIMITED = 10.0
"""Assumed range of a prismatic joint without limits [m]; the bounds hold inside it."""


def levers(robot: Robot, joints: Indices, points: Array) -> Array:
    """Return bounds (n, nv): a point moves by at most ``levers @ abs(v)`` a second [m].

    A revolute joint at unit velocity moves a point at most at the distance of the point from the joint's origin. This
    distance is at most the sum of the lengths of the links between them. A prismatic joint moves all points alike.

    Parameters
    ----------
    robot : Robot
    joints : ndarray of int (n,)
        Joint that carries each point.
    points : ndarray (n, 3)
        Coordinates in the frame of the joint [m].

    Raises
    ------
    InputError
        A joint is neither revolute, prismatic nor a free-flyer.
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
            raise InputError(
                f"Distances: joint {model.names[j]!r} is neither revolute nor prismatic; lock it with locked=."
            )
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
