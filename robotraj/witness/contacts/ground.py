"""Heights of feet over the ground in the phases in which they swing, and their speeds when they land.

Every contact of the problem is followed through all phases by plain Pinocchio, whatever rows the problem has. Feet that
a mirror puts in the place of others are followed too. Between several grounds, a foot stays above the lowest of them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.contacts.base import BoundContact, copied
from robotraj.dynamics.contacts.force_measure import GRAVITY
from robotraj.dynamics.contacts.point_on_frame import Spot
from robotraj.dynamics.design.binding import realised
from robotraj.dynamics.terrain.base import Ground
from robotraj.dynamics.terrain.function import as_ground
from robotraj.problem.clearance.swinging_feet import lowest_ground, stiff_legged
from robotraj.problem.constraints.clearance import GroundClearance
from robotraj.problem.links.periodic import Mirror
from robotraj.robot.robot import Robot
from robotraj.robot.size.reach import reach
from robotraj.witness.numbers import as_numbers
from robotraj.witness.planned import robot_sample
from robotraj.witness.protocols import PhaseSolutionLike, SolutionLike
from robotraj.witness.sampling import interval_samples

WORLD = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED


@dataclass(frozen=True)
class SwingingFoot(OneLine):
    """The height of a foot in a phase that does not hold it.

    Attributes
    ----------
    frame, phase : str
    depth : float
        Largest depth of its lowest point below the ground [m]; 0 where it stays above.
    time : float
        Time of its lowest height [s].
    rise : float
        Speed away from the ground just before it lands with an impact at the end of the phase [m/s]; 0 where it comes
        from above.
    end : float
        Time at the end of the phase [s].
    part : float
        The larger of the depth relative to the robot's reach l, and of the rise relative to sqrt(g l).
    free : bool
        Whether the foot may pass through the ground: ``rt.GroundClearance(frame, None)`` allows it, or its leg is one
        rigid body, which no knee lifts past a standing foot.
    """

    frame: str
    phase: str
    depth: float
    time: float
    rise: float
    end: float
    part: float
    free: bool


class FootPoint(NamedTuple):
    """A point of a frame that touches a ground in some phase, or the middle of a ball of ``radius`` [m] that does."""

    frame: str
    offset: tuple[float, float, float]
    ground: Ground
    radius: float = 0.0


def swings_of(
    solution: SolutionLike, samples: int, clock: Callable[[], None] = lambda: None
) -> tuple[SwingingFoot, ...]:
    """Follow every foot through the phases that do not hold it, at ``samples`` points of every interval."""
    lowest = lowest_ground([planned.phase for planned in solution.phases if planned.phase.robot is not None])
    feet = feet_of_plan(solution)
    found: list[SwingingFoot] = []
    for index, planned in enumerate(solution.phases):
        held = {(spot.frame, spot.offset) for contact in planned.phase.bound_contacts for spot in _spots(contact)}
        swinging = [spot for spot in feet if (spot.frame, spot.offset) not in held]
        if planned.phase.robot is not None and swinging:
            found += _followed(planned, swinging, lowest, _landing(solution, index), samples, clock)
    return tuple(found)


def feet_of_plan(solution: SolutionLike) -> list[FootPoint]:
    """Return the points of the feet of all phases, and of their mirror images, in the order of the phases."""
    both: dict[str, str] = {}
    for link in getattr(solution.problem, "links", ()):
        repeat = getattr(link, "repeat", link)
        both |= repeat.partner_of if isinstance(repeat, Mirror) else {}
    spots: dict[FootPoint, None] = {}
    for planned in solution.phases:
        robot = planned.phase.robot
        for contact in planned.phase.bound_contacts:
            spots |= dict.fromkeys(_spots(contact))
            other = both.get(contact.name, both.get(contact.frame, contact.frame))
            if other != contact.frame and robot is not None and robot.model.existFrame(other):
                spots |= dict.fromkeys(_spots(copied(contact.contact, frame=other, name=None).bound_to(robot)))
    return list(spots)


def _spots(contact: BoundContact) -> list[FootPoint]:
    """Return the points of a contact with a ground."""
    ground = contact.contact.ground
    if ground is None:
        return []
    return [FootPoint(spot.frame, spot.offset, as_ground(ground), spot.radius) for spot in contact.outline()]


def _landing(solution: SolutionLike, index: int) -> set[str]:
    """Return the frames that land with an impact at the end of a phase, as they are called before a mirror."""
    frames: set[str] = set()
    for link, bound in zip(getattr(solution.problem, "links", ()), solution.problem.bound_links, strict=False):
        if bound.phases[0] == index and any(row.name == "impact" for row in bound.rows):
            repeat = getattr(link, "repeat", None)
            both = repeat.partner_of if isinstance(repeat, Mirror) else {}
            for contact in solution.phases[bound.phases[1]].phase.bound_contacts:
                frames.add(both.get(contact.name, both.get(contact.frame, contact.frame)))
    return frames


def _followed(
    planned: PhaseSolutionLike,
    spots: Sequence[FootPoint],
    lowest_below: Ground | None,
    landing: set[str],
    samples: int,
    clock: Callable[[], None],
) -> list[SwingingFoot]:
    """Return the swing of each frame in one phase."""
    robot = realised(planned)
    model, data = robot.model, robot.model.createData()
    indices = [robot.frame(spot.frame) for spot in spots]
    lowest = {spot.frame: (np.inf, 0.0) for spot in spots}
    for part in interval_samples(planned, samples):
        clock()
        q = robot_sample(planned, part.times, part.interval).q
        places = np.empty((len(q), len(spots), 3))
        for i, each in enumerate(q):
            pin.forwardKinematics(model, data, each)
            for k, spot in enumerate(spots):
                places[i, k] = pin.updateFramePlacement(model, data, indices[k]).act(np.array(spot.offset))
        for k, spot in enumerate(spots):
            ground = lowest_below if lowest_below is not None and spot.ground.below else spot.ground
            heights = np.asarray(ground.gap(list(places[:, k].T), spot.radius))
            i = int(np.argmin(np.nan_to_num(heights, nan=-np.inf)))
            lowest[spot.frame] = min(lowest[spot.frame], (float(heights[i]), float(part.times[i])))
    size = reach(model)
    speed = float(np.sqrt(GRAVITY * size))
    passing = _passing(planned, robot, spots)
    end = float(planned.knots[-1])
    swings = []
    for frame, (height, time) in lowest.items():
        depth = float(np.nan_to_num(max(-height, 0.0), nan=np.inf))
        own = [spot for spot in spots if spot.frame == frame]
        rise = _rise(planned, own) if frame in landing else 0.0
        part_of_size = max(depth / size, rise / speed) if size > 0.0 else 0.0
        swings.append(SwingingFoot(frame, planned.phase.name, depth, time, rise, end, part_of_size, frame in passing))
    return swings


def _passing(planned: PhaseSolutionLike, robot: Robot, spots: Sequence[FootPoint]) -> set[str]:
    """Return the frames that may pass through the ground: by a constraint, or because their legs cannot be bent."""
    phase = planned.phase
    rows = [each for each in phase.constraints if isinstance(each, GroundClearance) and each.height is None]
    allowed = {
        spot.frame
        for spot in spots
        if any(row.covers(robot, Spot(spot.frame, spot.offset, spot.radius)) for row in rows)
    }
    stiff = {spot.frame for spot in spots if phase.contacts and stiff_legged(robot, spot.frame)}
    return allowed | stiff


def _rise(planned: PhaseSolutionLike, spots: Sequence[FootPoint]) -> float:
    """Return the largest speed of points along the ground's normal at the end of a phase, 0 if they come down."""
    robot = realised(planned)
    model, data = robot.model, robot.model.createData()
    knots = np.asarray(planned.knots, dtype=float)
    sample = robot_sample(planned, knots[-1:], len(knots) - 2)
    pin.forwardKinematics(model, data, sample.q[0], sample.v[0])
    fastest = 0.0
    for spot in spots:
        index = robot.frame(spot.frame)
        pose = pin.updateFramePlacement(model, data, index)
        motion = pin.getFrameVelocity(model, data, index, WORLD)
        arm = pose.rotation @ np.array(spot.offset)
        place = [float(each) for each in pose.translation + arm]
        normal = as_numbers(spot.ground.normal_at(place), "normal of the ground")
        fastest = max(fastest, float(normal @ (motion.linear + np.cross(motion.angular, arm))))
    return fastest
