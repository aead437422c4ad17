"""Waypoints that a robot passes, with stops and waits at some, as one problem of linked phases."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from robotraj._util.checks import is_number
from robotraj._util.errors import InputError
from robotraj.problem.constraints.base import AtEnd, AtStart, Constraint
from robotraj.problem.constraints.bounds import Between
from robotraj.problem.links.base import Link
from robotraj.problem.links.continuity import Continuity
from robotraj.problem.links.periodic import Periodic
from robotraj.problem.objectives.base import Objective
from robotraj.problem.objectives.duration import Duration
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.problem.state import State
from robotraj.robot.limits import Limits
from robotraj.robot.robot import Robot

Waypoint: TypeAlias = "ArrayLike | Constraint"
"""Joint positions (nq,) [rad, m], or a constraint such as ``rt.FramePose(frame, pose)``."""


class Waypoints(Problem):
    """A motion through places in their order, from rest to rest or periodic, without a stop unless one is given.

    Each leg from a place to the next is a phase with a free duration, and each dwell a phase of fixed duration in which
    the joints rest. Positions and velocities are continuous from phase to phase. The objectives of the legs add up; by
    default the whole motion takes the least time.

    Parameters
    ----------
    robot : Robot
    places : sequence of array (nq,) or Constraint
        At least two configurations [rad, m], or constraints that hold there, such as ``rt.FramePosition``,
        ``rt.FramePose`` or ``rt.constraints.PoseRegion``. Inverse kinematics finds configurations of constraints.
    cyclic : bool
        Whether the motion returns from the last place to the first one, and ends there with the positions and speeds of
        its start. Otherwise it starts and ends at rest.
    objective : Objective, optional
        Objective of every leg; ``rt.Duration()`` by default.
    duration : (float, float) or Between
        Bounds of the duration of a leg [s].
    constraints : sequence of Constraint
        Constraints of every leg.
    limits : Limits, optional
        Those of the robot by default.
    stop : bool or sequence of int
        Numbers of the places, from 0, at which the motion comes to rest; True is every place.
    dwell : mapping of int to float
        Time [s] that the robot rests at a place after it arrived there, by number of the place.

    Raises
    ------
    InputError
        There is no robot, there are fewer than two places, or a place is neither a configuration nor a constraint. A
        stop or a dwell is at no place where a leg ends, or a dwell is not above 0.

    Examples
    --------
    >>> weld = rt.Waypoints(ur5, [home, above, seam, home], stop=[1], dwell={2: 0.5})  # doctest: +SKIP
    """

    def __init__(
        self,
        robot: Robot,
        places: Sequence[Waypoint],
        *,
        cyclic: bool = False,
        objective: Objective | None = None,
        duration: Sequence[float] | Between = (0.01, 20.0),
        constraints: Sequence[Constraint] = (),
        limits: Limits | None = None,
        stop: bool | Sequence[int] = False,
        dwell: Mapping[int, float] | None = None,
    ) -> None:
        if not isinstance(robot, Robot):
            raise InputError(f"rt.Waypoints moves a robot of rt.load(...); got {type(robot).__name__}.")
        if len(places) < 2:
            raise InputError(f"rt.Waypoints needs two places at least; got {len(places)}.")
        every = [_place(robot, place, number) for number, place in enumerate(places)]
        arrivals = [*range(1, len(every)), *([0] if cyclic else [])]
        waits = _waits({} if dwell is None else dwell, arrivals)
        rests = _stops(stop, arrivals) | set(waits) | (set() if cyclic else {0, len(every) - 1})
        given = robot.limits if limits is None else limits
        phases: list[Phase] = []
        for k, last in enumerate(arrivals):
            start, at_start = _end(every[0] if k == 0 else None, k in rests)
            end, at_end = _end(every[last] if last else None, last in rests)
            rows = [*constraints, *map(AtStart, at_start), *map(AtEnd, at_end)]
            each = Duration() if objective is None else objective
            phases.append(Phase(robot, duration, start, end, each, rows, limits=given, name=f"leg {k + 1}"))
            if last in waits:
                # From rest, joints without acceleration stay at rest exactly.
                still = {f"a.{joint}": 0.0 for joint in robot.velocity_names}
                apart = [each for each in constraints if each.avoids_collisions]
                phases.append(
                    Phase(
                        robot,
                        waits[last],
                        State(v=0.0),
                        constraints=apart,
                        algebraic=still,
                        limits=given,
                        name=f"dwell at {last}",
                    )
                )
        links: list[Link] = [Continuity(k, k + 1) for k in range(len(phases) - 1)]
        super().__init__(phases, [*links, Periodic()] if cyclic else links)


def _end(place: np.ndarray | Constraint | None, rests: bool) -> tuple[State, list[Constraint]]:
    """Return the state at an end of a leg, and the constraints there."""
    still = {"v": 0.0} if rests else {}
    if isinstance(place, Constraint):
        return State(**still), [place]
    return State(**still) if place is None else State(q=place, **still), []


def _stops(stop: bool | Sequence[int], arrivals: Sequence[int]) -> set[int]:
    if isinstance(stop, bool):
        return set(arrivals) if stop else set()
    return {_arrival(number, arrivals, "stop") for number in stop}


def _waits(dwell: Mapping[int, float], arrivals: Sequence[int]) -> dict[int, float]:
    if not isinstance(dwell, Mapping):
        raise InputError(f"dwell of rt.Waypoints maps numbers of places to times [s], {{2: 0.5}}; got {dwell!r}.")
    for number, wait in dwell.items():
        _arrival(number, arrivals, "dwell")
        if not (is_number(wait) and 0.0 < wait < np.inf):
            raise InputError(f"The dwell at place {number} of rt.Waypoints is {wait!r}; give a time above 0 s.")
    return {number: float(wait) for number, wait in dwell.items()}


def _arrival(number: int, arrivals: Sequence[int], what: str) -> int:
    if number not in arrivals:
        raise InputError(
            f"{what}= of rt.Waypoints names place {number!r}; the motion arrives at the places "
            f"{', '.join(map(str, sorted(arrivals)))}."
        )
    return number


def _place(robot: Robot, place: Waypoint, number: int) -> np.ndarray | Constraint:
    if isinstance(place, Constraint):
        return place
    try:
        q = np.array(place, dtype=float)
    except (TypeError, ValueError):
        q = np.zeros(0)
    if q.shape != (robot.nq,) or not np.isfinite(q).all():
        given = f"an array of shape {q.shape}" if q.size > 1 else "one number" if q.ndim == 0 else repr(place)
        raise InputError(
            f"Place {number} of rt.Waypoints is {given}. The places are a list, or an array (places, {robot.nq}); "
            f"give {robot.nq} joint positions, or a constraint "
            "such as rt.FramePose(frame, pose)."
        )
    return q
