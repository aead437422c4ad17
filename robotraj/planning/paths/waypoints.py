"""Waypoints that a robot passes without a stop, as one problem of linked phases."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from robotraj._util.errors import InputError
from robotraj.problem.constraints.base import AtEnd, AtStart, Constraint
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

if TYPE_CHECKING:
    from robotraj.problem.constraints.bounds import Between

Place: TypeAlias = "ArrayLike | Constraint"
"""Joint positions (nq,) [rad, m], or a constraint such as ``rt.FramePose(frame, pose)``."""


class Waypoints(Problem):
    """A motion through places in their order, from rest to rest or periodic, without a stop in between.

    Each leg from a place to the next is a phase with a free duration. Positions and velocities are continuous from leg
    to leg. The objectives of the legs add up; by default the whole motion takes the least time.

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

    Raises
    ------
    InputError
        There is no robot, there are fewer than two places, or a place is neither a configuration nor a constraint.
    """

    def __init__(
        self,
        robot: Robot,
        places: Sequence[Place],
        *,
        cyclic: bool = False,
        objective: Objective | None = None,
        duration: Sequence[float] | Between = (0.01, 20.0),
        constraints: Sequence[Constraint] = (),
        limits: Limits | None = None,
    ) -> None:
        if not isinstance(robot, Robot):
            raise InputError(f"rt.Waypoints moves a robot of rt.load(...); got {type(robot).__name__}.")
        if len(places) < 2:
            raise InputError(f"rt.Waypoints needs two places at least; got {len(places)}.")
        every = [_place(robot, place, number) for number, place in enumerate(places)]
        count = len(every) - (not cyclic)
        phases = []
        for k in range(count):
            rows, start, end = list(constraints), None, None
            if k == 0:
                first = every[0]
                still = {} if cyclic else {"v": 0}
                start = State(**still) if isinstance(first, Constraint) else State(q=first, **still)
                rows += [AtStart(first)] if isinstance(first, Constraint) else []
            if k + 1 < len(every):
                still = {"v": 0} if not cyclic and k == count - 1 else {}
                last = every[k + 1]
                end = State(**still) if isinstance(last, Constraint) else State(q=last, **still)
                rows += [AtEnd(last)] if isinstance(last, Constraint) else []
            phases.append(
                Phase(
                    robot,
                    duration,
                    start,
                    end,
                    Duration() if objective is None else objective,
                    rows,
                    limits=robot.limits if limits is None else limits,
                    name=f"leg {k + 1}",
                )
            )
        links: list[Link] = [Continuity(k, k + 1) for k in range(count - 1)]
        super().__init__(phases, [*links, Periodic()] if cyclic else links)


def _place(robot: Robot, place: Place, number: int) -> np.ndarray | Constraint:
    if isinstance(place, Constraint):
        return place
    try:
        q = np.array(place, dtype=float)
    except (TypeError, ValueError):
        q = np.zeros(0)
    if q.shape != (robot.nq,) or not np.isfinite(q).all():
        raise InputError(
            f"Place {number} of rt.Waypoints is {place!r}; give {robot.nq} joint positions, or a constraint "
            "such as rt.FramePose(frame, pose)."
        )
    return q
