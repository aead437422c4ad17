"""Problems of phases and links from the sequence of standing feet."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.dynamics.terrain.function import as_ground
from robotraj.gait.bounds.margins import checked_margin, contact_with, limits_with
from robotraj.gait.bounds.swing_clearance import partners_of, swing_clearance
from robotraj.gait.bounds.turning import Turning
from robotraj.gait.capability.leg_reach import check_swing
from robotraj.gait.checks import TimeSpan, check_free_root, check_options, number
from robotraj.gait.dependent_feet import held_attitude
from robotraj.gait.feet import foot_contact
from robotraj.gait.posture import gait_objective, haste, posture_objective
from robotraj.gait.supports import GaitTerms, Support
from robotraj.guess.legs.stance import BalancedStance
from robotraj.guess.legs.standing_posture import standing
from robotraj.problem.constraints.bounds import Between, Interval, as_duration, between
from robotraj.problem.links.base import Link
from robotraj.problem.links.continuity import Continuity
from robotraj.problem.links.periodic import Mirror, Periodic
from robotraj.problem.links.touchdown import Liftoff, Touchdown
from robotraj.problem.objectives.base import Objective
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.problem.state import State
from robotraj.robot.robot import Robot


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

    ``Liftoff`` links two phases if feet leave the ground between them, and ``Touchdown`` if all feet of the next phase
    land. If some of these feet already stand, the others land without an impact, and the link is ``Continuity``.

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
    check_free_root(robot)
    check_options(repeat, terms.upright)
    if not supports or not all(isinstance(support, Support) for support in supports):
        raise InputError(
            f"supports= must be rt.gait.Support values, one or more in the order of time; got {supports!r}."
        )
    if terms.clearance is not None and not number(terms.clearance, "clearance") >= 0.0:
        raise InputError(f"clearance= is {terms.clearance!r}; give metres from 0 on, or None for no such row.")
    check_swing(robot, supports, terms.clearance)
    ground = as_ground(terms.ground)
    feet = tuple(dict.fromkeys(foot for support in supports for foot in support.feet))
    partners = partners_of(repeat)
    every = tuple(dict.fromkeys((*feet, *(partners.get(foot, foot) for foot in feet))))
    margin = checked_margin(terms.margin)
    contacts = {foot: contact_with(foot_contact(terms.contact, foot), margin) for foot in every}
    bound = {foot: contact.bound_to(robot) for foot, contact in contacts.items()}
    posture = standing(BalancedStance(robot, tuple(bound.values())))
    costs = _defaults(robot, posture, supports, repeat)
    phases: list[Phase] = []
    for i, support in enumerate(supports):
        swinging = [foot for foot in every if foot not in support.feet]
        rows, parameters = swing_clearance(robot, support, swinging, terms, ground, repeat, passes)
        states: dict[str, Interval] = {}
        if terms.upright is not None:
            states |= terms.upright.states(robot)
            rows += terms.upright.constraints(robot, posture, ground)
        if repeat is not None and "q.root_qw" in repeat.displacement:
            # A quaternion and its negative represent one attitude; this bound selects one of the two.
            states["q.root_qw"] = between(0.0, None)
        states |= held_attitude(robot, support, posture)
        if terms.sides is not None:
            level = not isinstance(terms.upright, Turning)
            rows += terms.sides.constraints(robot, bound, posture, support.feet, level=level)
        rows += limits_with(robot, margin)
        kind = Phase if support.feet else Flight
        phases.append(
            kind(
                robot,
                support.duration,
                start=(_origin(robot, repeat) if repeat is not None else start) if i == 0 else None,
                end=end if i == len(supports) - 1 else None,
                objective=costs[i] if terms.objective is None else terms.objective,
                constraints=rows,
                contacts=[contact_with(each, margin) for each in support.contacts(terms.contact)],
                parameters=parameters,
                states=states,
                name=support.name,
            )
        )
    links = [_link(i, supports[i].feet, supports[i + 1].feet) for i in range(len(phases) - 1)]
    if repeat is not None:
        last = tuple(partners.get(foot, foot) for foot in supports[-1].feet)
        links.append(_closing(len(phases) - 1, last, supports[0].feet, repeat))
    return Problem(phases, links)


def _defaults(
    robot: Robot, posture: NDArray[np.float64], supports: Sequence[Support], repeat: Mirror | Periodic | None
) -> list[Objective]:
    """Return the default objective of each phase; phases of free duration pay for haste.

    A planar robot at rest can balance without torque, so that by effort alone free phases would last as long as they
    may. A planar gait that repeats falls from step to step, and its effort is least at a duration in between.
    """
    spans = [as_duration(support.duration, support.name) for support in supports]
    free = [least < greatest for least, greatest in spans]
    if robot.root == "planar" and (repeat is not None or not any(free)):
        return [gait_objective(robot, posture)] * len(supports)
    plain = posture_objective(robot, posture)
    return [plain + haste(robot, posture) if each else plain for each in free]


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

    If a foot remains on the ground, an impact of another foot generally lifts it (Hurmuzlu and Marghitu, Int. J.
    Robotics Research 13, 1994). The ground cannot pull it down, so the landing foot must arrive at rest.
    """
    return bool(set(after) - set(before)) and not set(after) & set(before)


def _origin(robot: Robot, repeat: Mirror | Periodic | None) -> State:
    """Return the start that fixes the position, and the heading if it is free, of a repeating motion."""
    if robot.root == "planar" or isinstance(repeat, Mirror):
        return State(q={"root_x": 0.0})
    return State(q={"root_x": 0.0, "root_y": 0.0, "root_qz": 0.0})


def split_duration(duration: TimeSpan, parts: Sequence[float]) -> list[float | Sequence[float]]:
    """Return parts of a duration [s], fixed or bounded, in proportion; None in a pair is an open side."""
    if isinstance(duration, Between):
        duration = cast("tuple[float | None, float | None]", (duration.lower, duration.upper))
    if isinstance(duration, tuple | list) and len(duration) == 2:
        low, high = duration
        duration = 0.0 if low is None else low, np.inf if high is None else high
    whole = np.asarray(
        number(duration, "duration", "s") if np.ndim(cast(ArrayLike, duration)) == 0 else duration, dtype=float
    )
    every = [whole * part / sum(parts) for part in parts]
    return [tuple(float(v) for v in value) if value.shape else float(value) for value in every]


@dataclass(frozen=True, eq=False)
class Flight(Phase):
    """A phase of a robot with a free root and without contacts.

    The centre of mass falls freely and the angular momentum about it is constant. Parameters are those of ``rt.Phase``.

    Raises
    ------
    InputError
        The phase has contacts, or moves a System or a robot with a fixed root.
    """

    name: str = "flight"

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.robot is None or self.robot.root == "fixed":
            raise InputError(
                f"Flight {self.name!r} moves {'a System' if self.robot is None else repr(self.robot.name)}, which is "
                "fixed in the world; load the robot with root='floating' or root='planar'."
            )
        if self.contacts:
            names = ", ".join(repr(contact.label) for contact in self.contacts)
            raise InputError(f"Flight {self.name!r} has contacts ({names}); use rt.Phase for a phase with contacts.")
