"""``on_wheels``: a robot on a base that moves on level ground."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pinocchio as pin

from robotraj._util.errors import InputError
from robotraj.robot.coupling.coupled_model import coupled
from robotraj.robot.limits import Limits, concatenated
from robotraj.robot.loading.planning_model import rebuilt
from robotraj.robot.robot import Robot

JOINTS = ("base_x", "base_y", "base_yaw")
"""Joints of the base."""


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
    if robot.root != "fixed":
        raise InputError(f"{robot.name!r} has a {robot.root} root; rt.robot.on_wheels takes a robot with a fixed one.")
    if not (0.0 < mass < np.inf and 0.0 < inertia < np.inf):
        raise InputError(f"The base has mass {mass!r} kg and inertia {inertia!r} kg m^2; both must be above 0.")
    taken = [name for name in JOINTS if name in robot.joint_names or name in robot.frame_names]
    if taken:
        raise InputError(f"{robot.name!r} has a joint or frame {taken[0]!r} already; rename it in the URDF.")
    kinds = (pin.JointModelPX(), pin.JointModelPY(), pin.JointModelRZ())
    model = coupled(rebuilt(robot.model, tuple(zip(JOINTS, kinds, strict=True))), robot.followers)
    # The base turns about the vertical only, so its moments about the other axes have no effect.
    body = pin.Inertia(float(mass), np.zeros(3), np.diag([inertia, inertia, inertia]))
    model.appendBodyToJoint(len(JOINTS), body, pin.SE3.Identity())
    model.lowerPositionLimit[: len(JOINTS)] = -np.inf
    model.upperPositionLimit[: len(JOINTS)] = np.inf
    limits = concatenated((*JOINTS, *robot.limits.joints), (Limits.none(JOINTS), robot.limits))
    zeros = np.zeros(len(JOINTS))
    return replace(
        robot,
        name=f"{robot.name} on wheels",
        model=model,
        limits=limits,
        actuated=(*JOINTS, *robot.actuated),
        damping=np.append(zeros, robot.damping),
        friction=np.append(zeros, robot.friction),
        neutral=np.append(zeros, robot.neutral),
    )
