"""A robot among obstacles as geometric planners see it: configurations, distances and straight motions, no time."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from robotraj._util.values import dataclass
from robotraj.dynamics.obstacles.primitives import Primitives
from robotraj.native.build import load_native
from robotraj.robot.collision.placements import joint_tree
from robotraj.robot.collision.robot_spheres import RobotSpheres
from robotraj.robot.robot import Robot

if TYPE_CHECKING:
    from robotraj.native._native import SphereTree

Array = NDArray[np.float64]

RESOLUTION = 1e-3
"""Motions that come this close [m] to touching count as blocked, or half as close as the robot is at an end."""


@dataclass(frozen=True, eq=False)
class PathScene:
    """A robot on a fixed base among obstacles at rest.

    Attributes
    ----------
    tree : SphereTree
        The robot's spheres and the obstacles, compiled.
    lower, upper : ndarray (nq,)
        Bounds of the positions; infinite ones of joints without limits.
    speeds : ndarray (nq,)
        Largest speeds of the joints, by which motions of different joints are compared.
    margin : float
        Distance to keep [m].
    """

    tree: SphereTree
    lower: Array
    upper: Array
    speeds: Array
    margin: float

    def clearance(self, *configurations: Array) -> float:
        """Return the least distance [m] in some configurations (nq,), less the margin; negative in a collision."""
        return float(np.min(self.tree.clearances(np.concatenate(configurations)))) - self.margin

    def resolution(self, start: Array, end: Array) -> float:
        """Return how close to touching a motion may come between two configurations [m]."""
        return float(min(RESOLUTION, 0.5 * max(self.clearance(start, end), 0.0)))

    def is_free(self, first: Array, last: Array) -> bool:
        """Whether the straight motion between two configurations (nq,) keeps the margin; proved, not sampled."""
        return self.tree.motion_free(first, last, self.margin, self.resolution(first, last))


def sphere_tree(robot: Robot, spheres: RobotSpheres, pairs: NDArray[np.int_], shapes: Primitives) -> SphereTree:
    """Compile a robot's spheres and obstacles in the world.

    Parameters
    ----------
    robot : Robot
        On a fixed base, q of one number for each joint.
    spheres : RobotSpheres
    pairs : ndarray (m, 2)
        Links that may not touch, as indices in ``spheres.links``.
    shapes : Primitives
    """
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
