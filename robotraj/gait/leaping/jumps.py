"""Jumps as problems of three phases."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robotraj.dynamics.contacts.point_contact import PointContact
from robotraj.dynamics.terrain.base import Ground
from robotraj.dynamics.terrain.flat import Flat
from robotraj.dynamics.terrain.function import GroundFunction
from robotraj.gait.bounds.margins import MARGIN
from robotraj.gait.bounds.own_sides import OwnSides
from robotraj.gait.bounds.upright import Upright
from robotraj.gait.capability.take_off import check_take_off
from robotraj.gait.checks import check_options
from robotraj.gait.feet import FootKind, feet_of
from robotraj.gait.leaping.leaps import Leap
from robotraj.gait.supports import GaitTerms, Support
from robotraj.problem.constraints.bounds import Between
from robotraj.problem.objectives.base import Objective
from robotraj.problem.problem import Problem
from robotraj.robot.robot import Robot
from robotraj.robot.size.reach import reach

LEVEL = Flat()
OWN_SIDES = OwnSides()
LEAPING = Upright(least_height=0.4, greatest_height=np.inf)
RISE = 0.1
"""Default rise of the centre of mass, relative to the reach of the robot."""


def jump(
    robot: Robot,
    *,
    length: float = 0.0,
    height: float | None = None,
    push: float | Sequence[float] | Between | None = None,
    land: float | Sequence[float] | Between | None = None,
    feet: Sequence[str] | None = None,
    contact: FootKind = PointContact,
    clearance: float | None = 0.0,
    objective: Objective | None = None,
    upright: Upright | None = LEAPING,
    ground: Ground | GroundFunction = LEVEL,
    sides: OwnSides | None = OWN_SIDES,
    margin: float = MARGIN,
) -> Problem:
    """Return a jump from rest to rest: "push off" on all feet, "flight", "landing" on all feet.

    The flight takes sqrt(8 height / g): the centre of mass rises by ``height`` if it lands as high as it took off. The
    robot starts in the configuration of ``rt.gait.stand``, and ends in it displaced by ``length``.

    Parameters
    ----------
    robot : Robot
        With ``root="planar"`` or ``"floating"``.
    length, height : float
        Displacement and rise of the centre of mass [m]. By default it rises by a tenth of the robot's reach, the
        farthest that its masses can be from its first joint.
    push, land : float or (float, float), optional
        Durations of both stances [s], by default 2.5 sqrt(h / g) with the height h of the centre of mass. Free
        durations, (least, greatest), take many more iterations.
    feet, contact, clearance, upright, ground
        As for ``walk``; all feet stand. By default the root may sink lower than in a walk and rise without bound.
    sides, margin
        As for ``walk``.
    objective : Objective, optional
        Objective of every phase; ``rt.gait.posture_objective`` by default. By effort alone, planar robots land on
        straight legs, whose motors cannot brake the impact.

    Raises
    ------
    InputError
        The height is not positive, or the jump needs a higher take-off than the torques and speeds of the
        legs allow. The legs cannot carry the robot, or it has no feet.
    """
    check_options(None, upright)
    terms = GaitTerms(contact, clearance, objective, upright, ground, sides, margin)
    leap = Leap(robot, feet_of(robot, feet), terms, "jump", length)
    rise = leap.rise(RISE * reach(robot.model) if height is None else height)
    check_take_off(robot, leap.feet, leap.standing, rise, leap.length, leap.friction, leap.margin)
    push, land = (leap.stance_time if given is None else given for given in (push, land))
    return leap.problem(rise, [Support(leap.feet, push, "push off")], [Support(leap.feet, land, "landing")])
