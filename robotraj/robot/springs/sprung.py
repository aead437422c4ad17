"""``springs=`` of ``rt.load``: a robot with springs at its joints."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from robotraj._util.errors import InputError, unknown_name
from robotraj.robot.coupling.mimics import Mimic
from robotraj.robot.robot import Robot
from robotraj.robot.springs.joint_springs import Spring


def sprung(robot: Robot, springs: Mapping[str, float | tuple[float, float]]) -> Robot:
    """Return the robot with springs in place of its own.

    Parameters
    ----------
    robot : Robot
    springs : mapping
        By joint the stiffness, ``{"knee": 20.0}``, or stiffness and rest, ``{"knee": (20.0, -0.5)}``. A joint that
        follows another may have one: it counts at the leader.

    Raises
    ------
    InputError
        A joint is unknown or of a floating root, or a number is not finite or a stiffness negative.
    """
    if not isinstance(springs, Mapping):
        raise InputError(f"springs= is a mapping such as {{'knee': (20.0, -0.5)}}; got {springs!r}.")
    followers = {mimic.follower: mimic for mimic in robot.followers}
    joints = tuple(robot.velocity_names[robot.limits.free :])
    found = []
    for joint, given in springs.items():
        if joint not in joints and joint not in followers:
            raise unknown_name("joint", joint, (*joints, *followers), "Correct the name in springs=.")
        numbers = np.atleast_1d(np.asarray(given, dtype=float)) if np.shape(given) in ((), (2,)) else np.zeros(0)
        if not numbers.size or not np.isfinite(numbers).all() or numbers[0] < 0.0:
            raise InputError(
                f"The spring of {joint!r} is {given!r}; give its stiffness [N m/rad, N/m], or (stiffness, rest)."
            )
        stiffness, rest = float(numbers[0]), float(numbers[1]) if numbers.size == 2 else 0.0
        found.append(_at_leader(followers[joint], stiffness, rest) if joint in followers else (joint, stiffness, rest))
    return replace(robot, springs=_one_each(found, joints))


def _at_leader(mimic: Mimic, stiffness: float, rest: float) -> Spring:
    """Return the spring at a leader with the torque that one at its follower has there."""
    return mimic.leader, mimic.multiplier**2 * stiffness, mimic.of_leader(rest)


def _one_each(springs: Sequence[Spring], joints: Sequence[str]) -> tuple[Spring, ...]:
    """Add up springs at one joint: k = sum k_i, rest = sum k_i rest_i / k."""
    found = []
    for joint in joints:
        own = np.array([spring[1:] for spring in springs if spring[0] == joint and spring[1] > 0.0]).reshape(-1, 2)
        if own.size:
            total = float(own[:, 0].sum())
            found.append((joint, total, float(own[:, 0] @ own[:, 1]) / total))
    return tuple(found)
