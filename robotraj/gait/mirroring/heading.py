"""The direction that a legged robot faces, from the axes of its joints."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from robotraj._util.errors import InputError
from robotraj.robot.robot import Robot

ALONG = 0.9
"""Least component of an axis along a direction."""


def check_heading(robot: Robot) -> None:
    """Check that a floating robot does not face sideways: knees and most hips turn about the axis from left to right.

    Raises
    ------
    InputError
        Of the joints that turn, more have axes along x than along y; the message names the remedy.
    """
    if robot.root != "floating":
        return
    model, data = robot.model, robot.model.createData()
    jacobians = pin.computeJointJacobians(model, data, robot.neutral)
    axes = np.abs(jacobians[3:, 6:])
    along_x, along_y = (int(np.sum(axes[k] > ALONG)) for k in (0, 1))
    if along_x > along_y:
        raise InputError(
            f"{robot.name!r} faces along y: {along_x} of its joints turn about x and {along_y} about y. Gaits move "
            "along x. Give its URDF a new root link, with a fixed joint to the old one of yaw 1.5708 or -1.5708."
        )
