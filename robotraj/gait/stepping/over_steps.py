"""Walks from rest to rest over stairs and gaps: regular footholds, moved off the edges."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from robotraj._util.errors import InputError
from robotraj.dynamics.contacts.base import BoundContact
from robotraj.dynamics.contacts.point_contact import PointContact
from robotraj.dynamics.terrain.base import Ground
from robotraj.dynamics.terrain.steps import Steps
from robotraj.gait.checks import number
from robotraj.gait.feet import foot_contact
from robotraj.gait.repetition import on_ground
from robotraj.gait.stepping.footholds import LEVEL, Step, StepOptions, steps
from robotraj.gait.stepping.rest_to_rest import alternating
from robotraj.problem.problem import Problem
from robotraj.robot.robot import Robot
from robotraj.robot.size.reach import reach

if TYPE_CHECKING:
    from typing_extensions import Unpack

SAFE = 0.03
"""Default distance of a foot from an edge, relative to the reach of the robot."""
RAMP = 0.04
"""Length along x of the ramp that replaces a riser, relative to the reach of the robot."""


def stairs(
    robot: Robot,
    *,
    start: float,
    run: float,
    rise: float,
    count: int,
    step_length: float | None = None,
    edge_distance: float | None = None,
    **options: Unpack[StepOptions],
) -> Problem:
    """Return a walk over equal stairs along x from rest to rest, downwards if the rise is negative.

    Bipeds move one foot a step, quadrupeds the diagonal pairs of feet in turn. Footholds lie ``step_length`` apart, and
    those near an edge are moved onto the nearest tread. The ground of the motion is ``rt.terrain.Steps.stairs``, with
    ramps of 4 percent of the robot's reach.

    Parameters
    ----------
    robot : Robot
    start : float
        World x of the first edge [m].
    run, rise : float
        Depth and height of a stair [m].
    count : int
        Number of stairs.
    step_length : float, optional
        Displacement of the root in a step [m]; by default ``run``.
    edge_distance : float, optional
        Least distance of feet from edges [m]; by default 3 percent of the robot's reach, the farthest that its
        masses can be from its first joint.
    **options
        Of ``rt.gait.steps``, without ground.

    Raises
    ------
    InputError
        There are no stairs, a tread is too short for a foot, or a foot starts near an edge. The robot has neither two
        nor four feet. Further errors are those of ``steps``.
    """
    if not isinstance(count, int) or count < 1:
        raise InputError(f"rt.gait.stairs(count) is {count!r}; give at least 1 stair.")
    ground = Steps.stairs(start, run, rise, count, RAMP * reach(robot.model))
    treads = [(low, high) for low, high, _ in ground.treads]
    return _over(robot, ground, treads, run if step_length is None else step_length, edge_distance, "stairs", options)


def gap(
    robot: Robot,
    *,
    start: float,
    width: float,
    step_length: float,
    edge_distance: float | None = None,
    **options: Unpack[StepOptions],
) -> Problem:
    """Return a walk on level ground across a gap along x, from rest to rest; no foot stands in the gap.

    Footholds lie ``step_length`` apart, and those in the gap are moved to its nearer side. Swinging feet stay above the
    level of the ground.

    Parameters
    ----------
    robot : Robot
    start, width : float
        World x of the first edge, and distance of the edges [m].
    step_length, edge_distance, **options
        As for ``stairs``.

    Raises
    ------
    InputError
        The width or the step length is not positive, a foot starts near an edge, or the robot has neither two nor four
        feet. Further errors are those of ``steps``.
    """
    if not number(width, "rt.gait.gap(width)") > 0.0:
        raise InputError(f"rt.gait.gap(width) is {width!r}; give a positive length [m].")
    first = number(start, "rt.gait.gap(start)")
    sides = [(-np.inf, first), (first + width, np.inf)]
    return _over(robot, LEVEL, sides, step_length, edge_distance, "gap", options)


def _over(
    robot: Robot,
    ground: Ground,
    treads: Sequence[tuple[float, float]],
    step_length: float,
    edge_distance: float | None,
    what: str,
    options: StepOptions,
) -> Problem:
    """Return steps from rest until all feet stand on the last tread; treads are intervals of world x [m]."""
    length = number(step_length, f"rt.gait.{what}(step_length)")
    if not length > 0.0:
        raise InputError(f"rt.gait.{what}(step_length) is {step_length!r}; give a positive length [m].")
    away = (
        SAFE * reach(robot.model) if edge_distance is None else number(edge_distance, f"rt.gait.{what}(edge_distance)")
    )
    if "ground" in options:
        raise InputError(f"rt.gait.{what} sets its own ground; omit ground=, or use rt.gait.steps.")
    options = {**options, "ground": ground}
    groups, home = alternating(robot, options)
    kind = on_ground(options.get("contact", PointContact), ground)
    extents = {foot: _extent(foot_contact(kind, foot).bound_to(robot)) for foot in home}
    shortest = min(high - low for low, high in treads)
    if shortest < max(sum(each) for each in extents.values()) + 2.0 * away:
        raise InputError(
            f"rt.gait.{what}: the shortest level tread is {shortest:.3g} m, too short for a foot and its distance of "
            f"{away:.3g} m. Decrease edge_distance= or the size of the foot."
        )

    def landing(foot: str, x: float) -> float:
        """Return the place nearest to x where the whole foot lies on a tread."""
        back, front = extents[foot]
        inside = [float(np.clip(x, low + away + back, high - away - front)) for low, high in treads]
        return min(inside, key=lambda place: abs(place - x))

    offs = {foot: float(place[0]) - landing(foot, float(place[0])) for foot, place in home.items()}
    foot = max(offs, key=lambda name: abs(offs[name]))
    if abs(offs[foot]) > 1e-9:
        ends = [home[foot][0] + side for side in (-extents[foot][0], extents[foot][1])]
        advice = f"Increase start= by {offs[foot]:.3g} m" if offs[foot] > 0.0 else "Decrease start="
        raise InputError(
            f"rt.gait.{what}: at the beginning {foot!r} covers x = {ends[0]:.3g} to {ends[1]:.3g} m, less than "
            f"{away:.3g} m from an edge. {advice}, or decrease edge_distance=."
        )
    rear = min(home[foot][0] - away - extents[foot][0] for foot in home)
    count = max(int(np.ceil((treads[-1][0] - rear) / length - 1e-9)), 1)
    places = {foot: float(spot[0]) for foot, spot in home.items()}
    written: list[Step] = []
    for k in range(count + 1):
        moved = {f: landing(f, float(home[f][0]) + length * min(k + 1, count)) for f in groups[k % 2]}
        step = {f: (x, float(home[f][1])) for f, x in moved.items() if abs(x - places[f]) > 1e-9}
        places |= moved
        if step:
            written.append(step)
    return steps(robot, written, **options)


def _extent(contact: BoundContact) -> tuple[float, float]:
    """Return the extent of a foot behind and before its foothold along x [m]."""
    along = np.array([spot.offset for spot in contact.outline()])
    sole = along - along.mean(axis=0)
    return (0.0, 0.0) if len(sole) < 2 else (float(-sole[:, 0].min()), float(sole[:, 0].max()))
