"""The joints of legs, and their pairs on both sides."""

from __future__ import annotations

from collections.abc import Mapping

from robotraj.robot.robot import Robot
from robotraj.robot.root import root_of


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
