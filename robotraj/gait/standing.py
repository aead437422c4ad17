"""A configuration to stand in."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from robotraj._util.errors import InputError
from robotraj.dynamics.contacts.point_contact import PointContact
from robotraj.gait.feet import FootKind, feet_of, stands
from robotraj.guess.legs.stance import BalancedStance, height_above, standing
from robotraj.robot.robot import Robot

Array = NDArray[np.float64]

NEAR = 1e-2
"""Farthest the centre of mass may be from the height that was asked for [m]."""
REACHED = 1e-6
"""Farthest a foot may be from where it stands [m, rad]."""


def stand(
    robot: Robot, feet: Sequence[str] | None = None, contact: FootKind = PointContact, height: float | None = None
) -> Array:
    """Give a configuration (nq,) [m, rad] to stand in: feet on the ground, knees bent, mass over the feet.

    Feet are under where the neutral configuration has them, the root is upright, and joints are inside their limits and
    near the neutral ones. Straight legs, whose joints then could not lift the root, are bent at the knees.

    Parameters
    ----------
    robot : Robot
    feet : sequence of str, optional
        Frames; by default those named foot, sole or toe.
    contact : Contact or callable
        What they stand with, as for ``rt.gait.walk``.
    height : float, optional
        Of the centre of mass above the feet [m]; by default that of the neutral configuration, or a twentieth less
        where its legs are straight.

    Raises
    ------
    InputError
        No such frames, or feet that do not reach the ground.
    """
    names = feet_of(robot, feet)
    stance = BalancedStance(robot, tuple(stands(contact, name).bound_to(robot) for name in names))
    q = standing(stance, height)
    rows, _ = stance.places(q, stance.locate(q))
    if np.max(np.abs(rows), initial=0.0) > REACHED:
        raise InputError(
            f"{robot.name!r} cannot stand on {', '.join(names)}: a foot is {np.max(np.abs(rows)):.2g} off the ground "
            f"in the best configuration found. Give another height=, or feet= that reach the ground together."
        )
    if height is not None:
        com = pin.centerOfMass(robot.model, robot.model.createData(), q)
        found = height_above(stance, stance.locate(q), com)
        if abs(found - height) > NEAR:
            raise InputError(
                f"{robot.name!r} cannot stand with its centre of mass {height:g} m above {', '.join(names)}: "
                f"{found:.4g} m is as near as was found. Give another height=."
            )
    return q
