"""Jumps from rest to rest that are too long for the friction of the ground.

Contacts push the centre of mass up by f_z >= 0 and aside by |f_x| <= mu f_z. This bounds its motion whatever the robot
does. Per unit of mass, a stance of duration S from rest that rises by a has the impulse and the moment

    int f_z dt = v + g S,    int (S - t) f_z dt = a + g S^2 / 2,

with the speed of takeoff v. It moves the centre of mass by at most mu (a + g S^2 / 2) and ends at most at the speed
mu (v + g S) along the ground. The same holds for a landing, backwards in time, with impulses at the touchdown. A flight
of duration T from a higher takeoff is slower at takeoff, T v = d + b - a + g T^2 / 2. Here d is the rise of the whole
motion and b the height of the centre of mass at touchdown above its end. With both durations of stance, S and R, the
length L of the jump satisfies

    L <= mu (g (S^2 + R^2 + T^2) / 2 + min(2 b + d + g S T, 2 a - d + g R T)).

The longest path through links and joints from a foot to all masses bounds a and b.
"""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from robotraj.dynamics.terrain.flat import Flat
from robotraj.planning.diagnosis.exclusions.slipping import PRESERVING
from robotraj.problem.constraints.base import Where
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.robot.robot import Robot
from robotraj.solution.conflict import Conflict

Array = NDArray[np.float64]


class _Rest(NamedTuple):
    """Centre of mass of a robot at rest [m], and how far it can rise on its feet."""

    place: Array
    rise: float


def slipping_jumps(problem: Problem) -> tuple[Conflict, ...]:
    """Return the friction that a jump needs, if the ground has less; empty for other problems.

    The phases are stances on level ground, one flight of fixed duration, and stances again. Both ends are fixed.
    """
    phases = problem.phases
    robot, flights = phases[0].robot, [i for i, phase in enumerate(phases) if not phase.bound_contacts]
    if robot is None or robot.root == "fixed" or len(flights) != 1 or not 0 < flights[0] < len(phases) - 1:
        return ()
    (air,) = flights
    stands = phases[:air], phases[air + 1 :]
    if any(phase.robot is not robot or phase.design for phase in phases) or not _follow(problem):
        return ()
    frictions = [_friction(phase) for phase in (*stands[0], *stands[1])]
    least, most = phases[air].duration_bounds
    if None in frictions or least != most:
        return ()
    rests = _rest(robot, stands[0][0], Where.START), _rest(robot, stands[1][-1], Where.END)
    if None in rests:
        return ()
    begin, end = (rest for rest in rests if rest is not None)
    push, land = (sum(phase.duration_bounds[1] for phase in side) for side in stands)
    g = float(np.linalg.norm(robot.model.gravity.linear))
    climb = float(end.place[2] - begin.place[2])
    reach = 0.5 * g * (push**2 + land**2 + most**2) + min(
        2.0 * end.rise + climb + g * push * most, 2.0 * begin.rise - climb + g * land * most
    )
    given = max(friction for friction in frictions if friction is not None)
    length = float(np.linalg.norm(end.place[:2] - begin.place[:2]))
    if length <= given * reach or not reach > 0.0:
        return ()
    needed = length / reach
    name = f"friction cone, {stands[0][-1].bound_contacts[0].name}"
    reason = f"a jump of {length:.3g} m with {most:.3g} s of flight needs at least this friction on all contacts"
    time = sum(phase.duration_bounds[1] for phase in stands[0])
    return (Conflict(stands[0][-1].name, name, time, given, needed, "", (needed - given) / given, True, reason, True),)


def _follow(problem: Problem) -> bool:
    """Whether every phase begins as the one before it ends, up to impulses of contacts."""
    if not all(isinstance(link, PRESERVING) for link in problem.links):
        return False
    joined = {(getattr(link, "first", None), getattr(link, "second", None)) for link in problem.links}
    return all(pair in joined for pair in pairwise(range(len(problem.phases))))


def _friction(phase: Phase) -> float | None:
    """Return the largest friction of the contacts of a phase; None unless all stand on level ground."""
    found = []
    for bound in phase.bound_contacts:
        friction = getattr(bound.contact, "friction", None)
        if not isinstance(getattr(bound.contact, "ground", None), Flat) or not isinstance(friction, float | int):
            return None
        found.append(float(friction))
    return max(found)


def _rest(robot: Robot, phase: Phase, end: Where) -> _Rest | None:
    """Return the centre of mass at an end of a phase, and its greatest rise; None unless the end is fixed at rest."""
    bounds, size = phase.joint_ends[end], robot.nq + robot.nv
    lower, upper = bounds.lower[:size], bounds.upper[:size]
    if not np.array_equal(lower, upper) or not np.isfinite(lower).all() or lower[robot.nq :].any():
        return None
    place = np.array(pin.centerOfMass(robot.model, robot.model.createData(), np.array(lower[: robot.nq])))
    if robot.root == "planar":
        place[1] = 0.0
    feet = {(bound.frame, bound.contact.ground.level) for bound in phase.bound_contacts}  # type: ignore[attr-defined]
    return _Rest(place, max(level + longest_leg(robot, frame) for frame, level in feet) - float(place[2]))


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
