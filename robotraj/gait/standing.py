"""Standing configurations."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj.dynamics.contacts.point_contact import PointContact
from robotraj.gait.feet import FootKind, feet_of, foot_contact
from robotraj.gait.mirroring.heading import check_up
from robotraj.guess.legs.stance import BalancedStance
from robotraj.guess.legs.standing_posture import height_above, standing
from robotraj.robot.robot import Robot

HEIGHT_TOLERANCE = 1e-2
"""Largest difference of the centre of mass from the given height, relative to the reach of the robot."""
FOOT_TOLERANCE = 1e-6
"""Largest distance of a foot from its foothold [m, rad]."""


def stand(
    robot: Robot, feet: Sequence[str] | None = None, contact: FootKind = PointContact, height: float | None = None
) -> Array:
    """Return a standing configuration (nq,) [m, rad]: feet on the ground, bent knees, the mass above the feet.

    The feet keep their horizontal positions of the neutral configuration, or the nearest ones within the limits of the
    joints. The root is upright, and joints are inside their limits and near the neutral ones. Straight legs are bent at
    the knees, because the equations are singular with straight ones, and so are legs with a joint at a limit, which
    could not extend.

    Parameters
    ----------
    robot : Robot
    feet : sequence of str, optional
        Frames of the feet; by default those named foot, sole or toe.
    contact : Contact or callable
        Contact of every foot, as for ``rt.gait.walk``.
    height : float, optional
        Height of the centre of mass above the feet [m]. By default it is that of the neutral configuration, or a
        twentieth less if its legs are straight or at a limit.

    Raises
    ------
    InputError
        The frames do not exist, another axis than z is up, feet do not reach the ground, or the height is not reached.
    """
    names = feet_of(robot, feet)
    check_up(robot, names)
    stance = BalancedStance(robot, tuple(foot_contact(contact, name).bound_to(robot) for name in names))
    q = standing(stance, height)
    rows, _ = stance.places(q, stance.locate(q))
    if np.max(np.abs(rows), initial=0.0) > FOOT_TOLERANCE:
        raise InputError(
            f"{robot.name!r} cannot stand on {', '.join(names)}: a foot is {np.max(np.abs(rows)):.2g} off the ground "
            f"in the best configuration found. Give another height=, or feet= that reach the ground together."
        )
    if height is not None:
        com = pin.centerOfMass(robot.model, robot.model.createData(), q)
        found = height_above(stance, stance.locate(q), com)
        if abs(found - height) > HEIGHT_TOLERANCE * stance.size:
            raise InputError(
                f"{robot.name!r} cannot stand with its centre of mass {height:g} m above {', '.join(names)}: "
                f"the nearest height found is {found:.4g} m. Give another height=."
            )
    return q
