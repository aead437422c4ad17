"""A check before planning: a robot whose links overlap at a fixed end of a phase."""

from __future__ import annotations

import numpy as np

from robotraj._util.errors import InputError
from robotraj.problem.constraints.collision_free import disabled_pairs
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.robot.collision.own_body import OwnBody, own_body


def check_own_ends(problem: Problem) -> None:
    """Refuse fixed ends at which links of the robot overlap, unless ``self_collision`` of the phase is False.

    Raises
    ------
    InputError
        The message names the end, the links and the depth of the deepest overlap.
    """
    for phase in problem.phases:
        body = body_of(phase)
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


def body_of(phase: Phase) -> OwnBody | None:
    """Return the shapes that must not overlap in a phase; None where there are none, or they cannot be read."""
    robot = phase.robot
    if robot is None or not phase.self_collision or phase.design:
        return None
    try:
        body = own_body(robot, disabled_pairs(phase.constraints))
    except InputError:
        # The URDF or a mesh was removed after the robot was loaded. A plan does not need them; the witness names them.
        return None
    return body if len(body.pairs) else None
