"""Jumps as problems of three phases."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from robotraj._util.errors import InputError
from robotraj.dynamics.contacts.point_contact import PointContact
from robotraj.dynamics.terrain.base import Ground
from robotraj.dynamics.terrain.flat import Flat
from robotraj.dynamics.terrain.function import GroundFunction, as_ground
from robotraj.gait.bounds.margins import MARGIN, checked_margin
from robotraj.gait.bounds.own_sides import OwnSides
from robotraj.gait.bounds.upright import Upright
from robotraj.gait.capability.leg_samples import greatest_friction
from robotraj.gait.capability.take_off import check_take_off
from robotraj.gait.capability.weight import check_rest
from robotraj.gait.checks import check_options, number
from robotraj.gait.feet import FootKind, feet_of, foot_contact
from robotraj.gait.phase_sequence import sequence
from robotraj.gait.posture import posture_objective
from robotraj.gait.repetition import on_ground
from robotraj.gait.supports import GaitTerms, Support
from robotraj.guess.legs.stance import BalancedStance
from robotraj.guess.legs.standing_posture import pendulum_time, standing
from robotraj.problem.constraints.bounds import Between
from robotraj.problem.objectives.base import Objective
from robotraj.problem.problem import Problem
from robotraj.problem.state import State
from robotraj.robot.robot import Robot
from robotraj.robot.size.reach import reach

LEVEL = Flat()
OWN_SIDES = OwnSides()
LEAPING = Upright(least_height=0.4, greatest_height=np.inf)
CROUCH = 2.5
"""Default duration of either stance, in sqrt(h / g): a person crouches and rises in 0.7 s.

In 0.3 s five_link, talos_legs and monopod ended at their limits of torque and speed, or without a motion."""
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
        The height is not positive, or the jump needs a take-off for half as much again as the torques and speeds of the
        legs allow. The legs cannot carry the robot, or it has no feet.
    """
    names = feet_of(robot, feet)
    check_options(None, upright)
    number(length, "rt.gait.jump(length)")
    height = RISE * reach(robot.model) if height is None else number(height, "rt.gait.jump(height)")
    if not height > 0.0:
        raise InputError(f"rt.gait.jump: height= is {height!r}; give a positive height [m].")
    gravity = float(np.linalg.norm(robot.model.gravity.linear))
    kind = on_ground(contact, ground)
    standing_robot = BalancedStance(robot, tuple(foot_contact(kind, name).bound_to(robot) for name in names))
    q = standing(standing_robot)
    friction = greatest_friction(standing_robot)
    check_rest(robot, names, q, friction, checked_margin(margin))
    check_take_off(robot, names, q, height, length, friction, checked_margin(margin))
    landed = np.array(q)
    landed[0] += length
    data = robot.model.createData()
    rise = _level(robot, data, names, landed, ground) - _level(robot, data, names, q, ground)
    landed[1 if robot.root == "planar" else 2] += rise
    air = float(np.sqrt(8.0 * height / gravity))
    long = CROUCH * pendulum_time(standing_robot, q)
    push, land = (long if given is None else given for given in (push, land))
    phases = [Support(names, push, "push off"), Support((), air, "flight"), Support(names, land, "landing")]
    cost = posture_objective(robot, q) if objective is None else objective
    terms = GaitTerms(kind, clearance, cost, upright, ground, sides, margin)
    return sequence(robot, phases, terms, None, State(q=q, v=0.0), State(q=landed, v=0.0))


def _level(
    robot: Robot, data: pin.Data, feet: Sequence[str], q: NDArray[np.float64], ground: Ground | GroundFunction
) -> float:
    """Return the mean height of the ground under the feet [m]."""
    pin.framesForwardKinematics(robot.model, data, q)
    places = [data.oMf[robot.frame(name)].translation for name in feet]
    return float(np.mean([as_ground(ground).height(float(p[0]), float(p[1])) for p in places]))
