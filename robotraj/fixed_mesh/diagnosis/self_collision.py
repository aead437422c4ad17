"""Fixed ends of a phase at which links of the robot overlap: no motion keeps off itself there."""

from __future__ import annotations

import numpy as np

from robotraj.problem.clearance.own_shapes import own_shapes
from robotraj.problem.problem import Problem
from robotraj.solution.conflict import Conflict

SIZE = 0.05
"""Distance [m] relative to which overlaps are stated where no larger margin is."""


def overlapping_ends(problem: Problem) -> tuple[Conflict, ...]:
    """Return the deepest overlap of links at each fixed end, the worst first, without a solve.

    Ends that are free, and phases with ``self_collision=False``, have none.
    """
    found = []
    for phase in problem.phases:
        body = own_shapes(phase)
        if body is None or phase.robot is None:
            continue
        for end, bounds in phase.joint_ends.items():
            q = np.asarray(bounds.lower[: phase.robot.nq])
            if not np.array_equal(q, bounds.upper[: phase.robot.nq]):
                continue
            overlaps = sorted((body.depth(phase.robot, q, pair), pair) for pair in body.touching(phase.robot, q))
            if overlaps:
                depth, worst = overlaps[-1]
                reason = (
                    f"at the {end.value} they overlap by {depth:.3g} m: choose another {end.value}, name the pair in "
                    "rt.CollisionFree(srdf=...), or give self_collision=False to the phase"
                )
                name = f"distance of {body.label(worst)}"
                found.append(
                    Conflict(phase.name, name, np.nan, 0.0, -depth, "m", depth / SIZE, False, reason, certain=True)
                )
    return tuple(sorted(found, key=lambda conflict: -conflict.relative))
