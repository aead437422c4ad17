"""World axes in which a contact's frame can move; a contact has rows and forces in these axes only.

A foot of a robot in the x-z plane cannot move along y. A row for y would be 0 = 0, the force along y would have no
effect, and the acceleration rows would be singular. Axes without motion are found from the Jacobian at several
configurations.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj.robot.robot import Robot

AXES = ("x", "y", "z")

SAMPLES = 6
"""Number of seeded random configurations at which the Jacobian is evaluated."""
NEGLIGIBLE = 1e-4
"""Motion below this fraction of the largest is due to rounding in the URDF (1.5708 for a quarter turn)."""


def mobility(robot: Robot, jacobian: Callable[[Array], Array]) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """World axes along which, and about which, a contact can move.

    Parameters
    ----------
    robot : Robot
    jacobian : callable
        ``jacobian(q)`` returns the linear and angular velocity per joint velocity (6, nv), world axes.

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
    """Raise an error if a contact's frame leaves the plane of a robot with a planar root."""
    if robot.root == "planar" and (1 in axes or any(axis != 1 for axis in about)):
        raise InputError(
            f"Frame {frame!r} of {robot.name!r} leaves the x-z plane of root='planar', so no contact can hold it. "
            "Lock the joints that turn it out of the plane (locked=), or load with root='floating'."
        )


def require_rank(robot: Robot, rows: Callable[[Array], Array], count: int, what: str) -> None:
    """Raise an error if rows are linearly dependent in every configuration, where forces are not unique."""
    rank = max(int(np.linalg.matrix_rank(rows(q), tol=NEGLIGIBLE)) for q in configurations(robot))
    if rank < count:
        raise InputError(
            f"{what} holds {count} rows, but {robot.name!r} can move in {rank} of them only: the forces would not be "
            "determined. Use a contact with fewer rows, or a robot with more joints before the frame."
        )


def configurations(robot: Robot) -> list[Array]:
    """Return seeded random configurations near the neutral one, with unit quaternions."""
    rng = np.random.default_rng(0)
    steps = rng.uniform(-1.0, 1.0, (SAMPLES, robot.model.nv))
    return [np.asarray(pin.integrate(robot.model, np.array(robot.neutral), step)) for step in steps]
