"""Placements of a robot's joints at many configurations in one call."""

from __future__ import annotations

from weakref import WeakKeyDictionary

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj._util.values import dataclass
from robotraj.robot.coupling.mimics import mimics_of
from robotraj.robot.robot import Robot

_TINY = 1e-12


@dataclass(frozen=True, eq=False)
class JointTree:
    """The parameters of a model that determine the placements of its joints.

    Attributes
    ----------
    parents : tuple of int
        Parent of each joint; joint 0 is the world.
    rotations, translations : ndarray (njoints, 3, 3), (njoints, 3)
        Placement of each joint in its parent's frame at q = 0 [m].
    axes : ndarray (njoints, 3)
        Unit axis of each joint in its own frame; zero for a free-flyer.
    turns : ndarray of bool (njoints,)
        True for joints that turn about their axis, False for those that slide along it.
    first : tuple of int
        Index of each joint's first position in q; of a follower, that of its leader.
    scales, offsets : ndarray (njoints,)
        A follower is at scale * q + offset; other joints have scale 1 and offset 0.
    leaders : tuple of int
        The joint that each joint follows; itself if it is independent.
    """

    parents: tuple[int, ...]
    rotations: Array
    translations: Array
    axes: Array
    turns: npt.NDArray[np.bool_]
    first: tuple[int, ...]
    scales: Array
    offsets: Array
    leaders: tuple[int, ...]

    def is_carried_by(self) -> npt.NDArray[np.bool_]:
        """Return which joints carry each joint: entry (i, j) is whether j is i or above it."""
        count = len(self.parents)
        carried = np.eye(count, dtype=bool)
        for i in range(1, count):
            carried[i] |= carried[self.parents[i]]
        carried[:, 0] = False
        return carried

    def moving_both(self, joint: int, other: int) -> npt.NDArray[np.int_]:
        """Return the joints that carry two joints alike.

        There are none if one of them leads a joint that carries only one of the two.
        """
        carried = self.is_carried_by()
        both, one = np.flatnonzero(carried[joint] & carried[other]), np.flatnonzero(carried[joint] ^ carried[other])
        leaders = np.array(self.leaders)
        return both[:0] if np.isin(leaders[one], leaders[both]).any() else both


_TREES: WeakKeyDictionary[Robot, JointTree] = WeakKeyDictionary()


def joint_tree(robot: Robot) -> JointTree:
    """Return the tree of a robot's joints; it is computed once per robot."""
    known = _TREES.get(robot)
    if known is None:
        known = _TREES[robot] = _tree(robot.model)
    return known


def placements(robot: Robot, q: Array) -> tuple[Array, Array]:
    """Return rotations (m, njoints, 3, 3) and origins (m, njoints, 3) [m] of the joints in the world.

    Parameters
    ----------
    robot : Robot
    q : ndarray (m, nq)
        Configurations.
    """
    tree, count = joint_tree(robot), len(q)
    rotations = np.empty((count, len(tree.parents), 3, 3))
    origins = np.zeros((count, len(tree.parents), 3))
    rotations[:, 0] = np.eye(3)
    for i in range(1, len(tree.parents)):
        parent, at = rotations[:, tree.parents[i]], tree.first[i]
        rotation = parent @ tree.rotations[i]
        origin = origins[:, tree.parents[i]] + parent @ tree.translations[i]
        axis, place = tree.axes[i], tree.scales[i] * q[:, at] + tree.offsets[i]
        if not axis.any():
            origin = origin + (rotation @ q[:, at : at + 3, None])[:, :, 0]
            rotation = rotation @ _of_quaternions(q[:, at + 3 : at + 7])
        elif tree.turns[i]:
            rotation = rotation @ _turned(axis, place)
        else:
            origin = origin + (rotation @ axis) * place[:, None]
        rotations[:, i], origins[:, i] = rotation, origin
    return rotations, origins


def _turned(axis: Array, angle: Array) -> Array:
    """Rotations about a unit axis, (m, 3, 3), by Rodrigues's formula."""
    x, y, z = axis
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    sine, cosine = np.sin(angle)[:, None, None], np.cos(angle)[:, None, None]
    return np.asarray(np.eye(3) + sine * cross + (1.0 - cosine) * (cross @ cross))


def _of_quaternions(quaternions: Array) -> Array:
    """Rotation matrices (m, 3, 3) of unit quaternions (m, 4) as (x, y, z, w)."""
    vector, w = quaternions[:, :3], quaternions[:, 3]
    cross = np.zeros((len(quaternions), 3, 3))
    for i, (row, column) in enumerate(((2, 1), (0, 2), (1, 0))):
        cross[:, row, column], cross[:, column, row] = vector[:, i], -vector[:, i]
    return np.asarray(np.eye(3) + 2.0 * (w[:, None, None] * cross + cross @ cross))


def _tree(model: pin.Model) -> JointTree:
    neutral = pin.neutral(model)
    axes, turns = np.zeros((model.njoints, 3)), np.zeros(model.njoints, dtype=bool)
    scales, offsets, leaders = np.ones(model.njoints), np.zeros(model.njoints), list(range(model.njoints))
    for mimic in mimics_of(model):
        i = model.getJointId(mimic.follower)
        scales[i], offsets[i], leaders[i] = mimic.multiplier, mimic.offset, model.getJointId(mimic.leader)
    for i in range(1, model.njoints):
        joint = model.joints[i]
        if joint.nv > 1:
            continue
        data = joint.createData()
        joint.calc(data, neutral)
        linear, angular = np.split(np.array(data.S).reshape(6) / scales[i], 2)
        turns[i] = bool(np.linalg.norm(angular) > _TINY)
        axes[i] = angular if turns[i] else linear
    return JointTree(
        tuple(int(parent) for parent in model.parents),
        np.array([placement.rotation for placement in model.jointPlacements]),
        np.array([placement.translation for placement in model.jointPlacements]),
        axes,
        turns,
        tuple(max(int(joint.idx_q), 0) if i else 0 for i, joint in enumerate(model.joints)),
        scales,
        offsets,
        tuple(leaders),
    )
