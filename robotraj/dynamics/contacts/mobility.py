"""In which world axes a contact's frame can move at all: only there does it hold rows and carry forces.

A foot of a robot in the x-z plane cannot move along y. A row for y would say 0 = 0, and the force along y would do
nothing: the acceleration rows would be singular. What a mechanism never does is therefore found from its Jacobian at
several configurations.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from robotraj._util.errors import InputError

if TYPE_CHECKING:
    from robotraj.robot.robot import Robot

Array = NDArray[np.float64]

AXES = ("x", "y", "z")

SAMPLES = 6
"""Seeded random configurations at which the Jacobian is looked at."""
NEGLIGIBLE = 1e-4
"""Motion below this part of the largest is a URDF's rounding (1.5708 for a quarter turn), none at all."""


def mobility(robot: Robot, jacobian: Callable[[Array], Array]) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """World axes along which, and about which, a contact can move.

    Parameters
    ----------
    robot : Robot
    jacobian : callable
        ``jacobian(q)`` gives linear and angular velocity per joint velocity, (6, nv), world axes.

    Returns
    -------
    linear, angular : tuple of int
        Indices 0, 1, 2 of x, y, z.
    """
    sizes = np.max([np.linalg.norm(jacobian(q), axis=1) for q in configurations(robot)], axis=0)
    linear, angular = sizes[:3], sizes[3:]
    return (
        tuple(i for i in range(3) if linear[i] > NEGLIGIBLE * max(float(linear.max()), NEGLIGIBLE)),
        tuple(i for i in range(3) if angular[i] > NEGLIGIBLE),
    )


def require_plane(robot: Robot, frame: str, axes: tuple[int, ...], about: tuple[int, ...] = (1,)) -> None:
    """Refuse a contact whose frame leaves the plane of a robot with a planar root."""
    if robot.root == "planar" and (1 in axes or any(axis != 1 for axis in about)):
        raise InputError(
            f"Frame {frame!r} of {robot.name!r} leaves the x-z plane that root='planar' moves in, so that it cannot be "
            "held there; lock the joints that turn it out (locked=), or load with root='floating'."
        )


def require_rank(robot: Robot, rows: Callable[[Array], Array], count: int, who: str) -> None:
    """Refuse rows that depend on each other in every configuration: their forces would not be determined."""
    rank = max(int(np.linalg.matrix_rank(rows(q), tol=NEGLIGIBLE)) for q in configurations(robot))
    if rank < count:
        raise InputError(
            f"{who} holds {count} rows, but {robot.name!r} can move in {rank} of them only: the forces would not be "
            "determined. Use a contact that holds less, or a robot with more joints before the frame."
        )


def configurations(robot: Robot) -> list[Array]:
    """Seeded random configurations near the neutral one, valid for quaternions as well."""
    rng = np.random.default_rng(0)
    steps = rng.uniform(-1.0, 1.0, (SAMPLES, robot.model.nv))
    return [np.asarray(pin.integrate(robot.model, np.array(robot.neutral), step)) for step in steps]
