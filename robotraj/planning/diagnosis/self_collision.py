"""A warning before planning: an arm that passes through itself at an end of a phase."""

from __future__ import annotations

import numpy as np

from robotraj._util.errors import InputError, warn
from robotraj.problem.constraints.collision_free import CollisionFree
from robotraj.problem.problem import Problem
from robotraj.robot.collision.exact_shapes import touching_links


def warn_of_self_collision(problem: Problem) -> None:
    """Warn of fixed ends at which links of an arm touch, in phases where no ``CollisionFree`` keeps links apart.

    Warns
    -----
    UserWarning
        Names the links and the end.
    """
    for phase in problem.phases:
        robot = phase.robot
        kept = any(isinstance(each, CollisionFree) and each.self_collision for each in phase.constraints)
        if robot is None or robot.root != "fixed" or kept:
            continue
        for end, bounds in phase.joint_ends.items():
            q = bounds.lower[: robot.nq]
            if not np.array_equal(q, bounds.upper[: robot.nq]):
                continue
            try:
                touching = touching_links(robot, np.asarray(q))
            except InputError:
                # The URDF or a mesh was removed after the robot was loaded. A plan does not need them.
                return
            if touching:
                warn(
                    f"Phase {phase.name!r}: at the {end.value} {', '.join(touching)} touch; add rt.CollisionFree() to "
                    f"keep links apart, or choose another {end.value}."
                )
