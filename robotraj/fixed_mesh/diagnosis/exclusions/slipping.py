"""Slopes that are too steep for the friction of all contacts.

Over a motion that ends as fast as it began, the contacts' impulse balances gravity, sum int f dt = -m g T. Where all
stand on planes of one slope, every f lies in cones about one normal, and so must the vertical. That needs a coefficient
mu >= tan(angle of the slope), whatever the robot, its motion and the mesh.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robotraj.dynamics.contacts.base import Contact
from robotraj.dynamics.terrain.slope import Slope
from robotraj.problem.links.base import Link
from robotraj.problem.links.continuity import Continuity
from robotraj.problem.links.linkage import EqualDuration, SameParameter
from robotraj.problem.links.periodic import Mirror, Periodic
from robotraj.problem.links.touchdown import Liftoff, Touchdown
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.solution.conflict import Conflict

PRESERVING = (Continuity, Touchdown, Liftoff, Periodic, Mirror, EqualDuration, SameParameter)
"""Links at which nothing but impulses of contacts changes the momentum."""


def slipping_contacts(problem: Problem) -> tuple[Conflict, ...]:
    """Return the friction that the slope needs, if the problem has less; empty if speeds need not return."""
    stands = [_stand(contact.contact) for phase in problem.phases for contact in phase.bound_contacts]
    slopes = {None if stand is None else stand[0] for stand in stands}
    if len(slopes) != 1 or None in slopes or not _ends_as_fast_as_it_began(problem):
        return ()
    given, kept = max((stand[1:] for stand in stands if stand is not None), key=lambda each: each[0] * each[1])
    planar = any(phase.robot is not None and phase.robot.root == "planar" for phase in problem.phases)
    (slope,) = slopes
    assert slope is not None
    needed = (abs(slope[0]) if planar else float(np.hypot(*slope))) / kept
    if needed <= given:
        return ()
    first = next(phase for phase in problem.phases if phase.bound_contacts)
    name = f"friction cone, {first.bound_contacts[0].name}"
    reason = f"the slope of the ground, on which all contacts stand{margin_text(kept)}"
    return (Conflict(first.name, name, 0.0, given, needed, "", (needed - given) / given, True, reason, True),)


def margin_text(kept: float) -> str:
    """Return the margin of contacts for a reason; empty without one."""
    return f", with a margin of {100.0 * (1.0 - kept):.3g} %" if kept < 1.0 else ""


def _stand(contact: Contact) -> tuple[tuple[float, float], float, float] | None:
    """Return the slopes of the plane on which a contact stands, its friction and the used share; None for others."""
    ground = contact.ground
    if not isinstance(ground, Slope):
        return None
    return (float(ground.slope_x), float(ground.slope_y)), contact.friction, 1.0 - contact.margin


def _ends_as_fast_as_it_began(problem: Problem) -> bool:
    """Whether only contacts change the momentum, and the end has the speeds of the start, up to a reflection."""
    last = len(problem.phases) - 1
    if not all(isinstance(link, PRESERVING) for link in problem.links):
        return False
    return _repeats(problem.links, last) or (_rests(problem.phases[0], 0) and _rests(problem.phases[last], 1))


def _repeats(links: Sequence[Link], last: int) -> bool:
    """Whether the start of the first phase is the image of the end of the last one."""
    for link in links:
        if isinstance(link, Touchdown):
            closed, repeat = (link.first, link.second) in ((last, 0), (-1, 0)), link.repeat
        elif isinstance(link, Periodic | Mirror):
            closed, repeat = link.first == 0 and link.last in (-1, last), link
        else:
            continue
        if closed and repeat is not None and not any(name.startswith("v.") for name in repeat.displacement):
            return True
    return False


def _rests(phase: Phase, end: int) -> bool:
    """Whether all speeds are zero at the start (0) or the end (1) of a phase."""
    robot, bounds = phase.robot, tuple(phase.joint_ends.values())[end]
    if robot is None:
        return False
    speeds = slice(robot.nq, robot.nq + robot.nv)
    return not np.any(bounds.lower[speeds]) and not np.any(bounds.upper[speeds])
