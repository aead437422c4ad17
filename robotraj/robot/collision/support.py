"""How far collision shapes reach along directions."""

from __future__ import annotations

import numpy as np

from robotraj._util.arrays import Array
from robotraj.robot.collision.solids import Solid


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
