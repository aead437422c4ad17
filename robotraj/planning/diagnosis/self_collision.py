"""A check before planning: a robot whose links overlap at a fixed end of a phase."""

from __future__ import annotations

import numpy as np

from robotraj._util.errors import InputError
from robotraj.problem.clearance.own_shapes import own_shapes
from robotraj.problem.problem import Problem


def check_own_ends(problem: Problem) -> None:
    """Refuse fixed ends at which links of the robot overlap, unless ``self_collision`` of the phase is False.

    Raises
    ------
    InputError
        The message names the end, the links and the depth of the deepest overlap.
    """
    for phase in problem.phases:
        body = own_shapes(phase)
        if body is None or phase.robot is None:
            continue
        for end, bounds in phase.joint_ends.items():
            q = np.asarray(bounds.lower[: phase.robot.nq])
            if not np.array_equal(q, bounds.upper[: phase.robot.nq]):
                continue
            found = sorted((body.depth(phase.robot, q, pair), pair) for pair in body.touching(phase.robot, q))
            if found:
                depth, worst = found[-1]
                raise InputError(
                    f"Phase {phase.name!r}: at the {end.value} {body.label(worst)} overlap by {depth:.3g} m. Choose "
                    f"another {end.value}. If they may overlap, name the pair in rt.CollisionFree(srdf=...), or give "
                    "self_collision=False to the phase."
                )
