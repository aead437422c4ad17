"""Heights of links over the ground on which a robot stands, by the exact shapes.

Of several grounds the lowest at every place counts. A contact may be the middle of a ball or an ankle, so that a part
of its foot lies below the modelled ground. The ground of the other links is therefore that of the foot's shapes: it is
lower by the depth that some contact keeps as long as it holds. A link that carries feet may be as deep as where one of
them holds. A joint without shapes is its origin.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.design.binding import realised
from robotraj.dynamics.terrain.base import Ground
from robotraj.dynamics.terrain.flat import Flat
from robotraj.problem.clearance.link_parts import link_parts
from robotraj.problem.clearance.swinging_feet import lowest_ground
from robotraj.robot.collision.placements import placements
from robotraj.robot.robot import Robot
from robotraj.robot.size.reach import reach
from robotraj.witness.contacts.ground import SwingingFoot, feet_of_plan
from robotraj.witness.planned import robot_sample
from robotraj.witness.protocols import PhaseSolutionLike, SolutionLike
from robotraj.witness.sampling import interval_samples

OVERSIZED = "its shape lies below the feet in the neutral configuration and throughout"


@dataclass(frozen=True)
class LinkDepth(OneLine):
    """The lowest place of a link in one phase.

    Attributes
    ----------
    link, phase : str
    depth : float
        Largest depth below the ground that feet stand on [m]; negative where the link stays above.
    time : float
        Time of the lowest height [s].
    part : float
        The depth relative to the robot's reach.
    lowered : float
        How far the ground that feet stand on lies below the modelled one for this link [m].
    """

    link: str
    phase: str
    depth: float
    time: float
    part: float
    lowered: float


class _Lowest(NamedTuple):
    """Least and largest height of a link over the modelled ground in a phase [m], and the time of the least one.

    ``size`` is the robot's reach [m]; ``carries`` is whether the link carries a foot of some phase, ``holds`` whether
    that foot holds in this one.
    """

    link: str
    phase: str
    size: float
    carries: bool
    holds: bool
    least: float
    largest: float
    time: float


def link_depths_of(
    solution: SolutionLike, swings: Sequence[SwingingFoot], samples: int, clock: Callable[[], None] = lambda: None
) -> tuple[tuple[LinkDepth, ...], tuple[str, ...]]:
    """Measure every link of a robot that stands in some phase.

    Parameters
    ----------
    solution : Solution
    swings : sequence of SwingingFoot
        Links of feet that may pass through the ground are not measured.
    samples : int
        Points of every interval.
    clock : callable
        Called before each link; it raises an error at a limit of time.

    Returns
    -------
    depths : tuple of LinkDepth
    left_out : tuple of str
        Links whose shapes lie below the feet in the neutral configuration and below the ground at every time of the
        plan: they are larger than the links. Links of a robot whose shapes a design moves are neither named nor
        measured.
    """
    robots = [planned for planned in solution.phases if planned.phase.robot is not None]
    ground = lowest_ground([planned.phase for planned in robots])
    if ground is None:
        return (), ()
    robots = [planned for planned in robots if not planned.phase.design]
    feet = {spot.frame for spot in feet_of_plan(solution)}
    passing = {(swing.frame, swing.phase) for swing in swings if swing.free}
    found = [each for planned in robots for each in _measured(planned, ground, feet, passing, samples, clock)]
    standing = [each for each in found if each.holds]
    below = max((-each.largest for each in standing), default=0.0)
    deepest: dict[str, float] = {}
    for each in standing:
        deepest[each.link] = max(deepest.get(each.link, 0.0), -each.least)
    any_foot = max(deepest.values(), default=0.0)
    oversized = _below_feet(realised(robots[0]), feet) if robots else set()
    oversized -= {each.link for each in found if each.carries or each.largest > -below}
    depths = []
    for each in found:
        if each.link not in oversized:
            allowed = max(below, 0.0, deepest.get(each.link, any_foot) if each.carries else 0.0)
            depth = float(np.nan_to_num(-each.least - allowed, nan=np.inf))
            part = max(depth, 0.0) / each.size if each.size > 0.0 else 0.0
            depths.append(LinkDepth(each.link, each.phase, depth, each.time, part, allowed))
    return tuple(depths), tuple(f"{link} over the ground: {OVERSIZED}" for link in sorted(oversized))


def _below_feet(robot: Robot, feet: Collection[str]) -> set[str]:
    """Return the links that reach below all feet in the neutral configuration."""
    rotations, origins = placements(robot, robot.neutral[None])
    level = Flat(0.0)
    model, data = robot.model, robot.model.createData()
    pin.framesForwardKinematics(model, data, robot.neutral)
    lowest = min((float(data.oMf[robot.frame(foot)].translation[2]) for foot in feet), default=-np.inf)
    parts = link_parts(robot)
    heights = [(part.link, part.heights(rotations[:, part.joint], origins[:, part.joint], level)[0]) for part in parts]
    return {link for link, height in heights if height < lowest}


def _measured(
    planned: PhaseSolutionLike,
    ground: Ground,
    feet: set[str],
    passing: set[tuple[str, str]],
    samples: int,
    clock: Callable[[], None],
) -> Iterator[_Lowest]:
    """Yield the heights of every link of a robot, except those whose feet may pass through the ground."""
    robot, name = realised(planned), planned.phase.name
    joint_of = {foot: robot.model.frames[robot.frame(foot)].parentJoint for foot in feet}
    carrying = set(joint_of.values())
    free = {joint for foot, joint in joint_of.items() if (foot, name) in passing}
    holding = {robot.model.frames[robot.frame(contact.frame)].parentJoint for contact in planned.phase.bound_contacts}
    sampled = list(interval_samples(planned, samples))
    if not sampled:
        return
    times = np.concatenate([part.times for part in sampled])
    q = np.concatenate([robot_sample(planned, part.times, part.interval).q for part in sampled])
    rotations, origins = placements(robot, q)
    heights: dict[str, Array] = {}
    joints: dict[str, int] = {}
    for part in link_parts(robot, planned.phase.constraints):
        if part.joint not in free:
            clock()
            above = part.heights(rotations[:, part.joint], origins[:, part.joint], ground)
            heights[part.link] = np.minimum(above, heights.get(part.link, above))
            joints[part.link] = part.joint
    size = reach(robot.model)
    for link, found in heights.items():
        k, joint = int(np.argmin(np.nan_to_num(found, nan=-np.inf))), joints[link]
        carries, holds = joint in carrying, joint in holding
        yield _Lowest(link, name, size, carries, holds, float(found[k]), float(found.max()), float(times[k]))
