"""Bounds on the speed of a point of the robot per joint velocity, in any configuration."""

from __future__ import annotations

import numpy as np

from robotraj._util.arrays import Array, Indices
from robotraj._util.errors import InputError
from robotraj.robot.collision.placements import joint_tree
from robotraj.robot.robot import Robot

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
    return per_velocity(robot, levers_by_rate(robot, joints, points))


def relative_levers(robot: Robot, joints: Indices, points: Array, first: Indices, second: Indices) -> Array:
    """Return bounds (m, nv) for m pairs of points: their distance changes by at most ``levers @ abs(v)`` a second [m].

    Joints that carry both points do not change their distance.
    """
    own = levers_by_rate(robot, joints, points)
    return per_velocity(robot, across_pairs(robot, joints, first, second, own[first], own[second]))


def across_pairs(robot: Robot, joints: Indices, first: Indices, second: Indices, one: Array, other: Array) -> Array:
    """Return ``one`` (m, rates) where a joint carries the first point alone, ``other`` where the second, else 0."""
    carried = joint_tree(robot).is_carried_by()[joints][:, joints_of_rates(robot)]
    a, b = carried[first], carried[second]
    return np.where(a & ~b, one, 0.0) + np.where(b & ~a, other, 0.0)


def joints_of_rates(robot: Robot) -> Indices:
    """Return the joint of each rate: six of a free-flyer, one of each other joint, followers included."""
    return np.array([i for i, joint in enumerate(robot.model.joints) if i for _ in range(max(joint.nv, 1))], dtype=int)


def per_velocity(robot: Robot, by_rate: Array) -> Array:
    """Add up bounds (n, rates) by entries of v (n, nv); the rate of a follower is its leader's times the multiplier."""
    tree, joints = joint_tree(robot), joints_of_rates(robot)
    found = np.zeros((len(by_rate), robot.nv))
    for rate, joint in enumerate(joints.tolist()):
        entry = robot.model.joints[joint].idx_v + rate - int(np.searchsorted(joints, joint))
        found[:, entry] += abs(tree.scales[joint]) * by_rate[:, rate]
    return found


def levers_by_rate(robot: Robot, joints: Indices, points: Array) -> Array:
    """Return the bounds of ``levers`` (n, rates) per unit rate of every joint [m]."""
    tree, model, steps = joint_tree(robot), robot.model, _steps(robot)
    start = np.searchsorted(joints_of_rates(robot), np.arange(len(steps)))
    found = np.zeros((len(joints), len(joints_of_rates(robot))))
    for row, joint, point in zip(found, joints.tolist(), points, strict=True):
        reach, at = float(np.linalg.norm(point)), joint
        while at > 0:
            own = start[at]
            if model.joints[at].nv == 6:
                # Linear velocity, then angular velocity about the origin of the root: abs(w) <= sum abs(w_i).
                row[own : own + 3] = 1.0
                row[own + 3 : own + 6] = reach
            else:
                row[own] = reach if tree.turns[at] else 1.0
            reach += steps[at]
            at = tree.parents[at]
    return found


def levers_across(robot: Robot, joints: Indices, points: Array) -> Array:
    """Return bounds (n, rates) on the distance of points from the axes of joints that do not move them [m].

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
    tree, steps, rates = joint_tree(robot), _steps(robot), joints_of_rates(robot)
    between = np.zeros((len(steps), len(steps)))
    for j in range(1, len(steps)):
        # The parent of a joint has a lower number, so that joint k < j is not beyond joint j.
        between[j, :j] = between[:j, j] = between[tree.parents[j], :j] + steps[j]
    reach = np.linalg.norm(points, axis=1)[:, None] + between[joints]
    found = np.ones((len(joints), len(rates)))
    for rate, joint in enumerate(rates.tolist()):
        if robot.model.joints[joint].nv > 1:
            found[:, rate] = np.inf
        elif tree.turns[joint]:
            found[:, rate] = reach[:, joint]
    return found


def _steps(robot: Robot) -> Array:
    """Return bounds (njoints,) on the distance between the origins of joints and of their parents [m]."""
    tree, model = joint_tree(robot), robot.model
    steps = np.linalg.norm(tree.translations, axis=1)
    for j in range(1, len(steps)):
        joint = model.joints[j]
        if joint.nv < 2 and not tree.turns[j]:
            limits = (robot.limits.position_lower[joint.idx_v], robot.limits.position_upper[joint.idx_v])
            ends = (tree.scales[j] * limit + tree.offsets[j] for limit in limits)
            steps[j] += max(abs(end) if np.isfinite(end) else UNLIMITED for end in ends)
        elif joint.nv == 6:
            steps[j] = np.inf
        elif joint.nv > 1:
            raise InputError(
                f"Distances: joint {model.names[j]!r} is neither revolute nor prismatic; lock it with locked=."
            )
    return steps
