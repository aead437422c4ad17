"""Halves of gaits: what is asked of a step, and how its end becomes its beginning."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, cast

import numpy as np

from robotraj.errors import InputError
from robotraj.gait.feet import FootKind, feet_of, stands
from robotraj.gait.mirror import mirror
from robotraj.gait.sequence import Support, Terms, sequence
from robotraj.links import Mirror, Periodic
from robotraj.problem import Problem
from robotraj.robot import Robot
from robotraj.terrain import Flat, as_ground


def repeated(
    robot: Robot,
    phases: Sequence[Support],
    sides: Mapping[str, str],
    terms: Terms,
    repeat: Mirror | Periodic | None,
    length: float,
) -> Problem:
    """Close a gait on its mirror image, or write its other half and close it as it is."""
    terms = replace(terms, contact=grounded(terms.contact, terms.ground))
    if isinstance(repeat, Periodic):
        other = [Support(tuple(sides[f] for f in p.feet), p.duration, f"{p.name}, other side") for p in phases]
        return sequence(robot, [*phases, *other], terms, _moved(repeat, 2.0 * length, terms.ground))
    if repeat is None:
        repeat = mirror(robot)
    both = {**repeat.partners, **{b: a for a, b in repeat.partners.items()}}
    for foot in sides:
        if both.get(foot, foot) != sides[foot]:
            raise InputError(
                f"The mirror image of foot {foot!r} is {both.get(foot, foot)!r}, not {sides[foot]!r}; name the pair in "
                "rt.gait.mirror(robot, partners=...)."
            )
    return sequence(robot, phases, terms, _moved(repeat, length, terms.ground))


def _moved(repeat: Any, length: float, ground: Any) -> Any:
    """Add the way along x, and the rise of the ground along it, to what a repetition gains."""
    level = as_ground(ground)
    rise = float(level.height(length, 0.0)) - float(level.height(0.0, 0.0))
    way = {"q.root_x": length} | ({"q.root_z": rise} if rise else {})
    return replace(repeat, displacement={**way, **repeat.displacement})


def grounded(kind: FootKind, ground: Any) -> FootKind:
    """Contacts on a ground, where the kind of contact is named without one."""

    def on(frame: str) -> Any:
        contact = stands(kind, frame)
        if getattr(contact, "ground", None) == Flat():
            return replace(cast(Any, contact), ground=ground)
        return contact

    return on


def some_feet(robot: Robot, feet: Sequence[str] | None, count: int, who: str) -> tuple[str, ...]:
    """Find feet and count them."""
    names = feet_of(robot, feet)
    if len(names) != count:
        raise InputError(f"rt.gait.{who} needs {count} feet; got {', '.join(names)}. Name them with feet=[...].")
    return names


def pace(length: float | None, duration: Any, speed: float | None, who: str) -> tuple[float, Any]:
    """Step length [m] and duration [s] out of two of three."""
    if sum(value is not None for value in (length, duration, speed)) != 2:
        raise InputError(f"rt.gait.{who} takes two of step_length=, duration= and speed=.")
    if speed is None:
        return float(length), duration  # type: ignore[arg-type]
    if length is None:
        if np.ndim(duration):
            raise InputError(f"rt.gait.{who}: beside speed= the duration is one number; got {duration!r}.")
        return float(speed) * float(duration), duration
    if not speed > 0.0:
        raise InputError(f"rt.gait.{who}: speed= is {speed!r} beside a step length; give a positive speed [m/s].")
    return float(length), float(length) / float(speed)


def share(flight: float) -> float:
    """Check the share of a step in the air."""
    if not 0.0 < flight < 1.0:
        raise InputError(f"flight= is {flight!r}; give the share of the step in the air, between 0 and 1.")
    return flight
