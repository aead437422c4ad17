"""The crawl of quadrupeds: one foot after the other."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import pinocchio as pin

from robotraj._util.errors import InputError
from robotraj.dynamics.contacts.point_contact import PointContact
from robotraj.dynamics.terrain.base import Ground
from robotraj.dynamics.terrain.flat import Flat
from robotraj.gait.checks import share
from robotraj.gait.feet import FootKind
from robotraj.gait.halves import pace, repeated, some_feet
from robotraj.gait.phase_sequence import GaitTerms, Support, shares
from robotraj.gait.sides import other_side
from robotraj.gait.upright import Upright
from robotraj.problem.links.periodic import Mirror, Periodic
from robotraj.problem.objectives.base import Objective
from robotraj.problem.problem import Problem
from robotraj.robot.robot import Robot

LEVEL = Flat()
UPRIGHT = Upright()


def crawl(
    robot: Robot,
    *,
    step_length: float | None = None,
    duration: Any = None,
    speed: float | None = None,
    feet: Sequence[str] | None = None,
    contact: FootKind = PointContact,
    full_support: float = 0.0,
    clearance: float | None = 0.0,
    objective: Objective | None = None,
    upright: Upright | None = UPRIGHT,
    ground: Ground | Any = LEVEL,
    repeat: Mirror | Periodic | None = None,
) -> Problem:
    """Half a stride of a crawling quadruped: a hind foot swings, then the fore foot of its side, mirrored.

    Each foot in turn, hind left, fore left, hind right, fore right, the lateral sequence that quadrupeds walk in
    (Muybridge; McGhee and Frank, On the stability properties of quadruped creeping gaits, Mathematical Biosciences 3,
    1968): three feet stand while one swings and is set down at rest. A foot's swing takes it two step lengths on, from
    one behind its partner to one before it.

    Parameters are those of ``walk``, but ``double_support``, and

    Parameters
    ----------
    step_length, duration, speed : float
        Two of: way of the root in half a stride [m], its time [s] (or (least, greatest) beside a step length), speed.
    feet : sequence of str, optional
        Four frames; the side of the first one swings first.
    full_support : float
        Share of the half stride with all feet on the ground, before the hind foot lifts, 0 to less than 1. Both swings
        take half of the rest.

    Raises
    ------
    InputError
        Not four feet, a fore and a hind one on each side; else as ``walk``.
    """
    names = some_feet(robot, feet, 4, "crawl")
    length, time = pace(step_length, duration, speed, "crawl")
    share(full_support, "rt.gait.crawl(full_support)")
    sides = {name: other_side(name, names) for name in names}
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, robot.neutral)
    places = {name: data.oMf[robot.frame(name)].translation for name in names}
    near = [name for name in names if places[name][1] * places[names[0]][1] > 0.0]
    if len(near) != 2 or any(sides[name] in near for name in near):
        raise InputError(f"rt.gait.crawl needs two feet on each side; got {', '.join(names)}.")
    order = sorted(near, key=lambda name: float(places[name][0]))
    parts = [0.5 - 0.5 * full_support, 0.5 - 0.5 * full_support]
    if full_support > 0.0:
        parts.insert(0, full_support)
    spans = shares(time, parts)
    phases = [
        Support(tuple(name for name in names if name != foot), span, f"{foot} swings")
        for foot, span in zip(order, spans[-2:], strict=True)
    ]
    if full_support > 0.0:
        phases.insert(0, Support(names, spans[0], "all stand"))
    return repeated(
        robot, phases, parts, sides, GaitTerms(contact, clearance, objective, upright, ground), repeat, length
    )
