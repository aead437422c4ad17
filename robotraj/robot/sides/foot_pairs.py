"""Pairs of feet that keep their order: a left and a right foot, or a fore and a hind foot whose legs share a plane."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj.robot.coupling.dynamics import joint_axes
from robotraj.robot.robot import Robot
from robotraj.robot.root import root_of
from robotraj.robot.sides.other_side import other_side

PARALLEL = 1e-3
"""Largest component, off the y axis of the root, of the unit axis of a joint that turns in the plane x-z."""


class FootPair(NamedTuple):
    """Two feet that stay on their own sides of each other.

    Attributes
    ----------
    first, second : str
        Frames of the feet.
    across : tuple of 3 float
        Unit vector from the second foot to the first one, horizontal in the given posture, in the axes of the root.
    distance : float
        Distance of both feet along ``across`` in the posture [m].
    """

    first: str
    second: str
    across: tuple[float, float, float]
    distance: float


def foot_pairs(robot: Robot, feet: Sequence[str], posture: Array) -> tuple[FootPair, ...]:
    """Return the pairs of feet that keep their order along y or along x of the root.

    Left and right feet are those whose names differ by their side, or the only two feet, if they stand beside each
    other. There are none without a floating root, which alone can turn and step sideways. Fore and hind feet are those
    of one side whose legs move in planes parallel to x-z and hang from hips one behind the other: such a leg cannot
    step aside, so that it would pass through the other one.

    Parameters
    ----------
    robot : Robot
    feet : sequence of str
        Frames of the feet.
    posture : ndarray (nq,)
        Configuration in which the feet are on their own sides.
    """
    if robot.root == "fixed":
        return ()
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, posture)
    turn = data.oMi[root_joint(robot)].rotation
    places = {foot: np.array(data.oMf[robot.frame(foot)].translation) for foot in feet}
    beside = _beside(robot, feet, places, turn) if robot.root == "floating" else []
    found = [*((*pair, 1) for pair in beside), *((*pair, 0) for pair in _behind(robot, feet))]
    pairs = []
    for first, second, axis in found:
        level = turn[:, axis] * [1.0, 1.0, 0.0]
        level /= np.linalg.norm(level)
        distance = float((places[first] - places[second]) @ level)
        x, y, z = (float(v) for v in turn.T @ level * np.copysign(1.0, distance))
        pairs.append(FootPair(first, second, (x, y, z), abs(distance)))
    return tuple(pairs)


def root_joint(robot: Robot) -> int:
    """Return the last joint of the root, which carries the root link; 0, the world, for a fixed one."""
    return len(root_of(robot.root).joints)


def _beside(robot: Robot, feet: Sequence[str], places: dict[str, Array], turn: Array) -> list[tuple[str, str]]:
    """Return the pairs of a left and a right foot."""
    partners = dict(zip(feet, reversed(feet), strict=True)) if len(feet) == 2 else {}
    named = {foot: other_side(foot, feet) for foot in feet}
    found: dict[frozenset[str], tuple[str, str]] = {}
    for foot in feet:
        other = named[foot] if named[foot] != foot else partners.get(foot, foot)
        if other == foot or frozenset((foot, other)) in found:
            continue
        apart = places[foot] - places[other]
        # Feet of one side are no such pair: they are apart along x of the root, or above each other.
        local = turn.T @ (apart * [1.0, 1.0, 0.0])
        if abs(local[1]) > abs(local[0]) and abs(local[1]) > abs(apart[2]):
            found[frozenset((foot, other))] = foot, other
    return list(found.values())


def _behind(robot: Robot, feet: Sequence[str]) -> list[tuple[str, str]]:
    """Return the pairs of a fore and a hind foot of one side whose legs share a plane."""
    model, data, first = robot.model, robot.model.createData(), root_joint(robot)
    axes = joint_axes(model, data, robot.neutral)
    turn, origin = data.oMi[first].rotation, data.oMi[first].translation
    hips: dict[str, Array] = {}
    for foot in feet:
        legs = [i for i in model.supports[model.frames[robot.frame(foot)].parentJoint] if i > first]
        columns = [model.joints[i].idx_v for i in legs if model.joints[i].nv]
        angular = turn.T @ axes[3:, columns]
        turning = np.linalg.norm(angular, axis=0) > PARALLEL
        sliding = np.abs(turn[:, 1] @ axes[:3, columns])
        if legs and np.all(np.where(turning, np.abs(angular[[0, 2]]).max(axis=0), sliding) < PARALLEL):
            hips[foot] = turn.T @ (data.oMi[legs[0]].translation - origin)
    return [
        (a, b)
        for a, b in combinations(hips, 2)
        # Legs that hang from one place swing past each other.
        if hips[a][1] * hips[b][1] >= 0.0 and abs(hips[a][0] - hips[b][0]) > abs(hips[a][1] - hips[b][1])
    ]
