"""The crawl of quadrupeds, which moves one foot at a time."""

from __future__ import annotations

from collections.abc import Sequence

import pinocchio as pin

from robotraj._util.errors import InputError
from robotraj.dynamics.contacts.point_contact import PointContact
from robotraj.dynamics.terrain.base import Ground
from robotraj.dynamics.terrain.flat import Flat
from robotraj.dynamics.terrain.function import GroundFunction
from robotraj.gait.bounds.margins import MARGIN
from robotraj.gait.bounds.own_sides import OwnSides
from robotraj.gait.bounds.upright import Upright
from robotraj.gait.checks import TimeSpan, fraction, step_timing
from robotraj.gait.feet import FootKind
from robotraj.gait.phase_sequence import split_duration
from robotraj.gait.repetition import checked_feet, repeating
from robotraj.gait.supports import GaitTerms, Support
from robotraj.problem.links.periodic import Mirror, Periodic
from robotraj.problem.objectives.base import Objective
from robotraj.problem.problem import Problem
from robotraj.robot.robot import Robot
from robotraj.robot.sides.images import frames_across

LEVEL = Flat()
OWN_SIDES = OwnSides()
UPRIGHT = Upright()


def crawl(
    robot: Robot,
    *,
    step_length: float | None = None,
    duration: TimeSpan | None = None,
    speed: float | None = None,
    feet: Sequence[str] | None = None,
    contact: FootKind = PointContact,
    full_support: float = 0.0,
    clearance: float | None = 0.0,
    objective: Objective | None = None,
    upright: Upright | None = UPRIGHT,
    ground: Ground | GroundFunction = LEVEL,
    sides: OwnSides | None = OWN_SIDES,
    margin: float = MARGIN,
    repeat: Mirror | Periodic | None = None,
) -> Problem:
    """Return half a stride of a crawling quadruped: a hind foot swings, then the fore foot of the same side.

    The other half is its mirror image. The order of the feet is the lateral sequence: hind left, fore left, hind right,
    fore right. Three feet stand while one swings and is set down at rest. A swing is two step lengths long, from one
    behind its partner to one before it.
    Source: McGhee and Frank, Mathematical Biosciences 3 (1968), on the stability of creeping gaits.

    The other parameters are those of ``walk`` without ``double_support``.

    Parameters
    ----------
    step_length, duration, speed : float
        Two of: displacement of the root in half a stride [m], its duration [s] (or (least, greatest) beside a step
        length), speed [m/s].
    feet : sequence of str, optional
        Four frames; the side of the first one swings first.
    full_support : float
        Fraction of the half stride with all feet on the ground, before the hind foot lifts, 0 to less than 1. Each
        swing takes half of the rest.

    Raises
    ------
    InputError
        The robot has no fore and hind foot on each side; further errors are those of ``walk``.
    """
    names = checked_feet(robot, feet, 4, "crawl")
    length, time = step_timing(step_length, duration, speed, "crawl")
    fraction(full_support, "rt.gait.crawl(full_support)")
    others = frames_across(robot, names)
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, robot.neutral)
    places = {name: data.oMf[robot.frame(name)].translation for name in names}
    near = [name for name in names if places[name][1] * places[names[0]][1] > 0.0]
    if len(near) != 2 or any(others[name] in near for name in near):
        raise InputError(f"rt.gait.crawl needs two feet on each side; got {', '.join(names)}.")
    order = sorted(near, key=lambda name: float(places[name][0]))
    parts = [0.5 - 0.5 * full_support, 0.5 - 0.5 * full_support]
    if full_support > 0.0:
        parts.insert(0, full_support)
    spans = split_duration(time, parts)
    phases = [
        Support(tuple(name for name in names if name != foot), span, f"{foot} swings")
        for foot, span in zip(order, spans[-2:], strict=True)
    ]
    if full_support > 0.0:
        phases.insert(0, Support(names, spans[0], "full support"))
    return repeating(
        robot,
        phases,
        parts,
        others,
        GaitTerms(contact, clearance, objective, upright, ground, sides, margin),
        repeat,
        length,
    )
