"""A walk whose feet roll: each one lands on its heel, stands flat, and leaves the ground from its toe."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from robotraj._util.errors import InputError
from robotraj.dynamics.contacts.base import Contact
from robotraj.dynamics.contacts.edges.line_contact import LineContact
from robotraj.dynamics.contacts.flat_foot import BoundFlatFoot, FlatFoot
from robotraj.dynamics.terrain.base import Ground
from robotraj.dynamics.terrain.flat import Flat
from robotraj.dynamics.terrain.function import GroundFunction
from robotraj.gait.bounds.margins import MARGIN
from robotraj.gait.bounds.own_sides import OwnSides
from robotraj.gait.bounds.upright import Upright
from robotraj.gait.checks import TimeSpan, positive, step_timing
from robotraj.gait.feet import FootKind, foot_contact
from robotraj.gait.phase_sequence import split_duration
from robotraj.gait.repetition import checked_feet, on_ground, repeating
from robotraj.gait.supports import GaitTerms, Support
from robotraj.problem.links.periodic import Mirror, Periodic
from robotraj.problem.objectives.base import Objective
from robotraj.problem.problem import Problem
from robotraj.robot.robot import Robot

SHARES = (0.2, 0.4, 0.4)
"""Default fractions of a step on heel and toe, on the flat foot and on the toe."""


def heel_to_toe(
    robot: Robot,
    *,
    contact: FootKind,
    step_length: float | None = None,
    duration: TimeSpan | None = None,
    speed: float | None = None,
    feet: Sequence[str] | None = None,
    shares: Sequence[float] = SHARES,
    objective: Objective | None = None,
    upright: Upright | None = Upright(),  # noqa: B008  # a frozen value
    ground: Ground | GroundFunction = Flat(),  # noqa: B008  # a frozen value
    sides: OwnSides | None = OwnSides(),  # noqa: B008  # a frozen value
    margin: float = MARGIN,
    repeat: Mirror | Periodic | None = None,
) -> Problem:
    """Return one step of a walk whose feet roll over heel and toe, closed by its mirror image.

    The step has three phases: "heel and toe", in which the heel of the front foot and the toe of the rear one stand,
    "flat", on the sole of the front foot, and "toe", on its toe, while the other foot swings and lands on its heel.
    Heel and toe are the edges of the sole, ``rt.contacts.LineContact``, about which the foot turns. The sole comes
    down, and the heel lands, without an impact. All corners of both soles stay above the ground. The other parameters
    are those of ``rt.gait.walk``.

    Parameters
    ----------
    contact : FlatFoot or callable
        The sole of every foot, such as ``functools.partial(rt.FlatFoot, length=0.2, width=0.1)``.
    shares : (float, float, float)
        Fractions of the step in the three phases.

    Raises
    ------
    InputError
        The contact is no ``FlatFoot``, or there are not three positive shares; further errors are those of ``walk``.
    """
    names = checked_feet(robot, feet, 2, "heel_to_toe")
    length, time = step_timing(step_length, duration, speed, "heel_to_toe")
    if len(shares) != 3:
        raise InputError(f"rt.gait.heel_to_toe(shares) is {shares!r}; give three fractions: heel and toe, flat, toe.")
    parts = [positive(share, 0.0, "rt.gait.heel_to_toe(shares)") for share in shares]
    sole = on_ground(contact, ground)
    heel, toe = edge(robot, sole, front=False), edge(robot, sole, front=True)
    front, rear = names
    both, flat, last = split_duration(time, parts)
    phases = [
        Support((front, rear), both, "heel and toe", (heel, toe)),
        Support((front,), flat, "flat", (sole,)),
        Support((front,), last, "toe", (toe,)),
    ]
    terms = GaitTerms(sole, 0.0, objective, upright, ground, sides, margin)
    return repeating(robot, phases, parts, {front: rear, rear: front}, terms, repeat, length)


def edge(robot: Robot, sole: FootKind, front: bool) -> Callable[[str], Contact]:
    """Return the contact of the front or back edge of the soles of a robot, as a function of the frame.

    It has the sole's name, so that what sole and edge both hold is carried from one phase to the next.
    """

    def on(frame: str) -> Contact:
        flat = foot_contact(sole, frame)
        if not isinstance(flat, FlatFoot):
            raise InputError(
                f"rt.gait.heel_to_toe needs soles, but contact= gives {type(flat).__name__} {flat.label!r}; give "
                "functools.partial(rt.FlatFoot, length=..., width=...)."
            )
        bound = flat.bound_to(robot)
        assert isinstance(bound, BoundFlatFoot)
        way = bound.shape.front if front else -bound.shape.back
        x, y, z = (float(part) for part in np.array(flat.offset) + way * np.array(bound.feet.forward))
        return LineContact(
            frame,
            flat.width,
            flat.friction,
            flat.ground,
            flat.name,
            normal_force=flat.normal_force,
            offset=(x, y, z),
            direction=bound.feet.left,
            margin=flat.margin,
        )

    return on
