"""Pose of the root link, gravity and rotors of a robot."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TypeAlias

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from robotraj._util.errors import InputError, unknown_name
from robotraj.robot.configuration import unit_quaternion
from robotraj.robot.loading.planning_model import has_free_flyer
from robotraj.robot.loading.source import Description
from robotraj.robot.robot import Robot

Base: TypeAlias = "pin.SE3 | tuple[Sequence[float], Sequence[float]]"
"""A pose, or a position [m] and a quaternion (x, y, z, w)."""


def placed(about: Description, base: Base) -> Description:
    """Return a description whose root link has a pose in the world; with a moving root, in the axes of that root.

    Parameters
    ----------
    about : Description
        Of a model that is not rooted yet, or that starts with a free-flyer.
    base : pinocchio.SE3 or (position, quaternion)

    Raises
    ------
    InputError
        The pose is none.
    """
    pose, model = _pose(base), about.model.copy()
    root = 1 if has_free_flyer(model) else 0
    for joint in range(root + 1, model.njoints):
        if model.parents[joint] == root:
            model.jointPlacements[joint] = pose * model.jointPlacements[joint]
    model.inertias[root] = pose.act(model.inertias[root])
    for frame in list(model.frames)[1:]:
        if frame.parentJoint == root and not (root and frame.name == model.names[root]):
            frame.placement = pose * frame.placement
    if not isinstance(about.geometry, tuple):
        return replace(about, model=model)
    shapes = tuple(each.copy() for each in about.geometry)
    for shape in (shape for each in shapes for shape in each.geometryObjects if shape.parentJoint == root):
        shape.placement = pose * shape.placement
    return replace(about, model=model, geometry=(shapes[0], shapes[1]))


def mounted(
    robot: Robot,
    gravity: ArrayLike | None = None,
    rotors: Mapping[str, tuple[float, float]] | None = None,
) -> Robot:
    """Return a robot with another gravity and rotors.

    Parameters
    ----------
    robot : Robot
    gravity : array (3,), optional
        Gravity in the world [m/s^2].
    rotors : mapping of str to (float, float), optional
        Inertia of the rotor [kg m^2] and gear ratio n by joint. Armature = inertia n^2 replaces that of the joint.

    Raises
    ------
    InputError
        A number is not finite, or a joint is unknown.
    """
    model = robot.model.copy()
    if gravity is not None:
        pull = np.array(gravity, dtype=float)
        if pull.shape != (3,) or not np.isfinite(pull).all():
            raise InputError(f"gravity= is {gravity!r}; give three finite numbers [m/s^2].")
        model.gravity.linear = pull
    for joint, rotor in (rotors or {}).items():
        if joint not in robot.velocity_names:
            raise unknown_name("joint", joint, robot.velocity_names, "Correct the name in rotors=.")
        if np.shape(rotor) != (2,) or not np.isfinite(rotor).all() or rotor[0] < 0:
            raise InputError(f"The rotor of {joint!r} is {rotor!r}; give (inertia [kg m^2], gear ratio).")
        model.armature[robot.velocity_names.index(joint)] = rotor[0] * rotor[1] ** 2
    return replace(robot, model=model)


def _pose(base: Base) -> pin.SE3:
    if isinstance(base, pin.SE3):
        base = base.translation.tolist(), pin.Quaternion(base.rotation).coeffs().tolist()
    if not isinstance(base, Sequence) or len(base) != 2 or np.shape(base[0]) != (3,) or np.shape(base[1]) != (4,):
        raise InputError(f"base= is {base!r}; give a pinocchio.SE3, or position (3,) and quaternion (x, y, z, w).")
    place, turn = np.array(base[0], dtype=float), unit_quaternion(base[1], "quaternion of base=")
    if not np.isfinite(place).all():
        raise InputError(f"base= has the position {base[0]!r}; give three finite numbers [m].")
    return pin.SE3(pin.Quaternion(turn).matrix(), place)
