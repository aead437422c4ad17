"""Convex hulls of points by coal, flat ones included."""

from __future__ import annotations

import coal
import numpy as np

from robotraj._util.arrays import Array

FLAT = 1e-6
"""Extent along a direction, relative to the largest one, below which points are flat. Qhull's hulls need 1e-7."""
POINT = 1e-6
"""Least extent that counts as the largest one [m]."""


def convex_hull(points: Array, options: str = "") -> coal.CollisionGeometry:
    """Return the convex hull of points (n, 3) [m]; flat ones are thickened first.

    coal 3.0 ends the process on hulls of points in a plane or on a line, such as those of stickers.

    Parameters
    ----------
    points : ndarray (n, 3)
    options : str
        Of Qhull.
    """
    every = coal.StdVec_Vec3s()
    every.extend(list(thickened(points)))
    return coal.Convex.convexHull(every, False, options)


def thickened(points: Array) -> Array:
    """Return points (n, 3) with others on both sides of them in the directions in which they are flat [m]."""
    middle = points - points.mean(axis=0)
    directions = np.linalg.svd(middle.T @ middle)[2]
    extents = np.ptp(middle @ directions.T, axis=0)
    thickness = FLAT * max(float(extents.max()), POINT)
    for direction in directions[extents < thickness]:
        points = np.vstack([points - thickness * direction, points + thickness * direction])
    return points
