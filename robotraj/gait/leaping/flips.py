"""Flips: jumps in which the root turns once over."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pinocchio as pin

from robotraj.dynamics.contacts.point_contact import PointContact
from robotraj.gait.bounds.margins import MARGIN
from robotraj.gait.bounds.own_sides import OwnSides
from robotraj.gait.bounds.turning import Turning
from robotraj.gait.capability.turn_over import check_turn, height_of_least_energy
from robotraj.gait.checks import positive
from robotraj.gait.feet import FootKind, feet_of
from robotraj.gait.leaping.jumps import OWN_SIDES
from robotraj.gait.leaping.leaps import Leap
from robotraj.gait.supports import GaitTerms, Support
from robotraj.problem.objectives.base import Objective
from robotraj.problem.problem import Problem
from robotraj.robot.robot import Robot
from robotraj.robot.size.reach import reach

BACK = (0.0, -1.0, 0.0)
ONE_SIDE = 0.4
"""Share of push and landing in which the feet of one side stand, over which the robot turns."""
ASIDE = 0.05
"""Least distance of these feet from the middle of all, relative to the robot's reach."""


def flip(
    robot: Robot,
    *,
    axis: Sequence[float] = BACK,
    height: float | None = None,
    length: float = 0.0,
    push: float | None = None,
    land: float | None = None,
    feet: Sequence[str] | None = None,
    contact: FootKind = PointContact,
    objective: Objective | None = None,
    sides: OwnSides | None = OWN_SIDES,
    margin: float = MARGIN,
) -> Problem:
    """Return a flip from rest to rest: "push off", "last push", "flight" with one turn, "first landing", "landing".

    All feet push off and land. In the last push only the feet stand towards which the robot turns over, the hind feet
    in a backflip, and those of the other side land first. Robots whose feet are all beside each other have neither
    phase. The robot starts in the configuration of ``rt.gait.stand`` and ends in it one turn later: a floating root
    with the negative quaternion, a planar one with a pitch 2 pi away.

    Parameters
    ----------
    robot : Robot
        With ``root="floating"``, or ``root="planar"`` for flips about y.
    axis : (float, float, float)
        Horizontal axis of the turn, counter-clockwise: (0, -1, 0) is a backflip, (0, 1, 0) a frontflip, (1, 0, 0) and
        (-1, 0, 0) are side flips to the right and to the left.
    height : float, optional
        Rise of the centre of mass in flight [m]. By default it is that of the least energy at take-off, pi / 2 times
        the radius of gyration about the axis, where rising takes as much energy as turning.
    length : float
        Displacement along x [m].
    push, land : float, optional
        Durations of push and landing [s], as for ``jump``.
    feet, contact, objective, sides, margin
        As for ``jump``.

    Raises
    ------
    InputError
        The axis is not horizontal, or the legs are too weak or too slow for the energy of the take-off. The message has
        a height that would do, or the robot's estimate.
    """
    turning = Turning(0.4, np.inf, axis=tuple(axis))  # type: ignore[arg-type]
    names = feet_of(robot, feet)
    terms = GaitTerms(contact, 0.0, objective, turning, sides=sides, margin=margin)
    leap = Leap(robot, names, terms, "flip", length)
    rise = leap.rise(height_of_least_energy(robot, leap.standing, turning.axis) if height is None else height)
    check_turn(robot, names, leap.standing, rise, turning.axis, leap.friction, leap.margin)
    before, after = (
        positive(given, leap.stance_time, f"rt.gait.flip({name})") for given, name in ((push, "push"), (land, "land"))
    )
    last, first = _sides(leap, turning.axis)
    pushes, landings = [Support(names, before, "push off")], [Support(names, after, "landing")]
    if last and first:
        pushes = [Support(names, (1.0 - ONE_SIDE) * before, "push off"), Support(last, ONE_SIDE * before, "last push")]
        landings = [
            Support(first, ONE_SIDE * after, "first landing"),
            Support(names, (1.0 - ONE_SIDE) * after, "landing"),
        ]
    return leap.problem(rise, pushes, landings)


def _sides(leap: Leap, axis: Sequence[float]) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return the feet on the side towards which the top of the robot turns, and those on the other side."""
    robot, data = leap.robot, leap.robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, leap.standing)
    places = np.array([data.oMf[robot.frame(foot)].translation for foot in leap.feet])
    along = (places - places.mean(axis=0)) @ np.cross(axis, (0.0, 0.0, 1.0))
    far = ASIDE * reach(robot.model)
    return (
        tuple(foot for foot, part in zip(leap.feet, along, strict=True) if part > far),
        tuple(foot for foot, part in zip(leap.feet, along, strict=True) if part < -far),
    )
