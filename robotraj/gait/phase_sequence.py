"""Problems from schedules of feet: phases, their links, and the clearance of swinging feet."""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, cast

import numpy as np

from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.dynamics.contacts.point_contact import PointContact
from robotraj.dynamics.point import RobotPoint
from robotraj.dynamics.terrain.base import Ground
from robotraj.dynamics.terrain.flat import Flat
from robotraj.dynamics.terrain.function import GroundFunction, as_ground
from robotraj.dynamics.variable import Scalar
from robotraj.gait.checks import TimeSpan, check_options, number
from robotraj.gait.feet import FootKind, foot_contact
from robotraj.gait.flight import Flight
from robotraj.gait.posture import gait_objective
from robotraj.gait.upright import Upright
from robotraj.guess.legs.stance import BalancedStance, standing
from robotraj.problem.constraints.base import Constraint
from robotraj.problem.constraints.bounds import Between, between
from robotraj.problem.constraints.clearance import GroundClearance
from robotraj.problem.constraints.heights import RequiredHeight
from robotraj.problem.links.base import Link
from robotraj.problem.links.continuity import Continuity
from robotraj.problem.links.periodic import Mirror, Periodic
from robotraj.problem.links.touchdown import Liftoff, Touchdown
from robotraj.problem.objectives.base import Objective
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.problem.state import State
from robotraj.robot.robot import Robot

TOUCH = 1e-4
"""Depth below the ground [m] that clearance allows, so that it is not redundant at liftoff and touchdown."""


@dataclass(frozen=True)
class Support:
    """One phase of a gait: its standing feet and its duration.

    Attributes
    ----------
    feet : tuple of str
        Frames of the standing feet; none in flight.
    duration : float or (float, float)
        Fixed or bounded [s].
    name : str
    """

    feet: tuple[str, ...]
    duration: float | Sequence[float] | Between
    name: str


@dataclass(frozen=True)
class GaitTerms:
    """Options that all phases of a gait share.

    Attributes
    ----------
    contact : Contact or callable
        Of every foot: ``rt.PointContact``, a contact to copy to the other feet, or a function of a frame.
    clearance : float or None
        Height of swinging feet halfway between their footholds [m]; 0 keeps them above the ground, None adds no row.
    objective : Objective or None
        Of every phase; ``gait_objective(robot, standing)`` by default.
    upright : Upright or None
    ground : Ground or callable
        For clearance; contacts have their own ground.
    """

    contact: FootKind = PointContact
    clearance: float | None = 0.0
    objective: Objective | None = None
    upright: Upright | None = None
    ground: Ground | GroundFunction = Flat()


