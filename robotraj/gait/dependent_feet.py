"""Feet that cannot move independently of each other, and the attitude of the root that they hold."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj._util.errors import warn
from robotraj.gait.supports import Support
from robotraj.robot.robot import Robot

SINGULAR = 1e-6
"""Least singular value of the feet's Jacobian, relative to the largest, below which their motions are dependent."""
ACROSS = 1e-3
"""Largest part along x and z of a unit vector of dependent rows that are across the planes of the legs."""


def dependent_rows(robot: Robot, feet: Sequence[str], posture: Array) -> Array:
    """Return unit vectors f of forces of the feet (count, feet, 3), world axes, with J' f = 0.

    J is the Jacobian (3 feet, nv) of the feet's positions at the posture. There are none for a planar root.
    """
    none = np.zeros((0, len(feet), 3))
    if robot.root != "floating" or len(feet) < 2:
        return none
    model, data = robot.model, robot.model.createData()
    pin.computeJointJacobians(model, data, posture)
    pin.updateFramePlacements(model, data)
    frames = [robot.frame(foot) for foot in feet]
    rows = [pin.getFrameJacobian(model, data, frame, pin.LOCAL_WORLD_ALIGNED)[:3] for frame in frames]
    bases, values, _ = np.linalg.svd(np.vstack(rows))
    sizes = np.zeros(len(bases))
    sizes[: len(values)] = values
    return np.asarray(bases.T[sizes < SINGULAR * values[0]].reshape(-1, len(feet), 3))


def held_attitude(robot: Robot, support: Support, posture: Array) -> dict[str, float]:
    """Return the values of the root's quaternion that feet hold in a support, by state name; none for most robots.

    Legs that move in planes parallel to x-z keep the distance of their feet across these planes. Feet on both sides
    then hold the root level: at a roll r the distance of their footholds would be 1 / cos(r) times as long. This
    condition has no slope at r = 0, so solvers do not converge to it; with the row r = 0 they do.

    The function warns of other feet that cannot move independently: their plan may not be found.

    Parameters
    ----------
    robot : Robot
    support : Support
    posture : ndarray (nq,)
        Standing configuration.
    """
    dependent = dependent_rows(robot, support.feet, posture)
    if not len(dependent):
        return {}
    if np.max(np.abs(dependent[:, :, [0, 2]])) > ACROSS:
        warn(
            f"{support.name!r} holds {', '.join(support.feet)}, which {robot.name!r} cannot move independently of "
            "each other. Its plan may not be found. Legs that move in parallel planes are planned with "
            "root='planar'."
        )
        return {}
    return {"q.root_qx": 0.0}
