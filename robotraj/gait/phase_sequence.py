"""From a timetable of feet to a problem: phases, links between them, clearance of what swings."""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.dynamics.contacts.point_contact import PointContact
from robotraj.dynamics.terrain.base import Ground
from robotraj.dynamics.terrain.flat import Flat
from robotraj.dynamics.terrain.function import as_ground
from robotraj.gait.checks import check_kinds, number
from robotraj.gait.feet import FootKind, stands
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
"""How far below the ground [m] a foot may come where it leaves and lands: no row then says what another says."""


@dataclass(frozen=True)
class Support:
    """One phase of a gait: which feet stand, and how long.

    Attributes
    ----------
    feet : tuple of str
        Frames that stand; none in flight.
    duration : float or (float, float)
        Fixed or bounded [s].
    name : str
    """

    feet: tuple[str, ...]
    duration: Any
    name: str


@dataclass(frozen=True)
class GaitTerms:
    """What the phases of a gait share.

    Attributes
    ----------
    contact : Contact or callable
        What a foot stands with: ``rt.PointContact``, a contact to copy to the other feet, or a function of a frame.
    clearance : float or None
        How high swinging feet pass between their footholds [m], 0 for above the ground alone, None for no such row.
    objective : Objective or None
        Of every phase; ``gait_objective(robot, standing)`` where None.
    upright : Upright or None
    ground : Ground or callable
        For clearance; contacts carry their own.
    """

    contact: FootKind = PointContact
    clearance: float | None = 0.0
    objective: Objective | None = None
    upright: Upright | None = None
    ground: Ground | Any = Flat()


def sequence(
    robot: Robot,
    supports: Sequence[Support],
    terms: GaitTerms,
    repeat: Mirror | Periodic | None,
    start: State | None = None,
    end: State | None = None,
    passes: Mapping[str, str] | None = None,
) -> Problem:
    """Write phases and links: ``Liftoff`` where feet leave, ``Touchdown`` where all that stand then come down.

    Where one foot stays while another comes down, that one is set down at rest and the state runs on, ``Continuity``.

    Parameters
    ----------
    robot : Robot
    supports : sequence of Support
        In the order of time.
    terms : GaitTerms
    repeat : Mirror, Periodic or None
        How the start sees the end; a gait that repeats starts at root_x = 0 (and root_y = 0, heading along x, where it
        does not turn left into right), since it could start anywhere.
    start, end : State, optional
        Of the whole motion, where it does not repeat.
    passes : mapping of str to str, optional
        Which standing foot a swinging one passes, where both steps of a stride are written; those of the mirror by
        default.

    Raises
    ------
    InputError
        A robot whose root is fixed, or a clearance that is negative.
    """
    if robot.root == "fixed":
        raise InputError(
            f"{robot.name!r} is fixed in the world; load it with root='floating', or root='planar' for motion in the "
            "x-z plane."
        )
    check_kinds(repeat, terms.upright)
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
    contacts = {foot: stands(terms.contact, foot) for foot in every}
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
            # A quaternion and its negative are one attitude: without a sign a turn may go from one to the other.
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
    """Repeat through an impact where feet come down, else as the state runs on."""
    if _lands(before, after):
        return Touchdown(last, 0, repeat=repeat)
    return replace(repeat, first=0, last=last)


def _lands(before: Sequence[str], after: Sequence[str]) -> bool:
    """Whether feet come down with an impact: those that do, while none stays.

    Where a foot stays, an impact of the other would as a rule pull at it (Hurmuzlu and Marghitu, Int. J. Robotics
    Research 13, 1994), which no ground does. The only impulse left is then zero: the foot is set down at rest, the
    state runs on, and the rows of the phase after it hold.
    """
    return bool(set(after) - set(before)) and not set(after) & set(before)


