"""Two planned motions in one cell: how long the second robot waits so that their links stay apart.

With positions q_1(t) and q_2(t) of the plans, which rest at their ends, the cell at time t with a delay D is

    q(t) = (q_1(t), q_2(t - D)),    each at its first position before its start and at its last one after its end.

The least delay that keeps the clearance is found from below. Where the links come too near at a time t, the second
robot would have to be where it was earlier: no delay helps until q_2(t - D) is clear of q_1(t) there. The next delay is
the largest of those for several times t. The last one is proved: on every piece of the motion the distance of the links
in its middle exceeds the clearance by what their speeds change in half of the piece.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.checks import is_number
from robotraj._util.errors import InputError
from robotraj._util.lazy_values import cached_property
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.robot.collision.along_motion import Near, near_pairs, pairs_within
from robotraj.robot.collision.own_body import OwnBody, body_between
from robotraj.robot.collision.placements import placements
from robotraj.robot.collision.solids import hull_distance
from robotraj.robot.join import Pose, join
from robotraj.robot.robot import Robot
from robotraj.solution.solution import Solution

RESTING = 1e-6
"""Largest speed of a joint that rests [rad/s, m/s]."""
STEP = 5e-3
"""Difference of two delays that are compared, and the most by which the least one may be exceeded [s]."""
ASKED = 9
"""Number of times of a conflict at which longer delays are tried."""
PER_INTERVAL, RESERVE = 5, 1.2
"""Samples of the joint speeds in an interval, and a factor on them."""
OTHER = {"first": "second", "second": "first"}
SAMPLES = 201
"""Times at which the smallest distance is looked for."""


@dataclass(frozen=True, eq=False)
class SharedCell(OneLine):
    """Two plans in one cell, of which the second begins after a delay; see ``share_cell``.

    Attributes
    ----------
    first, second : Solution
    robot : Robot
        Both robots at their places, as of ``rt.robot.join``.
    delay : float
        Time from the start of the first motion to that of the second [s].
    clearance : float
        Distance that is proved at every time for all links of one robot and of the other [m].
    unjudged : tuple of (str, str)
        Links whose shapes are missing, each with the reason.
    """

    first: Solution
    second: Solution
    robot: Robot
    delay: float
    clearance: float
    unjudged: tuple[tuple[str, str], ...] = ()

    def __str__(self) -> str:
        name, distance, time = self.nearest
        lines = [
            f"The second motion waits {self.delay:.3f} s; both end after {self.duration:.3f} s.",
            f"Links stay {1e3 * self.clearance:.4g} mm apart at every time. "
            f"The nearest are {name}, {1e3 * distance:.4g} mm at t = {time:.3f} s.",
        ]
        lines += [f"Not judged: {link}, {reason}." for link, reason in self.unjudged]
        return "\n".join(lines)

    @property
    def duration(self) -> float:
        """Time until both robots rest at their ends [s]."""
        return max(self.first.duration, self.delay + self.second.duration)

    def positions(self, times: Array) -> Array:
        """Return the positions of ``robot`` at times (m,), (m, nq)."""
        t = np.asarray(times, dtype=float)
        parts = ((self.first, t), (self.second, t - self.delay))
        return np.hstack([plan.at(np.clip(own, 0.0, plan.duration)).q for plan, own in parts])

    @cached_property
    def nearest(self) -> tuple[str, float, float]:
        """The two links that are nearest at ``SAMPLES`` times, the distance of their convex hulls [m], the time [s]."""
        body, times = _between(self.robot), np.linspace(0.0, self.duration, SAMPLES)
        least = ("", np.inf, 0.0)
        for time, rotations, origins in zip(times, *placements(self.robot, self.positions(times)), strict=True):
            placed = [body.placed(shape, rotations, origins) for shape in range(len(body.solids))]
            for pair, (a, b) in enumerate(body.pairs.tolist()):
                apart = hull_distance(placed[a], placed[b])
                if apart < least[1]:
                    least = body.label(pair), apart, float(time)
        return least


def share_cell(
    first: Solution, second: Solution, at: Mapping[str, Pose] | None = None, *, clearance: float = 0.02
) -> SharedCell:
    """Let two robots share a cell in time: the second one waits at its start until the first one has made way.

    Parameters
    ----------
    first, second : Solution
        Plans of robots with fixed roots, from rest to rest. The first is not changed. For a slower second robot give
        ``rt.override(second, 0.5)``.
    at : mapping of str to pose, optional
        Poses of the roots ``"first"`` and ``"second"`` in the world, as of ``rt.robot.join``: (x, y, z) [m], or
        ((x, y, z), (x, y, z, w)). The origin by default.
    clearance : float
        Least distance of a link of one robot from one of the other, above 0 [m]. It is that of their convex hulls; up
        to 5 mm that of their exact shapes.

    Returns
    -------
    SharedCell
        With the least ``delay``, up to 5 ms; ``str`` of it names the links that come nearest.

    Raises
    ------
    InputError
        A plan is none of a robot, was not solved or does not rest at an end, or the clearance is not above 0. Or no
        delay helps, since a robot at rest stands in the way of the other: the message names both links, and the other
        order where it helps.

    Examples
    --------
    >>> cell = rt.share_cell(pick, place, at={"second": (0.9, 0.0, 0.0)})  # doctest: +SKIP
    >>> cell.delay  # doctest: +SKIP
    """
    if not (is_number(clearance) and 0.0 < clearance < np.inf):
        raise InputError(f"The clearance of a shared cell is {clearance!r}; give a distance above 0 m.")
    one, two = _robot_of(first, "first"), _robot_of(second, "second")
    found = _shared(first, second, join({"first": one, "second": two}, at), clearance)
    if isinstance(found, SharedCell):
        return found
    swapped = {OTHER[name]: pose for name, pose in (at or {}).items()}
    other = _shared(second, first, join({"first": two, "second": one}, swapped), clearance)
    remedy = (
        f"Let the first robot wait instead: share_cell(second, first) has a delay of {other.delay:.3f} s."
        if isinstance(other, SharedCell)
        else "In the other order a robot at rest stands in the way, too. Plan other ends, or move the robots apart."
    )
    raise InputError(f"No delay keeps the robots {clearance:g} m apart: {found}. {remedy}")


def _robot_of(plan: Solution, which: str) -> Robot:
    """Return the robot of a plan from rest to rest."""
    robots = [part.phase.robot for part in plan.phases] if isinstance(plan, Solution) else [None]
    robot = robots[0]
    if robot is None or any(each is not robot for each in robots) or not plan.success:
        raise InputError(f"rt.share_cell takes two plans that were solved, each of one robot; the {which} is {plan!r}.")
    speeds = np.abs(plan.at(np.array([0.0, plan.duration])).v).max(axis=1)
    if speeds.max() > RESTING:
        end = "start" if speeds[0] > RESTING else "end"
        raise InputError(f"The {which} motion moves at its {end}; robots that share a cell rest at both ends, v=0.")
    return robot


def _shared(first: Solution, second: Solution, robot: Robot, clearance: float) -> SharedCell | str:
    """Return the cell with the least delay, or which robot stands in the way of the other at rest."""
    body = _between(robot)
    cell = SharedCell(first, second, robot, 0.0, float(clearance), body.unguarded)
    while True:
        near = _too_near(cell, body)
        if not near:
            return cell
        longer = [cell.delay + STEP]
        every = np.array(sorted({(time, each.pair) for each in near for time in each.times.tolist()}))
        for time, pair in every[np.unique(np.linspace(0, len(every) - 1, ASKED).astype(int))]:
            wait = _free_from(cell, body, float(time))
            if wait is None or time >= first.duration:
                still = "second robot at its start" if wait is None else "first robot at its end"
                return f"the {still} stands in the way, {body.label(int(pair))} at t = {time:.3f} s"
            longer.append(wait)
        cell = SharedCell(first, second, robot, max(longer), cell.clearance, body.unguarded)


def _free_from(cell: SharedCell, body: OwnBody, time: float) -> float | None:
    """Return the least longer delay with which the links are apart at one time [s]; None where none is."""
    left = time - cell.delay
    delays = time - np.append(np.arange(left - STEP, 0.0, -STEP), 0.0)
    q = np.hstack(
        [
            np.repeat(cell.first.at(np.array([min(time, cell.first.duration)])).q, len(delays), axis=0),
            cell.second.at(np.clip(time - delays, 0.0, cell.second.duration)).q,
        ]
    )
    free = np.flatnonzero(~pairs_within(cell.robot, body, q, cell.clearance).any(axis=1))
    return float(delays[free[0]]) if free.size else None


def _too_near(cell: SharedCell, body: OwnBody) -> list[Near]:
    """Return the pairs of links that are not proved to stay apart."""
    ends = (0.0, cell.first.duration, cell.delay, cell.duration)
    knots = np.unique(np.concatenate([cell.first.knots, cell.second.knots + cell.delay, ends]))
    inside = (knots[:-1, None] + np.diff(knots)[:, None] * np.linspace(0.0, 1.0, PER_INTERVAL)).ravel()
    speeds = []
    for plan, own in ((cell.first, inside), (cell.second, inside - cell.delay)):
        moving = (own >= 0.0) & (own <= plan.duration)
        speeds.append(np.abs(plan.at(np.clip(own, 0.0, plan.duration)).v) * moving[:, None])
    bounds = RESERVE * np.hstack(speeds).reshape(len(knots) - 1, PER_INTERVAL, -1).max(axis=1)
    found = near_pairs(cell.robot, body, cell.positions, knots, bounds, apart=cell.clearance)
    return [each for each in found if each.overlaps]


def _between(robot: Robot) -> OwnBody:
    return body_between(robot, lambda link: link.startswith("first_"))