def sequence(
    robot: Robot,
    supports: Sequence[Support],
    terms: GaitTerms,
    repeat: Mirror | Periodic | None,
    start: State | None = None,
    end: State | None = None,
    passes: Mapping[str, str] | None = None,
) -> Problem:
    """Return a problem of phases and links.

    ``Liftoff`` links phases where feet leave the ground, and ``Touchdown`` where all feet of the next phase land. If
    some of them already stand, the others are set down at rest, and the link is ``Continuity``.

    Parameters
    ----------
    robot : Robot
    supports : sequence of Support
        In the order of time.
    terms : GaitTerms
    repeat : Mirror, Periodic or None
        Link from the end to the start. A repeating gait starts at root_x = 0; one that is not mirrored also at
        root_y = 0 and heading along x.
    start, end : State, optional
        Ends of a motion that does not repeat.
    passes : mapping of str to str, optional
        The standing foot that each swinging foot passes, if the problem has both steps of a stride; by default those of
        the mirror.

    Raises
    ------
    InputError
        The root of the robot is fixed, or the clearance is negative.
    """
    if robot.root == "fixed":
        raise InputError(
            f"{robot.name!r} is fixed in the world; load it with root='floating', or root='planar' for motion in the "
            "x-z plane."
        )
    check_options(repeat, terms.upright)
    if not supports or not all(isinstance(support, Support) for support in supports):
        raise InputError(
            f"supports= must be rt.gait.Support values, one or more in the order of time; got {supports!r}."
        )
    if terms.clearance is not None and not number(terms.clearance, "clearance") >= 0.0:
        raise InputError(f"clearance= is {terms.clearance!r}; give metres from 0 on, or None for no such row.")
    ground = as_ground(terms.ground)
    feet = tuple(dict.fromkeys(foot for support in supports for foot in support.feet))
    partners = _partners(repeat)
    every = tuple(dict.fromkeys((*feet, *(partners.get(foot, foot) for foot in feet))))
    contacts = {foot: foot_contact(terms.contact, foot) for foot in every}
    posture = standing(BalancedStance(robot, tuple(contact.bound_to(robot) for contact in contacts.values())))
    objective = terms.objective if terms.objective is not None else gait_objective(robot, posture)
    phases: list[Phase] = []
    for i, support in enumerate(supports):
        swinging = [foot for foot in every if foot not in support.feet]
        rows: list[Constraint] = _swing(robot, support, swinging, terms, ground, repeat, passes)
        states = {}
        if terms.upright is not None:
            states = terms.upright.states(robot)
            rows += terms.upright.constraints(robot, posture, ground)
        if repeat is not None and "q.root_qw" in repeat.displacement:
            # A quaternion and its negative are one attitude; the sign excludes a change between them.
            states = {**states, "q.root_qw": between(0.0, None)}
        kind = Phase if support.feet else Flight
        phases.append(
            kind(
                robot,
                support.duration,
                start=(_origin(robot, repeat) if repeat is not None else start) if i == 0 else None,
                end=end if i == len(supports) - 1 else None,
                objective=objective,
                constraints=rows,
                contacts=[contacts[foot] for foot in support.feet],
                states=states,
                name=support.name,
            )
        )
    links = [_link(i, supports[i].feet, supports[i + 1].feet) for i in range(len(phases) - 1)]
    if repeat is not None:
        last = tuple(partners.get(foot, foot) for foot in supports[-1].feet)
        links.append(_closing(len(phases) - 1, last, supports[0].feet, repeat))
    return Problem(phases, links)


def _partners(repeat: Mirror | Periodic | None) -> dict[str, str]:
    if not isinstance(repeat, Mirror):
        return {}
    return {**repeat.partners, **{b: a for a, b in repeat.partners.items()}}


def _link(i: int, before: Sequence[str], after: Sequence[str]) -> Link:
    if _lands(before, after):
        return Touchdown(i, i + 1)
    return Liftoff(i, i + 1) if set(after) < set(before) else Continuity(i, i + 1)


def _closing(last: int, before: Sequence[str], after: Sequence[str], repeat: Mirror | Periodic) -> Link:
    """Return the link that closes a repeating gait, with an impact if feet land."""
    if _lands(before, after):
        return Touchdown(last, 0, repeat=repeat)
    return replace(repeat, first=0, last=last)


def _lands(before: Sequence[str], after: Sequence[str]) -> bool:
    """Return whether feet land with an impact: some land and none remains.

    If a foot remains on the ground, an impact of another generally pulls at it (Hurmuzlu and Marghitu, Int. J. Robotics
    Research 13, 1994). As the ground cannot pull, the impulse is zero: the foot is set down at rest.
    """
    return bool(set(after) - set(before)) and not set(after) & set(before)


def _origin(robot: Robot, repeat: Mirror | Periodic | None) -> State:
    """Return the start that fixes the position, and the heading if it is free, of a repeating motion."""
    if robot.root == "planar" or isinstance(repeat, Mirror):
        return State(q={"root_x": 0.0})
    return State(q={"root_x": 0.0, "root_y": 0.0, "root_qz": 0.0})


