"""Halves of gaits: what is asked of a step, and how its end becomes its beginning."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any, cast

import numpy as np

from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.dynamics.terrain.flat import Flat
from robotraj.dynamics.terrain.function import as_ground
from robotraj.gait.checks import check_ground_repeats, check_kinds, number
from robotraj.gait.feet import FootKind, feet_of, stands
from robotraj.gait.mirror_inertia import IMBALANCE, imbalance
from robotraj.gait.mirroring import mirror_by_geometry
from robotraj.gait.phase_sequence import GaitTerms, Support, sequence
from robotraj.problem.links.linkage import Linkage
from robotraj.problem.links.periodic import Mirror, Periodic
from robotraj.problem.problem import Problem
from robotraj.robot.robot import Robot


def repeated(
    robot: Robot,
    phases: Sequence[Support],
    parts: Sequence[float],
    sides: Mapping[str, str],
    terms: GaitTerms,
    repeat: Mirror | Periodic | None,
    length: float,
) -> Problem:
    """Close a gait on its mirror image, or write its other half and close it as it is; ``parts`` are the shares."""
    check_kinds(repeat, terms.upright)
    terms = replace(terms, contact=grounded(terms.contact, terms.ground))
    if repeat is None:
        repeat = _symmetric_repeat(robot)
    if isinstance(repeat, Periodic):
        other = [Support(tuple(sides[f] for f in p.feet), p.duration, f"{p.name}, other side") for p in phases]
        moved = _moved(robot, sides, repeat, 2.0 * length, terms.ground)
        return _in_shares(sequence(robot, [*phases, *other], terms, moved, passes=sides), [*parts, *parts])
    both = {**repeat.partners, **{b: a for a, b in repeat.partners.items()}}
    for foot in sides:
        if both.get(foot, foot) != sides[foot]:
            raise InputError(
                f"The mirror image of foot {foot!r} is {both.get(foot, foot)!r}, not {sides[foot]!r}; name the pair in "
                "rt.gait.mirror(robot, partners=...)."
            )
    return _in_shares(sequence(robot, phases, terms, _moved(robot, sides, repeat, length, terms.ground)), parts)


def _symmetric_repeat(robot: Robot) -> Mirror | Periodic:
    """Return the mirror of a robot, or ``Periodic`` with a warning where its inertia is not symmetric."""
    found = mirror_by_geometry(robot)
    off = imbalance(robot, found)
    if off <= IMBALANCE:
        return found
    warnings.warn(
        f"The inertia of {robot.name!r} is not symmetric (moments differ by {100 * off:.2g} % of weight times size). "
        "Hence both halves of the gait are planned, with rt.Periodic. repeat=rt.gait.mirror(robot, imbalance=0.2) "
        "plans one half.",
        stacklevel=4,
    )
    return Periodic()


def _in_shares(problem: Problem, parts: Sequence[float]) -> Problem:
    """Keep free durations in the proportion of the phases' parts."""
    bounds = [phase.duration_bounds for phase in problem.phases]
    ties = [
        Linkage((i, i + 1), InProportion(parts[i + 1] / parts[i]), name="share of the step", unit="s")
        for i in range(len(bounds) - 1)
        if bounds[i][0] < bounds[i][1]
    ]
    return replace(problem, links=[*problem.links, *ties])


@dataclass(frozen=True)
class InProportion:
    """How much longer a phase takes than so many times the one before [s]."""

    times: float

    def __call__(self, first: Any, second: Any) -> Any:
        """Compare both durations."""
        return second.end.t - second.start.t - self.times * (first.end.t - first.start.t)


def _moved(robot: Robot, feet: Iterable[str], repeat: Any, length: float, ground: Any) -> Any:
    """Add the way along x, and the rise of the ground along it, to what a repetition gains."""
    level = as_ground(ground)
    rise = float(level.height(length, 0.0)) - float(level.height(0.0, 0.0))
    way = {"q.root_x": length} | ({"q.root_z": rise} if rise else {})
    gains = {**way, **repeat.displacement}
    check_ground_repeats(robot, list(feet), gains, isinstance(repeat, Mirror), level)
    return replace(repeat, displacement=gains)


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
    if length is not None:
        advice = "A free one is a displacement: repeat=rt.Periodic(displacement={'q.root_x': rt.between(...)})."
        length = number(length, f"rt.gait.{who}(step_length)", advice=advice)
    if speed is None:
        assert length is not None
        return length, duration
    speed = number(speed, f"rt.gait.{who}(speed)", "m/s")
    if length is None:
        if np.ndim(duration):
            raise InputError(f"rt.gait.{who}: beside speed= the duration is one number; got {duration!r}.")
        return speed * number(duration, f"rt.gait.{who}(duration)", "s"), duration
    if not speed > 0.0:
        raise InputError(f"rt.gait.{who}: speed= is {speed!r} beside a step length; give a positive speed [m/s].")
    return length, length / speed
