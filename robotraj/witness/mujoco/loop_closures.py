"""Closed loops for MuJoCo: pairs of points of the robot that are joined by equality constraints."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from robotraj._util.errors import InputError
from robotraj.dynamics.contacts.loop_closure import BoundLoopClosure
from robotraj.witness.mujoco.model import wxyz
from robotraj.witness.mujoco.package import load_mujoco
from robotraj.witness.mujoco.reference_motion import ReferenceMotion

if TYPE_CHECKING:
    import mujoco

    from robotraj.dynamics.contacts.base import BoundContact

IMPEDANCE = [0.999, 0.9999, 0.001, 0.5, 2.0]
"""MuJoCo's ``solimp`` of a loop, nearly rigid; its default is softer by a twentieth."""


def loops_of(course: ReferenceMotion) -> tuple[BoundLoopClosure, ...]:
    """Return the closed loops of the robot.

    Raises
    ------
    InputError
        A loop that is closed in some phases and open in others.
    """
    held = [
        {bound.name: bound for bound in getattr(planned.phase, "bound_contacts", ()) if _closes(bound)}
        for planned in course.phases
    ]
    every = {name: bound for loops in held for name, bound in loops.items()}
    for planned, loops in zip(course.phases, held, strict=True):
        for name in every:
            if name not in loops:
                raise InputError(
                    f"Phase {planned.phase.name!r} opens the loop {name!r}; second_opinion() needs closed loops. "
                    "Use rt.validate."
                )
    return tuple(every.values())


def close(
    course: ReferenceMotion,
    loops: tuple[BoundLoopClosure, ...],
    time: float,
    spec: mujoco.MjSpec,
    bodies: Mapping[int, mujoco.MjsBody],
) -> None:
    """Add the loops to a specification of MuJoCo, with a time constant [s]."""
    mujoco = load_mujoco()
    for loop in loops:
        ends = []
        for side, spot, turn in (("a", loop.first, np.eye(3)), ("b", loop.second, loop.turn)):
            frame = course.robot.model.frames[course.robot.frame(spot.frame)]
            name = f"{loop.name} {side}"
            place = frame.placement.act(np.array(spot.offset))
            bodies[frame.parentJoint].add_site(name=name, pos=place, quat=wxyz(frame.placement.rotation @ turn))
            ends.append(name)
        kind = mujoco.mjtEq.mjEQ_WELD if loop.about else mujoco.mjtEq.mjEQ_CONNECT
        equality = spec.add_equality(
            name=loop.name, type=kind, objtype=mujoco.mjtObj.mjOBJ_SITE, name1=ends[0], name2=ends[1]
        )
        equality.solref, equality.solimp = [time, 1.0], IMPEDANCE


def _closes(bound: BoundContact) -> bool:
    return isinstance(bound, BoundLoopClosure)