def _swing(
    robot: Robot,
    support: Support,
    swinging: Sequence[str],
    terms: GaitTerms,
    ground: Ground,
    repeat: Mirror | Periodic | None,
    passes: Mapping[str, str] | None,
) -> list[Constraint]:
    """Return the clearance of swinging feet.

    In a mirrored gait a foot swings past its standing partner: from one displacement behind the partner's foothold
    to one before it. The same holds in each half of a complete stride. Other feet are kept above the ground, with a
    warning if the clearance is positive. All corners of a sole are kept above the ground.
    """
    if terms.clearance is None or not swinging:
        return []
    partners = _partners(repeat) if passes is None else passes
    gain = repeat.displacement.get("q.root_x") if repeat is not None else None
    if passes is not None and isinstance(gain, int | float):
        gain = 0.5 * gain
    rows: list[Constraint] = []
    level: list[tuple[str, tuple[float, ...]]] = []
    low: list[str] = []
    for foot in swinging:
        other, corners = partners.get(foot, foot), foot_contact(terms.contact, foot).bound_to(robot).outline()
        if terms.clearance > 0.0 and other in support.feet and isinstance(gain, int | float) and gain != 0.0:
            place, step = f"{foot_contact(terms.contact, other).label}.x", float(gain)
            rows.append(GroundClearance(_contact_point(terms, foot), SwingArc(terms.clearance, place, step), ground))
            level += corners if len(corners) > 1 else []
        else:
            level += corners
            low.append(foot)
    if low and support.feet and terms.clearance > 0.0:
        warnings.warn(
            f"clearance={terms.clearance:g} is not held by {', '.join(low)} in {support.name!r}: they are only kept "
            "above the ground. The height needs a standing partner that the foot passes, and a step of known length. "
            "Add rt.GroundClearance(foot, rt.constraints.SwingApex(...)) for these feet.",
            stacklevel=3,
        )
    spots = [(frame, offset) if any(offset) else frame for frame, offset in level]
    return [*rows, GroundClearance(spots, -TOUCH, ground)] if spots else rows


def _contact_point(terms: GaitTerms, foot: str) -> str | tuple[str, tuple[float, ...]]:
    """Return the contact point of a foot: its frame, or its frame and offset."""
    offset = getattr(foot_contact(terms.contact, foot), "offset", None)
    return foot if offset is None or not np.any(offset) else (foot, tuple(offset))


@dataclass(frozen=True)
class SwingArc(RequiredHeight):
    """Height [m] of a swing foot, h = 4 (apex + d) s (1 - s) - d with d = 0.1 mm, s its progress between footholds.

    Halfway, h is the apex; the foot never comes below -d. s runs from 0 to 1 between one step behind and one step
    before the partner's foothold. Without d, the contacts at both ends would make the inequality active at its only
    feasible value, where multipliers are not unique.

    Attributes
    ----------
    apex : float
        [m].
    anchor : str
        Parameter of the phase: world x of the partner's foothold.
    step : float
        Displacement of a step along x [m].
    """

    apex: float
    anchor: str
    step: float

    def heights(self, point: RobotPoint, position: Sequence[Scalar]) -> dict[str, Scalar]:
        """Return the least heights at ``position``."""
        progress = 0.5 + 0.5 * (position[0] - point.p[self.anchor]) / self.step
        return {
            "ground clearance": -TOUCH,
            "swing apex": 4.0 * (self.apex + TOUCH) * progress * (1.0 - progress) - TOUCH,
        }


def split_duration(duration: TimeSpan, parts: Sequence[float]) -> list[float | Sequence[float]]:
    """Return parts of a duration [s], fixed or bounded, in proportion; None in a pair is an open side."""
    if isinstance(duration, Between):
        duration = cast("tuple[float | None, float | None]", (duration.lower, duration.upper))
    if isinstance(duration, tuple | list) and len(duration) == 2:
        low, high = duration
        duration = 0.0 if low is None else low, np.inf if high is None else high
    whole = np.asarray(
        number(duration, "duration", "s") if np.ndim(cast(Any, duration)) == 0 else duration, dtype=float
    )
    every = [whole * part / sum(parts) for part in parts]
    return [tuple(float(v) for v in value) if value.shape else float(value) for value in every]


__all__ = ["GaitTerms", "Support", "SwingArc", "sequence", "split_duration"]
