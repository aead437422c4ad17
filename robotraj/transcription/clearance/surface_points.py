"""Points of two links' exact surfaces that are near each other along a known motion, with the normals between them.

Where the convex hulls of two shapes are apart, their nearest points and the plane between them are enough. Elsewhere
the lowest points of each surface above the other one are taken, and the nearest points of both.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from robotraj._util.arrays import Array, Indices
from robotraj.robot.collision.own_body import OwnBody
from robotraj.robot.collision.placements import placements
from robotraj.robot.collision.solids import Placed, hull_points, surface_points
from robotraj.robot.robot import Robot

NEAR = 0.03
"""Height above the other surface up to which a point has a row [m]."""
APART = 1e-3
"""Distance of convex hulls from which the plane between them is the row [m]."""
TOUCHING = 1e-5
"""Distance of shapes up to which their nearest points have no direction [m]."""
POINTS = 4
"""Largest number of points of one surface at one place."""
SPREAD = 0.02
"""Least distance between two of these points [m]."""


class SurfacePoints(NamedTuple):
    """Points of one surface near another one.

    Attributes
    ----------
    at : ndarray of int (n,)
        Configuration of each point, in ascending order.
    first, second : ndarray (n, 3)
        Points of both surfaces in the frames of their joints [m].
    normals : ndarray (n, 3)
        From the second to the first, in the world.
    """

    at: Indices
    first: Array
    second: Array
    normals: Array


class _NearPoints(NamedTuple):
    """Points (n, 3) of both surfaces and normals in the world, of one configuration."""

    at: int
    first: Array
    second: Array
    normals: Array


def points_between(
    robot: Robot, body: OwnBody, first: int, second: int, q: Array, reach: float
) -> tuple[SurfacePoints, SurfacePoints]:
    """Return the points of the first shape near the second one at configurations q (m, nq), and those of the second.

    Configurations at which the convex hulls are farther apart than ``reach`` [m] have none. The nearest points of both
    are those of the first shape.
    """
    joints = placements(robot, q)
    of_first, of_second = list[_NearPoints](), list[_NearPoints]()
    for at, (a, b) in enumerate(zip(*(body.placed_along(shape, *joints) for shape in (first, second)), strict=True)):
        apart, *nearest = hull_points(a, b)
        if apart > APART:
            if apart <= reach:
                of_first.append(_between(at, apart, *nearest))
            continue
        apart, *nearest = surface_points(a, b)
        if apart > TOUCHING:
            of_first.append(_between(at, apart, *nearest))
        if apart < NEAR:
            of_first += _lowest(at, a, b)
            of_second += _lowest(at, b, a)
    return _in_joints(body, first, second, of_first, *joints), _in_joints(body, second, first, of_second, *joints)


def _between(at: int, apart: float, first: Array, second: Array) -> _NearPoints:
    """Return the nearest points of two shapes that are apart."""
    return _NearPoints(at, first[None], second[None], (first - second)[None] / apart)


def _lowest(at: int, moves: Placed, stays: Placed) -> list[_NearPoints]:
    """Return the lowest points of a surface above another one, at least ``SPREAD`` apart."""
    own = moves.solid.spots
    there = moves.seen_from(stays, own)
    lower, upper = stays.solid.box
    close = np.flatnonzero(np.all((there > lower - NEAR) & (there < upper + NEAR), axis=1))
    if not close.size or not len(stays.solid.spots):
        return []
    heights = stays.solid.heights(there[close], NEAR)
    close, heights = close[heights < NEAR], heights[heights < NEAR]
    chosen: list[int] = []
    while close.size and len(chosen) < POINTS:
        chosen.append(int(close[np.argmin(heights)]))
        apart = np.linalg.norm(own[close] - own[chosen[-1]], axis=1) > SPREAD
        close, heights = close[apart], heights[apart]
    if not chosen:
        return []
    kept, feet, normals = _feet(stays, there[chosen])
    return [_NearPoints(at, moves.in_world(own[chosen][kept]), stays.in_world(feet), normals @ stays.rotation.T)]


def _feet(stays: Placed, points: Array) -> tuple[Indices, Array, Array]:
    """Return which points are near a surface, the nearest points on it and its normals there, all in its axes."""
    inside = stays.solid.contains(points)
    feet = np.array([stays.solid.nearest(point) for point in points])
    apart = points - feet
    length = np.linalg.norm(apart, axis=1)
    normals = np.where(inside, -1.0, 1.0)[:, None] * apart / np.maximum(length, 1e-12)[:, None]
    # A point on the surface has no direction to it.
    kept = np.flatnonzero((inside | (length < NEAR)) & (length > 1e-6))
    return kept, feet[kept], normals[kept]


def _in_joints(
    body: OwnBody, inner: int, outer: int, found: list[_NearPoints], rotations: Array, origins: Array
) -> SurfacePoints:
    """Return points of the world in the frames of the joints that carry both shapes."""
    if not found:
        return SurfacePoints(np.zeros(0, dtype=int), *np.zeros((3, 0, 3)))
    at = np.repeat([each.at for each in found], [len(each.first) for each in found])
    first, second, normals = (np.concatenate(each) for each in list(zip(*found, strict=True))[1:])
    own, other = (
        np.einsum("nji,nj->ni", rotations[at, body.joint[shape]], points - origins[at, body.joint[shape]])
        for shape, points in ((inner, first), (outer, second))
    )
    return SurfacePoints(at, own, other, normals)
