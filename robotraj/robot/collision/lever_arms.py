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
    steps = _steps(robot)
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
            reach += steps[at]
            at = tree.parents[at]
    return found


def levers_across(robot: Robot, joints: Indices, points: Array) -> Array:
    """Return bounds (n, nv) on the distance of points from the axes of joints that do not move them [m].

    They are infinite across a free-flyer, and 1 for prismatic joints, as in ``levers``. A joint between two bodies
    changes their distance at most at the lesser distance of both nearest points from its axis: with n along p - q,
    n' (w x p) = n' (w x q).

    Parameters
    ----------
    robot : Robot
    joints : ndarray of int (n,)
        Joint that carries each point.
    points : ndarray (n, 3)
        Coordinates in the frame of the joint [m].
    """
    tree, model, steps = joint_tree(robot), robot.model, _steps(robot)
    between = np.zeros((len(steps), len(steps)))
    for j in range(1, len(steps)):
        # The parent of a joint has a lower number, so that joint k < j is not beyond joint j.
        between[j, :j] = between[:j, j] = between[tree.parents[j], :j] + steps[j]
    reach = np.linalg.norm(points, axis=1)[:, None] + between[joints]
    found = np.ones((len(joints), robot.nv))
    for j in range(1, len(steps)):
        own = model.joints[j]
        if own.nv != 1 or tree.turns[j]:
            found[:, own.idx_v : own.idx_v + own.nv] = (reach[:, j] if own.nv == 1 else np.full(len(joints), np.inf))[
                :, None
            ]
    return found


def _steps(robot: Robot) -> Array:
    """Return bounds (njoints,) on the distance between the origins of joints and of their parents [m]."""
    tree, model = joint_tree(robot), robot.model
    steps = np.linalg.norm(tree.translations, axis=1)
    for j in range(1, len(steps)):
        joint = model.joints[j]
        if joint.nv == 1 and not tree.turns[j]:
            limits = (robot.limits.position_lower[joint.idx_v], robot.limits.position_upper[joint.idx_v])
            steps[j] += max(abs(limit) if np.isfinite(limit) else UNLIMITED for limit in limits)
        elif joint.nv == 6:
            steps[j] = np.inf
        elif joint.nv != 1:
            raise InputError(
                f"Distances: joint {model.names[j]!r} is neither revolute nor prismatic; lock it with locked=."
            )
    return steps
