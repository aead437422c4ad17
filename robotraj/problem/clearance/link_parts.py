"""The shapes of a robot's links over a ground, and the origins of joints that carry none."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj.dynamics.terrain.base import Ground
from robotraj.problem.constraints.base import Constraint
from robotraj.problem.constraints.collision_free import disabled_pairs
from robotraj.robot.collision.own_body import OwnBody, own_body
from robotraj.robot.collision.placements import joint_tree
from robotraj.robot.collision.solids import Solid
from robotraj.robot.robot import Robot
from robotraj.robot.root import root_of


class LinkPart(NamedTuple):
    """A shape of a link, or the origin of a joint that carries none (``body`` is None).

    Attributes
    ----------
    link : str
        Frame of the link, or of the joint.
    joint : int
        Pinocchio's joint that carries it.
    """

    link: str
    joint: int
    body: OwnBody | None = None
    shape: int = 0

    def heights(self, rotations: Array, origins: Array, ground: Ground) -> Array:
        """Return the distances (m,) of the lowest points from the ground's tangent planes under them [m].

        Over uneven ground these are the lowest of points all over the surface. The joint has the rotations (m, 3, 3)
        and origins (m, 3) [m].
        """
        if self.body is None:
            return over(origins, ground)
        if not ground.even:
            points = self._in_world(self.body.solids[self.shape].wide_spots, rotations, origins)
            return np.asarray(over(points, ground).min(axis=1))
        middles = self._in_world(np.zeros((1, 3)), rotations, origins)[:, 0]
        first, second = ground.plan
        normals = np.stack(np.broadcast_arrays(*ground.normal(middles[:, first], middles[:, second])), axis=-1)
        turned = rotations @ self.body.rotation[self.shape]
        reached = support(self.body.solids[self.shape], -np.einsum("mi,mij->mj", normals, turned))
        return np.asarray(over(middles, ground) - reached)

    def lowest(self, rotations: Array, origins: Array, ground: Ground) -> tuple[Array, float]:
        """Return points (k, 3) in the joint's axes and the radius of balls about them [m].

        These are the corners of the hull, or the middles of its round ends, that are lowest in some placement.
        """
        if self.body is None:
            return np.zeros((1, 3)), 0.0
        points, radius = core(self.body.solids[self.shape])
        heights = over(self._in_world(points, rotations, origins), ground)
        chosen = points[np.unique(heights.argmin(axis=1))]
        return np.asarray(chosen @ self.body.rotation[self.shape].T + self.body.position[self.shape]), radius

    def _in_world(self, points: Array, rotations: Array, origins: Array) -> Array:
        assert self.body is not None
        local = points @ self.body.rotation[self.shape].T + self.body.position[self.shape]
        return np.asarray(np.einsum("mij,kj->mki", rotations, local) + origins[:, None])


def over(points: Array, ground: Ground) -> Array:
    """Return the distances (...) of points (..., 3) from the ground's tangent planes under them [m]."""
    height, slope_x, slope_y = ground.plane(points[..., 0], points[..., 1])
    return np.asarray((points[..., 2] - height) / np.sqrt(1.0 + slope_x**2 + slope_y**2))


def link_parts(robot: Robot, constraints: Iterable[Constraint] = ()) -> list[LinkPart]:
    """Return the shapes of all moving links, and the turning joints below the root that carry none."""
    try:
        body = own_body(robot, disabled_pairs(constraints))
    except InputError:
        # The URDF or a mesh was removed after the robot was loaded, which the claim on the own body names.
        body = None
    found = [] if body is None else [LinkPart(link, int(body.joint[i]), body, i) for i, link in enumerate(body.links)]
    shaped = {part.joint for part in found}
    tree, first = joint_tree(robot), len(root_of(robot.root).joints) + 1
    bare = [j for j in range(first, robot.model.njoints) if tree.turns[j] and j not in shaped]
    return [part for part in found if part.joint] + [LinkPart(robot.model.names[j], j) for j in bare]


def support(solid: Solid, directions: Array) -> Array:
    """Return max over the shape of d . p (m,) [m] for unit directions (m, 3) in the shape's axes.

    It is exact for spheres, capsules, cylinders, cones, ellipsoids, boxes and meshes.
    """
    shape, kind = solid.geometry, type(solid.geometry).__name__
    along, across = directions[:, 2], np.hypot(directions[:, 0], directions[:, 1])
    if kind == "Cylinder":
        return np.asarray(np.abs(along) * float(shape.halfLength) + across * float(shape.radius))
    if kind == "Cone":
        half = float(shape.halfLength)
        return np.asarray(np.maximum(along * half, across * float(shape.radius) - along * half))
    if kind == "Ellipsoid":
        return np.linalg.norm(directions * np.array(shape.radii), axis=1)
    points, radius = core(solid)
    return np.asarray((directions @ points.T).max(axis=1) + radius)


def core(solid: Solid) -> tuple[Array, float]:
    """Return points (n, 3) and the radius of balls about them, whose hull is a sphere, a capsule, a box or a hull [m].

    Around other shapes it is their box.
    """
    shape, kind = solid.geometry, type(solid.geometry).__name__
    if kind == "Sphere":
        return np.zeros((1, 3)), float(shape.radius)
    if kind == "Capsule":
        half = float(shape.halfLength)
        return np.array([[0.0, 0.0, -half], [0.0, 0.0, half]]), float(shape.radius)
    return solid.extreme_points, 0.0
