"""The shapes of a phase's robot that must not overlap."""

from __future__ import annotations

from typing import TYPE_CHECKING

from robotraj._util.errors import InputError
from robotraj.problem.constraints.collision_free import disabled_pairs
from robotraj.robot.collision.own_body import OwnBody, own_body

if TYPE_CHECKING:
    from robotraj.problem.phase import Phase


def own_shapes(phase: Phase) -> OwnBody | None:
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
