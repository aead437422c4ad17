"""Feet that cannot move independently of each other."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from robotraj._util.errors import warn
from robotraj.gait.supports import Support
from robotraj.robot.robot import Robot

SINGULAR = 1e-6
"""Least singular value of the feet's Jacobian, relative to the largest, below which their motions are dependent."""


def warn_of_dependent_feet(robot: Robot, supports: Sequence[Support], posture: NDArray[np.float64]) -> None:
    """Warn of a support whose feet cannot move independently, as where all legs move in parallel planes.

    The distance across these planes is then fixed, and the sideways forces of the feet are not determined. The
    constraints that hold the feet are dependent, so that solvers take many iterations or fail.

    Parameters
    ----------
    robot : Robot
    supports : sequence of Support
    posture : ndarray (nq,)
        Configuration at which the Jacobian (3 feet, nv) of the feet's positions is evaluated.
    """
    if robot.root != "floating":
        return
    model, data = robot.model, robot.model.createData()
    pin.computeJointJacobians(model, data, posture)
    pin.updateFramePlacements(model, data)
    for support in supports:
        frames = [robot.frame(foot) for foot in support.feet]
        if len(frames) < 2:
            continue
        rows = [pin.getFrameJacobian(model, data, frame, pin.LOCAL_WORLD_ALIGNED)[:3] for frame in frames]
        values = np.linalg.svd(np.vstack(rows), compute_uv=False)
        if values[-1] < SINGULAR * values[0]:
            warn(
                f"{support.name!r} holds {', '.join(support.feet)}, which {robot.name!r} cannot move independently of "
                "each other. Its plan may not be found. Legs that move in parallel planes are planned with "
                "root='planar'."
            )
            return
