"""Pairs of left and right frames by their places, where names do not show them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj.robot.robot import Robot
from robotraj.robot.sides.other_side import other_side

REFLECTION = np.array([1.0, -1.0, 1.0])
NEAR = 0.1
"""Distance of a frame from the image of its partner up to which they are a pair, relative to that between both."""


def places_of(robot: Robot, q: Array) -> dict[str, Array]:
    """Return the position of every frame in the world (3,) [m] at a configuration q (nq,)."""
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, np.asarray(q, dtype=float))
    return {frame.name: np.array(data.oMf[i].translation) for i, frame in enumerate(robot.model.frames)}


def frames_across(robot: Robot, names: Sequence[str], q: Array | None = None) -> dict[str, str]:
    """Return the frame on the other side for each of some frames, the frame itself where there is none.

    Names decide first. Frames without a partner by name are paired where each is the nearest one to the mirror image of
    the other, (x, -y, z), in a configuration: the neutral one by default.
    """
    known = set(names)
    others = {name: other_side(name, known) for name in names}
    places = places_of(robot, robot.neutral if q is None else q)
    left = [name for name in names if others[name] == name]
    at = np.array([places[name] for name in left]).reshape(-1, 3)
    apart = np.linalg.norm(at[:, None] - REFLECTION * at[None], axis=2)
    width = 2.0 * np.abs(at[:, 1])
    for i, name in enumerate(left):
        near = np.flatnonzero(apart[i] <= NEAR * width)
        # Several frames at one place are no pair: their order would decide.
        if len(near) == 1 and near[0] != i and np.count_nonzero(apart[near[0]] <= NEAR * width) == 1:
            others[name] = left[int(near[0])]
    return others
