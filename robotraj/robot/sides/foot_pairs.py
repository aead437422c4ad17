"""Pairs of a left and a right foot."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from robotraj.robot.robot import Robot
from robotraj.robot.sides.other_side import other_side

Array = NDArray[np.float64]


class FootPair(NamedTuple):
    """Two feet on different sides of a robot with a floating root.

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
    """Return the pairs whose names differ by their side, or the only two feet, if they stand beside each other.

    There are none without a floating root, which alone can turn and step sideways.

    Parameters
    ----------
    robot : Robot
    feet : sequence of str
        Frames of the feet.
    posture : ndarray (nq,)
        Configuration in which the feet are on their own sides.
    """
    if robot.root != "floating":
        return ()
    partners = dict(zip(feet, reversed(feet), strict=True)) if len(feet) == 2 else {}
    named = {foot: other_side(foot, feet) for foot in feet}
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, posture)
    found: dict[frozenset[str], FootPair] = {}
    for foot in feet:
        other = named[foot] if named[foot] != foot else partners.get(foot, foot)
        if other == foot or frozenset((foot, other)) in found:
            continue
        apart = data.oMf[robot.frame(foot)].translation - data.oMf[robot.frame(other)].translation
        # Feet of one side are no pair: they are apart along x of the root, or above each other.
        local = data.oMi[1].rotation.T @ np.array([apart[0], apart[1], 0.0])
        if abs(local[1]) <= abs(local[0]) or abs(local[1]) <= abs(apart[2]):
            continue
        across = data.oMi[1].rotation.T @ (data.oMi[1].rotation[:, 1] * [1.0, 1.0, 0.0])
        across *= np.sign(local[1]) / np.linalg.norm(across)
        distance = float(local @ across)
        x, y, z = (float(v) for v in across)
        found[frozenset((foot, other))] = FootPair(foot, other, (x, y, z), distance)
    return tuple(found.values())
