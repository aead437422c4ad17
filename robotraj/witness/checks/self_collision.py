"""Overlaps of a robot's own links along a plan, judged by coal on the exact shapes as solids.

Every robot with shapes is judged, whatever the problem states about distances. The speeds that bound the motion between
two evaluations are sampled from the plan, with a reserve.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj.problem.constraints.collision_free import disabled_pairs
from robotraj.problem.phase import Phase
from robotraj.robot.collision.along_motion import deepest_overlap, least_distance, near_pairs
from robotraj.robot.collision.own_body import own_body
from robotraj.witness.checks.clearance import Clearance, speeds_of
from robotraj.witness.planned import robot_sample
from robotraj.witness.protocols import PhaseSolutionLike

SWITCHED_OFF = "self_collision=False"
DESIGN = "its design may move the shapes"


class OwnBodyFigures(NamedTuple):
    """How near the links of a robot come to each other in a phase.

    Attributes
    ----------
    overlaps : tuple of Clearance
        Pairs of links that overlap, the deepest first: ``distance`` is the negative of the depth [m].
    nearest : Clearance or None
        The pair that comes nearest without an overlap, of those that come near.
    judged : int
        Number of pairs of shapes that were judged.
    unjudged : tuple of str
        What could not be judged, such as links whose shapes were not read, each with the reason.
    left_out : tuple of str
        Pairs of links that are not judged on purpose, each with the reason.
    """

    overlaps: tuple[Clearance, ...] = ()
    nearest: Clearance | None = None
    judged: int = 0
    unjudged: tuple[str, ...] = ()
    left_out: tuple[str, ...] = ()


def own_body_of(planned: PhaseSolutionLike, clock: Callable[[], None] = lambda: None) -> OwnBodyFigures:
    """Judge whether the links of a robot overlap in a phase."""
    phase = planned.phase
    if not isinstance(phase, Phase) or phase.robot is None:
        return OwnBodyFigures()
    robot = phase.robot
    if not phase.self_collision:
        return OwnBodyFigures(left_out=(f"all links in phase {phase.name!r}: {SWITCHED_OFF}",))
    try:
        body = own_body(robot, disabled_pairs(phase.constraints))
    except InputError as error:
        return OwnBodyFigures(unjudged=(f"all links of {robot.name}: {error}",))
    unjudged = tuple(f"{link}: {reason}" for link, reason in body.unguarded)
    left_out = tuple(f"{pair}: {reason}" for pair, reason in body.left_out)
    if phase.design and len(body.pairs):
        return OwnBodyFigures(unjudged=(*unjudged, f"all links in phase {phase.name!r}: {DESIGN}"), left_out=left_out)

    def motion(times: Array) -> Array:
        return robot_sample(planned, times).q

    knots = np.asarray(planned.knots, dtype=float)
    found = near_pairs(robot, body, motion, knots, speeds_of(planned, knots), clock) if len(body.pairs) else []
    overlaps: dict[str, Clearance] = {}
    nearest: Clearance | None = None
    for each in found:
        clock()
        label = body.label(each.pair)
        if each.overlaps:
            depth, time = deepest_overlap(robot, body, motion, each)
            if label not in overlaps or -depth < overlaps[label].distance:
                overlaps[label] = Clearance(phase.name, label, -depth, 0.0, time)
        else:
            distance, time = least_distance(robot, body, motion, each)
            if nearest is None or distance < nearest.distance:
                nearest = Clearance(phase.name, label, distance, 0.0, time)
    worst = tuple(sorted(overlaps.values(), key=lambda each: each.distance))
    return OwnBodyFigures(worst, nearest, len(body.pairs), unjudged, left_out)
