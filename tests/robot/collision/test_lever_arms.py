"""Bounds on the speeds of points, and on their distances from the axes of other joints."""

from __future__ import annotations

import numpy as np
import pytest

import robotraj as rt
from robotraj.robot.collision.lever_arms import levers_across
from robotraj.robot.collision.own_body import own_body
from robotraj.robot.collision.placements import joint_tree, placements


@pytest.mark.parametrize("name", ["ur5", "panda"])
def test_points_are_no_further_from_the_axes_of_other_joints_than_the_bounds(name: str) -> None:
    robot, rng = rt.load(name), np.random.default_rng(2)
    body, tree = own_body(robot), joint_tree(robot)
    bounds, moved = levers_across(robot, body.joint, body.farthest), tree.is_moved_by()
    limits = robot.limits
    for _ in range(5):
        q = rng.uniform(limits.position_lower, limits.position_upper)
        rotations, origins = (each[0] for each in placements(robot, q[None]))
        for shape, (joint, point) in enumerate(zip(body.joint.tolist(), body.farthest, strict=True)):
            place = rotations[joint] @ point + origins[joint]
            for j in np.flatnonzero(tree.turns & ~moved[joint]).tolist():
                axis = rotations[j] @ tree.axes[j]
                away = np.linalg.norm(np.cross(place - origins[j], axis))
                assert away <= bounds[shape, robot.model.joints[j].idx_v] + 1e-12
