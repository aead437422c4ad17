"""Motions from rest to rest that need more friction than the level ground has.

Contacts push the centre of mass up by f_z >= 0 and aside by |f_x| <= mu f_z, whatever the robot does. Take forces per
unit of mass, a motion of duration T that moves it by L along the ground and by h upwards, and any time c. Between both
rests the sideways impulse is zero. The moments about c of all forces, with the rise z of the centre of mass, are

    L = int (c - t) f_x dt,
    z(c) = int_0^c (c - t) f_z dt - g c^2 / 2,    z(c) - h = int_c^T (t - c) f_z dt - g (T - c)^2 / 2.

Hence L <= mu int |c - t| f_z dt = mu (2 z(c) - h + g (c^2 + (T - c)^2) / 2). Impulses at touchdowns are in the same
cone. Where a contact holds at the time c, the longest path through links and joints from it to all masses bounds z(c).
Since the forces add up to g T, L <= mu g T^2 / 2 as well, with c = T / 2.

The stated friction suffices for a centre of mass that rises evenly from start to end, if nothing else limits it.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj.dynamics.terrain.flat import Flat
from robotraj.fixed_mesh.diagnosis.exclusions.slipping import PRESERVING, margin_text
from robotraj.problem.constraints.base import Where
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.robot.robot import Robot
from robotraj.solution.conflict import Conflict, with_room


def slipping_motions(problem: Problem) -> tuple[Conflict, ...]:
    """Return the friction that a motion from rest to rest needs, if the ground has less; empty for other problems.

    All contacts stand on level ground, and both ends are fixed. Longest durations count.
    """
    phases = problem.phases
    robot = phases[0].robot
    if robot is None or robot.root == "fixed" or not _follow(problem):
        return ()
    if any(phase.robot is not robot or phase.design for phase in phases):
        return ()
    frictions = [_friction(phase) for phase in phases if phase.bound_contacts]
    begin, end = _place_at_rest(robot, phases[0], Where.START), _place_at_rest(robot, phases[-1], Where.END)
    if not frictions or None in frictions or begin is None or end is None:
        return ()
    most, level = _reaches(robot, phases, begin, end)
    given, kept = max(friction for friction in frictions if friction is not None)
    length = float(np.linalg.norm(end[:2] - begin[:2]))
    if not np.isfinite(most) or length <= kept * given * most or not level > 0.0:
        return ()
    needed = with_room(given, length / level / kept)
    total = sum(phase.duration_bounds[1] for phase in phases)
    pushing = next(phase for phase in phases if phase.bound_contacts)
    name = f"friction cone, {pushing.bound_contacts[0].name}"
    reason = f"the centre of mass moves {length:.3g} m from rest to rest in {total:.3g} s{margin_text(kept)}"
    return (Conflict(pushing.name, name, 0.0, given, needed, "", (needed - given) / given, True, reason, True),)


def _reaches(robot: Robot, phases: Sequence[Phase], begin: Array, end: Array) -> tuple[float, float]:
    """Return how far the centre of mass moves at most for a friction of 1, and if it rises evenly to the end [m]."""
    g = float(np.linalg.norm(robot.model.gravity.linear))
    times = np.cumsum([0.0, *(phase.duration_bounds[1] for phase in phases)])
    total, climb = float(times[-1]), float(end[2] - begin[2])
    most, level = 0.5 * g * total**2, np.inf
    for phase, first, last in zip(phases, times[:-1], times[1:], strict=True):
        if phase.bound_contacts:
            c = float(np.clip(0.5 * total, first, last))
            rise = _greatest_height(robot, phase) - float(begin[2])
            moments = 0.5 * g * (c**2 + (total - c) ** 2)
            most, level = min(most, moments + 2.0 * rise - climb), min(level, moments + (2.0 * c / total - 1.0) * climb)
    return most, min(most, level)


def _follow(problem: Problem) -> bool:
    """Whether every phase begins as the one before it ends, up to impulses of contacts."""
    if not all(isinstance(link, PRESERVING) for link in problem.links):
        return False
    joined = {(getattr(link, "first", None), getattr(link, "second", None)) for link in problem.links}
    return all(pair in joined for pair in pairwise(range(len(problem.phases))))


def _friction(phase: Phase) -> tuple[float, float] | None:
    """Return the largest friction of the contacts of a phase, and the share of it that plans use.

    None unless all stand on level ground.
    """
    contacts = [bound.contact for bound in phase.bound_contacts]
    if not all(isinstance(contact.ground, Flat) for contact in contacts):
        return None
    slippery = max(contacts, key=lambda each: each.planned_friction)
    return slippery.friction, 1.0 - slippery.margin


def _place_at_rest(robot: Robot, phase: Phase, end: Where) -> Array | None:
    """Return the centre of mass at an end of a phase [m]; None unless the end is fixed at rest."""
    bounds, size = phase.joint_ends[end], robot.nq + robot.nv
    lower, upper = bounds.lower[:size], bounds.upper[:size]
    if not np.array_equal(lower, upper) or not np.isfinite(lower).all() or lower[robot.nq :].any():
        return None
    place = np.array(pin.centerOfMass(robot.model, robot.model.createData(), np.array(lower[: robot.nq])))
    if robot.root == "planar":
        place[1] = 0.0
    return place


def _greatest_height(robot: Robot, phase: Phase) -> float:
    """Bound the height of the centre of mass while the contacts of a phase hold [m]."""
    feet = {(bound.frame, bound.contact.ground.level) for bound in phase.bound_contacts}  # type: ignore[union-attr]
    return max(level + longest_leg(robot, frame) for frame, level in feet)


def longest_leg(robot: Robot, frame: str) -> float:
    """Bound the distance of the centre of mass from a frame, whatever the configuration [m].

    It is the mean over the masses of the longest path of links and joints to each of them, infinite where joints slide.
    """
    model = robot.model
    foot = model.frames[robot.frame(frame)]
    lengths = [float(np.linalg.norm(place.translation)) for place in model.jointPlacements]
    for joint in range(1, model.njoints):
        # The root's own joints are on the way to every body, and so on no path between two of them.
        if model.joints[joint].nv == 1 and robot.units[model.joints[joint].idx_v] == "m":
            lengths[joint] = np.inf
    above, total = set(model.supports[foot.parentJoint]), 0.0
    for body in range(1, model.njoints):
        mass, lever = model.inertias[body].mass, float(np.linalg.norm(model.inertias[body].lever))
        if mass:
            total += mass * (lever + sum(lengths[joint] for joint in above ^ set(model.supports[body])))
    return total / robot.mass + float(np.linalg.norm(foot.placement.translation))