def _origin(robot: Robot, repeat: Mirror | Periodic | None) -> State:
    """Fix what a repeating motion leaves open: where it starts, and where it heads."""
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
    """Clearance of the feet that do not stand.

    Halfway through a mirrored gait a foot swings past its partner, which stands in the middle of its way: from one
    displacement behind the partner's foothold to one before it; so it does in each half of a stride whose both halves
    are written. Elsewhere feet stay above the ground, and a warning says that more was asked for. Of soles all corners
    stay above it.
    """
    if terms.clearance is None or not swinging:
        return []
    partners = _partners(repeat) if passes is None else passes
    gain = repeat.displacement.get("q.root_x") if repeat is not None else None
    if passes is not None and isinstance(gain, int | float):
        gain = 0.5 * gain
    rows: list[Constraint] = []
    level: list[Any] = []
    low: list[str] = []
    for foot in swinging:
        other, corners = partners.get(foot, foot), stands(terms.contact, foot).bound_to(robot).outline()
        if terms.clearance > 0.0 and other in support.feet and isinstance(gain, int | float) and gain != 0.0:
            place, step = f"{stands(terms.contact, other).label}.x", float(gain)
            rows.append(GroundClearance(_spot(terms, foot), SwingArc(terms.clearance, place, step), ground))
            level += corners if len(corners) > 1 else []
        else:
            level += corners
            low.append(foot)
    if low and support.feet and terms.clearance > 0.0:
        warnings.warn(
            f"clearance={terms.clearance:g} is not held by {', '.join(low)} in {support.name!r}, which stay above the "
            "ground alone: a foot reaches its height where it passes one that stands, over a step of known length. "
            "Give others rt.GroundClearance(foot, rt.constraints.SwingApex(...)).",
            stacklevel=3,
        )
    spots = [(frame, offset) if any(offset) else frame for frame, offset in level]
    return [*rows, GroundClearance(spots, -TOUCH, ground)] if spots else rows


def _spot(terms: GaitTerms, foot: str) -> Any:
    """Give the place of a foot that stands: the origin of its frame, or what its contact is offset by."""
    offset = getattr(stands(terms.contact, foot), "offset", None)
    return foot if offset is None or not np.any(offset) else (foot, tuple(offset))


@dataclass(frozen=True)
class SwingArc(RequiredHeight):
    """Height [m] of a swing foot, h = 4 (apex + d) s (1 - s) - d with d = 0.1 mm, s its progress between footholds.

    Halfway it is the apex, and below -d the foot never comes. s runs from 0 to 1 between one step behind and one step
    before the partner's foothold. The tenth of a millimetre keeps the row from saying at both ends what the phases
    before and after say as well, that the foot is on the ground: an inequality that can hold in one way alone has no
    multipliers.

    Attributes
    ----------
    apex : float
        [m].
    anchor : str
        Parameter of the phase: world x of the partner's foothold.
    step : float
        What a step gains along x [m].
    """

    apex: float
    anchor: str
    step: float

    def heights(self, point: Any, position: Sequence[Any]) -> dict[str, Any]:
        """Height that a place at ``position`` must have."""
        progress = 0.5 + 0.5 * (position[0] - point.p[self.anchor]) / self.step
        return {
            "ground clearance": -TOUCH,
            "swing apex": 4.0 * (self.apex + TOUCH) * progress * (1.0 - progress) - TOUCH,
        }


def shares(duration: Any, parts: Sequence[float]) -> list[Any]:
    """Split a duration [s], fixed or bounded, with None for an open side, in proportion."""
    if isinstance(duration, Between):
        duration = duration.lower, duration.upper
    if isinstance(duration, tuple | list) and len(duration) == 2:
        low, high = duration
        duration = 0.0 if low is None else low, np.inf if high is None else high
    whole = np.asarray(number(duration, "duration", "s") if np.ndim(duration) == 0 else duration, dtype=float)
    every = [whole * part / sum(parts) for part in parts]
    return [tuple(float(v) for v in value) if value.shape else float(value) for value in every]


__all__ = ["GaitTerms", "Support", "SwingArc", "sequence", "shares"]
