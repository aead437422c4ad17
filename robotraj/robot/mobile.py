"""``on_wheels`` and ``on_rail``: a robot on a base that moves on level ground, or on a carriage."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pinocchio as pin

from robotraj._util.errors import InputError, warn
from robotraj.robot.coupling.coupled_model import coupled
from robotraj.robot.limits import Limits, concatenated
from robotraj.robot.loading.other_units import in_other_unit
from robotraj.robot.loading.planning_model import rebuilt
from robotraj.robot.robot import Robot
from robotraj.robot.size.reach import reach

JOINTS = ("base_x", "base_y", "base_yaw")
"""Joints of the base."""
FAR, HEAVY = 100.0, 100.0
"""Length of a rail and mass of a base, relative to the reach and mass of its robot, above which units are doubtful."""
AXES = {"x": pin.JointModelPX, "y": pin.JointModelPY, "z": pin.JointModelPZ}
"""Joints of a rail by their axes in the world."""


def on_wheels(robot: Robot, mass: float, inertia: float) -> Robot:
    """Put a robot on a base that moves in the plane z = 0 and turns about the vertical.

    The base has three joints before those of the robot: base_x and base_y [m] along the world's axes, base_yaw [rad].
    Their efforts are the horizontal force [N] and the moment about the vertical [N m] of the ground on the wheels.
    ``rt.constraints.DifferentialDrive`` restricts them to two wheels that roll without slip.

    Parameters
    ----------
    robot : Robot
        Robot with a fixed root. The base turns about the vertical through the root link's origin.
    mass : float
        Mass of the base and its wheels [kg]; its centre lies on the axis of rotation.
    inertia : float
        Inertia of the base about the vertical [kg m^2].

    Returns
    -------
    Robot
        Its base has no limits; set them by ``robot.limits.with_``.

    Raises
    ------
    InputError
        The robot has a moving root or a joint or frame of these names, or the mass or inertia is not above 0.
    """
    if not (0.0 < mass < np.inf and 0.0 < inertia < np.inf):
        raise InputError(f"The base has mass {mass!r} kg and inertia {inertia!r} kg m^2; both must be above 0.")
    _warn_of_mass(robot, mass, "base")
    joints = dict(zip(JOINTS, (pin.JointModelPX(), pin.JointModelPY(), pin.JointModelRZ()), strict=True))
    # The base turns about the vertical only, so its moments about the other axes have no effect.
    body = pin.Inertia(float(mass), np.zeros(3), np.diag([inertia, inertia, inertia]))
    return _on_joints(robot, joints, body, Limits.none(JOINTS), "on wheels")


def on_rail(
    robot: Robot,
    mass: float,
    travel: tuple[float, float],
    velocity: float,
    effort: float,
    axis: str = "x",
    name: str = "rail",
) -> Robot:
    """Put a robot on a carriage that slides along a rail, or on a lift.

    The carriage has one joint before those of the robot [m], along an axis of the world through the root link. At 0 the
    robot stands where it stood without the rail. Its effort is the force of the drive [N]; that of a lift carries the
    weights of carriage and robot as well.

    Parameters
    ----------
    robot : Robot
        Robot with a fixed root; it keeps its shapes.
    mass : float
        Mass of the carriage [kg].
    travel : (float, float)
        Least and greatest position [m].
    velocity, effort : float
        Limits of the drive [m/s, N].
    axis : str
        ``"x"``, ``"y"`` or, for a lift, ``"z"``.
    name : str
        Name of the joint.

    Raises
    ------
    InputError
        The robot has a moving root, or a joint or frame of that name. The mass or a limit is not above 0, or the travel
        is reversed or infinite.

    Examples
    --------
    >>> cell = rt.robot.on_rail(rt.load("ur5"), mass=20.0, travel=(-1.0, 1.0), velocity=1.5, effort=500.0)
    """
    if axis not in AXES:
        raise InputError(f"The axis of the rail is {axis!r}; give one of {', '.join(map(repr, AXES))}.")
    for what, value in (("mass", mass), ("velocity", velocity), ("effort", effort)):
        if not 0.0 < value < np.inf:
            raise InputError(f"The {what} of the rail's carriage is {value!r}; give a number above 0.")
    if len(travel) != 2 or not -np.inf < travel[0] < travel[1] < np.inf:
        raise InputError(f"The travel of the rail is {travel!r}; give (least, greatest) [m].")
    far, longest = reach(robot.model), max(map(abs, travel))
    if 0.0 < FAR * far < longest:
        warn(
            f"The rail of {robot.name!r} goes to {longest:g} m, and the robot reaches {far:.2g} m. "
            f"{in_other_unit(longest, 'm')}"
        )
    _warn_of_mass(robot, mass, "carriage")
    body = pin.Inertia(float(mass), np.zeros(3), np.zeros((3, 3)))
    limits = Limits.none((name,)).with_(position=travel, velocity=velocity, effort=effort)
    return _on_joints(robot, {name: AXES[axis]()}, body, limits, "on a rail")


def _warn_of_mass(robot: Robot, mass: float, what: str) -> None:
    """Warn of a base or carriage that is far heavier than its robot.

    Warns
    -----
    UserWarning
    """
    if 0.0 < HEAVY * robot.mass < mass:
        warn(
            f"The {what} of {robot.name!r} weighs {mass:g} kg, and the robot {robot.mass:.3g} kg. "
            f"{in_other_unit(mass, 'kg')}"
        )


def _on_joints(
    robot: Robot, joints: Mapping[str, pin.JointModel], body: pin.Inertia, limits: Limits, where: str
) -> Robot:
    """Put a robot on a body that a chain of driven joints moves."""
    if robot.root != "fixed":
        raise InputError(f"{robot.name!r} has a {robot.root} root; only a robot with a fixed root is put {where}.")
    taken = [name for name in joints if name in robot.joint_names or name in robot.frame_names]
    if taken:
        raise InputError(f"{robot.name!r} has a joint or frame {taken[0]!r} already; rename it in the URDF.")
    n, zeros = len(joints), np.zeros(len(joints))
    model = coupled(rebuilt(robot.model, tuple(joints.items())), robot.followers)
    model.appendBodyToJoint(n, body, pin.SE3.Identity())
    model.lowerPositionLimit[:n] = limits.position_lower
    model.upperPositionLimit[:n] = limits.position_upper
    return replace(
        robot,
        name=f"{robot.name} {where}",
        model=model,
        limits=concatenated((*joints, *robot.limits.joints), (limits, robot.limits)),
        actuated=(*joints, *robot.actuated),
        damping=np.append(zeros, robot.damping),
        friction=np.append(zeros, robot.friction),
        neutral=np.append(np.clip(zeros, limits.position_lower, limits.position_upper), robot.neutral),
    )
