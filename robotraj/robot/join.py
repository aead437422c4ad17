"""``join``: several robots in one problem, as one robot."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TypeAlias

import numpy as np

from robotraj._util.errors import InputError, unknown_name, warn
from robotraj.robot.configuration import unit_quaternion
from robotraj.robot.limits import concatenated
from robotraj.robot.loading.joined import JoinedGeometry, JoinedPart, joined_model
from robotraj.robot.robot import Robot

Pose: TypeAlias = "Sequence[float] | tuple[Sequence[float], Sequence[float]]"
"""Position (x, y, z) [m], or position and quaternion (x, y, z, w)."""


def join(robots: Mapping[str, Robot], at: Mapping[str, Pose] | None = None) -> Robot:
    """Put several robots into one, so that one problem moves all of them.

    Joints and frames get the name of their robot as a prefix, as in ``left_elbow_joint``. q, v and tau are those of the
    robots, concatenated. ``friction_speed`` is the least of robots with dry friction. A constraint may read frames of
    several robots, for example to keep them apart.

    Parameters
    ----------
    robots : mapping of str to Robot
        At least two robots with fixed roots; one robot may have several names.
    at : mapping of str to pose, optional
        Pose of each root in the world: (x, y, z) [m], or ((x, y, z), (x, y, z, w)). The origin by default.

    Returns
    -------
    Robot

    Raises
    ------
    InputError
        Fewer than two robots, a root that moves, another gravity, or an impossible pose.

    Warns
    -----
    UserWarning
        Two roots are in the same place.

    Examples
    --------
    >>> ur5 = rt.load("ur5")
    >>> pair = rt.robot.join({"left": ur5, "right": ur5}, at={"right": (0.8, 0.0, 0.0)})
    """
    if not isinstance(robots, Mapping) or len(robots) < 2:
        raise InputError("rt.robot.join takes two robots or more by name, {'left': ur5, 'right': ur5}.")
    for name, robot in robots.items():
        if not isinstance(robot, Robot) or not isinstance(name, str):
            raise InputError(f"rt.robot.join takes robots of rt.load by name; got {type(robot).__name__} for {name!r}.")
        if robot.root != "fixed":
            raise InputError(f"{name!r} has a {robot.root} root; rt.robot.join takes robots with fixed roots.")
    first = next(iter(robots.values()))
    for name, robot in robots.items():
        if not np.array_equal(robot.model.gravity.vector, first.model.gravity.vector):
            raise InputError(f"{name!r} has another gravity than the first robot; load both alike.")
    if at is not None and not isinstance(at, Mapping):
        raise InputError(f"at= gives poses by the names of the robots, {{{list(robots)[1]!r}: {at!r}}}; got {at!r}.")
    poses = dict(at or {})
    for name in poses:
        if name not in robots:
            raise unknown_name("robot", name, robots, "Correct the name in at=.")
    parts = tuple(
        JoinedPart(f"{name}_", robot.model, robot.geometry, *_pose(name, poses.get(name, (0.0, 0.0, 0.0))))
        for name, robot in robots.items()
    )
    for i, part in enumerate(parts):
        beside = [each.prefix[:-1] for each in parts[:i] if each.position == part.position]
        if beside:
            name = part.prefix[:-1]
            warn(f"{beside[0]!r} and {name!r} stand in the same place; at={{{name!r}: (x, y, z)}} moves one [m].")
    every = tuple(robots.items())

    def names(which: str) -> tuple[str, ...]:
        return tuple(f"{name}_{joint}" for name, robot in every for joint in getattr(robot, which))

    def values(which: str) -> np.ndarray:
        return np.concatenate([getattr(robot, which) for _, robot in every])

    title = " and ".join(f"{name} {robot.name}" for name, robot in every)
    return Robot(
        title,
        joined_model(title, parts),
        concatenated(names("velocity_names"), [robot.limits for _, robot in every]),
        names("actuated"),
        values("damping"),
        values("friction"),
        values("neutral"),
        min((robot.friction_speed for _, robot in every if np.any(robot.friction)), default=first.friction_speed),
        JoinedGeometry(parts),
        "rt.robot.join",
        notes=tuple(f"{name}: {note}" for name, robot in every for note in robot.notes),
        springs=tuple((f"{name}_{joint}", k, rest) for name, robot in every for joint, k, rest in robot.springs),
    )


def _pose(name: str, pose: Pose) -> tuple[tuple[float, float, float], tuple[float, float, float, float]]:
    """Read a position, or a position and a quaternion."""
    try:
        nested = np.ndim(pose[0]) == 1
        position = np.asarray(pose[0] if nested else pose, dtype=float)
        quaternion = np.asarray(pose[1] if nested else (0.0, 0.0, 0.0, 1.0), dtype=float)
    except (TypeError, ValueError, IndexError, KeyError):
        position = quaternion = np.zeros(0)
    if position.shape != (3,) or quaternion.shape != (4,) or not np.isfinite(position).all():
        raise InputError(
            f"at= of {name!r} is {pose!r}; give its position (x, y, z) [m], or position and quaternion (x, y, z, w)."
        )
    x, y, z = position.tolist()
    a, b, c, d = unit_quaternion(quaternion, f"quaternion of {name!r}").tolist()
    return (x, y, z), (a, b, c, d)
