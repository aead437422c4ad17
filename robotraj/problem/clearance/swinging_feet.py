"""Feet stay above the ground in the phases that do not hold them.

A foot is a frame that a contact holds in some phase, or the image of one in a mirror. In every other phase its points
get the row z_p(q) - h(x_p, y_p) >= -d with d = 0.1 mm. h is the lowest of the grounds on which the problem holds
contacts, so that a foot that climbs onto a box starts below the top of the box. A hand that some phase holds on a wall
stays on the free side of that wall instead.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np
import pinocchio as pin

from robotraj._util.errors import InputError
from robotraj.dynamics.contacts.base import Contact, copied
from robotraj.dynamics.contacts.point_on_frame import Spot
from robotraj.dynamics.terrain.base import Ground
from robotraj.dynamics.terrain.flat import Flat
from robotraj.dynamics.terrain.function import as_ground
from robotraj.dynamics.terrain.lowest import Lowest
from robotraj.problem.constraints.base import Where
from robotraj.problem.constraints.clearance import GroundClearance
from robotraj.problem.links.base import Link
from robotraj.problem.links.periodic import Mirror
from robotraj.problem.phase import Phase
from robotraj.robot.robot import Robot
from robotraj.robot.root import root_of

TOUCH = 1e-4
"""Depth below the ground [m] that clearance permits, so that its rows are not redundant at liftoff and touchdown."""


def with_feet_above_ground(phases: Sequence[Phase], links: Iterable[Link]) -> tuple[Phase, ...]:
    """Return the phases with a ``GroundClearance`` of feet that they do not hold, where they have none.

    Raises
    ------
    InputError
        A given end of a phase has a foot below the ground. The message names the frame and its depth.
    """
    lowest = lowest_ground(phases)
    feet: dict[Ground, list[tuple[Robot, Spot]]] = {}
    for robot, spot, touched in _feet(phases, links):
        ground = lowest if lowest is not None and touched.below else touched
        feet.setdefault(ground, []).append((robot, spot))
    for ground, spots in feet.items():
        phases = [_above(phase, spots, ground) for phase in phases]
    return tuple(phases)


def stiff_legged(robot: Robot, frame: str) -> bool:
    """Return whether one turning joint joins a foot to the root: no knee lifts it past a standing foot."""
    model = robot.model
    first = len(root_of(robot.root).velocities)
    above = [model.joints[i] for i in model.supports[model.frames[robot.frame(frame)].parentJoint] if i]
    moving = [joint for joint in above if joint.idx_v >= first]
    return len(moving) == 1 and moving[0].shortname().startswith("JointModelR")


def lowest_ground(phases: Sequence[Phase]) -> Ground | None:
    """Return the ground on which contacts stand, of several ones the lowest at every place; None without any."""
    grounds = list(dict.fromkeys(as_ground(c.contact.ground) for p in phases for c in p.bound_contacts if c.stands))
    if grounds and all(isinstance(each, Flat) for each in grounds):
        return min(grounds, key=lambda each: each.level)  # type: ignore[attr-defined]
    return Lowest(grounds) if len(grounds) > 1 else next(iter(grounds), None)


def _feet(phases: Sequence[Phase], links: Iterable[Link]) -> list[tuple[Robot, Spot, Ground]]:
    """Return the points of feet that some phase holds, and of their mirror images, with the robot and the ground."""
    both: dict[str, str] = {}
    for link in links:
        repeat = getattr(link, "repeat", link)
        both |= repeat.partner_of if isinstance(repeat, Mirror) else {}
    found: dict[tuple[Robot, Spot, Ground], None] = {}
    for phase in phases:
        for contact in phase.bound_contacts:
            assert phase.robot is not None
            other = both.get(contact.name, both.get(contact.frame, contact.frame))
            feet: list[Contact] = [contact.contact]
            if other != contact.frame and other in phase.robot.frame_names:
                feet.append(copied(contact.contact, frame=other, name=None))
            for foot in feet:
                if foot.ground is not None:
                    found |= dict.fromkeys(
                        (phase.robot, spot, as_ground(foot.ground)) for spot in foot.bound_to(phase.robot).outline()
                    )
    return list(found)


def _above(phase: Phase, feet: Sequence[tuple[Robot, Spot]], ground: Ground) -> Phase:
    """Return the phase with the clearance of feet that it neither holds nor clears."""
    robot = phase.robot
    if robot is None:
        return phase
    held = {spot for contact in phase.bound_contacts for spot in contact.outline()}
    swinging = [spot for of, spot in feet if of is robot and spot not in held]
    if phase.contacts:
        swinging = [spot for spot in swinging if not stiff_legged(robot, spot.frame)]
    rows = [row for row in phase.constraints if isinstance(row, GroundClearance)]
    free = [spot for spot in swinging if not any(_replaces(row, robot, spot, ground) for row in rows)]
    if not free:
        return phase
    _check_ends(phase, robot, free, ground)
    places = [spot.plainly for spot in free]
    return replace(phase, constraints=[*phase.constraints, GroundClearance(places, -TOUCH, ground)])


def _replaces(row: GroundClearance, robot: Robot, spot: Spot, ground: Ground) -> bool:
    """Return whether a row of the phase keeps a point above the ground, or lets it pass through."""
    if isinstance(row.height, int | float) and row.height < -TOUCH:
        return False
    return (row.height is None or as_ground(row.ground) == ground) and row.covers(robot, spot)


def _check_ends(phase: Phase, robot: Robot, spots: Sequence[Spot], ground: Ground) -> None:
    """Raise an InputError if an end that fixes all positions has a foot below the ground."""
    model, data = robot.model, robot.model.createData()
    for where, bounds in phase.joint_ends.items():
        q = bounds.lower[: robot.nq]
        if not np.array_equal(q, bounds.upper[: robot.nq]) or where not in (Where.START, Where.END):
            continue
        pin.framesForwardKinematics(model, data, q)
        for spot in spots:
            place = [float(v) for v in data.oMf[robot.frame(spot.frame)].act(np.array(spot.offset))]
            depth = -float(ground.gap(place, spot.radius))
            if depth > TOUCH:
                inside = "below the ground" if ground.below else "behind its wall"
                away = f"Raise the robot by {depth:.3g} m" if ground.below else f"Move it back by {depth:.3g} m"
                raise InputError(
                    f"Phase {phase.name!r}: the {where.value} has foot {spot.frame!r} {depth:.3g} m {inside}, "
                    f"which another phase holds on it. {away} or bend that leg; "
                    f"rt.GroundClearance({spot.frame!r}, None) in constraints= lets the foot pass through the ground."
                )
