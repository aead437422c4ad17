"""A robot's spheres and obstacles at rest, compiled."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from robotraj.dynamics.obstacles.base import Obstacle
from robotraj.dynamics.obstacles.primitives import primitives_of
from robotraj.native.build import load_native
from robotraj.robot.collision.placements import joint_tree
from robotraj.robot.collision.robot_spheres import RobotSpheres
from robotraj.robot.robot import Robot

if TYPE_CHECKING:
    from robotraj.native._native import SphereTree


def sphere_tree(
    robot: Robot, spheres: RobotSpheres, pairs: NDArray[np.int_], obstacles: Sequence[Obstacle]
) -> SphereTree:
    """Compile a robot's spheres, sorted by link, and obstacles in the world.

    Parameters
    ----------
    robot : Robot
        Robot with a fixed base, whose joints have one position each.
    spheres : RobotSpheres
    pairs : ndarray (m, 2)
        Links that may not touch, as indices in ``spheres.links``.
    obstacles : sequence of Obstacle
        Obstacles at rest in the world.
    """
    shapes = primitives_of(obstacles)
    joints = joint_tree(robot)
    count = len(joints.parents)
    numbers = [joints.axes, joints.rotations.reshape(count, 9), joints.translations]
    order = np.argsort(spheres.link, kind="stable")
    links, groups = np.unique(spheres.link[order], return_inverse=True)
    first = order[np.searchsorted(spheres.link[order], links)]
    poses = [shapes.rotations.reshape(-1, 9), shapes.positions, shapes.dimensions]
    corners = [triangles.reshape(-1) for triangles in shapes.triangles]
    tree: SphereTree = load_native().SphereTree(
        np.array(joints.parents[1:], dtype=np.int64) - 1,
        joints.turns[1:].astype(np.int64),
        np.hstack(numbers)[1:].ravel(),
        spheres.joint[first].astype(np.int64) - 1,
        groups.astype(np.int64),
        np.column_stack([spheres.centre, spheres.radius])[order].ravel(),
        np.searchsorted(links, pairs).astype(np.int64).ravel(),
        shapes.kinds.astype(np.int64),
        np.hstack(poses).ravel(),
        np.array([len(triangles) for triangles in shapes.triangles], dtype=np.int64),
        np.concatenate([np.zeros(0), *corners]),
    )
    return tree
