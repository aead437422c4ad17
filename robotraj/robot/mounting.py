"""Gravity, pose of the base and rotors of a robot."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from robotraj._util.errors import InputError, unknown_name
from robotraj.robot.configuration import unit_quaternion
from robotraj.robot.loading.joined import JoinedGeometry, JoinedPart, joined_model

if TYPE_CHECKING:
    from robotraj.robot.robot import Robot

Base: TypeAlias = "pin.SE3 | tuple[Sequence[float], Sequence[float]]"
"""A pose, or a position [m] and a quaternion (x, y, z, w)."""


def mounted(
    robot: Robot,
    gravity: ArrayLike | None = None,
    base: Base | None = None,
    rotors: Mapping[str, tuple[float, float]] | None = None,
) -> Robot:
    """Return a robot with another gravity, base and rotors.

    Parameters
    ----------
    robot : Robot
    gravity : array (3,), optional
        Gravity in the world [m/s^2].
    base : pinocchio.SE3 or (position, quaternion), optional
        Pose of the root link in the world; only for a fixed root.
    rotors : mapping of str to (float, float), optional
        Inertia of the rotor [kg m^2] and gear ratio n by joint. Armature = inertia n^2 replaces that of the joint.

    Raises
    ------
    InputError
        A number is not finite, a moving root has a base, or a joint is unknown.
    """
    model = robot.model.copy()
    geometry = robot.geometry
    if base is not None:
        if robot.root != "fixed":
            raise InputError(f"base= places a fixed root, but {robot.name!r} has a {robot.root} root; use its start.")
        part = JoinedPart("", model, geometry, *_pose(base))
        model, geometry = joined_model(robot.name, [part]), JoinedGeometry((part,))
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
    return replace(robot, model=model, geometry=geometry)


def _pose(base: Base) -> tuple[tuple[float, float, float], tuple[float, float, float, float]]:
    if isinstance(base, pin.SE3):
        base = base.translation.tolist(), pin.Quaternion(base.rotation).coeffs().tolist()
    if not isinstance(base, Sequence) or len(base) != 2 or np.shape(base[0]) != (3,) or np.shape(base[1]) != (4,):
        raise InputError(f"base= is {base!r}; give a pinocchio.SE3, or position (3,) and quaternion (x, y, z, w).")
    x, y, z = (float(value) for value in base[0])
    a, b, c, d = unit_quaternion(np.array(base[1], dtype=float), "quaternion of base=").tolist()
    return (x, y, z), (a, b, c, d)
