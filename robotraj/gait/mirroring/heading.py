"""The direction that a legged robot faces, and the one that is up, from its legs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from robotraj._util.errors import InputError
from robotraj.robot.coupling.dynamics import joint_axes
from robotraj.robot.robot import Robot
from robotraj.robot.root import root_of

ALONG = 0.9
"""Least component of an axis along a direction."""
DOWN = 0.3
"""Least component of the legs' direction along -z; crouched and sprawled legs have more than half."""
FOLDED = 0.5
"""Distance of the feet from the hips, relative to the length of the legs, up to which folded legs point nowhere."""


def check_up(robot: Robot, feet: Sequence[str]) -> None:
    """Check that the legs of a robot point down in its neutral configuration, unless they are folded there.

    Raises
    ------
    InputError
        They point along another axis, as in files whose y axis is up; the message has the call that turns the robot.
    """
    model, data = robot.model, robot.model.createData()
    pin.framesForwardKinematics(model, data, robot.neutral)
    legs, length = [np.zeros(3)], 0.0
    for foot in feet:
        chain = joints_of_leg(robot, foot)
        if chain:
            places = [*(data.oMi[joint].translation for joint in chain), data.oMf[robot.frame(foot)].translation]
            legs.append(places[-1] - places[0])
            length += float(np.linalg.norm(np.diff(places, axis=0), axis=1).sum())
    down = np.sum(legs, axis=0)
    if robot.root == "fixed" or -down[2] > DOWN * np.linalg.norm(down) or np.linalg.norm(down) <= FOLDED * length:
        return
    axis = int(np.argmax(np.abs(down)))
    if abs(down[axis]) < ALONG * np.linalg.norm(down):
        return
    side = np.sign(down[axis]) * np.eye(3)[axis]
    up = f"{'-' if down[axis] > 0 else ''}{'xyz'[axis]}"
    turn = pin.Quaternion.FromTwoVectors(side, np.array([0.0, 0.0, -1.0]))
    raise InputError(
        f"The legs of {robot.name!r} point against its {up} axis, so that axis is up in its file. Gaits need z up: "
        f"{_call(robot, turn.coeffs())}."
    )


def check_heading(robot: Robot, feet: Sequence[str]) -> None:
    """Check that a floating robot does not face sideways: knees and most hips turn about the axis from left to right.

    Raises
    ------
    InputError
        Of the joints of its legs, more have axes along x than along y; the message has the call that turns the robot.
    """
    if robot.root != "floating":
        return
    model, data = robot.model, robot.model.createData()
    legs = {joint for foot in feet for joint in joints_of_leg(robot, foot)}
    columns = [model.joints[joint].idx_v for joint in sorted(legs) if model.joints[joint].nv]
    axes = np.abs(joint_axes(model, data, robot.neutral)[3:, columns])
    along_x, along_y = (int(np.sum(axes[k] > ALONG)) for k in (0, 1))
    if along_x > along_y:
        other = "(0, 0, 0.7071068, 0.7071068)"
        raise InputError(
            f"{robot.name!r} faces along y: {along_x} joints of its legs turn about x and {along_y} about y. Gaits "
            f"move along x. If it faces +y: {_call(robot, (0.0, 0.0, -0.7071068, 0.7071068))}. If it faces -y, with "
            f"{other}."
        )


def _call(robot: Robot, quaternion: Sequence[float] | NDArray[np.float64]) -> str:
    """Return the call that turns the robot in its root."""
    numbers = ", ".join(f"{value + 0.0:.7g}" for value in np.round(quaternion, 7))
    return f"rt.load(..., root={robot.root!r}, base=((0, 0, 0), ({numbers})))"


def joints_of_leg(robot: Robot, foot: str) -> list[int]:
    """Return the joints between the root and a foot, the hip first."""
    model, first = robot.model, len(root_of(robot.root).joints)
    return [i for i in model.supports[model.frames[robot.frame(foot)].parentJoint] if i > first]


def leg_pairs(robot: Robot, sides: Mapping[str, str]) -> dict[str, str]:
    """Return the other side of each foot and of each independent joint of its leg, where the legs have as many joints.

    Parameters
    ----------
    robot : Robot
    sides : mapping of str to str
        Foot on the other side of each foot.
    """
    names, joints = robot.model.names, robot.joint_names
    pairs: dict[str, str] = {}
    for foot, other in sides.items():
        legs = [[names[i] for i in joints_of_leg(robot, each) if names[i] in joints] for each in (foot, other)]
        if foot != other and len(legs[0]) == len(legs[1]):
            pairs |= {foot: other, **{a: b for a, b in zip(*legs, strict=True) if a != b}}
    return pairs
