"""How far collision shapes reach along directions."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from robotraj.robot.collision.solids import Solid

Array = npt.NDArray[np.float64]


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
    points, radius = solid.core
    return np.asarray((directions @ points.T).max(axis=1) + radius)
